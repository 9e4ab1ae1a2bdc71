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

namespace palpate {
namespace {

constexpr std::size_t kMostAtOnce = 4096;  // poses between two looks at the keyboard (chosen)

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
  std::string text;
  for (Portions portions(poses.size(), kMostAtOnce); portions.next();) {
    const std::size_t first = portions.first(), count = portions.count();
    text.clear();
    if (auto done = backend.touches(std::span(lattice).subspan(first, count), std::span(bits).first(count));
        !done)
      return done;
    const std::string engine = backend.measured_by();
    std::size_t answered = first + count;
    for (std::size_t i = first; i < first + count; ++i) {
      bool touches = bits[i - first] != 0;
      if (touches && rule.tolerance > 0) {
        const auto touch = touch_at(backend, lattice[i], rule);
        if (!touch) return touch.error();
        touches = touch->touches;
      }
      if (options.any) {
        text += fmt::format("{{\"number\":{},\"engine\":\"{}\",\"touches\":{}}}\n", i, engine, touches);
        continue;
      }
      Clearance clearance;
      if (bits[i - first] != 0)
        clearance.kind = Clearance::Kind::kTouching;
      else if (auto done = backend.clearance(lattice[i], within, clearance); !done)
        return done;
      if (options.within_m && clearance.kind == Clearance::Kind::kFurther) continue;
      append_clearance_line(geometry, i, poses[i], clearance, touches,
                            bits[i - first] != 0 ? engine : backend.measured_by(), text);
      if (interrupted()) {
        answered = i + 1;
        break;
      }
    }
    if (auto done = print_text(text); !done) return done;
    if (interrupted() && answered < poses.size())
      return Error{ErrorCode::kInternal,
                   fmt::format("interrupted after {} of {} poses", answered, poses.size())};
  }
  for (const std::string& note : backend.take_notes()) console.note(note);
  return {};
}

}  // namespace palpate
