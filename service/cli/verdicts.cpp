#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "service/cli/cli.h"
#include "service/cli/console.h"
#include "service/cli/scene_host.h"
#include "service/cli/text_output.h"
#include "service/queries/path_check.h"
#include "service/queries/portions.h"
#include "service/queries/query_json.h"
#include "service/queries/side_by_side.h"

namespace palpate {
namespace {

constexpr std::size_t kMostAtOnce = 4096;  // poses between two looks at the keyboard (chosen)

/// Of one pose.
struct Verdict {
  bool touches = false;  ///< under the tolerance
  Clearance clearance;
  std::string engine;  ///< that answered
};

}  // namespace

Result<void> verdicts_command(const QueryOptions& options, const std::vector<Pose>& poses,
                              const Parts& parts) {
  catch_interrupts();
  Console console;
  auto prepared = prepare_for_verdicts(options.common, options.tolerance_m, parts, console);
  if (!prepared) return prepared.error();
  const SceneGeometry& geometry = (*prepared)->loaded.geometry;
  CollisionBackend& backend = *(*prepared)->backend;
  const TouchRule rule = TouchRule::of(geometry, options.tolerance_m);
  const std::int32_t within = within_steps(geometry, options.within_m);
  std::vector<LatticePose> lattice;
  for (const Pose& pose : poses) {
    const auto at = to_lattice(pose, geometry);
    if (!at) return at.error();
    lattice.push_back(*at);
  }
  std::vector<std::uint8_t> bits(std::min(kMostAtOnce, poses.size()));
  std::vector<Verdict> verdicts(bits.size());
  Fellows fellows(backend);
  std::string text;
  for (Portions portions(poses.size(), kMostAtOnce); portions.next();) {
    const std::size_t first = portions.first(), count = portions.count();
    text.clear();
    if (auto done = backend.touches(std::span(lattice).subspan(first, count), std::span(bits).first(count));
        !done)
      return done;
    const std::string engine = backend.measured_by();
    const auto judge = [&](CollisionBackend& asked, std::size_t k) -> Result<void> {
      Verdict& verdict = verdicts[k] = {};
      verdict.touches = bits[k] != 0;
      if (verdict.touches && rule.tolerance > 0) {
        const auto touch = touch_at(asked, lattice[first + k], rule);
        if (!touch) return touch.error();
        verdict.touches = touch->touches;
      }
      verdict.engine = engine;
      if (options.any) return {};
      if (bits[k] != 0) {
        verdict.clearance.kind = Clearance::Kind::kTouching;
        return {};
      }
      auto done = asked.clearance(lattice[first + k], within, verdict.clearance);
      verdict.engine = asked.measured_by();
      return done;
    };
    std::size_t answered = count;
    if (!options.any || rule.tolerance > 0) {
      const auto judged = fellows.ask(count, judge, [](std::size_t) { return !interrupted(); });
      if (!judged) return judged.error();
      answered = *judged;
    }
    for (std::size_t k = 0; k < answered; ++k) {
      const Verdict& verdict = verdicts[k];
      const std::size_t i = first + k;
      if (options.any)
        text += fmt::format("{{\"number\":{},\"engine\":\"{}\",\"touches\":{}}}\n", i, engine,
                            rule.tolerance > 0 ? verdict.touches : bits[k] != 0);
      else if (!options.within_m || verdict.clearance.kind != Clearance::Kind::kFurther)
        append_clearance_line(geometry, i, poses[i], verdict.clearance, verdict.touches, verdict.engine,
                              text);
    }
    if (auto done = print_text(text); !done) return done;
    if (interrupted() && first + answered < poses.size())
      return Error{ErrorCode::kInternal,
                   fmt::format("interrupted after {} of {} poses", first + answered, poses.size())};
  }
  for (const std::string& note : backend.take_notes()) console.note(note);
  return {};
}

}  // namespace palpate
