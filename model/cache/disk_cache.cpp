#include "model/cache/disk_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// In front of every entry's payload. A new layout of anything that is kept needs no new version: the program
/// is part of every key.
struct Head {
  char magic[16] = {'p', 'a', 'l', 'p', 'a', 't', 'e', ' ', 'c', 'a', 'c', 'h', 'e', '\n', '\0', '\0'};
  std::uint64_t version = 1;
  std::uint64_t payload_bytes = 0;
  ContentKey key{}, checksum{};
};
static_assert(sizeof(Head) == 64);

constexpr std::string_view kSuffix = ".palpate";
constexpr auto kAbandoned =
    std::chrono::hours(24);  // a half-written file this old has lost its writer (chosen)

ContentKey checksum_of(const std::vector<std::string_view>& pieces) {
  KeyBuilder builder;
  for (const std::string_view piece : pieces) builder.bytes(piece.data(), piece.size());
  return builder.finish();
}

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace

std::string_view DiskCache::Entry::payload() const { return file_.bytes().substr(sizeof(Head)); }

std::optional<fs::path> DiskCache::usual_folder() {
  const auto variable = [](const char* name) -> std::string_view {
    const char* value =
        std::getenv(name);  // NOLINT(concurrency-mt-unsafe): read before any thread changes it
    return value ? value : "";
  };
  if (const auto own = variable("PALPATE_CACHE"); !own.empty())
    return own == "off" ? std::nullopt : std::optional(fs::path(own));
  if (const auto xdg = variable("XDG_CACHE_HOME"); !xdg.empty()) return fs::path(xdg) / "palpate";
  if (const auto home = variable("HOME"); !home.empty()) return fs::path(home) / ".cache" / "palpate";
  return std::nullopt;
}

fs::path DiskCache::path_of(const std::string& kind, const ContentKey& key) const {
  return settings_.folder / (kind + "-" + key.hex() + std::string(kSuffix));
}

void DiskCache::note(std::string sentence) {
  const std::lock_guard lock(mutex_);
  notes_.push_back(std::move(sentence));
}

std::vector<std::string> DiskCache::take_notes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notes_, {});
}

std::optional<DiskCache::Entry> DiskCache::find(const std::string& kind, const ContentKey& key) {
  if (anew_) return std::nullopt;
  const fs::path path = path_of(kind, key);
  std::error_code error;
  if (!fs::exists(path, error)) return std::nullopt;
  Result<FileView> file = FileView::open(path.string());
  const auto sound = [&] {
    if (!file || file->bytes().size() < sizeof(Head)) return false;
    Head head, expected;
    std::memcpy(&head, file->bytes().data(), sizeof head);
    const std::string_view payload = file->bytes().substr(sizeof head);
    return std::memcmp(head.magic, expected.magic, sizeof head.magic) == 0 &&
           head.version == expected.version && head.key == key && head.payload_bytes == payload.size() &&
           head.checksum == checksum_of({payload});
  };
  if (!sound()) {
    drop(kind, key, "is damaged");
    return std::nullopt;
  }
  ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0);  // used now: the last to go
  return Entry(std::move(*file));
}

void DiskCache::drop(const std::string& kind, const ContentKey& key, const std::string& why) {
  const fs::path path = path_of(kind, key);
  note(fmt::format("cache: '{}' {}; it is made anew", path.string(), why));
  std::error_code error;
  fs::remove(path, error);
}

void DiskCache::keep(const std::string& kind, const ContentKey& key,
                     const std::vector<std::string_view>& pieces, double seconds) {
  if (seconds < settings_.worth_s) return;
  std::error_code error;
  fs::create_directories(settings_.folder, error);
  if (!error) fs::permissions(settings_.folder, fs::perms::owner_all, error);
  if (error)
    return note(fmt::format("cache: '{}' can't be used: {}", settings_.folder.string(), error.message()));

  Head head;
  head.key = key;
  head.checksum = checksum_of(pieces);
  for (const std::string_view piece : pieces) head.payload_bytes += piece.size();
  if (head.payload_bytes > settings_.max_bytes) return;
  static std::atomic<unsigned> count{0};
  const fs::path path = path_of(kind, key),
                 beside = path.string() + fmt::format(".{}.{}", ::getpid(), count++);
  const int file = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  bool written = file >= 0 && write_all(file, {reinterpret_cast<const char*>(&head), sizeof head});
  for (const std::string_view piece : pieces) written = written && write_all(file, piece);
  int failure = written ? 0 : errno;
  if (file >= 0 && ::close(file) != 0 && failure == 0) failure = errno;
  if (failure == 0 && std::rename(beside.c_str(), path.c_str()) != 0) failure = errno;
  if (failure != 0) {
    if (file >= 0) fs::remove(beside, error);
    return note(fmt::format("cache: '{}' can't be written: {}", path.string(), std::strerror(failure)));
  }
  make_room();
}

void DiskCache::make_room() {
  struct File {
    fs::file_time_type used;
    std::uint64_t bytes;
    fs::path path;
  };
  std::vector<File> files;
  std::uint64_t sum = 0;
  std::error_code error;
  for (fs::directory_iterator it(settings_.folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;  // another process may have removed it
    const std::string name = it->path().filename().string();
    const auto used = it->last_write_time(gone);
    if (gone || name.find(kSuffix) == std::string::npos) continue;
    if (!name.ends_with(kSuffix)) {
      if (fs::file_time_type::clock::now() - used > kAbandoned) fs::remove(it->path(), gone);
      continue;
    }
    const std::uint64_t bytes = it->file_size(gone);
    if (gone) continue;
    files.push_back({used, bytes, it->path()});
    sum += bytes;
  }
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.used < b.used; });
  for (const File& file : files) {
    if (sum <= settings_.max_bytes) break;
    fs::remove(file.path, error);
    sum -= file.bytes;
  }
}

}  // namespace palpate
