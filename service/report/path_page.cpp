#include "service/report/path_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "service/cli/numbers.h"
#include "service/report/chart_svg.h"
#include "service/report/markup.h"
#include "service/report/report_assets.h"
#include "service/report/section_svg.h"

namespace palpate {
namespace {

constexpr std::size_t kMostRows = 400;  // of the page's table; the CSV has all (chosen)

std::string pair_text(const std::string& tool, const std::string& fixed) {
  if (tool.empty() && fixed.empty()) return "";
  return markup_text(tool.empty() ? "the tool" : tool) + " and " +
         markup_text(fixed.empty() ? "the mock-up" : fixed);
}

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + markup_text(name);
  return out;
}

std::string tile(const std::string& value, const std::string& what) {
  return "<div class=\"tile\"><b>" + value + "</b><span>" + what + "</span></div>";
}

/// Triangles meet, and no sample of either body lies in the other.
bool has_unknown_depth(const PathMoment& moment) { return moment.depth_m == 0.0; }

double tool_size(const SceneGeometry& geometry) {
  const Int3 size = geometry.tool.box_max - geometry.tool.box_min;
  return geometry.lattice.step_m * std::max({size.x, size.y, size.z});
}

/// Two sections of a moment, the whole tool and what is close.
std::string pictures(const LoadedScene& scene, const PathMoment& moment, const std::string& title) {
  const SceneGeometry& geometry = scene.geometry;
  const auto pose = to_lattice(moment.pose, geometry);
  if (!pose || pose->beyond_lattice) return "";
  const double voxel = geometry.mockup_grid.size * geometry.lattice.step_m;
  SectionView near;
  double gap = 0;
  if (moment.clearance.kind == Clearance::Kind::kApart) {
    const Vec3 a = in_world(geometry, moment.clearance.on_static),
               b = in_world(geometry, moment.clearance.on_mobile);
    gap = moment.clearance.steps * geometry.lattice.step_m;
    near = section_through(0.5 * (a + b), b - a, std::max(12 * gap, 4 * voxel));
    near.gap = true;
    near.on_static = a;
    near.on_mobile = b;
    near.label = length_text(gap);
  } else {
    near = section_through(moment.where.value_or(in_world(geometry, pose->translation)), moment.facing,
                           4 * voxel);
    near.label = moment.depth_m ? "up to " + length_text(*moment.depth_m) + " deep" : "";
  }
  turn_through_tool(
      geometry, *pose,
      moment.clearance.kind == Clearance::Kind::kApart ? near.on_mobile - near.on_static : moment.facing,
      near);
  SectionView whole = near;
  whole.width_m = 2 * near.width_m;
  show_tool(geometry, *pose, whole);
  whole.label.clear();
  if (moment.clearance.kind != Clearance::Kind::kApart) near.width_m = 0.6 * tool_size(geometry);
  const auto figure = [&](const SectionView& view, const std::string& caption) {
    return "<figure class=\"bench\"><figcaption>" + caption + "</figcaption><div class=\"picture\">" +
           section_svg(geometry, *pose, view) + "</div></figure>";
  };
  return "<h2>" + title + "</h2><p class=\"lead\">" + pair_text(moment.tool_part, moment.static_part) +
         "</p><div class=\"pair\">" +
         figure(whole, "Section <span>the whole tool; mock-up orange, tool blue</span>") +
         figure(near, "Section <span>enlarged</span>") + "</div>";
}

std::string chart(const PathReport& report, const char* title, const char* label,
                  const std::function<std::optional<double>(const PathMoment&)>& value) {
  Chart out{.title = title, .unit = "mm", .labels = {}, .series = {{label, {}, {}}}, .x_title = "pose"};
  for (std::size_t i = 0; i < report.moments.size(); ++i)
    if (const auto v = value(report.moments[i])) {
      out.series[0].x.push_back(static_cast<double>(i));
      out.series[0].y.push_back(*v * 1e3);
    }
  if (out.series[0].x.size() < 2 || *std::max_element(out.series[0].y.begin(), out.series[0].y.end()) == 0)
    return "";  // a line along 0 tells nothing
  return "<figure class=\"bench\"><div class=\"picture\">" + chart_svg(out) + "</div></figure>";
}

}  // namespace

