#include "service/server/sessions/run_routes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>

#include "service/server/http/json_input.h"
#include "service/server/http/safe_path.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> kFiles = {"frames.jsonl", "trace.csv", "summary.json",
                                                    "report.html"};
constexpr std::array<const char*, 4> kTypes = {"application/x-ndjson", "text/csv", "application/json",
                                               "text/html; charset=utf-8"};
constexpr int kDeepest = 4;
constexpr std::size_t kMostListed = 500, kPiece = 256 << 10;
constexpr std::uintmax_t kLongestSummary = 1 << 20;

ordered_json described(const fs::path& folder, const std::string& name) {
  std::error_code error;
  ordered_json run = {{"name", name}, {"files", ordered_json::object()}};
  for (const std::string_view file : kFiles)
    if (fs::is_regular_file(folder / file, error))
      run["files"][std::string(file)] = fs::file_size(folder / file, error);
  const auto changed = fs::last_write_time(folder, error);
  run["modified"] = std::chrono::duration_cast<std::chrono::seconds>(
                        std::chrono::file_clock::to_sys(changed).time_since_epoch())
                        .count();
  nlohmann::json summary;
  if (run["files"].contains("summary.json") &&
      fs::file_size(folder / "summary.json", error) < kLongestSummary) {
    std::ifstream in(folder / "summary.json");
    const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    if (!nests_deeper(text, 32)) summary = nlohmann::json::parse(text, nullptr, false);
  }
  for (const char* key : {"static_triangles", "tool_triangles", "backend", "ticks"})
    run[key] = summary.is_object() && summary.contains(key) ? ordered_json(summary[key]) : ordered_json();
  return run;
}

std::string list(const fs::path& root) {
  ordered_json runs = ordered_json::array();
  std::error_code error;
  if (!root.empty())
    for (auto it =
             fs::recursive_directory_iterator(root, fs::directory_options::skip_permission_denied, error);
         !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
      if (it.depth() >= kDeepest) it.disable_recursion_pending();
      if (!it->is_directory(error) || it->is_symlink(error)) continue;
      if (!fs::exists(it->path() / "frames.jsonl", error) && !fs::exists(it->path() / "trace.csv", error))
        continue;
      runs.push_back(described(it->path(), fs::relative(it->path(), root, error).string()));
      if (runs.size() == kMostListed) break;
    }
  return dump({{"runs", runs}});
}

class FileSource final : public BodySource {
 public:
  FileSource(std::ifstream in, std::uint64_t left) : in_(std::move(in)), left_(left) {}
  void next(std::function<void(Chunk)> take) override {
    Chunk chunk;
    chunk.data.resize(static_cast<std::size_t>(std::min<std::uint64_t>(left_, kPiece)));
    in_.read(chunk.data.data(), static_cast<std::streamsize>(chunk.data.size()));
    chunk.broken = static_cast<std::size_t>(in_.gcount()) != chunk.data.size();  // cut short meanwhile
    left_ -= chunk.data.size();
    chunk.last = left_ == 0;
    take(std::move(chunk));
  }

 private:
  std::ifstream in_;
  std::uint64_t left_;
};

/// "bytes=10-19", "bytes=10-", "bytes=-5" of a file of `size` bytes; nothing: another kind, or outside.
std::optional<std::pair<std::uint64_t, std::uint64_t>> byte_range(std::string_view text, std::uint64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  if (!text.starts_with(kUnit) || size == 0) return std::nullopt;
  text.remove_prefix(kUnit.size());
  const auto dash = text.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto number = [](std::string_view digits, std::uint64_t& value) {
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && stop == digits.data() + digits.size();
  };
  std::uint64_t first = 0, last = size - 1;
  if (dash == 0) {
    std::uint64_t count = 0;
    if (!number(text.substr(1), count) || count == 0) return std::nullopt;
    first = size - std::min(count, size);
  } else {
    if (!number(text.substr(0, dash), first)) return std::nullopt;
    if (dash + 1 < text.size() && !number(text.substr(dash + 1), last)) return std::nullopt;
  }
  last = std::min(last, size - 1);
  if (first > last) return std::nullopt;
  return std::pair{first, last};
}

HttpResponse file_of(const fs::path& root, const HttpRequest& request) {
  const std::string& name = request.segments[2];
  const std::string& file = request.segments[3];
  const auto known = std::find(kFiles.begin(), kFiles.end(), file);
  const Problem missing{404, "not-found",
                        "there is no '" + shown_text(file) + "' of a run '" + shown_text(name) + "'", "name"};
  if (known == kFiles.end() || root.empty()) return missing;
  const auto path = path_below(root, fs::path(name) / file);
  std::error_code error;
  if (!path) {
    const fs::path straight = fs::path(name).lexically_normal();
    if (straight.is_absolute() || (!straight.empty() && *straight.begin() == "..") ||
        fs::exists(fs::symlink_status(root / straight / file, error)))
      return Problem{403, "outside-root", "'" + shown_text(name) + "' lies outside the root", "name"};
    return missing;
  }
  if (!fs::is_regular_file(*path, error)) return missing;
  const std::uint64_t size = fs::file_size(*path, error);
  std::ifstream in(*path, std::ios::binary);
  if (error || !in) return missing;
  HttpResponse response;
  response.type = kTypes[static_cast<std::size_t>(known - kFiles.begin())];
  response.headers.emplace_back("Accept-Ranges", "bytes");
  // A recorded page runs nothing here.
  response.headers.emplace_back("Content-Security-Policy",
                                "sandbox allow-scripts; default-src 'unsafe-inline' data:");
  std::uint64_t first = 0, length = size;
  if (request.range.starts_with("bytes=")) {  // a range in other units is none, as RFC 9110 has it
    const auto range = byte_range(request.range, size);
    if (!range) {
      HttpResponse refused(Problem{
          416, "range", "the range '" + shown_text(request.range) + "' is none of this file's", "Range"});
      refused.headers.emplace_back("Content-Range", "bytes */" + std::to_string(size));
      return refused;
    }
    first = range->first;
    length = range->second - range->first + 1;
    response.status = 206;
    response.headers.emplace_back("Content-Range", "bytes " + std::to_string(range->first) + "-" +
                                                       std::to_string(range->second) + "/" +
                                                       std::to_string(size));
  }
  in.seekg(static_cast<std::streamoff>(first));
  if (length == 0) return response;
  response.source = std::make_shared<FileSource>(std::move(in), length);
  response.source_length = length;
  return response;
}

}  // namespace

void add_run_routes(Router& router, WorkerPool& workers, const fs::path& root) {
  router.add({.method = "GET", .pattern = "v1/runs", .handle = [&workers, root](HttpRequest, Reply reply) {
                workers.post([root, reply] { reply(HttpResponse(200, list(root))); });
              }});
  router.add({.method = "GET",
              .pattern = "v1/runs/*/*",
              .handle = [&workers, root](HttpRequest request, Reply reply) {
                workers.post([root, request = std::move(request), reply] { reply(file_of(root, request)); });
              }});
}

}  // namespace palpate
