#include "service/cli/query_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>

namespace palpate {
namespace {

std::string vector_text(const Vec3& v) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z); }

std::string flags_text(std::uint32_t bits) {
  std::string out;
  for (std::size_t i = 0; i < flag_names.size(); ++i)
    if (bits >> i & 1u) out += (out.empty() ? "" : ", ") + std::string(flag_names[i]);
  return out;
}

std::string list_text(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out.empty() ? "none" : out;
}

/// The deepest of the areas, m.
double depth_of(const ContactResponse& response) {
  double out = 0;
  for (const AreaResponse& area : response.areas) out = std::max(out, area.depth);
  return out;
}

}  // namespace

std::string answer_text(const Pose& pose, const Contacts& contacts, const ContactResponse& response,
                        const TouchedParts* parts) {
  const auto line = [](const char* name, const std::string& value) {
    return fmt::format("{:<10} {}\n", name, value);
  };
  const auto& [p, q] = pose;
  std::string out = line("pose", fmt::format("{} m, turned by ({:.4g}, {:.4g}, {:.4g}, {:.4g})",
                                             vector_text(p), q.x, q.y, q.z, q.w));
  if (contacts.truncated) return out + line("contact", "unknown: the frame was truncated and gives no force");
  if (!contacts.contact) return out + line("contact", "none");
  out += line("contact", fmt::format("{} pairs of triangles, {} {}", contacts.pairs, contacts.areas.size(),
                                     contacts.areas.size() == 1 ? "area" : "areas"));
  if (parts) {
    out += line("mock-up", list_text(parts->statics(contacts)));
    out += line("tool", list_text(parts->mobiles(contacts)));
  }
  const Wrench& told = response.told();
  out +=
      line("force", fmt::format("{} N, {:.4g} N in all", vector_text(told.force), glm::length(told.force)));
  if (response.contact_points)
    out += line("torque", fmt::format("{} N·m about the tool's centre of mass, {:.4g} N·m in all",
                                      vector_text(told.torque), glm::length(told.torque)));
  if (const std::string flags = flags_text(response.flags); !flags.empty()) out += line("flags", flags);
  if (response.felt && !response.areas.empty())
    out += line("",
                "felt by a hand at rest there; the areas' forces are of the pose itself, from the mock-up's "
                "samples alone");
  for (std::size_t i = 0; i < std::min(contacts.areas.size(), response.areas.size()); ++i) {
    const AreaResponse& area = response.areas[i];
    std::string text = fmt::format("{:.4g} mm deep, along {}", 1000 * area.depth, vector_text(area.normal));
    if (response.contact_points) text += fmt::format(", at {} m", vector_text(area.point));
    text += fmt::format(", {:.4g} N", glm::length(area.force));
    if (const std::string flags = flags_text(area.flags); !flags.empty()) text += fmt::format(" [{}]", flags);
    out += line(fmt::format("area {}", i + 1).c_str(), text);
  }
  return out;
}

std::string answer_table_head() {
  return fmt::format("{:>7}  {:>7}  {:>5}  {:>8}  {:>9}  {:>10}  {}\n", "pose", "pairs", "areas", "depth mm",
                     "force N", "torque N·m", "flags");
}

std::string answer_table_line(std::uint64_t number, const Contacts& contacts, const ContactResponse& response,
                              const TouchedParts* parts) {
  const Wrench& told = response.told();
  std::string words = contacts.truncated ? "truncated" : flags_text(response.flags);
  if (parts && contacts.contact)
    words += fmt::format("{}{} touches {}", words.empty() ? "" : "; ", list_text(parts->mobiles(contacts)),
                         list_text(parts->statics(contacts)));
  std::string out = fmt::format("{:>7}  {:>7}  {:>5}  {:>8.4g}  {:>9.4g}  {:>10.4g}  {}", number,
                                contacts.pairs, contacts.areas.size(), 1000 * depth_of(response),
                                glm::length(told.force), glm::length(told.torque), words);
  while (out.back() == ' ') out.pop_back();
  return out + "\n";
}

}  // namespace palpate
