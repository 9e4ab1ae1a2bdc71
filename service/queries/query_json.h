#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "model/contact/clearance.h"
#include "model/contact/contacts.h"
#include "model/contact/response.h"
#include "model/lattice/pose.h"
#include "model/scene/scene_geometry.h"
#include "service/queries/touched_parts.h"

namespace palpate {

/// What a line says beside the contacts and the response.
struct QueryLine {
  std::uint64_t number = 0;            ///< of the pose, from 0
  double total_us = 0;                 ///< wall time from pose in to wrench and id lists out, µs
  std::optional<std::uint64_t> batch;  ///< `--batch N`: times are the pose's share
  std::optional<std::int64_t> tick;    ///< frames.jsonl: the tick whose pose was judged
  bool sets = true;                    ///< false: without the lists of ids
  bool area_lists = true;              ///< false: without those of which triangles belong to an area
  const TouchedParts* parts =
      nullptr;  ///< `parts`: the paths of the parts that touch, {"static": […], "tool": […]}; null: without
  bool heights =
      false;  ///< areas tell their samples, too: `rays` that gave a height, `max_depth`, the largest, in m
  const Pose* pose = nullptr;  ///< `pose`: what was asked, [x, y, z, qx, qy, qz, qw]; null: without
};

/// Appends one JSON object and a line feed to `out`: the fields of `palpate query` in the contract's order
/// (`tick` last). Numbers in the shortest form that reads back to the same double; one that is not finite
/// becomes null. Allocates only when `out` has to grow. Not for the 1 kHz thread.
void append_query_line(const QueryLine& line, const Contacts& contacts, const ContactResponse& response,
                       std::string& out);

/// Appends how far the tool is from the mock-up at `pose`, as one JSON object and a line feed: `number`,
/// `pose`, `engine`, `touches`, `clearance` in m (null: further than was asked), and of two that are apart
/// the nearest triangles, points and parts.
void append_clearance_line(const SceneGeometry& geometry, std::size_t number, const Pose& pose,
                           const Clearance& clearance, bool touches, const std::string& engine,
                           std::string& out);

/// What CollisionBackend::clearance is asked for where poses further than `within_m` have no line; none: as
/// far as it can be told.
std::int32_t within_steps(const SceneGeometry& geometry, std::optional<double> within_m);

}  // namespace palpate
