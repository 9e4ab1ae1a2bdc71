#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "model/generate/solids.h"
#include "model/mesh_import.h"

namespace palpate {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// A file in a folder of its own, gone at the end of the test.
class MeshImport : public testing::Test {
 protected:
  MeshImport() : folder_(std::filesystem::path(testing::TempDir()) / ("palpate_import_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~MeshImport() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& content) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }

  Mesh read(const std::string& path, double scale = 1) {
    auto mesh = import_mesh(path, scale, report_);
    EXPECT_TRUE(mesh) << mesh.error().sentence;
    return mesh ? std::move(*mesh) : Mesh{};
  }

  /// The sentence with which a file is refused.
  std::string refused(const std::string& path, double scale = 1) {
    const auto mesh = import_mesh(path, scale, report_);
    EXPECT_FALSE(mesh);
    if (mesh) return {};
    EXPECT_EQ(mesh.error().code, ErrorCode::kBadValue);
    EXPECT_THAT(mesh.error().sentence, HasSubstr(path));
    EXPECT_EQ(mesh.error().sentence.find('\n'), std::string::npos);
    return mesh.error().sentence;
  }

  std::filesystem::path folder_;
  ImportReport report_;
};

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binary_stl(const Mesh& mesh) {
  std::string out(80, ' ');
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) put(out, 0.0f);
    for (const std::uint32_t v : t)
      for (int k = 0; k < 3; ++k) put(out, static_cast<float>(mesh.vertices[v][k]));
    put(out, std::uint16_t{0});
  }
  return out;
}

std::string ascii_stl(const std::string& x = "1.5") {
  return "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex " + x + " 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
         "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex -1 0 0\nendloop\nendfacet\nendsolid s\n";
}

/// The corners of a triangle, in order.
std::vector<Vec3> corners(const Mesh& mesh, std::size_t t) {
  return {mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]], mesh.vertices[mesh.triangles[t][2]]};
}

