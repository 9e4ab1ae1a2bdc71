#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Number of a static and of a mobile triangle that meet.
using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// Another collision library, as a user would pick it instead: it finds all pairs of triangles that meet at a
/// pose, nothing more. One thread. The bodies are what both sides judge: the integer meshes, as metres from
/// the lattice's origin.
class Peer {
 public:
  virtual ~Peer() = default;
  virtual std::string name() const = 0;     ///< "FCL OBB"
  virtual std::string version() const = 0;  ///< "0.7.0"
  /// Builds what the library builds once. `geometry` outlives the peer.
  virtual void build(const SceneGeometry& geometry) = 0;
  /// Replaces the contents of `pairs`, each pair once, in any order.
  virtual void find(const LatticePose& pose, std::vector<TrianglePair>& pairs) = 0;
};

/// Another collision library, asked what a planner asks. One thread. Of a tool wholly inside a closed mock-up
/// such libraries say that it does not touch, and how far the surfaces are apart.
class QuestionPeer {
 public:
  virtual ~QuestionPeer() = default;
  virtual std::string name() const = 0;     ///< "FCL OBBRSS"
  virtual std::string version() const = 0;  ///< "0.7.0"
  /// As Peer::build().
  virtual void build(const SceneGeometry& geometry) = 0;
  /// None: it is not made for this question.
  virtual std::optional<bool> touches(const LatticePose& pose) = 0;
  /// Metres between the two surfaces; 0 or less where they meet.
  virtual double distance(const LatticePose& pose) = 0;
};

/// The peers of this build, in the order of their columns, and last the judge: palpate's own integers
/// ("exact"), slow, never timed. Defined in bench/peers, which is built only when asked for
/// (PALPATE_BENCH_PEERS).
std::vector<std::unique_ptr<Peer>> make_peers();
std::unique_ptr<Peer> make_judge();
std::vector<std::unique_ptr<QuestionPeer>> make_question_peers();

}  // namespace palpate
