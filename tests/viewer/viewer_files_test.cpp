// The viewer as the program carries it.
#include "service/viewer/viewer_files.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace palpate {
namespace {

TEST(ViewerFiles, AreWhatTheBundlerMade) {
  ASSERT_FALSE(viewer_files().empty()) << viewer_missing();
  for (const ViewerFile& file : viewer_files()) {
    std::ifstream in(PALPATE_VIEWER_OUT "/" + std::string(file.path), std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    // What is embedded names no address: scripts/cmake/EmbedText.cmake.
    for (std::size_t at; (at = text.find("https://")) != std::string::npos;) text.erase(at, 8);
    EXPECT_GT(text.size(), 1000u) << file.path;
    EXPECT_TRUE(file.content == text)
        << file.path << ": " << file.content.size() << " bytes instead of " << text.size();
    EXPECT_NE(file.type.find("charset=utf-8"), std::string_view::npos) << file.path;
  }
}

TEST(ViewerFiles, CarryTheLicenceOfThree) {
  ASSERT_FALSE(viewer_files().empty()) << viewer_missing();
  int scripts = 0;
  for (const ViewerFile& file : viewer_files()) {
    if (!file.path.ends_with(".js")) continue;
    ++scripts;
    for (const char* words : {"The MIT License", "three.js authors", "Permission is hereby granted",
                              "shall be included in\nall copies or substantial portions"})
      EXPECT_NE(file.content.substr(0, 2000).find(words), std::string_view::npos)
          << file.path << ": " << words;
  }
  EXPECT_EQ(scripts, 2);  // the page's and the mouse's
}

TEST(ViewerFiles, EitherThereIsAViewerOrAReason) {
  EXPECT_NE(viewer_files().empty(), viewer_missing().empty());
}

}  // namespace
}  // namespace palpate
