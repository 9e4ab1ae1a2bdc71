// What is kept on disk comes back as it was or not at all, whatever happens to the files.
#include "model/cache/disk_cache.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <thread>

#include "model/cache/archive.h"
#include "temporary_folder.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ContentKey key_of(std::string_view text) {
  KeyBuilder builder;
  builder.text(text);
  return builder.finish();
}

class Cache : public testing::Test {
 protected:
  DiskCache::Settings settings(std::uint64_t max_bytes = 1 << 20) const {
    return {folder.path("cache"), max_bytes, 0};
  }
  std::vector<fs::path> files() const {
    std::vector<fs::path> out;
    if (fs::exists(folder.path("cache")))
      for (const auto& entry : fs::directory_iterator(folder.path("cache"))) out.push_back(entry.path());
    return out;
  }
  TemporaryFolder folder;
};

std::string found(DiskCache& cache, const ContentKey& key) {
  const auto entry = cache.find("kind", key);
  return entry ? std::string(entry->payload()) : "(none)";
}

TEST_F(Cache, AnEntryComesBackInTheNextRunUnderItsOwnKeyAlone) {
  {
    DiskCache cache(settings());
    EXPECT_EQ(found(cache, key_of("a")), "(none)");
    cache.keep("kind", key_of("a"), {"to", "", "gether"}, 1);
    cache.keep("kind", key_of("b"), {}, 1);
  }
  DiskCache cache(settings());
  EXPECT_EQ(found(cache, key_of("a")), "together");
  EXPECT_EQ(found(cache, key_of("b")), "");
  EXPECT_EQ(found(cache, key_of("c")), "(none)");
  EXPECT_FALSE(cache.find("other", key_of("a")));
  EXPECT_THAT(cache.take_notes(), IsEmpty());
}

TEST_F(Cache, AnyFlippedBitAnyCutAndAnyAdditionCountsAsDamaged) {
  const std::string payload = "what was worked out";
  DiskCache cache(settings());
  cache.keep("kind", key_of("a"), {payload}, 1);
  const fs::path path = files().at(0);
  std::string whole(fs::file_size(path), '\0');
  std::ifstream(path, std::ios::binary).read(whole.data(), static_cast<std::streamsize>(whole.size()));
  const auto judged = [&](std::string_view bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
    const std::string answer = found(cache, key_of("a"));
    const auto notes = cache.take_notes();
    EXPECT_EQ(notes.size(), answer == "(none)" ? 1u : 0u);
    for (const auto& note : notes)
      EXPECT_THAT(note, testing::AllOf(HasSubstr(path.string()), HasSubstr("damaged")));
    return answer;
  };
  ASSERT_EQ(judged(whole), payload);
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    EXPECT_EQ(judged(damaged), "(none)") << "bit " << bit;
  }
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_EQ(judged(whole.substr(0, length)), "(none)") << "cut to " << length;
  EXPECT_EQ(judged(whole + "x"), "(none)");
  // It is gone, not found damaged again and again; and can be made anew.
  EXPECT_THAT(files(), IsEmpty());
  cache.keep("kind", key_of("a"), {payload}, 1);
  EXPECT_EQ(found(cache, key_of("a")), payload);
}

