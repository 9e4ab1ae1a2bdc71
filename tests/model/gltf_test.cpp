// Meshes of glTF files: nodes, instances, materials, and what is absurd in them.
#include <fmt/format.h>

#include <cstring>
#include <map>

#include "tests/model/import_files.h"

namespace palpate {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// A triangle (0,0,0) (1,0,0) (0,1,0) in a buffer beside the file; `nodes` is the array's JSON.
std::string gltf(const std::string& nodes, const std::string& scene = "[0]", const std::string& count = "3") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":)" + scene + R"(}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" +
         count +
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
  EXPECT_THAT(paths,
              ElementsAre("engine/left", "engine/left/bolt", "engine/right/bolt", "engine/right/bolt#2"));
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(corners(mesh, 1)[1], Vec3(12, 0, 0));                     // 10 + 2 · 1
  EXPECT_LT(glm::length(corners(mesh, 2)[0] - Vec3(0, 5, 0)), 1e-6);  // a float's sine of 45°
  EXPECT_LT(glm::length(corners(mesh, 3)[1] - Vec3(-1, 0, 0)), 1e-6)
      << "a mirrored node's triangles are turned";
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

TEST_F(MeshImport, GltfWithWeightsOfMorphTargetsIsRefused) {
  std::string buffer;
  for (const float f : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(buffer, f);
  write("t.bin", buffer);
  const auto with = [&](const std::string& of_mesh, const std::string& of_node) {
    std::string text = gltf(R"([{"name":"a","mesh":0)" + of_node + "}]");
    const std::string primitives = R"({"primitives":[{"attributes":{"POSITION":0})";
    text.replace(text.find(primitives), primitives.size(),
                 "{" + of_mesh + primitives.substr(1) + R"(,"targets":[{"POSITION":0}])");
    return write("m.gltf", text);
  };
  EXPECT_EQ(read(with("", "")).triangles.size(), 1u);
  EXPECT_EQ(read(with(R"("weights":[0.0],)", R"(,"weights":[0])")).triangles.size(), 1u);
  EXPECT_THAT(refused(with(R"("weights":[0, 0.5],)", "")),
              HasSubstr("weights of morph targets in entry 0 of 'meshes'"));
  EXPECT_THAT(refused(with("", R"(,"weights":[1])")),
              HasSubstr("weights of morph targets in entry 0 of 'nodes'"));
}

TEST_F(MeshImport, GltfMeshNamesAddressPartsToo) {
  std::string buffer;
  for (const float f : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(buffer, f);
  write("t.bin", buffer);
  std::string text = gltf(
      R"([{"name":"engine","children":[1,2,3,4]},{"name":"node_1","mesh":0},{"name":"node_2","mesh":1},{"mesh":2},{"mesh":3}])");
  const std::string one = R"({"primitives":[{"attributes":{"POSITION":0}}]})",
                    triangle = R"({"attributes":{"POSITION":0}})";
  text.replace(text.find(one), one.size(),
               R"({"name":"Piston_123-844","primitives":[)" + triangle +
                   R"(]},{"name":"node_1","primitives":[)" + triangle + "," + triangle + R"(]},)" + one +
                   R"(,{"name":"Rod","primitives":[)" + triangle + "]}");
  const Mesh mesh = read(write("meshes.gltf", text));
  ASSERT_EQ(mesh.parts.size(), 4u);
  EXPECT_EQ(mesh.parts[0].also, "Piston_123-844");
  EXPECT_EQ(mesh.parts[1].also, "node_1") << "two primitives are one part, and its mesh's name has no number";
  EXPECT_EQ(mesh.parts[2].also, "") << "an invented name is none";
  EXPECT_EQ(mesh.parts[2].path, "engine/node");
  EXPECT_EQ(mesh.parts[3].path, "engine/Rod") << "a node without a name has its mesh's";
  EXPECT_EQ(take_part(mesh, "Piston_123-844", "meshes.gltf")->parts[0].path, "engine/node_1");
  EXPECT_EQ(take_part(mesh, "node_1", "meshes.gltf")->parts[0].path, "engine/node_1")
      << "a node's own name goes before a mesh's";
  EXPECT_EQ(take_part(mesh, "#2", "meshes.gltf")->parts[0].path, "engine/node_2");
  EXPECT_THAT(take_part(mesh, "Piston_123-845", "meshes.gltf").error().sentence,
              testing::AllOf(HasSubstr("did you mean 'Piston_123-844'"),
                             HasSubstr("`palpate info --tree 'meshes.gltf'` lists them")));
}

// 255 · (1.055 · 0.2^(1/2.4) − 0.055) = 123.55: 0x7c.
TEST_F(MeshImport, GltfMaterialsColourParts) {
  std::string buffer;
  for (const float f : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(buffer, f);
  write("t.bin", buffer);
  std::string text = gltf(
      R"([{"name":"all","children":[1,2,3,4]},{"name":"red","mesh":0},{"name":"most","mesh":1},{"name":"none","mesh":2},{"name":"textured","mesh":3}])");
  const auto primitive = [](const std::string& material) {
    return R"({"attributes":{"POSITION":0})" + material + "}";
  };
  const std::string one = R"({"primitives":[{"attributes":{"POSITION":0}}]})", red = R"(,"material":0)",
                    grey = R"(,"material":1)";
  text.replace(text.find(one), one.size(),
               R"({"primitives":[)" + primitive(red) + R"(]},{"primitives":[)" + primitive(red) + "," +
                   primitive(grey) + "," + primitive(grey) + R"(]},)" + one + R"(,{"primitives":[)" +
                   primitive(R"(,"material":2)") + "]}");
  text.insert(
      text.rfind('}'),
      R"(,"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}},{"pbrMetallicRoughness":{"baseColorFactor":[0.214,0.214,0.214,1]}},
      {"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],"images":[{"uri":"none.png"}])");
  const Mesh mesh = read(write("a.gltf", text));
  std::vector<std::optional<std::uint32_t>> colours;
  for (const MeshPart& part : mesh.parts) colours.push_back(part.colour);
  EXPECT_THAT(colours, ElementsAre(0xff0000u, 0x7f7f7fu, std::nullopt, std::nullopt));
}

TEST_F(MeshImport, AbsurdGltfIsRefused) {
  write("t.bin", std::string(36, '\0'));
  EXPECT_THAT(refused(write("cycle.gltf", gltf(R"([{"children":[1]},{"children":[0]}])"))),
              HasSubstr("contains itself"));
  EXPECT_THAT(refused(write("self.gltf", gltf(R"([{"children":[0]}])"))), HasSubstr("contains itself"));
  EXPECT_THAT(refused(write("child.gltf", gltf(R"([{"children":[7]}])"))),
              HasSubstr("not one of its 1 nodes"));
  EXPECT_THAT(refused(write("count.gltf", gltf(R"([{"mesh":0}])", "[0]", "4"))),
              HasSubstr("beyond its buffer view"));
  EXPECT_THAT(refused(write("huge.gltf", gltf(R"([{"mesh":0}])", "[0]", "99999999999"))),
              HasSubstr("99999999999 entries"));
  const auto requires_extension = [&](const std::string& name) {
    return gltf(R"([{"mesh":0}])").replace(0, 1, R"({"extensionsRequired":[")" + name + R"("],)");
  };
  EXPECT_THAT(refused(write("instances.gltf", requires_extension("EXT_mesh_gpu_instancing"))),
              HasSubstr("requires the extension 'EXT_mesh_gpu_instancing'"));
  EXPECT_EQ(read(write("unlit.gltf", requires_extension("KHR_materials_unlit"))).triangles.size(), 1u);
  EXPECT_THAT(refused(write("json.gltf", "{\"asset\": ")), HasSubstr("no valid JSON"));
  EXPECT_THAT(refused(write("deep.gltf", std::string(100000, '['))), HasSubstr("deep"));
  std::string doubling = "[";
  for (int i = 0; i < 40; ++i)
    doubling += "{\"children\":[" + std::to_string(i + 1) + "," + std::to_string(i + 1) + "]},";
  EXPECT_THAT(refused(write("doubling.gltf", gltf(doubling + "{\"mesh\":0}]"))),
              HasSubstr("instances counted"));
  // A sparse accessor without its lists: the importer crashed (found by fuzzing).
  const auto sparse = [](const std::string& what) {
    return R"({"asset":{"version":"2.0"},"accessors":[{"componentType":5126,"count":4,"type":"VEC3","sparse":)" +
           what +
           R"(}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"t.bin"}]})";
  };
  EXPECT_THAT(refused(write("s1.gltf", sparse(R"({"count":2,"values":{"bufferView":0}})"))),
              HasSubstr("sparse accessor 0 without indices"));
  EXPECT_THAT(
      refused(write(
          "s2.gltf",
          sparse(
              R"({"count":2,"indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":1}})"))),
      HasSubstr("sparse accessor 0 without values"));
  EXPECT_THAT(
      refused(write(
          "s3.gltf",
          sparse(
              R"({"count":4,"indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":0}})"))),
      HasSubstr("values are beyond their buffer view"));
  EXPECT_THAT(refused(write("s4.gltf", sparse("7"))), HasSubstr("without a count"));
  write("t.bin", std::string(20, '\0'));
  EXPECT_THAT(refused(write("short.gltf", gltf(R"([{"mesh":0}])"))),
              HasSubstr("buffer 0 promises 36 bytes, there are 20"));
  EXPECT_THAT(refused(write("short.glb", std::string("glTF\2\0\0\0\xff\0\0\0\10\0\0\0JSON{}", 22))),
              HasSubstr("cut short"));
}

// The library left the face out and said nothing.
TEST_F(MeshImport, AGltfFaceOfAVertexThatDoesNotExistIsRefused) {
  const auto with = [&](std::uint16_t last) {
    std::string buffer;
    for (const float f : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) put(buffer, f);
    for (const std::uint16_t i :
         {std::uint16_t{0}, std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{0}, std::uint16_t{1}, last})
      put(buffer, i);
    write("i.bin", buffer);
    return write(
        "i.gltf",
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
      "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],"buffers":[{"byteLength":60,"uri":"i.bin"}]})");
  };
  EXPECT_EQ(read(with(3)).triangles.size(), 2u);
  EXPECT_THAT(refused(with(9)), HasSubstr("2 triangles in mesh 'meshes[0]' of which 1 can be read"));
}

// The library lists meshes in the order in which nodes name them, not in the file's.
TEST_F(MeshImport, GltfMeshesMayBeNamedInAnyOrder) {
  std::string buffer;
  for (const float f : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) put(buffer, f);
  for (const int i : {0, 1, 2, 0, 1, 3}) put(buffer, static_cast<std::uint16_t>(i));
  write("i.bin", buffer);
  const Mesh mesh = read(write(
      "order.gltf",
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"name":"a","mesh":1},{"name":"b","mesh":0}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]},{"primitives":[{"attributes":{"POSITION":0},"indices":2}]},{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"},
        {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
      "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],"buffers":[{"byteLength":60,"uri":"i.bin"}]})"));
  ASSERT_EQ(mesh.parts.size(), 2u);
  EXPECT_EQ(mesh.parts[0].triangle_count, 1u);
  EXPECT_EQ(mesh.parts[1].triangle_count, 2u);
}

}  // namespace
}  // namespace palpate
