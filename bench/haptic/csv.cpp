#include "bench/haptic/csv.h"

#include <fmt/format.h>
#include <fmt/os.h>

#include <utility>

namespace yardstick {
namespace {

std::string cell(const std::optional<double>& value) { return value ? fmt::format("{:.6g}", *value) : ""; }
std::string cells(const std::optional<Vec3>& value) {
  return value ? fmt::format("{:.9g},{:.9g},{:.9g}", value->x, value->y, value->z) : ",,";
}

using Column = std::pair<const char*, std::optional<double>>;

std::vector<Column> columns(const Measured& m, const Figures& f) {
  return {{"direction_p50_deg", f.direction_p50_deg},
          {"direction_p95_deg", f.direction_p95_deg},
          {"magnitude_p50", f.magnitude_p50},
          {"magnitude_p95", f.magnitude_p95},
          {"torque_p50", f.torque_p50},
          {"torque_p95", f.torque_p95},
          {"step", f.step},
          {"noise", f.noise},
          {"loop_lost", f.loop_lost},
          {"frame_p50_us", f.frame_p50_us},
          {"frame_p99_us", f.frame_p99_us},
          {"evaluation_p50_us", f.evaluation_p50_us},
          {"unsettled", f.unsettled},
          {"memory_mib", m.memory_mib},
          {"prepare_s", m.prepare_s}};
}

}  // namespace

void write_samples(const std::string& file, const Case& subject, const Measured& measured) {
  auto out = fmt::output_file(file);
  out.print(
      "part,x,y,z,qx,qy,qz,qw,fx,fy,fz,tx,ty,tz,true_fx,true_fy,true_fz,true_tx,true_ty,true_tz,way_x,way_y,"
      "way_z,scale,evaluations,settled,wall_us,cpu_us\n");
  for (const auto& [part, samples] : {std::pair{"path", &measured.path}, std::pair{"loop", &measured.loop},
                                      std::pair{"rest", &measured.rest}})
    for (std::size_t i = 0; i < samples->size(); ++i) {
      const Sample& s = (*samples)[i];
      const Truth truth =
          samples == &measured.path && i < subject.truths.size() ? subject.truths[i] : Truth{};
      const Quat& q = s.hand.rotation;
      out.print(
          "{},{},{:.12g},{:.12g},{:.12g},{:.12g},{},{},{},{},{},{:.9g},{},{},{:.2f},{:.2f}\n", part,
          fmt::format("{:.12g},{:.12g},{:.12g}", s.hand.position.x, s.hand.position.y, s.hand.position.z),
          q.x, q.y, q.z, q.w, cells(s.answer.wrench.force), cells(s.answer.wrench.torque), cells(truth.force),
          cells(truth.torque), cells(truth.way), truth.scale, s.answer.evaluations, s.answer.settled ? 1 : 0,
          s.wall_us, s.cpu_us);
    }
}

std::string figures_head() {
  std::string out = "case,group,method";
  for (const Column& column : columns({}, {})) out += fmt::format(",{}", column.first);
  return out + "\n";
}

std::string figures_row(const Case& subject, const std::string& method, const Measured& measured,
                        const Figures& figures) {
  std::string out = fmt::format("\"{}\",{},{}", subject.name, subject.group, method);
  for (const Column& column : columns(measured, figures)) out += "," + cell(column.second);
  return out + "\n";
}

}  // namespace yardstick
