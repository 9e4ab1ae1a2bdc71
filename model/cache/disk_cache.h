#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/cache/content_key.h"
#include "model/files/file_view.h"

namespace palpate {

/// Results of long work, kept in a folder under the key of all that they depend on, the program included. It
/// can only save time: whatever is damaged, missing or can't be written counts as not there, with a note.
/// Entries used longest ago go first when the folder grows too large. May be used by several threads and
/// processes at once.
class DiskCache {
 public:
  /// Where it is, and how large it may grow.
  struct Settings {
    std::filesystem::path folder;
    std::uint64_t max_bytes = std::uint64_t{8}
                              << 30;  ///< of all entries (chosen: some scenes of ten million triangles)
    double worth_s = 0.25;            ///< work that took less is not kept
  };

  /// An entry, mapped.
  class Entry {
   public:
    /// What was kept; valid as long as the entry.
    std::string_view payload() const;

   private:
    friend class DiskCache;
    explicit Entry(FileView file) : file_(std::move(file)) {}
    FileView file_;
  };

  /// Touches no file.
  explicit DiskCache(Settings settings) : settings_(std::move(settings)) {}

  /// Where the environment wants it: PALPATE_CACHE (a folder; `off`: no cache), else XDG_CACHE_HOME/palpate,
  /// else HOME/.cache/palpate. Empty: nowhere.
  static std::optional<std::filesystem::path> usual_folder();

  /// `kind` is a short word, part of the file's name.
  std::optional<Entry> find(const std::string& kind, const ContentKey& key);
  /// Keeps `pieces`, one after the other, if making them took `seconds` that are worth it. Written beside,
  /// then renamed: never half there.
  void keep(const std::string& kind, const ContentKey& key, const std::vector<std::string_view>& pieces,
            double seconds);
  /// Drops an entry whose checksum is right and whose content is not.
  void drop(const std::string& kind, const ContentKey& key, const std::string& why);

  /// For benches: while `on`, nothing is found, and what is made is kept as ever.
  void begin_anew(bool on) { anew_ = on; }

  /// What went wrong since the last call, a sentence each.
  std::vector<std::string> take_notes();

 private:
  std::filesystem::path path_of(const std::string& kind, const ContentKey& key) const;
  void note(std::string sentence);
  void make_room();

  Settings settings_;
  std::atomic<bool> anew_{false};
  std::mutex mutex_;
  std::vector<std::string> notes_;
};

}  // namespace palpate
