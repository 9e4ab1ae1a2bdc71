#pragma once
#include <memory>

#include "model/lattice/screw.h"

namespace palpate {

/// A screw that an engine is asked about at later and later times, with what the engine learned of it so far.
/// Whoever asks holds it, so that an answer depends on nothing that others ask in between.
struct ScrewMotion {
  /// Nothing of it is known yet.
  explicit ScrewMotion(const Screw& along) : screw(along) {}

  /// An engine's own: what it says holds for the scene, whichever object made it.
  struct Learned {
    Learned() = default;
    Learned(const Learned&) = delete;
    Learned& operator=(const Learned&) = delete;
    virtual ~Learned() = default;
  };

  const Screw screw;
  std::unique_ptr<Learned> learned;  ///< null before the first question
};

}  // namespace palpate
