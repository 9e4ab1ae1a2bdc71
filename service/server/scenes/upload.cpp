#include "service/server/scenes/upload.h"

#include <atomic>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "model/mesh/mesh_import.h"
#include "model/scene/scene_json.h"
#include "service/server/http/json_input.h"
#include "service/server/http/multipart.h"
#include "service/server/http/refusal.h"
#include "service/server/http/safe_path.h"
#include "service/server/scenes/spool_files.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t kLongestField = 100;  ///< bytes of a value like "mm"
constexpr const char* kSceneName = "scene.json";

class Upload final : public BodySink {
 public:
  Upload(const std::string& boundary, const fs::path& folder, const ServerLimits& limits, Metrics& metrics,
         WorkerPool& workers, std::function<void(SceneContent, Reply)> done)
      : folder_(std::make_shared<SpoolFolder>(folder)),
        limits_(limits),
        metrics_(metrics),
        workers_(workers),
        done_(std::move(done)),
        reader_(boundary, {[this](const PartHead& head) { return begin(head); },
                           [this](std::string_view data) { return take(data); }, [this] { return end(); }}) {}

  std::optional<Problem> write(std::string_view piece) override {
    metrics_.upload_bytes += piece.size();
    bytes_ += piece.size();
    return reader_.feed(piece);
  }

  void finish(Reply reply) override {
    if (!reader_.complete()) return reply(bad_request("the form ends before its last boundary", "body"));
    const auto scene = scene_text();
    if (const auto* problem = std::get_if<Problem>(&scene)) return reply(*problem);
    workers_.post([folder = folder_, text = std::get<std::string>(scene), &limits = limits_, done = done_,
                   reply, bytes = bytes_, name = shown_name(), fields = stated_] {
      // Who is told no may try again at once, with the room that this one took.
      const auto refuse = [&](const Problem& problem) {
        folder->drop();
        reply(problem);
      };
      if (const auto problem = write_new_file(folder->path() / kSceneName, text)) return refuse(*problem);
      auto content = read_scene_content(folder->path() / kSceneName, folder->path(), std::nullopt, limits,
                                        Neighbours::kByContent);
      if (const auto* problem = std::get_if<Problem>(&content)) return refuse(as_sent(*problem, fields));
      auto& made = std::get<SceneContent>(content);
      made.name = name;
      made.uploaded = true;
      made.disk_bytes = bytes;
      folder->take();
      done(std::move(made), reply);
    });
  }

 private:
  /// JSON pointers of the scene that is made of parts, and the parts that said what stands there.
  using Stated = std::map<std::string, std::string>;

  /// A fault of such a scene, told of the part that is at fault.
  static Problem as_sent(Problem problem, const Stated& stated) {
    for (const auto& [pointer, part] : stated) {
      const std::string start = std::string(kSceneName) + ": " + pointer + " ";
      if (!problem.detail.starts_with(start)) continue;
      problem.detail = part + " " + problem.detail.substr(start.size());
      problem.field = part;
    }
    return problem;
  }

  std::optional<Problem> begin(const PartHead& head) {
    part_ = head.name;
    text_.clear();
    if (++parts_ > limits_.upload_files)
      return Problem{413, "too-large", "a form may have " + std::to_string(limits_.upload_files) + " parts",
                     "body"};
    if (part_ == "scene") return std::nullopt;
    if (part_ == "file" || part_ == "static" || part_ == "tool") {
      if (!plain_name(head.filename))
        return bad_request(
            "the file name '" + shown_text(head.filename) +
                "' is not letters, digits, '.', '_', '-' only, at most 100, without a dot in front",
            part_);
      if (part_ == "tool" && !tool_.empty()) return bad_request("there are two tools", "tool");
      // Bodies may come from files of one name.
      std::string name = head.filename;
      if (part_ != "file" && names_.contains(name))
        name = (part_ == "tool" ? "tool" : "static" + std::to_string(statics_.size())) + "_" + name;
      if (!names_.insert(name).second)
        return bad_request("the file name '" + name + "' comes twice, or is taken", part_);
      if (part_ == "static") statics_.push_back(name);
      if (part_ == "tool") tool_ = name;
      if (!file_.open(folder_->path() / name)) return storage_problem("opened");
      return std::nullopt;
    }
    static const std::vector<std::string> known = {
        "scene", "file", "static", "tool", "units", "static_units", "tool_units", "profile", "stiffness"};
    if (std::find(known.begin() + 4, known.end(), part_) == known.end())
      return bad_request("unknown part '" + shown_text(part_) + "'; the nearest known one is '" +
                             nearest_word(part_.substr(0, 40), known) + "'",
                         shown_text(part_));
    return std::nullopt;
  }

