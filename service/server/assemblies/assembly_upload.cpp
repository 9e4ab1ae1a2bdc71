#include "service/server/assemblies/assembly_upload.h"

#include <algorithm>
#include <atomic>
#include <set>

#include "service/server/http/json_input.h"
#include "service/server/http/multipart.h"
#include "service/server/http/refusal.h"
#include "service/server/http/safe_path.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class AssemblyUpload final : public BodySink {
 public:
  using Done = std::function<void(std::shared_ptr<SpoolFolder>, std::vector<AssemblyFile>, const Reply&)>;

  AssemblyUpload(const std::string& boundary, const fs::path& folder, const ServerLimits& limits,
                 Metrics& metrics, Done done)
      : folder_(std::make_shared<SpoolFolder>(folder)),
        limits_(limits),
        metrics_(metrics),
        done_(std::move(done)),
        reader_(boundary, {[this](const PartHead& head) { return begin(head); },
                           [this](std::string_view data) { return take(data); }, [this] { return end(); }}) {}

  std::optional<Problem> write(std::string_view piece) override {
    metrics_.upload_bytes += piece.size();
    return reader_.feed(piece);
  }

  void finish(Reply reply) override {
    if (!reader_.complete()) return reply(bad_request("the form ends before its last boundary", "body"));
    if (std::none_of(files_.begin(), files_.end(), [](const auto& file) { return file.mesh; }))
      return reply(bad_request("none of these files is a mesh by its ending", "file"));
    done_(folder_, std::move(files_), reply);
  }

 private:
  std::optional<Problem> begin(const PartHead& head) {
    if (head.name != "file")
      return bad_request("unknown part '" + shown_text(head.name) + "'; only 'file' is known",
                         shown_text(head.name));
    if (files_.size() == limits_.upload_files)
      return Problem{413, "too-large",
                     "an assembly may have " + std::to_string(limits_.upload_files) + " files", "body"};
    if (!plain_name(head.filename) || head.filename == "scene.json" || head.filename == "path.csv")
      return bad_request("the file name '" + shown_text(head.filename) +
                             "' is not letters, digits, '.', '_', '-' only, at most 100, without a dot in "
                             "front, or is taken",
                         "file");
    if (!names_.insert(head.filename).second)
      return bad_request("the file name '" + head.filename + "' comes twice", "file");
    files_.push_back({.name = head.filename, .mesh = is_mesh_name(head.filename)});
    if (!file_.open(folder_->path() / head.filename)) return storage_problem("opened");
    return std::nullopt;
  }
  std::optional<Problem> take(std::string_view data) {
    files_.back().bytes += data.size();
    return file_.write(data) ? std::nullopt : std::optional(storage_problem("written"));
  }
  std::optional<Problem> end() {
    return file_.close() ? std::nullopt : std::optional(storage_problem("written"));
  }

  std::shared_ptr<SpoolFolder> folder_;
  const ServerLimits& limits_;
  Metrics& metrics_;
  Done done_;
  MultipartReader reader_;
  std::vector<AssemblyFile> files_;
  std::set<std::string> names_;
  SpoolFile file_;
};

}  // namespace

std::unique_ptr<BodySink> receive_assembly(
    const HttpRequest& request, const fs::path& spool, const ServerLimits& limits, Metrics& metrics,
    std::function<void(std::shared_ptr<SpoolFolder>, std::vector<AssemblyFile>, const Reply&)> done) {
  static std::atomic<std::uint64_t> count{0};
  const std::string boundary = boundary_of(request.content_type);
  if (boundary.empty())
    return std::make_unique<Refusal>(
        bad_request("the content type has no boundary of 1 to 70 characters", "Content-Type"));
  std::error_code error;
  const fs::path folder = spool / ("assembly-" + std::to_string(++count));
  if (!fs::create_directory(folder, error))
    return std::make_unique<Refusal>(
        Problem{507, "storage", "the upload can't be stored: " + error.message(), ""});
  return std::make_unique<AssemblyUpload>(boundary, folder, limits, metrics, std::move(done));
}

}  // namespace palpate
