#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>

#include "model/generate/solids.h"
#include "tests/model/import_files.h"

namespace palpate {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

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
  return "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex " + x +
         " 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
         "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex -1 0 "
         "0\nendloop\nendfacet\nendsolid s\n";
}

/// The corners of a triangle, in order.
TEST_F(MeshImport, BinaryStlKeepsTheOrderOfItsFaces) {
  const Mesh sphere = solids::sphere(0.5, 12, 6);
  const Mesh mesh = read(write("a.stl", binary_stl(sphere)), 0.001);
  ASSERT_EQ(mesh.triangles.size(), sphere.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT(glm::length(corners(mesh, t)[k] - 0.001 * corners(sphere, t)[k]),
                1e-10);  // STL keeps 24 bits of 0.5 mm
  ASSERT_EQ(mesh.parts.size(), 1u);
  EXPECT_EQ(mesh.parts[0].path, "a") << "a file without names is one part, named like the file";
}

TEST_F(MeshImport, AsciiStl) {
  const Mesh mesh = read(write("a.STL", ascii_stl()));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_THAT(corners(mesh, 0), ElementsAre(Vec3(0), Vec3(1.5, 0, 0), Vec3(0, 1, 0)));
  EXPECT_EQ(mesh.parts[0].path, "a/s");
}

TEST_F(MeshImport, ConvexPolygonsAreSplitAsFansInOrder) {
  const Mesh mesh =
      read(write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\nf 1 2 3 4 5\nf 3 2 1\n"));
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_THAT(corners(mesh, 0), ElementsAre(Vec3(0), Vec3(1, 0, 0), Vec3(1, 1, 0)));
  EXPECT_THAT(corners(mesh, 2), ElementsAre(Vec3(0), Vec3(0, 1, 0), Vec3(-1, 0.5, 0)));
  EXPECT_THAT(corners(mesh, 3), ElementsAre(Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0)));
  EXPECT_THAT(report_.notes, Contains("split 1 polygons into triangles"));
}

/// Six times the signed volume of a closed surface.
double volume6(const Mesh& mesh) {
  double out = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::vector<Vec3> c = corners(mesh, t);
    out += glm::dot(c[0], glm::cross(c[1], c[2]));
  }
  return out;
}

/// Directed edges by place that have no opposite.
std::size_t open_edges(const Mesh& mesh) {
  std::map<std::array<double, 6>, int> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::vector<Vec3> c = corners(mesh, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = c[k], &b = c[(k + 1) % 3];
      ++edges[{a.x, a.y, a.z, b.x, b.y, b.z}];
      --edges[{b.x, b.y, b.z, a.x, a.y, a.z}];
    }
  }
  return static_cast<std::size_t>(
      std::count_if(edges.begin(), edges.end(), [](const auto& edge) { return edge.second > 0; }));
}

/// A prism on a polygon of corners in a plane, `first` of which begins its caps: vertices of the lower, then
/// the upper end, and faces.
struct Prism {
  std::vector<Vec3> vertices;
  std::vector<std::vector<std::size_t>> faces;
};
Prism prism(const std::vector<Vec3>& outline, double height, std::size_t first) {
  Prism out;
  const std::size_t n = outline.size();
  for (const double z : {0.0, height})
    for (const Vec3& p : outline) out.vertices.push_back(p + Vec3(0, 0, z));
  std::vector<std::size_t> low, high;
  for (std::size_t i = 0; i < n; ++i) {
    low.push_back((first + n - i) % n);
    high.push_back(n + (first + i) % n);
    out.faces.push_back({i, (i + 1) % n, n + (i + 1) % n, n + i});
  }
  out.faces.push_back(low);
  out.faces.push_back(high);
  return out;
}

std::string as_text(const Prism& prism, const std::string& kind) {
  std::string vertices, faces;
  for (const Vec3& v : prism.vertices)
    vertices += fmt::format("{}{} {} {}\n", kind == "obj" ? "v " : "", v.x, v.y, v.z);
  for (const auto& face : prism.faces) {
    faces += kind == "obj" ? "f" : fmt::format("{}", face.size());
    for (const std::size_t i : face) faces += fmt::format(" {}", i + (kind == "obj" ? 1 : 0));
    faces += "\n";
  }
  if (kind == "obj") return vertices + faces;
  if (kind == "off")
    return fmt::format("OFF\n{} {} 0\n{}{}", prism.vertices.size(), prism.faces.size(), vertices, faces);
  return fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n{}{}",
      prism.vertices.size(), prism.faces.size(), vertices, faces);
}