std::string path_page(const LoadedScene& scene, const PathReport& report, const std::string& path_name,
                      const std::string& scene_name, const std::string& engine) {
  const double step = scene.geometry.lattice.step_m;
  std::string body = "<header><h1>" +
                     std::string(report.clear() ? "The path is clear" : "The path is not clear") +
                     "</h1><p>" + markup_text(path_name) + " in " + markup_text(scene_name) +
                     ", examined by the engine " + markup_text(engine) + "</p></header>";
  body += "<div class=\"tiles\">";
  if (report.first_screw)
    body += tile(
        *report.first_screw == 0
            ? "at the start"
            : fmt::format("pose {:.4f}", static_cast<double>(*report.first_screw) - 1 + report.first_time),
        "first contact");
  if (report.closest)
    body += tile(length_text(report.moments[*report.closest].clearance.steps * step),
                 fmt::format("least clearance where free, at pose {}", *report.closest));
  if (report.deepest)
    body += tile(length_text(*report.moments[*report.deepest].depth_m),
                 fmt::format("worst depth, at pose {}", *report.deepest));
  if (report.rule.tolerance > 0)
    body += tile(length_text(report.rule.tolerance * step), "tolerance: shallower contacts don't count");
  body += tile(fmt::format("{}", report.moments.size()), "poses examined");
  body += tile(fmt::format("{}", report.screws), "screw motions between them examined");
  body += tile(fmt::format("{}", report.evaluations), "evaluations");
  body += tile(length_text(report.rule.early * step), "a first contact is early by no more, and never late");
  body += "</div><section>";
  const auto undecided = std::count_if(report.moments.begin(), report.moments.end(),
                                       [](const PathMoment& m) { return m.undecided; });
  if (undecided > 0)
    body += fmt::format(
        "<div class=\"notes\"><p>{} motions run along so near to the mock-up that they were left where they "
        "stood: they count as not clear.</p></div>",
        undecided);
  if (report.without_depth > 0)
    body += fmt::format(
        "<div class=\"notes\"><p>At {} of {} poses triangles meet and no sample of either body lies in the "
        "other: no depth is known there to hold against the tolerance, and the contact does not count "
        "(sheets, or surfaces that coincide).</p></div>",
        report.without_depth, report.moments.size());
  if (!report.closest && !report.deepest)
    body +=
        "<p class=\"lead\" style=\"margin-top:14px\">At no pose is the tool in touch, or so near that its "
        "distance was measured.</p>";
  if (!report.first_static.empty() || !report.first_tool.empty())
    body += "<p class=\"lead\" style=\"margin-top:14px\">First to come together: " +
            pair_text(report.first_tool, report.first_static) + ".</p>";
  if (!report.static_parts.empty())
    body += "<p class=\"lead\">Parts that touch at some pose: " + joined(report.tool_parts) + " with " +
            joined(report.static_parts) + ".</p>";
  body += chart(report, "Clearance", "clearance", [&](const PathMoment& m) -> std::optional<double> {
    if (m.clearance.kind == Clearance::Kind::kFurther) return std::nullopt;
    return m.clearance.steps * step;
  });
  body += chart(report, "Depth of contact", "depth", [](const PathMoment& m) -> std::optional<double> {
    if (has_unknown_depth(m)) return std::nullopt;
    return m.depth_m.value_or(0);
  });
  if (report.first_screw && report.first_pose) {
    // Where it comes together: the nearest moment's witnesses, if that is apart.
    PathMoment first = report.moments[*report.first_screw];
    first.pose = *report.first_pose;
    if (*report.first_screw > 0 &&
        report.moments[*report.first_screw - 1].clearance.kind == Clearance::Kind::kApart)
      first = report.moments[*report.first_screw - 1];
    body += pictures(scene, first,
                     *report.first_screw == 0 ? "Where it starts" : "Just before the first contact");
  }
  if (report.deepest)
    body +=
        pictures(scene, report.moments[*report.deepest], fmt::format("Deepest, at pose {}", *report.deepest));
  if (report.closest)
    body += pictures(scene, report.moments[*report.closest],
                     fmt::format("Closest while free, at pose {}", *report.closest));
  body +=
      "<h2>Poses</h2><div "
      "class=\"scroll\"><table><tr><th>pose</th><th>travel</th><th>clearance</th><th>depth</th><th>first "
      "contact before it</th><th>tool part</th><th>mock-up part</th></tr>";
  const std::size_t every = (report.moments.size() + kMostRows - 1) / kMostRows;
  for (std::size_t i = 0; i < report.moments.size(); i += every) {
    const PathMoment& m = report.moments[i];
    body += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>", i,
        length_text(m.travel_m),
        m.clearance.kind == Clearance::Kind::kFurther    ? "further"
        : m.clearance.kind == Clearance::Kind::kTouching ? (m.touches ? "touches" : "within tolerance")
                                                         : length_text(m.clearance.steps * step),
        has_unknown_depth(m) ? "unknown"
        : m.depth_m          ? length_text(*m.depth_m)
                             : "",
        m.first_contact
            ? fmt::format("{:.4f}", (i == 0 ? 0.0 : static_cast<double>(i) - 1) + *m.first_contact)
            : "",
        markup_text(m.tool_part), markup_text(m.static_part));
  }
  body += "</table></div></section>";
  if (every > 1) body += fmt::format("<p class=\"lead\">Every {}th pose; path.csv has all.</p>", every);
  return "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width\"><title>Path report</title><style>" +
         std::string(assets::report_css) + "</style></head><body><main>" + body + "</main></body></html>\n";
}

}  // namespace palpate
