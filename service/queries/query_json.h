#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "model/contact/contacts.h"
#include "model/contact/response.h"
#include "model/lattice/pose.h"
#include "service/queries/touched_parts.h"

namespace palpate {

/// What a line says beside the contacts and the response.
struct QueryLine {
  std::uint64_t number = 0;            ///< of the pose, from 0
  double total_us = 0;                 ///< wall time from pose in to wrench and id lists out, µs
  std::optional<std::uint64_t> batch;  ///< `--batch N`: times are the pose's share
  std::optional<std::int64_t> tick;    ///< frames.jsonl: the tick whose pose was judged
  bool sets = true;                    ///< false: without the lists of ids
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

}  // namespace palpate
