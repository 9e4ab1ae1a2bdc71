#include "service/cli/serve.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>

namespace palpate {
namespace {

constexpr const char* kServeFooter =
    R"(Answers over HTTP and WebSocket until SIGINT or SIGTERM: then forces go to zero first. docs/SERVICE.md has the protocol.
Only this machine can connect, unless --listen says otherwise; beyond loopback a token and TLS are required (exit code 2).
The log goes to standard error: at a terminal the address and what becomes of scenes and sessions, elsewhere a JSON object for each event and request.

Examples:
  palpate serve --root scenes
  palpate serve --listen 0.0.0.0:8443 --token-file token --tls-certificate cert.pem --tls-key key.pem --host haptics.example)";

}  // namespace

void add_serve_command(CLI::App& app, ServeOptions& options, const Parts& parts, Result<void>& outcome) {
  CLI::App* serve_app = app.add_subcommand("serve", "answer over HTTP and WebSocket, with a viewer at /");
  serve_app
      ->add_option("--listen", options.listen,
                   "address and port; port 0 is any free one; default 127.0.0.1:8090")
      ->type_name("ADDR:PORT");
  serve_app->add_option("--root", options.root, "folder of scenes that may be named, and of recorded runs")
      ->type_name("DIR");
  serve_app
      ->add_option("--spool", options.spool,
                   "where uploads are kept while the server runs; default the system's temporary folder")
      ->type_name("DIR");
  serve_app
      ->add_option("--token-file", options.token_file,
                   "file with the token that requests must bring, 16 characters or more")
      ->type_name("FILE");
  serve_app->add_option("--tls-certificate", options.certificate, "certificate chain, PEM")
      ->type_name("FILE");
  serve_app->add_option("--tls-key", options.key, "its key, PEM")->type_name("FILE");
  serve_app
      ->add_option("--host", options.hosts,
                   "a further name under which this server is asked; may be repeated")
      ->type_name("NAME");
  serve_app->add_option("--backend", options.backend, "the engine that answers, as for run (auto)")
      ->check(CLI::IsMember({"auto", "gpu", "cpu", "ref"}).description(""))
      ->type_name("auto|gpu|cpu|ref");
  serve_app->add_option("--log", options.log, "how events are told; default plain at a terminal, else json")
      ->check(CLI::IsMember({"plain", "json"}).description(""))
      ->type_name("plain|json");
  const auto mebibytes = [&](const char* flag, std::uint64_t& bytes, const char* text) {
    serve_app
        ->add_option_function<std::uint64_t>(
            flag, [&bytes](const std::uint64_t& mib) { bytes = mib << 20; }, text)
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 24).description(""))
        ->type_name("MIB");
  };
  mebibytes("--memory", options.limits.memory_bytes,
            "memory of all prepared scenes; who is unused longest goes; default 4096");
  mebibytes("--disk", options.limits.disk_bytes, "disk of all uploads; default 8192");
  mebibytes("--max-upload", options.limits.upload_bytes, "largest upload; default 512");
  // Up to far more than a machine has room for (chosen).
  const auto count = [&](const char* flag, auto& out, std::int64_t most, const char* text) {
    serve_app
        ->add_option_function<std::int64_t>(
            flag,
            [&out](const std::int64_t& given) { out = static_cast<std::decay_t<decltype(out)>>(given); },
            text)
        ->check(CLI::Range(std::int64_t{1}, most).description(""))
        ->type_name("N");
  };
  count("--max-triangles", options.limits.triangles, std::int64_t{1} << 31, "of a scene; default 10000000");
  count("--max-poses", options.limits.poses, 1'000'000'000, "of a query; default 100000");
  count("--max-connections", options.limits.connections, 1'000'000, "at a time; default 1024");
  serve_app->footer(kServeFooter);
  serve_app->callback([&] { outcome = serve(options, parts); });
}

}  // namespace palpate
