#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "model/contact/response.h"
#include "tests/equivalence/case.h"
#include "tests/mutation/questions.h"

namespace palpate::mutation {

/// What a back end answers to the cases of tests/equivalence before anything is changed, to hold its later
/// answers against.
class Oracle {
 public:
  /// Of all cases but the chapter's large ones, or only of the killer cases; not of `without`. `backend` is
  /// asked for its answers to a case just before that is first compared, between calls of unchanged(true) and
  /// unchanged(false), which take a mutant out and put it back in.
  Oracle(CollisionBackend& backend, bool killers, const std::vector<std::string>& without,
         std::function<void(bool)> unchanged);

  /// Of an engine that knows `refined` alone: no other case is asked, and the planner's questions are
  /// answered, too. Before the first answer.
  void refined_alone();

  /// Has the back end begin anew, so that no thread of its own is left, which a fork would not take along.
  void begin_anew() const;

  /// Whether distances and the planner's questions are asked again: what an engine makes for them takes most
  /// of its time. They are until this says otherwise.
  void ask_planners(bool ask) { planners_ = ask; }

  /// Asks for all answers now. Throws std::runtime_error where that fails, as all below do: then there is
  /// nothing to compare with.
  void answer_all();

  /// Called with the seconds of processor time that a case took when nothing was changed, before it is asked
  /// again.
  std::function<void(double)> before_case = [](double) {};

  /// Asks again and compares, partitions and answers, until something differs: that, with `of` the case;
  /// empty when nothing does.
  std::string first_difference_now(std::size_t& of);

  /// The same of the cases that have been compared before.
  std::string first_difference_again(std::size_t& of);

  /// Asks a few cases with one list of a frame after the other made too small, and compares what is told of
  /// it. `set_room(list, items)` is called before; an empty name: room for all.
  std::string first_overflow_difference(std::size_t& of,
                                        const std::function<void(const char*, std::uint32_t)>& set_room);

  /// The case of this name, if it is asked.
  std::optional<std::size_t> find(const std::string& name) const;

  /// Asks the first poses of a case as the back end stands: of each, what is told: nothing, which list was
  /// too small, or what differs. Returns what failed; empty: nothing.
  std::string tell(std::size_t of, std::vector<std::string>& told);

  /// Of processor time, that a case took when nothing was changed.
  double seconds(std::size_t of) const { return cases_[of].seconds; }

  /// As first_difference_now() of what the host does before and after a back end: geometry made again from
  /// the meshes, and the answers' response. The back end is not asked.
  std::string first_host_difference(std::size_t& of) const;

  /// From now on this case is asked first: it has just caught a mutant, and the next one is often its
  /// neighbour.
  void ask_first(std::size_t c);

  std::size_t size() const { return cases_.size(); }
  const SceneGeometry& geometry(std::size_t c) const { return cases_[c].geometry; }
  const std::string& name(std::size_t c) const { return cases_[c].name; }

 private:
  struct Query {
    LatticePose pose;
    std::optional<Ignored> ignored;  ///< what is left out, or coarser
    Contacts answer;
    ContactResponse response;
    std::optional<Clearance> clearance;  ///< empty: the back end measures none
  };
  struct Case {
    std::string name;
    const equivalence::Case* wanted = nullptr;
    bool answered = false;
    double seconds = 0;  ///< of processor time, to answer
    SceneGeometry geometry;
    Plan plan;
    VoxelPartition mockup, tool;
    std::vector<Query> queries;
    std::optional<Questions> questions;  ///< where these are asked
  };
  /// A pose's answer when a list is too small.
  struct Overflow {
    const char* list;
    std::uint32_t room;
    std::size_t of;
    std::vector<std::string> told;  ///< of each pose
  };
  void answer(Case& c);
  std::string ask(const Case& c) const;
  std::string ask_host(const Case& c) const;

  CollisionBackend& backend_;
  std::function<void(bool)> unchanged_;
  std::vector<equivalence::Case> wanted_;
  std::vector<Case> cases_;
  std::vector<std::size_t> order_;
  std::vector<Overflow> overflows_;
  bool refined_alone_ = false, planners_ = true;
};

}  // namespace palpate::mutation