// An L, and a comb: a fan from most of their corners covers their notches.
TEST_F(MeshImport, ConcavePolygonsBoundWhatTheyBound) {
  const std::vector<Vec3> l = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  std::vector<Vec3> comb = {{0, 0, 0}};
  for (int i = 0; i < 6; ++i)
    comb.insert(comb.end(),
                {{2.0 * i + 1, 0, 0}, {2.0 * i + 1, 3, 0}, {2.0 * i + 2, 3, 0}, {2.0 * i + 2, 0, 0}});
  comb.insert(comb.end(), {{13, 0, 0}, {13, -1, 0}, {6, -1, 0}, {0, -1, 0}});  // and one on a straight side
  std::reverse(comb.begin(), comb.end());                                      // round to the left
  for (const auto& [outline, area] : {std::pair{l, 3.0}, std::pair{comb, 13.0 + 6 * 3}})
    for (std::size_t first = 0; first < outline.size(); ++first)
      for (const char* kind : {"obj", "off", "ply"}) {
        const std::string path = write(std::string("a.") + kind, as_text(prism(outline, 0.5, first), kind));
        if (outline.size() > 9 &&
            std::string_view(kind) == "off") {  // of which the library leaves large ones out
          EXPECT_THAT(refused(path), HasSubstr("29 corners in face 29; OFF faces of more than 9"));
          continue;
        }
        const Mesh mesh = read(path);
        EXPECT_NEAR(volume6(mesh) / 6, area * 0.5, 1e-6) << kind << " from corner " << first;
        EXPECT_EQ(open_edges(mesh), 0u) << kind << " from corner " << first;
        // Without a fold: no cap's triangle looks the other way, so their areas add up to the cap's, not to
        // more.
        double caps = 0;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
          const std::vector<Vec3> c = corners(mesh, t);
          if (c[0].z == c[1].z && c[1].z == c[2].z)
            caps += glm::length(glm::cross(c[1] - c[0], c[2] - c[0])) / 2;
        }
        EXPECT_NEAR(caps, 2 * area, 1e-6) << kind << " from corner " << first;
        EXPECT_THAT(report_.notes, testing::Not(Contains(HasSubstr("cross"))));
      }
}