TEST_F(Cache, WhatWasUsedLongestAgoMakesRoom) {
  DiskCache cache(settings(3500));  // three entries of 1064 bytes
  const std::string payload(1000, 'x');
  const auto age = [&](const char* name, int hours) {
    for (const fs::path& path : files())
      if (path.string().find(key_of(name).hex()) != std::string::npos)
        fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  for (const char* name : {"a", "b", "c"}) cache.keep("kind", key_of(name), {payload}, 1);
  age("a", 3), age("b", 2), age("c", 1);
  EXPECT_EQ(found(cache, key_of("a")), payload);  // used just now
  cache.keep("kind", key_of("d"), {payload}, 1);
  EXPECT_EQ(found(cache, key_of("a")), payload);
  EXPECT_EQ(found(cache, key_of("b")), "(none)");
  EXPECT_EQ(found(cache, key_of("c")), payload);
  EXPECT_EQ(found(cache, key_of("d")), payload);
  cache.keep("kind", key_of("larger than all"), {std::string(4000, 'x')}, 1);
  EXPECT_EQ(files().size(), 3u);
}

TEST_F(Cache, WorkThatTookNoTimeIsNotKept) {
  DiskCache::Settings picky = settings();
  picky.worth_s = 0.5;
  DiskCache cache(picky);
  cache.keep("kind", key_of("a"), {"x"}, 0.4);
  EXPECT_THAT(files(), IsEmpty());
  cache.keep("kind", key_of("a"), {"x"}, 0.6);
  EXPECT_EQ(files().size(), 1u);
}

TEST_F(Cache, AFolderThatCannotBeWrittenIsANoteAndNothingElse) {
  folder.write("cache", "a file where the folder should be");
  DiskCache cache(settings());
  EXPECT_EQ(found(cache, key_of("a")), "(none)");
  cache.keep("kind", key_of("a"), {"x"}, 1);
  EXPECT_THAT(cache.take_notes(), ElementsAre(HasSubstr("can't be")));
  EXPECT_EQ(found(cache, key_of("a")), "(none)");
}

TEST_F(Cache, AHalfWrittenFileIsNeverReadAndGoesAfterADay) {
  DiskCache cache(settings());
  cache.keep("kind", key_of("a"), {"x"}, 1);
  const std::string torn = files().at(0).string() + ".1234.0";
  std::ofstream(torn) << "half";
  cache.keep("kind", key_of("b"), {"x"}, 1);
  EXPECT_TRUE(fs::exists(torn));  // perhaps somebody still writes it
  fs::last_write_time(torn, fs::file_time_type::clock::now() - std::chrono::hours(25));
  cache.keep("kind", key_of("c"), {"x"}, 1);
  EXPECT_FALSE(fs::exists(torn));
}

TEST_F(Cache, SeveralWritersAndReadersOfOneEntrySeeItWholeOrNotAtAll) {
  const std::string payload(100'000, 'y');
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      DiskCache cache(settings());
      for (int i = 0; i < 50; ++i) {
        cache.keep("kind", key_of("a"), {payload}, 1);
        const std::string answer = found(cache, key_of("a"));
        EXPECT_TRUE(answer == payload || answer == "(none)");
      }
      EXPECT_THAT(cache.take_notes(), IsEmpty());
    });
  for (std::thread& thread : threads) thread.join();
}

TEST_F(Cache, TheFolderIsItsOwnersAlone) {
  DiskCache cache(settings());
  cache.keep("kind", key_of("a"), {"x"}, 1);
  struct stat status {};
  ASSERT_EQ(::stat(folder.path("cache").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0700u);
}

TEST(CacheFolder, TheEnvironmentSaysWhereItIs) {
  const auto usual = [](const char* own, const char* xdg, const char* home) {
    for (const auto& [name, value] :
         {std::pair{"PALPATE_CACHE", own}, {"XDG_CACHE_HOME", xdg}, {"HOME", home}})
      value ? ::setenv(name, value, 1) : ::unsetenv(name);
    return DiskCache::usual_folder();
  };
  EXPECT_EQ(usual("/own", "/xdg", "/home/me"), fs::path("/own"));
  EXPECT_EQ(usual(nullptr, "/xdg", "/home/me"), fs::path("/xdg/palpate"));
  EXPECT_EQ(usual(nullptr, nullptr, "/home/me"), fs::path("/home/me/.cache/palpate"));
  EXPECT_EQ(usual("off", "/xdg", "/home/me"), std::nullopt);
  EXPECT_EQ(usual(nullptr, nullptr, nullptr), std::nullopt);
}

TEST(Archive, ReadsBackWhatWasWrittenAndNothingFromACutOne) {
  const std::vector<std::string> names{"one", "", "three"};
  const std::vector<std::uint32_t> numbers{1, 2, 3};
  ArchiveWriter writer;
  writer(7);
  writer(std::string("text"));
  writer(numbers);
  writer.each(names, [](ArchiveWriter& a, const std::string& name) { a(name); });
  std::string bytes;
  for (const auto piece : writer.pieces()) bytes += piece;

  const auto read = [](std::string_view from) {
    ArchiveReader reader(from);
    int seven = 0;
    std::string text;
    std::vector<std::uint32_t> numbers_back;
    std::vector<std::string> names_back;
    reader(seven), reader(text), reader(numbers_back);
    reader.each(names_back, [](ArchiveReader& a, std::string& name) { a(name); });
    return std::tuple(reader.complete(), seven, text, numbers_back, names_back);
  };
  EXPECT_EQ(read(bytes), std::tuple(true, 7, "text", numbers, names));
  for (const char* before : {"1", "22", "4444"})
    EXPECT_EQ(read(std::string_view(before + bytes).substr(std::strlen(before))),
              std::tuple(true, 7, "text", numbers, names));  // lists that lie anywhere
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(std::get<0>(read(bytes.substr(0, length)))) << length;
  EXPECT_FALSE(std::get<0>(read(bytes + "x")));
  // A length that no file could hold allocates nothing.
  std::string greedy = bytes;
  greedy[4 + 7] = '\x7f';
  EXPECT_FALSE(std::get<0>(read(greedy)));
}

}  // namespace
}  // namespace palpate
