#pragma once
#include <cstdint>
#include <string>

#include "model/contact/contacts.h"
#include "model/contact/response.h"
#include "model/lattice/pose.h"
#include "service/queries/touched_parts.h"

namespace palpate {

/// An answer for a person: what touches, how deep and with which force; no lists of triangles. `parts`: null
/// where they are not asked for.
std::string answer_text(const Pose& pose, const Contacts& contacts, const ContactResponse& response,
                        const TouchedParts* parts);

/// A line of the table that several poses make, and the line above it. `number` counts from 0, as the JSON
/// has it.
std::string answer_table_head();
std::string answer_table_line(std::uint64_t number, const Contacts& contacts, const ContactResponse& response,
                              const TouchedParts* parts);

}  // namespace palpate
