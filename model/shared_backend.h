#pragma once
#include <functional>
#include <memory>

#include "model/collision_backend.h"

namespace palpate {

/// A back end whose prepared scene several may ask at once.
class SharedBackend {
 public:
  /// Makes one more that answers as this one does, of the same prepared scene. May be called by any thread,
  /// whoever asks this or another meanwhile, and when this is gone; the geometry must be there.
  using Another = std::function<std::unique_ptr<CollisionBackend>()>;

  virtual ~SharedBackend() = default;
  /// Not while anything asks this. Empty: nothing has been prepared, or there can be only one.
  virtual Another another() const = 0;
};

}  // namespace palpate
