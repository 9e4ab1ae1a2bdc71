#pragma once
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "tests/equivalence/case.h"

namespace palpate::mutation {

/// What a back end answers to the cases of tests/equivalence before anything is changed, to hold its later answers against.
class Oracle {
 public:
  /// Asks `backend` all cases but the chapter's large ones, or only the killer cases. Throws std::runtime_error where it fails: then
  /// there is nothing to compare with.
  Oracle(CollisionBackend& backend, bool killers);

  /// Asks again and compares, partitions and answers, until something differs: that, with `of` the case; empty when nothing does.
  std::string first_difference_now(std::size_t& of) const;

  /// From now on this case is asked first: it has just caught a mutant, and the next one is often its neighbour.
  void ask_first(std::size_t c);

  std::size_t size() const { return cases_.size(); }
  const std::string& name(std::size_t c) const { return cases_[c].name; }

 private:
  struct Query {
    LatticePose pose;
    Held held;
    bool remembers = false;
    Contacts answer;
  };
  struct Case {
    std::string name;
    SceneGeometry geometry;
    Plan plan;
    VoxelPartition mockup, tool;
    std::vector<Query> queries;
  };
  void answer(const equivalence::Case& wanted);
  std::string ask(const Case& c) const;

  CollisionBackend& backend_;
  std::vector<Case> cases_;
  std::vector<std::size_t> order_;
};

}  // namespace palpate::mutation
