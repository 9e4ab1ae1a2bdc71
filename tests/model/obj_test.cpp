#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/model/import_files.h"

namespace palpate {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

// The library gave the second A's faces to B.
TEST_F(MeshImport, AnObjWithTwoObjectsOfOneNameIsRefused) {
  const std::string a = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n";
  EXPECT_EQ(read(write("once.obj", "o A\n" + a + "o A\n" + a + "o B\n" + a)).triangles.size(), 3u);
  EXPECT_THAT(refused(write("twice.obj", "o A\n" + a + "o B\n" + a + "o A\n" + a)),
              HasSubstr("object 'A' in line 1 and another one in line 11"));
  EXPECT_THAT(refused(write("group.obj", "o A 1\n" + a + "g B\n" + a + "o A 1\n" + a)),
              HasSubstr("object 'A 1' in line 1 and another one in line 11"));
  EXPECT_THAT(refused(write("bare.obj", "g A\n" + a + "g\n" + a + "o A\n" + a)),
              HasSubstr("object 'A' in line 1 and another one in line 11"));
  EXPECT_EQ(read(write("same.obj", "o A\ng A\n" + a + "o B\ng B\n" + a)).parts.size(), 2u);
  EXPECT_THAT(refused(write("none.obj", "o A\n" + a + "o\n" + a)),
              HasSubstr("an object without a name in line 6"));
}

// The library ends them at the first blank, and gave the second bolt's faces to the nut.
TEST_F(MeshImport, NamesOfObjObjectsAreReadWhole) {
  const std::string a = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n";
  const Mesh mesh = read(
      write("names.obj", "o Bolt 1\n" + a + "o  Nut\r\n" + a + a + "o Bolt\t2 \n" + a + "o Bolt #3\n" + a));
  ASSERT_EQ(mesh.parts.size(), 4u);
  const char* const names[] = {"Bolt 1", "Nut", "Bolt 2", "Bolt #3"};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_THAT(mesh.parts[i].path, EndsWith(names[i]));
    EXPECT_EQ(mesh.parts[i].triangle_count, i == 1 ? 2u : 1u);
  }
}

// assimp passes over lines that begin with blanks, and takes the next one with a comment that ends in a
// backslash.
TEST_F(MeshImport, LinesOfAnObjCountHoweverTheyBeginAndEnd) {
  const std::string plain =
      "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nv 9 9 9\n";
  const Mesh wanted = read(write("plain.obj", plain));
  const std::vector<std::pair<std::string, std::string>> changes = {
      {"v 0 2 0", " v 0 2 0"},
      {"v 0 2 0", "\t \tv .0 2 0"},
      {"v 0 0 0", "\xEF\xBB\xBFv 0 0 0"},
      {"v 0 0 0", "\xEF\xBB\xBF# text\n  v 0 0 0"},
      {"f 1 2 4", "  f 1 2 4"},
      {"v 1 0 0", "# from C:\\models\\\nv 1 0 0"},
      {"v 1 0 0", "v 1 0 0 # C:\\"},
      {"f 1 2 4", "f 1 2 4# \\\r"},
      {"f 1 2 4", "f 1 \\\n  2 4"},
      {"v 1 0 0\n", "v 1 0 0\r\n \r\n"}};
  for (const auto& [from, to] : changes) {
    std::string text = plain;
    text.replace(text.find(from), from.size(), to);
    const Mesh mesh = read(write("a.obj", text));
    ASSERT_EQ(mesh.triangles.size(), 4u) << text;
    for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ(corners(mesh, t), corners(wanted, t)) << text;
    ASSERT_EQ(mesh.parts.size(), 1u);
    EXPECT_EQ(mesh.parts[0].path, "a.obj/defaultobject");
  }
  EXPECT_THAT(refused(write("u.obj", plain + "F 1 2 3\n")),
              HasSubstr("has 'F' in line 10; OBJ's words are in small"));
  EXPECT_THAT(refused(write("n.obj", "g a\\\n" + plain)),
              HasSubstr("has a name in line 1 that ends in a backslash"));
}

}  // namespace
}  // namespace palpate
