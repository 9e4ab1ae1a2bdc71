#pragma once
#include <cstddef>
#include <cstdint>

namespace palpate {

/// What a client may ask of the server. All chosen; the first group has flags of `palpate serve`.
struct ServerLimits {
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;    ///< prepared scenes together
  std::uint64_t upload_bytes = std::uint64_t{512} << 20;  ///< body of an upload
  std::uint64_t triangles = 10'000'000;                   ///< of a scene, both bodies
  std::uint64_t poses = 100'000;                          ///< of a query
  std::size_t connections = 1024;

  std::uint64_t disk_bytes = std::uint64_t{8} << 30;  ///< uploads kept on disk together
  std::size_t header_bytes = 16 << 10;
  std::size_t json_bytes = 1 << 20;      ///< body of any JSON but poses
  std::size_t poses_bytes = 64 << 20;    ///< body of a query
  std::size_t message_bytes = 64 << 10;  ///< a WebSocket message of a client
  std::size_t json_depth = 32;
  std::size_t upload_files = 64;
  std::size_t scenes = 256;  ///< known at a time, ready or not
  std::size_t sessions = 16;
  std::size_t loops = 64;            ///< haptic connections
  std::size_t batches = 256;         ///< queries being answered
  std::uint32_t voxels = 4'000'000;  ///< of a class, in one answer

  double header_s = 10, idle_s = 60;  ///< until a request's head is whole; between requests
  double piece_s = 10;                ///< without a byte of a body, or of a client that reads
  double slowest_bytes_per_s = 4096;  ///< a body's size over this, and piece_s, is the time it may take
};

}  // namespace palpate