  std::optional<Problem> take(std::string_view data) {
    if (file_.is_open()) return file_.write(data) ? std::nullopt : std::optional(storage_problem("written"));
    const std::size_t limit = part_ == "scene" ? limits_.json_bytes : kLongestField;
    if (text_.size() + data.size() > limit)
      return Problem{413, "too-large",
                     "the part '" + part_ + "' may have " + std::to_string(limit) + " bytes", part_};
    text_.append(data);
    return std::nullopt;
  }

  std::optional<Problem> end() {
    if (file_.is_open()) return file_.close() ? std::nullopt : std::optional(storage_problem("written"));
    if (!fields_.emplace(part_, text_).second)
      return bad_request("the part '" + part_ + "' comes twice", part_);
    return std::nullopt;
  }

  std::string shown_name() const {
    return fields_.contains("scene") ? "upload" : tool_ + " on " + statics_.front();
  }

  /// A body of a file, at `pointer` of the scene. `units` alone is for files that state none.
  ordered_json body(const std::string& name, const char* own_units, const std::string& pointer) {
    ordered_json out{{"mesh", name}};
    const char* units = fields_.contains(own_units) ? own_units : states_unit(name) ? "" : "units";
    if (fields_.contains(units)) {
      out["units"] = fields_.at(units);
      stated_[pointer + "/units"] = units;
    }
    return out;
  }

  /// The scene as sent, or one made of the parts `static` and `tool`.
  std::variant<std::string, Problem> scene_text() {
    if (fields_.contains("scene")) {
      if (!tool_.empty() || !statics_.empty() || fields_.size() > 1)
        return bad_request("beside 'scene' only 'file' may stand", "scene");
      return fields_.at("scene");
    }
    if (tool_.empty() || statics_.empty())
      return bad_request(
          std::string("the part '") + (tool_.empty() ? "tool" : "static") + "' is missing, and so is 'scene'",
          tool_.empty() ? "tool" : "static");
    ordered_json scene;
    for (std::size_t i = 0; i < statics_.size(); ++i)
      scene["static"].push_back(body(statics_[i], "static_units", "/static/" + std::to_string(i)));
    scene["tool"] = body(tool_, "tool_units", "/tool");
    for (const char* key : {"profile", "stiffness"}) stated_[std::string("/response/") + key] = key;
    if (fields_.contains("profile")) scene["response"]["profile"] = fields_.at("profile");
    if (fields_.contains("stiffness")) {
      const std::string& text = fields_.at("stiffness");
      double value = 0;
      const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value))
        return bad_request("the stiffness '" + shown_text(text) + "' is no number", "stiffness");
      scene["response"]["stiffness"] = value;
    }
    return dump(scene);
  }

  std::shared_ptr<SpoolFolder> folder_;
  const ServerLimits& limits_;
  Metrics& metrics_;
  WorkerPool& workers_;
  std::function<void(SceneContent, Reply)> done_;
  MultipartReader reader_;
  std::uint64_t bytes_ = 0;
  std::size_t parts_ = 0;
  std::string part_, text_, tool_;
  std::vector<std::string> statics_;
  std::set<std::string> names_{kSceneName};
  std::map<std::string, std::string> fields_;
  Stated stated_;
  SpoolFile file_;
};

}  // namespace

std::unique_ptr<BodySink> receive_upload(const HttpRequest& request, const fs::path& spool,
                                         const ServerLimits& limits, Metrics& metrics, WorkerPool& workers,
                                         std::function<void(SceneContent, Reply)> done) {
  static std::atomic<std::uint64_t> count{0};
  const std::string boundary = boundary_of(request.content_type);
  if (boundary.empty())
    return std::make_unique<Refusal>(
        bad_request("the content type has no boundary of 1 to 70 characters", "Content-Type"));
  std::error_code error;
  const fs::path folder = spool / ("upload-" + std::to_string(++count));
  if (!fs::create_directory(folder, error))
    return std::make_unique<Refusal>(
        Problem{507, "storage", "the upload can't be stored: " + error.message(), ""});
  return std::make_unique<Upload>(boundary, folder, limits, metrics, workers, std::move(done));
}

}  // namespace palpate
