#include "service/bench/ready_scene.h"

namespace palpate {

Result<std::unique_ptr<HostedScene>> ready_scene(const BenchOptions& options, const std::string& file,
                                                 const std::string& backend, Purpose purpose,
                                                 const Parts& parts, Console& console) {
  auto prepared = prepare_scene({file, backend, options.profile, false}, purpose, parts, console);
  if (!prepared) return prepared.error();
  if (auto done = (*prepared)->backend->finish_preparing(); !done) return done.error();
  return prepared;
}

std::vector<std::string> asked_backends(const BenchOptions& options) {
  return options.backends.empty() ? std::vector<std::string>{""} : options.backends;
}

}  // namespace palpate
