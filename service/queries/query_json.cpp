#include "service/queries/query_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "service/queries/path_check.h"

namespace palpate {
namespace {

/// Writes JSON with fmt, whose shortest form of a double reads back to the same bits.
class Writer {
 public:
  explicit Writer(std::string& out) : out_(out) {}

  void open(char bracket) {
    separate();
    out_.push_back(bracket);
    first_ = true;
  }
  void close(char bracket) {
    out_.push_back(bracket);
    first_ = false;
  }
  /// Keys and strings here are names of ours: nothing in them needs escaping.
  void key(std::string_view name) {
    separate();
    fmt::format_to(std::back_inserter(out_), "\"{}\":", name);
    first_ = true;
  }
  void text(std::string_view value) {
    separate();
    fmt::format_to(std::back_inserter(out_), "\"{}\"", value);
  }
  void text_or_null(std::string_view value) {
    if (!value.empty()) return text(value);
    separate();
    out_ += "null";
  }
  void boolean(bool value) {
    separate();
    out_ += value ? "true" : "false";
  }
  void number(double value) {
    separate();
    if (std::isfinite(value))
      fmt::format_to(std::back_inserter(out_), "{}", value);
    else
      out_ += "null";
  }
  template <class Integer>
  void integer(Integer value) {
    separate();
    fmt::format_to(std::back_inserter(out_), "{}", value);
  }
  void vector(std::string_view name, const Vec3& v) {
    key(name);
    open('[');
    for (int i = 0; i < 3; ++i) number(v[i]);
    close(']');
  }
  void vector_or_null(std::string_view name, const Vec3& v, bool known) {
    if (known) return vector(name, v);
    key(name);
    separate();
    out_ += "null";
  }
  void pose(std::string_view name, const Pose& pose) {
    const auto& [p, q] = pose;
    key(name);
    open('[');
    for (const double one : {p.x, p.y, p.z, q.x, q.y, q.z, q.w}) number(one);
    close(']');
  }
  void ids(std::span<const std::uint32_t> list) {
    open('[');
    for (const std::uint32_t id : list) integer(id);
    close(']');
  }
  void ids(std::string_view name, std::span<const std::uint32_t> list) {
    key(name);
    ids(list);
  }
  /// A file's own words.
  void strings(std::string_view name, const std::vector<std::string>& list) {
    key(name);
    separate();
    out_ += nlohmann::json(list).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  void flags(std::uint32_t bits) {
    key("flags");
    open('[');
    for (std::size_t i = 0; i < flag_names.size(); ++i)
      if (bits >> i & 1u) text(flag_names[i]);
    close(']');
  }

 private:
  void separate() {
    if (!first_) out_.push_back(',');
    first_ = false;
  }

  std::string& out_;
  bool first_ = true;
};

/// Clocks tell no less than a nanosecond; more digits would be noise of the arithmetic.
double to_nanoseconds(double us) { return std::round(us * 1000) / 1000; }

void write_area(Writer& json, const QueryLine& line, const ContactArea& area, const AreaResponse& response,
                bool points) {
  json.open('{');
  json.key("id");
  json.integer(area.id);
  if (line.sets && line.area_lists) {
    json.key("zones");
    json.open('[');
    for (const auto& zone : area.zones) json.ids(zone);
    json.close(']');
    json.ids("static", area.static_ids);
    json.ids("mobile", area.mobile_ids);
  }
  json.vector("normal", response.normal);
  json.key("depth");
  json.number(response.depth);
  json.vector_or_null("point", response.point, points);
  json.vector("force", response.force);
  json.vector_or_null("torque", response.torque, points);
  json.flags(response.flags);
  if (line.heights) {
    json.key("rays");
    json.integer(area.rays);
    json.key("max_depth");
    json.number(response.max_depth);
  }
  json.close('}');
}

}  // namespace

void append_query_line(const QueryLine& line, const Contacts& contacts, const ContactResponse& response,
                       std::string& out) {
  Writer json(out);
  json.open('{');
  json.key("number");
  json.integer(line.number);
  if (line.pose) json.pose("pose", *line.pose);
  json.key("contact");
  json.boolean(contacts.contact);
  json.key("pairs");
  json.integer(contacts.pairs);
  if (line.sets) {
    json.ids("cst", contacts.cst);
    json.ids("bst", contacts.bst);
    json.ids("cmt", contacts.cmt);
    json.ids("bmt", contacts.bmt);
    json.ids("imt", contacts.imt);
    json.ids("est", contacts.est);
  }
  if (line.parts) {
    json.key("parts");
    json.open('{');
    json.strings("static", line.parts->statics(contacts));
    json.strings("tool", line.parts->mobiles(contacts));
    json.close('}');
  }
  json.key("areas");
  json.open('[');
  // A truncated frame has no response at all.
  for (std::size_t i = 0; i < contacts.areas.size(); ++i)
    write_area(json, line, contacts.areas[i], i < response.areas.size() ? response.areas[i] : AreaResponse{},
               response.contact_points);
  json.close(']');
  json.vector("force", response.told().force);
  json.vector_or_null("torque", response.told().torque, response.contact_points);
  json.flags(response.flags);
  if (response.felt) {
    json.pose("tool", response.felt->tool);
    json.key("evaluations");
    json.integer(response.felt->evaluations);
  }
  json.key("truncated");
  json.boolean(contacts.truncated);
  json.key("engine");
  json.text_or_null(contacts.engine);
  json.key("time_us");
  json.open('{');
  json.key("total");
  json.number(to_nanoseconds(line.total_us));
  for (const Contacts::StageTime& time : contacts.times) {
    json.key(time.stage);
    json.number(to_nanoseconds(time.us));
  }
  json.close('}');
  if (line.batch) {
    json.key("batch");
    json.integer(*line.batch);
  }
  if (line.tick) {
    json.key("tick");
    json.integer(*line.tick);
  }
  json.close('}');
  out.push_back('\n');
}

void append_clearance_line(const SceneGeometry& geometry, std::size_t number, const Pose& pose,
                           const Clearance& c, bool touches, const std::string& engine, std::string& out) {
  using Json = nlohmann::ordered_json;
  const double step = geometry.lattice.step_m;
  const auto point = [&](const Int3& p) {
    const Vec3 at = geometry.lattice.origin_m + step * Vec3(p);
    return Json{at.x, at.y, at.z};
  };
  const Vec3& p = pose.position;
  const Quat& q = pose.rotation;
  Json line{{"number", number},
            {"pose", {p.x, p.y, p.z, q.x, q.y, q.z, q.w}},
            {"engine", engine},
            {"touches", touches}};
  line["clearance"] = c.kind == Clearance::Kind::kFurther ? Json(nullptr) : Json(c.steps * step);
  if (c.kind == Clearance::Kind::kApart) {
    line["static"] = c.static_id;
    line["mobile"] = c.mobile_id;
    line["on_static"] = point(c.on_static);
    line["on_mobile"] = point(c.on_mobile);
    line["parts"] = {{"static", part_of(geometry.mockup_report, c.static_id)},
                     {"mobile", part_of(geometry.tool_report, c.mobile_id)}};
  }
  out += line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::int32_t within_steps(const SceneGeometry& geometry, std::optional<double> within_m) {
  if (!within_m) return INT32_MAX - 2;
  return static_cast<std::int32_t>(std::min(*within_m / geometry.lattice.step_m, 0x1p30));
}

}  // namespace palpate