TEST_F(MeshImport, BinaryStlKeepsTheOrderOfItsFaces) {
  const Mesh sphere = solids::sphere(0.5, 12, 6);
  const Mesh mesh = read(write("a.stl", binary_stl(sphere)), 0.001);
  ASSERT_EQ(mesh.triangles.size(), sphere.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT(glm::length(corners(mesh, t)[k] - 0.001 * corners(sphere, t)[k]), 1e-10);   // STL keeps 24 bits of 0.5 mm
  ASSERT_EQ(mesh.parts.size(), 1u);
  EXPECT_EQ(mesh.parts[0].path, "a") << "a file without names is one part, named like the file";
}

TEST_F(MeshImport, AsciiStl) {
  const Mesh mesh = read(write("a.STL", ascii_stl()));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_THAT(corners(mesh, 0), ElementsAre(Vec3(0), Vec3(1.5, 0, 0), Vec3(0, 1, 0)));
  EXPECT_EQ(mesh.parts[0].path, "a/s");
}

TEST_F(MeshImport, PolygonsAreSplitAsFansInOrder) {
  const Mesh mesh = read(write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\nf 1 2 3 4 5\nf 3 2 1\n"));
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_THAT(corners(mesh, 0), ElementsAre(Vec3(0), Vec3(1, 0, 0), Vec3(1, 1, 0)));
  EXPECT_THAT(corners(mesh, 2), ElementsAre(Vec3(0), Vec3(0, 1, 0), Vec3(-1, 0.5, 0)));
  EXPECT_THAT(corners(mesh, 3), ElementsAre(Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0)));
  EXPECT_THAT(report_.notes, Contains("split 1 polygons as fans"));
}

TEST_F(MeshImport, LinesAndPointsAreDroppedAndCounted) {
  const Mesh mesh = read(write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2\nl 2 3\nf 1 2 3\n"));
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_THAT(report_.notes, Contains("dropped 2 line primitives"));
  EXPECT_THAT(refused(write("b.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")), HasSubstr("no triangles"));
}

TEST_F(MeshImport, PlyAndOff) {
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                             "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  const Mesh ply = read(write("a.ply", header + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"));
  ASSERT_EQ(ply.triangles.size(), 2u);
  EXPECT_THAT(corners(ply, 1), ElementsAre(Vec3(0), Vec3(1, 1, 0), Vec3(0, 1, 0)));
  const Mesh off = read(write("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"));
  ASSERT_EQ(off.triangles.size(), 2u);
  EXPECT_EQ(corners(off, 1), corners(ply, 1));
  EXPECT_THAT(refused(write("short.ply", header + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n")),
              HasSubstr("promises 2 elements 'face' and has 1"));
  EXPECT_THAT(refused(write("many.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n")),
              HasSubstr("promises 4000000000 elements 'vertex'"));
  // Without a property an element takes no bytes: the importer then counted to 353535235358 (found by fuzzing).
  EXPECT_THAT(refused(write("no_property.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 353535235358\nend_header\n0000")),
              HasSubstr("promises 353535235358 elements 'vertex'"));
  EXPECT_THAT(refused(write("unknown.ply", "ply\nformat ascii 1.0\nelement vertex 3\npoperty float x\nend_header\n0\n0\n0\n")), HasSubstr("begins with 'poperty', which PLY does not know"));
  // The importer wrote beyond the first one's vertices (found by fuzzing).
  EXPECT_THAT(refused(write("twice.ply", "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n" + header.substr(header.find("element vertex")) + "1\n2\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n")),
              HasSubstr("has two elements 'vertex'"));
  const std::string told = std::string(header).insert(header.find("element face"), "comment of ours\n\nobj_info num_cols 2\n");
  EXPECT_EQ(read(write("told.ply", told + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n")).triangles.size(), 2u);
  EXPECT_THAT(refused(write("index.ply", header + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 9\n")), HasSubstr("vertex index 9"));
  EXPECT_THAT(refused(write("many.off", "OFF\n353535235358 6 0\n0 0 0\n")), HasSubstr("promises 353535235358 vertices"));
  EXPECT_THAT(refused(write("short.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n")), HasSubstr("promises 2 faces and has 1"));
  EXPECT_THAT(refused(write("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 7\n")), HasSubstr("vertex index 7"));
}

/// A triangle (0,0,0) (1,0,0) (0,1,0) in a buffer beside the file; `nodes` is the array's JSON.
std::string gltf(const std::string& nodes, const std::string& scene = "[0]", const std::string& count = "3") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":)" + scene + R"(}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + count +
         R"(,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"t.bin"}]})";
}

TEST_F(MeshImport, GltfHierarchyAndInstancesAreFlattenedDepthFirst) {
  std::string buffer;
  for (const float f : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(buffer, f);
  write("t.bin", buffer);
  const Mesh mesh = read(write("a.gltf", gltf(R"([{"name":"engine","children":[1,3]},
      {"name":"left","translation":[10,0,0],"children":[2],"mesh":0},{"name":"bolt","scale":[2,2,2],"mesh":0},
      {"name":"right","rotation":[0,0,0.7071067811865476,0.7071067811865476],"children":[4,5]},
      {"name":"bolt","translation":[5,0,0],"mesh":0},{"name":"bolt","scale":[-1,1,1],"mesh":0}])")));
  std::vector<std::string> paths;
  for (const MeshPart& part : mesh.parts) paths.push_back(part.path);
  EXPECT_THAT(paths, ElementsAre("engine/left", "engine/left/bolt", "engine/right/bolt", "engine/right/bolt#2"));
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(corners(mesh, 1)[1], Vec3(12, 0, 0));                            // 10 + 2 · 1
  EXPECT_LT(glm::length(corners(mesh, 2)[0] - Vec3(0, 5, 0)), 1e-6);         // a float's sine of 45°
  EXPECT_LT(glm::length(corners(mesh, 3)[1] - Vec3(-1, 0, 0)), 1e-6) << "a mirrored node's triangles are turned";
  EXPECT_THAT(report_.notes, Contains("turned the triangles of 1 mirrored nodes"));

  // Parts in and out.
  EXPECT_EQ(take_part(mesh, "left", "a.gltf")->triangles.size(), 2u);
  EXPECT_EQ(take_part(mesh, "engine/right/bolt", "a.gltf")->triangles.size(), 1u);
  EXPECT_EQ(take_part(mesh, "bolt#2", "a.gltf")->vertices.size(), 3u);
  EXPECT_EQ(without_parts(mesh, {"left", "bolt#2"}, "a.gltf")->parts[0].path, "engine/right/bolt");
  EXPECT_THAT(take_part(mesh, "bolt", "a.gltf").error().sentence, HasSubstr("2 nodes named 'bolt'"));
  EXPECT_THAT(take_part(mesh, "rihgt", "a.gltf").error().sentence, HasSubstr("did you mean 'right'"));
  EXPECT_THAT(without_parts(mesh, {"engine"}, "a.gltf").error().sentence, HasSubstr("nothing is left"));
}

TEST_F(MeshImport, AbsurdGltfIsRefused) {
  write("t.bin", std::string(36, '\0'));
  EXPECT_THAT(refused(write("cycle.gltf", gltf(R"([{"children":[1]},{"children":[0]}])"))), HasSubstr("contains itself"));
  EXPECT_THAT(refused(write("self.gltf", gltf(R"([{"children":[0]}])"))), HasSubstr("contains itself"));
  EXPECT_THAT(refused(write("child.gltf", gltf(R"([{"children":[7]}])"))), HasSubstr("not one of its 1 nodes"));
  EXPECT_THAT(refused(write("count.gltf", gltf(R"([{"mesh":0}])", "[0]", "4"))), HasSubstr("beyond its buffer view"));
  EXPECT_THAT(refused(write("huge.gltf", gltf(R"([{"mesh":0}])", "[0]", "99999999999"))), HasSubstr("99999999999 entries"));
  EXPECT_THAT(refused(write("json.gltf", "{\"asset\": ")), HasSubstr("no valid JSON"));
  EXPECT_THAT(refused(write("deep.gltf", std::string(100000, '['))), HasSubstr("deep"));
  std::string doubling = "[";
  for (int i = 0; i < 40; ++i) doubling += "{\"children\":[" + std::to_string(i + 1) + "," + std::to_string(i + 1) + "]},";
  EXPECT_THAT(refused(write("doubling.gltf", gltf(doubling + "{\"mesh\":0}]"))), HasSubstr("instances counted"));
  // A sparse accessor without its lists: the importer crashed (found by fuzzing).
  const auto sparse = [](const std::string& what) {
    return R"({"asset":{"version":"2.0"},"accessors":[{"componentType":5126,"count":4,"type":"VEC3","sparse":)" + what +
           R"(}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"t.bin"}]})";
  };
  EXPECT_THAT(refused(write("s1.gltf", sparse(R"({"count":2,"values":{"bufferView":0}})"))), HasSubstr("sparse accessor 0 without indices"));
  EXPECT_THAT(refused(write("s2.gltf", sparse(R"({"count":2,"indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":1}})"))),
              HasSubstr("sparse accessor 0 without values"));
  EXPECT_THAT(refused(write("s3.gltf", sparse(R"({"count":4,"indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":0}})"))),
              HasSubstr("values are beyond their buffer view"));
  EXPECT_THAT(refused(write("s4.gltf", sparse("7"))), HasSubstr("without a count"));
  write("t.bin", std::string(20, '\0'));
  EXPECT_THAT(refused(write("short.gltf", gltf(R"([{"mesh":0}])"))), HasSubstr("buffer 0 promises 36 bytes, there are 20"));
  EXPECT_THAT(refused(write("short.glb", std::string("glTF\2\0\0\0\xff\0\0\0\10\0\0\0JSON{}", 22))), HasSubstr("cut short"));
}

TEST_F(MeshImport, AColladaNodeThatContainsItselfIsRefused) {
  EXPECT_THAT(refused(write("a.dae", "<COLLADA><library_nodes><node id=\"a\"><instance_node url=\"#b\"/></node><node id=\"b\">"
                                     "<instance_node url=\"#a\"/></node></library_nodes></COLLADA>")), HasSubstr("contains itself"));
}

TEST_F(MeshImport, AColladaFileWithOddIndicesOrCountsIsRefused) {
  EXPECT_THAT(refused(write("p.dae", "<COLLADA><p>0 1 7? 3</p></COLLADA>")), HasSubstr("has '?' among its vertex indices"));
  EXPECT_THAT(refused(write("m.dae", "<COLLADA><p>0 1 -2 3</p></COLLADA>")), HasSubstr("has '-' among its vertex indices"));
  EXPECT_THAT(refused(write("c.dae", "<COLLADA><float_array count=\"99999999999\">0</float_array></COLLADA>")),
              HasSubstr("count of '99999999999'"));
}

TEST_F(MeshImport, TruncatedStlIsRefused) {
  std::string binary = binary_stl(solids::box(Vec3(0), Vec3(1)));
  EXPECT_THAT(refused(write("a.stl", binary.substr(0, binary.size() - 70))), HasSubstr("cut short: its 12 facets take 684 bytes, it has 614"));
  EXPECT_THAT(refused(write("head.stl", binary.substr(0, 60))), HasSubstr("cut short"));
  const std::string ascii = ascii_stl();
  for (const std::size_t length : {ascii.size() - 12, ascii.size() / 2, std::size_t{20}})
    EXPECT_THAT(refused(write("b.stl", ascii.substr(0, length))), HasSubstr("does not end with 'endsolid'"));
}

TEST_F(MeshImport, ABinaryStlMayBeginWithTheWordSolid) {
  std::string binary = binary_stl(solids::box(Vec3(0), Vec3(1)));
  std::memcpy(binary.data(), "solid ", 6);
  EXPECT_EQ(read(write("a.stl", binary)).triangles.size(), 12u);
}

TEST_F(MeshImport, CoordinatesMustBeFinite) {
  for (const char* bad : {"nan", "inf", "1e39"}) EXPECT_THAT(refused(write("a.stl", ascii_stl(bad))), testing::Not(testing::IsEmpty()));
  std::string binary = binary_stl(solids::box(Vec3(0), Vec3(1)));
  const float nan = std::nanf("");
  std::memcpy(binary.data() + 84 + 12, &nan, 4);
  EXPECT_THAT(refused(write("b.stl", binary)), HasSubstr("nan m in vertex 0"));
  EXPECT_THAT(refused(write("c.obj", "v 0 0 0\nv nan 0 0\nv 1 1 0\nf 1 2 3\n")), HasSubstr("nan"));
}

TEST_F(MeshImport, MissingEmptyAndUnknownFilesAreRefused) {
  EXPECT_THAT(refused((folder_ / "none.stl").string()), HasSubstr("can't be opened: No such file"));
  EXPECT_THAT(refused(write("empty.stl", "")), HasSubstr("is empty"));
  EXPECT_THAT(refused(folder_.string()), HasSubstr("is not a file"));
  EXPECT_THAT(refused(write("a.xyz1", "1")), HasSubstr("extension '.xyz1'"));
  EXPECT_THAT(refused(write("nothing.stl", "solid s\nendsolid s\n")), testing::Not(testing::IsEmpty()));
  const std::string good = write("good.stl", ascii_stl());
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL}) EXPECT_THAT(refused(good, scale), HasSubstr("the scale of"));
}

}  // namespace
}  // namespace palpate
