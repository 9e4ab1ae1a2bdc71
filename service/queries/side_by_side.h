#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "model/collision_backend.h"

namespace palpate {

/// Piece `i` of some work, asking `backend`, and nobody else.
using BackendWork = std::function<Result<void>(CollisionBackend& backend, std::size_t i)>;
/// Asked between two pieces, with how many have been begun; false: no more are.
using GoOn = std::function<bool(std::size_t begun)>;

/// Does pieces 0 … count − 1 in any order: this thread asks `own`, a thread each the `others`, as far as
/// threads can be had. Returns how many of the first pieces have been done: all, or fewer where `go_on`,
/// which this thread asks, said no. Error: a piece's, which ends the whole, or there was no memory for one.
Result<std::size_t> side_by_side(CollisionBackend& own, std::span<CollisionBackend* const> others,
                                 std::size_t count, const BackendWork& work, const GoOn& go_on);

/// A back end and, on the other processors, others of the same prepared scene (SharedBackend), where it can
/// have such: for questions that it does not share out itself (distances, first contacts). Nobody else asks
/// it meanwhile. The others are made when they are first worth it.
class Fellows {
 public:
  explicit Fellows(CollisionBackend& own) : own_(own) {}
  /// As side_by_side().
  Result<std::size_t> ask(std::size_t count, const BackendWork& work, const GoOn& go_on);

 private:
  CollisionBackend& own_;
  bool alone_ = false;  ///< there are no more to be had
  std::vector<std::unique_ptr<CollisionBackend>> made_;
};

}  // namespace palpate