TEST_F(MeshImport, APolygonThatCrossesItselfIsReported) {
  EXPECT_EQ(read(write("bow.obj", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n")).triangles.size(), 2u);
  EXPECT_THAT(report_.notes, Contains(HasSubstr("1 polygons cross themselves, the first is face 0")));
  std::string star = "";
  for (int i = 0; i < 5; ++i)
    star += fmt::format("v {} {} 0\n", std::cos(i * 0.8 * M_PI),
                        std::sin(i * 0.8 * M_PI));  // twice round: every turn is to the left
  read(write("star.obj", star + "f 1 2 3 4 5\n"));
  EXPECT_THAT(report_.notes, Contains(HasSubstr("1 polygons cross themselves")));
}

TEST_F(MeshImport, LinesAndPointsAreDroppedAndCounted) {
  const Mesh mesh = read(write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2\nl 2 3\nf 1 2 3\n"));
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_THAT(report_.notes, Contains("dropped 2 line primitives"));
  EXPECT_THAT(refused(write("b.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")), HasSubstr("no triangles"));
}

TEST_F(MeshImport, PlyAndOff) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  const Mesh ply = read(write("a.ply", header + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"));
  ASSERT_EQ(ply.triangles.size(), 2u);
  EXPECT_THAT(corners(ply, 1), ElementsAre(Vec3(0), Vec3(1, 1, 0), Vec3(0, 1, 0)));
  const Mesh off = read(write("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"));
  ASSERT_EQ(off.triangles.size(), 2u);
  EXPECT_EQ(corners(off, 1), corners(ply, 1));
  EXPECT_THAT(refused(write("short.ply", header + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n")),
              HasSubstr("promises 2 elements 'face' and has 1"));
  EXPECT_THAT(
      refused(write(
          "many.ply",
          "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n")),
      HasSubstr("promises 4000000000 elements 'vertex'"));
  // Without a property an element takes no bytes: the importer then counted to 353535235358 (found by
  // fuzzing).
  EXPECT_THAT(
      refused(write("no_property.ply",
                    "ply\nformat binary_little_endian 1.0\nelement vertex 353535235358\nend_header\n0000")),
      HasSubstr("promises 353535235358 elements 'vertex'"));
  EXPECT_THAT(
      refused(write("unknown.ply",
                    "ply\nformat ascii 1.0\nelement vertex 3\npoperty float x\nend_header\n0\n0\n0\n")),
      HasSubstr("begins with 'poperty', which PLY does not know"));
  // The importer wrote beyond the first one's vertices (found by fuzzing).
  EXPECT_THAT(refused(write("twice.ply", "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n" +
                                             header.substr(header.find("element vertex")) +
                                             "1\n2\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n")),
              HasSubstr("has two elements 'vertex'"));
  const std::string told =
      std::string(header).insert(header.find("element face"), "comment of ours\n\nobj_info num_cols 2\n");
  EXPECT_EQ(read(write("told.ply", told + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n")).triangles.size(),
            2u);
  EXPECT_THAT(refused(write("index.ply", header + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 9\n")),
              HasSubstr("vertex index 9"));
  EXPECT_THAT(refused(write("many.off", "OFF\n353535235358 6 0\n0 0 0\n")),
              HasSubstr("promises 353535235358 vertices"));
  EXPECT_THAT(refused(write("short.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n")),
              HasSubstr("promises 2 faces and has 1"));
  // The importer wrote beyond the room that it took for the others (found by fuzzing).
  EXPECT_THAT(refused(write("empty_face.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n1 1 0\n0\n3 0 1 2\n")),
              HasSubstr("has 0 corners in face 0"));
  EXPECT_THAT(refused(write("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 7\n")),
              HasSubstr("vertex index 7"));
}

// What Blender 2.47 writes. Other lines that PLY does not know are refused, for the library takes some of
// them for elements.
TEST_F(MeshImport, APlyMayTellItsMakerWithoutSayingComment) {
  const auto with = [&](const char* line) {
    return write("maker.ply", std::string("ply\nformat ascii 1.0\n") + line +
                                  "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                                  "element face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 "
                                  "0\n1 0 0\n0 1 0\n3 0 1 2\n");
  };
  EXPECT_EQ(read(with("Created by Blender3D 247 - www.blender.org, source file:")).triangles.size(), 1u);
  EXPECT_THAT(refused(with("Elements by nobody")),
              HasSubstr("begins with 'Elements', which PLY does not know"));
}

/// A triangle (0 0 0) (1 0 0) (0 2 3) as COLLADA has it.
std::string collada(const std::string& up, int numbers = 9) {
  std::string array;
  for (const int n : std::vector<int>{0, 0, 0, 1, 0, 0, 0, 2, 3})
    array += numbers-- > 0 ? fmt::format("{} ", n) : "";
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
         up + R"(</asset>
    <library_geometries><geometry id="g"><mesh><source id="s"><float_array id="f" count="9">)" +
         array + R"(</float_array><technique_common><accessor source="#f" count="3" stride="3">
    <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
    <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
    <library_visual_scenes><visual_scene id="vs"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#vs"/></scene></COLLADA>)";
}

// One rule: coordinates are the file's own, whichever axis it says is up.
TEST_F(MeshImport, NoFormatIsTurned) {
  const std::vector<Vec3> wanted = {Vec3(0), Vec3(1, 0, 0), Vec3(0, 2, 3)};
  for (const char* up :
       {"", "<up_axis>Y_UP</up_axis>", "<up_axis>Z_UP</up_axis>", "<up_axis>X_UP</up_axis>"}) {
    EXPECT_EQ(corners(read(write("a.dae", collada(up))), 0), wanted) << up;
    const bool told = std::string(up).find("Z_UP") != std::string::npos;
    EXPECT_EQ(std::any_of(report_.notes.begin(), report_.notes.end(),
                          [](const std::string& note) {
                            return note == "the file says that z is up; coordinates are the file's own";
                          }),
              told)
        << up;
  }
  // 3DS: chunks of a number, a length and what is in them.
  const auto chunk = [](std::uint16_t number, const std::string& content) {
    std::string out;
    put(out, number);
    put(out, static_cast<std::uint32_t>(6 + content.size()));
    return out + content;
  };
  std::string vertices, faces;
  put(vertices, std::uint16_t{3});
  for (const Vec3& p : wanted)
    for (int k = 0; k < 3; ++k) put(vertices, static_cast<float>(p[k]));
  put(faces, std::uint16_t{1});
  for (const int i : {0, 1, 2, 7}) put(faces, static_cast<std::uint16_t>(i));
  const std::string object =
      std::string("plate\0", 6) + chunk(0x4100, chunk(0x4110, vertices) + chunk(0x4120, faces));
  EXPECT_EQ(corners(read(write("a.3ds", chunk(0x4D4D, chunk(0x3D3D, chunk(0x4000, object))))), 0), wanted);
  EXPECT_THAT(report_.notes, Contains("z is up in 3DS files; coordinates are the file's own"));
}

// The library took what lay behind the array in memory for coordinates.
TEST_F(MeshImport, AColladaArrayShorterThanItsAccessorIsRefused) {
  EXPECT_THAT(
      refused(write("a.dae", collada("", 8))),
      HasSubstr("accessor of 3 times 3 numbers, 3 apart, from number 0 on, beyond its array 'f' of 8"));
}

// Of a longer array the library takes as many numbers as its `count` says.
TEST_F(MeshImport, AColladaArrayThatSaysLessThanItHasIsRefused) {
  const auto with = [](const std::string& what, const std::string& instead) {
    std::string text = collada("");
    return text.replace(text.find(what), what.size(), instead);
  };
  EXPECT_EQ(read(write("a.dae", with("count=\"9\"", "count = '9'"))).triangles.size(), 1u);
  EXPECT_THAT(refused(write("b.dae", with("count=\"9\"", "count=\"3\""))),
              HasSubstr("beyond its array 'f' of 3"));
  EXPECT_THAT(refused(write("c.dae", with("count=\"9\"", "count = '3'"))),
              HasSubstr("beyond its array 'f' of 3"));
  EXPECT_THAT(refused(write("d.dae", with(" count=\"9\"", ""))), HasSubstr("beyond its array 'f' of 0"));
  EXPECT_THAT(refused(write("e.dae", with("count=\"3\" stride", "count=\"0x9\" stride"))),
              HasSubstr("has '0x9' for a count, stride or offset"));
  EXPECT_THAT(
      refused(write("f.dae", with("stride=\"3\"", "stride=\"4\""))),
      HasSubstr("accessor of 3 times 4 numbers, 4 apart, from number 0 on, beyond its array 'f' of 9"));
  // Four names reach a number further than the last item's three.
  EXPECT_THAT(refused(write(
                  "g.dae", with("<param name=\"X\"", "<param name=\"W\" type=\"float\"/><param name=\"X\""))),
              HasSubstr("accessor of 3 times 4 numbers, 3 apart, from number 0 on"));
}

// The library made a skeleton's bones of cameras.
TEST_F(MeshImport, AFileOfCamerasHasNoTriangles) {
  EXPECT_THAT(
      refused(write(
          "cameras.dae",
          R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><library_visual_scenes><visual_scene id="vs">
    <node id="a"><translate>1 0 0</translate><node id="b"><translate>0 1 0</translate></node></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#vs"/></scene></COLLADA>)")),
      HasSubstr("has no triangles"));
}

TEST_F(MeshImport, ABinaryPlyMayBeginWithAnyByte) {
  for (const int first : {0x0a, 0x0d, 0x20, 0x00}) {
    std::string file =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float "
        "y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    float x = 0;
    const unsigned char bytes[4] = {static_cast<unsigned char>(first), 0x0a, 0x80, 0x3f};  // just above 1
    std::memcpy(&x, bytes, 4);
    for (const float f : {x, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) put(file, f);
    put(file, std::uint8_t{3});
    for (const std::int32_t i : {0, 1, 2}) put(file, i);
    const Mesh mesh = read(write("a.ply", file));
    ASSERT_EQ(mesh.triangles.size(), 1u) << first;
    EXPECT_EQ(corners(mesh, 0)[0], Vec3(x, 0, 0)) << first;
    EXPECT_EQ(corners(mesh, 0)[2], Vec3(0, 0, 1)) << first;
  }
}

// The library took none of the unknown elements' bytes, and so others' for vertices.
TEST_F(MeshImport, APlyWithUnknownElementsInFrontIsRefused) {
  const std::string header = "ply\nformat ascii 1.0\n",
                    vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
                    faces = "element face 1\nproperty list uchar int vertex_indices\n",
                    more = "element tag 2\nproperty float x\n";
  EXPECT_THAT(refused(write("a.ply", header + more + vertices + faces +
                                         "end_header\n7\n8\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")),
              HasSubstr("has 2 elements 'tag' in front of others"));
  EXPECT_EQ(read(write("b.ply",
                       header + vertices + faces + more + "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n7\n8\n"))
                .triangles.size(),
            1u);
}

// Of 268,000 triangles in strips the library read one.
TEST_F(MeshImport, APlyOfStripsIsRefused) {
  EXPECT_THAT(
      refused(write("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
                    "float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                    "0 0 0\n1 0 0\n0 1 0\n1 1 0\n5 0 1 2 3 -1\n")),
      HasSubstr("keeps its triangles in strips"));
}

TEST_F(MeshImport, ObjIndicesAndEncodingsAreChecked) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(read(write("a.obj", vertices + "f -3 -2 -1\n")).triangles.size(), 1u);
  EXPECT_EQ(read(write("behind.obj", "f 1 2 3\n" + vertices)).triangles.size(), 1u);
  EXPECT_EQ(read(write("on.obj", vertices + "f 1 \\\n2 3\n")).triangles.size(), 1u);
  EXPECT_THAT(refused(write("b.obj", vertices + "f -4 -2 -1\n")),
              HasSubstr("vertex index -4 in line 4, beyond the vertex list (size 3)"));
  EXPECT_THAT(refused(write("c.obj", "v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n")),
              HasSubstr("vertex index -3 in line 3, beyond the vertex list (size 2)"));
  EXPECT_THAT(refused(write("d.obj", vertices + "f 1 2 4\n")), HasSubstr("vertex index 4 in line 4"));
  EXPECT_THAT(refused(write("e.obj", vertices + "f 0 1 2\n")), HasSubstr("vertex index 0 in line 4"));
  EXPECT_THAT(refused(write("f.obj", vertices + "f 1 2 x\n")), HasSubstr("'x' for a vertex in line 4"));
  EXPECT_EQ(read(write("n.obj", vertices + "vt 0 0\nvn 0 0 1\nf 1/1/1 2//-1 3/-1\n")).triangles.size(), 1u);
  EXPECT_THAT(refused(write("t.obj", vertices + "f 1 2 3\nf 1/1 2/1 3/1\n")),
              HasSubstr("texture index 1 in line 5, beyond the texture list (size 0)"));
  EXPECT_THAT(refused(write("n0.obj", vertices + "vn 0 0 1\nf 1//1 2//2 3//1\n")),
              HasSubstr("normal index 2 in line 5, beyond the normal list (size 1)"));
  std::string wide("\xFF\xFE", 2);
  for (const char c : vertices + "f 1 2 3\n") wide += {c, '\0'};
  EXPECT_THAT(refused(write("g.obj", wide)), HasSubstr("is UTF-16 text"));
  wide.clear();
  for (const char c : collada("")) wide += {'\0', c};
  EXPECT_THAT(refused(write("h.dae", wide)), HasSubstr("is UTF-16 text"));
  EXPECT_THAT(refused(write("i.dae", "\xFE\xFF" + wide)), HasSubstr("is UTF-16 text"));
}

TEST_F(MeshImport, AColladaNodeThatContainsItselfIsRefused) {
  EXPECT_THAT(
      refused(write("a.dae",
                    "<COLLADA><library_nodes><node id=\"a\"><instance_node url=\"#b\"/></node><node id=\"b\">"
                    "<instance_node url=\"#a\"/></node></library_nodes></COLLADA>")),
      HasSubstr("contains itself"));
}

TEST_F(MeshImport, AColladaFileWithOddIndicesOrCountsIsRefused) {
  EXPECT_THAT(refused(write("p.dae", "<COLLADA><p>0 1 7? 3</p></COLLADA>")),
              HasSubstr("has '?' among its vertex indices"));
  EXPECT_THAT(refused(write("m.dae", "<COLLADA><p>0 1 -2 3</p></COLLADA>")),
              HasSubstr("has '-' among its vertex indices"));
  EXPECT_THAT(
      refused(write("c.dae", "<COLLADA><float_array count=\"99999999999\">0</float_array></COLLADA>")),
      HasSubstr("count of '99999999999'"));
}

// The library took three of them.
TEST_F(MeshImport, AnStlFacetOfFourVerticesIsRefused) {
  std::string ascii = ascii_stl();
  ascii.insert(ascii.find("endloop"), "vertex 1 1 0\n");
  EXPECT_THAT(refused(write("a.stl", ascii)), HasSubstr("a facet of more than three vertices, in line 7"));
  EXPECT_THAT(refused(write("b.stl", "SOLID s\n" + std::string(200, ' ') + "\nENDSOLID s\n")),
              HasSubstr("in capitals"));
}

TEST_F(MeshImport, TruncatedStlIsRefused) {
  std::string binary = binary_stl(solids::box(Vec3(0), Vec3(1)));
  EXPECT_THAT(refused(write("a.stl", binary.substr(0, binary.size() - 70))),
              HasSubstr("cut short: its 12 facets take 684 bytes, it has 614"));
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
  for (const char* bad : {"nan", "inf", "1e39"})
    EXPECT_THAT(refused(write("a.stl", ascii_stl(bad))), testing::Not(testing::IsEmpty()));
  std::string binary = binary_stl(solids::box(Vec3(0), Vec3(1)));
  const float nan = std::nanf("");
  std::memcpy(binary.data() + 84 + 12, &nan, 4);
  EXPECT_THAT(refused(write("b.stl", binary)), HasSubstr("coordinate inf or nan in vertex 0"));
  EXPECT_THAT(refused(write("c.obj", "v 0 0 0\nv nan 0 0\nv 1 1 0\nf 1 2 3\n")), HasSubstr("nan"));
}

// The library takes what a word begins with, or leaves out the vertex and takes the next one for it.
TEST_F(MeshImport, EveryNumberOfATextIsWhollyOne) {
  const auto obj = [&](const std::string& first) {
    return write("n.obj", "v " + first + "\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nv 9 9 9\n");
  };
  const auto off = [&](const std::string& first) {
    return write("n.off", "OFF\n3 1 0\n" + first + "\n1 0 0\n0 1 0\n3 0 1 2\n");
  };
  const auto ply = [&](const std::string& first, const std::string& face = "3 0 1 2") {
    return write(
        "n.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
        "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" +
            first + "\n1 0 0\n0 1 0\n" + face + "\n");
  };
  const auto stl = [&](const std::string& first) {
    return write("n.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex " + first +
                              "\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n");
  };
  const std::vector<std::pair<const char*, Vec3>> good = {{".5 -.25 +.125", Vec3(0.5, -0.25, 0.125)},
                                                          {"2. +3 5E-1", Vec3(2, 3, 0.5)},
                                                          {" 0\t.5  4e+1 ", Vec3(0, 0.5, 40)},
                                                          {"0,5 -2,25 0", Vec3(0.5, -2.25, 0)}};
  for (const auto& [text, wanted] : good)
    for (const auto& path : {obj(text), off(text), ply(text), stl(text)})
      EXPECT_EQ(corners(read(path), 0)[0], wanted) << path << " " << text;
  for (const char* bad : {"0x10 0 0", "0 1,5,2 0", "0 0 1.5.2", "1d3 0 0", "0 0 5-3", "1e 0 0", "abc 0 0",
                          "1_0 0 0", ". 0 0", "30000000000000000000000000000000000000000e-40 0 0"})
    for (const auto& path : {obj(bad), off(bad), ply(bad), stl(bad)})
      EXPECT_THAT(refused(path), HasSubstr("for a number in ")) << path << " " << bad;
  for (const auto& path : {off("0 0"), ply("0 0"), stl("0 0")})
    EXPECT_THAT(refused(path), HasSubstr("has 2 of 3 numbers in ")) << path;
  EXPECT_THAT(refused(obj("0 0")),
              HasSubstr("has a vertex of 2 numbers in line 1; of 3, 4 or 6 it can be read"));
  EXPECT_THAT(refused(obj("0 0 0 1 1 1 1")), HasSubstr("has a vertex of 7 numbers in line 1"));
  EXPECT_THAT(refused(ply("0 0 0", "3. 0 1 2")), HasSubstr("has '3.' for the length of a list in line 13"));
  EXPECT_THAT(refused(ply("0 0 0", "3 0 1")), HasSubstr("has 2 of 3 numbers in line 13"));
  EXPECT_EQ(
      read(
          write("map.obj",
                "v 0 0 0 1 .5 1\nv 1 0 0\nv \\\n0 \\\n.5 0\nvt .5 .5\nvn 0 0 .5 # .5\nf 1/1/1 2/1/1 3/1/1\n"))
          .vertices.back(),
      Vec3(0, 0.5, 0));
}

TEST_F(MeshImport, NamesOfStlSolidsAreWhole) {
  const auto solid = [](const std::string& name) {
    return "solid " + name +
           "\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
           "0\nendloop\nendfacet\nendsolid " +
           name + "\n";
  };
  for (const char* mark : {"", "\xEF\xBB\xBF"}) {
    const Mesh mesh = read(write("n.stl", mark + solid("Left Bracket") + solid("Left  Arm ") + solid("one")));
    ASSERT_EQ(mesh.parts.size(), 3u);
    EXPECT_EQ(mesh.parts[0].path, "n/Left Bracket");
    EXPECT_EQ(mesh.parts[1].path, "n/Left  Arm");
    EXPECT_EQ(mesh.parts[2].path, "n/one");
    EXPECT_EQ(take_part(mesh, "Left Bracket", "n.stl")->triangles.size(), 1u);
  }
}

TEST_F(MeshImport, EveryNumberOfAColladaIsWhollyOne) {
  const std::string good = collada("");
  for (const char* bad : {"1.5.2", "5-3", "1,5,2", "0x10", "1d3"}) {
    std::string text = good;
    const std::size_t numbers = text.find('>', text.find("<float_array")) + 1;
    text.replace(numbers, text.find_first_of(" <", numbers) - numbers, bad);
    EXPECT_THAT(refused(write("a.dae", text)),
                HasSubstr(std::string("'") + bad + "' for a number of a <float_array>"));
  }
  std::string turned = good;
  turned.insert(turned.find("<instance_geometry"), "<translate>0 1.2.3 0</translate>");
  EXPECT_THAT(refused(write("b.dae", turned)), HasSubstr("'1.2.3' for a number of a <translate>"));
}

TEST_F(MeshImport, MissingEmptyAndUnknownFilesAreRefused) {
  EXPECT_THAT(refused((folder_ / "none.stl").string()), HasSubstr("can't be opened: No such file"));
  EXPECT_THAT(refused(write("empty.stl", "")), HasSubstr("is empty"));
  EXPECT_THAT(refused(folder_.string()), HasSubstr("is not a file"));
  EXPECT_THAT(refused(write("a.xyz1", "1")), HasSubstr("extension '.xyz1'"));
  EXPECT_THAT(refused(write("nothing.stl", "solid s\nendsolid s\n")), testing::Not(testing::IsEmpty()));
  const std::string good = write("good.stl", ascii_stl());
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THAT(refused(good, scale), HasSubstr("the scale of"));
}

}  // namespace
}  // namespace palpate
