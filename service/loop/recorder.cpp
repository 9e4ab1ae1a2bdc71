#include "service/loop/recorder.h"

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "service/queries/query_json.h"

namespace palpate {
namespace {

constexpr char kTraceHeader[] =
    "time_s,x_m,y_m,z_m,qx,qy,qz,qw,force_x_N,force_y_N,force_z_N,torque_x_Nm,torque_y_Nm,torque_z_Nm,"
    "response_force_x_N,response_force_y_N,response_force_z_N,response_torque_x_Nm,response_torque_y_Nm,"
    "response_torque_z_Nm,result_age_ticks,contact,stage\n";

/// Builds one row in fixed memory. 23 columns of at most 25 characters fit with room to spare.
class Row {
 public:
  template <class Number>
  void put(Number value) {
    if (length_ > 0) text_[length_++] = ',';
    if constexpr (std::is_floating_point_v<Number>) value += 0.0;  // "-0" would only puzzle the reader
    const auto end = std::to_chars(text_ + length_, text_ + sizeof text_ - 2, value);
    length_ = static_cast<std::size_t>(end.ptr - text_);
  }
  void put(const Vec3& v) {
    put(v.x);
    put(v.y);
    put(v.z);
  }
  std::size_t finish() {
    text_[length_++] = '\n';
    return length_;
  }
  const char* text() const { return text_; }

 private:
  char text_[1024];
  std::size_t length_ = 0;
};

/// A file with its path, so that every failure can say which.
class OutputFile {
 public:
  OutputFile() = default;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile() {
    if (file_) std::fclose(file_);
  }

  Result<void> open(const std::filesystem::path& path) {
    path_ = path.string();
    file_ = std::fopen(path_.c_str(), "wb");
    if (!file_) return bad_value("can't write '" + path_ + "': " + std::strerror(errno));
    std::setvbuf(file_, nullptr, _IOFBF, 1 << 18);
    return {};
  }
  Result<void> write(const char* text, std::size_t length) {
    if (std::fwrite(text, 1, length, file_) != length) return failed();
    return {};
  }
  Result<void> close() {
    if (!file_) return {};
    std::FILE* file = std::exchange(file_, nullptr);
    const bool flushed = std::fflush(file) == 0;
    const int flush_errno = errno;
    if (std::fclose(file) != 0) return failed();
    if (flushed) return {};
    errno = flush_errno;
    return failed();
  }

 private:
  Error failed() const {
    return {ErrorCode::kInternal, "writing '" + path_ + "' failed: " + std::strerror(errno)};
  }

  std::string path_;
  std::FILE* file_ = nullptr;
};

}  // namespace

struct Recorder::Files {
  OutputFile trace, frames;
  std::uint64_t frames_written = 0;
  std::string line;  ///< reused
};

Recorder::Recorder() : files_(std::make_unique<Files>()) {}
Recorder::~Recorder() = default;

Result<std::unique_ptr<Recorder>> Recorder::create(const std::string& directory) {
  std::error_code code;
  std::filesystem::create_directories(directory, code);
  if (code) return bad_value("can't make the directory '" + directory + "': " + code.message());
  std::unique_ptr<Recorder> recorder(new Recorder);
  const std::filesystem::path root(directory);
  if (auto opened = recorder->files_->trace.open(root / "trace.csv"); !opened) return opened.error();
  if (auto opened = recorder->files_->frames.open(root / "frames.jsonl"); !opened) return opened.error();
  if (auto wrote = recorder->files_->trace.write(kTraceHeader, sizeof kTraceHeader - 1); !wrote)
    return wrote.error();
  return recorder;
}

Result<void> Recorder::on_tick(const TickRecord& tick) {
  Row row;
  row.put(tick.time_s);
  row.put(tick.pose.position);
  row.put(tick.pose.rotation.x);
  row.put(tick.pose.rotation.y);
  row.put(tick.pose.rotation.z);
  row.put(tick.pose.rotation.w);
  row.put(tick.sent.force);
  row.put(tick.sent.torque);
  row.put(tick.response.force);
  row.put(tick.response.torque);
  row.put(tick.result_age_ticks);
  row.put(tick.contact ? 1 : 0);
  row.put(tick.stage);
  const std::size_t length = row.finish();
  return files_->trace.write(row.text(), length);
}

Result<void> Recorder::on_frame(const FrameRecord& frame) {
  files_->line.clear();
  const QueryLine line{.number = files_->frames_written++,
                       .total_us = frame.total_us,
                       .batch = {},
                       .tick = frame.tick,
                       .heights = true,
                       .pose = &frame.pose};
  append_query_line(line, frame.contacts, frame.response, files_->line);
  return files_->frames.write(files_->line.data(), files_->line.size());
}

Result<void> Recorder::finish() {
  auto trace = files_->trace.close();
  auto frames = files_->frames.close();
  return trace ? frames : trace;
}

}  // namespace palpate
