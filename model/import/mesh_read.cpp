#include "model/import/mesh_read.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <unordered_map>

#include "model/file_view.h"
#include "model/import/import_checks.h"
#include "model/lattice_build.h"
#include "model/one_line.h"
#include "model/weld.h"

namespace palpate {
namespace {

/// Opens files below a folder, all symbolic links followed, and no others.
class FilesBelow final : public Assimp::DefaultIOSystem {
 public:
  explicit FilesBelow(const std::string& folder) : folder_(folder) {}
  bool Exists(const char* path) const override { return below(path) && DefaultIOSystem::Exists(path); }
  Assimp::IOStream* Open(const char* path, const char* mode) override { return below(path) ? DefaultIOSystem::Open(path, mode) : nullptr; }

 private:
  bool below(const char* path) const {
    std::error_code error;
    const std::filesystem::path real = std::filesystem::canonical(path, error);
    return !error && std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end()).first == folder_.end();
  }
  std::filesystem::path folder_;
};

/// Row-major affine transform in double: assimp's are float, their products need not be.
struct Transform {
  double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

  static Transform of(const aiMatrix4x4& a) {
    return {{{a.a1, a.a2, a.a3, a.a4}, {a.b1, a.b2, a.b3, a.b4}, {a.c1, a.c2, a.c3, a.c4}}};
  }
  Transform operator*(const Transform& b) const {
    Transform out;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c)
        out.m[r][c] = m[r][0] * b.m[0][c] + m[r][1] * b.m[1][c] + m[r][2] * b.m[2][c] + (c == 3 ? m[r][3] : 0);
    return out;
  }
  Vec3 operator*(const aiVector3D& p) const {
    Vec3 out;
    for (int r = 0; r < 3; ++r)
      out[r] = m[r][0] * static_cast<double>(p.x) + m[r][1] * static_cast<double>(p.y) + m[r][2] * static_cast<double>(p.z) + m[r][3];
    return out;
  }
  /// Mirrors: the triangles must be turned, or their normals would point inwards.
  bool mirrors() const {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) < 0;
  }
};

/// The name that a file gives a node; empty where the importer had to invent one ("<STL_BINARY>", "<OFFRoot>", …).
std::string given_name(const aiNode& node) {
  std::string name(node.mName.data, node.mName.length);
  if (name.size() > 1 && name.front() == '<' && name.back() == '>') name.clear();
  std::replace_if(name.begin(), name.end(), [](char c) { return c == '/' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '_');
  return name;
}

/// A node's name for a path: never empty, without the slash that joins paths, told apart from its siblings'.
std::string path_name(const aiNode& node, const std::string& otherwise, std::unordered_map<std::string, int>& siblings) {
  std::string name = given_name(node);
  if (name.empty()) name = otherwise;
  std::string unique = name;
  for (int& n = siblings[name]; ++n > 1 && siblings.count(unique = fmt::format("{}#{}", name, n)) != 0;) {
  }
  if (unique != name) siblings[unique] = 1;
  return unique;
}

class Flattener {
 public:
  Flattener(const aiScene& scene, double scale, const std::string& file) : scene_(scene), scale_(scale), file_(file) {}

  Result<Mesh> run(std::vector<std::string>& notes) {
    // Depth first with a stack of our own, children in order: pushed back to front.
    std::vector<Visit> stack{{scene_.mRootNode, Transform{}, ""}};
    std::unordered_map<std::string, int> root_names;
    stack.back().path = path_name(*scene_.mRootNode, std::filesystem::path(file_).stem().string(), root_names);
    while (!stack.empty()) {
      const Visit visit = std::move(stack.back());
      stack.pop_back();
      const Transform here = visit.above * Transform::of(visit.node->mTransformation);
      if (std::string wrong = add_node(*visit.node, here, visit.path); !wrong.empty())
        return bad_value(fmt::format("'{}' {}", file_, wrong));
      std::unordered_map<std::string, int> siblings;
      const std::size_t first = stack.size();
      for (unsigned i = 0; i < visit.node->mNumChildren; ++i) {
        const aiNode* child = visit.node->mChildren[i];
        // A file without names, such as an STL, is one part, named like the file.
        const bool nameless = visit.node->mNumChildren == 1 && given_name(*visit.node).empty() && given_name(*child).empty();
        stack.push_back({child, here, nameless ? visit.path : visit.path + "/" + path_name(*child, "node", siblings)});
      }
      std::reverse(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.end());
    }
    if (mesh_.triangles.empty())
      return bad_value(fmt::format("'{}' has no triangles{}", file_, lines_ + points_ ? ", only lines or points" : ""));
    if (lines_) notes.push_back(fmt::format("dropped {} line primitives", lines_));
    if (points_) notes.push_back(fmt::format("dropped {} point primitives", points_));
    if (polygons_) notes.push_back(fmt::format("split {} polygons as fans", polygons_));
    if (mirrored_) notes.push_back(fmt::format("turned the triangles of {} mirrored nodes", mirrored_));
    return std::move(mesh_);
  }

 private:
  struct Visit {
    const aiNode* node;
    Transform above;
    std::string path;
  };

  std::string add_node(const aiNode& node, const Transform& transform, const std::string& path) {
    const std::size_t first = mesh_.triangles.size();
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      if (node.mMeshes[i] >= scene_.mNumMeshes) return fmt::format("has a node '{}' with a mesh that does not exist", path);
      if (std::string wrong = add_mesh(*scene_.mMeshes[node.mMeshes[i]], transform, path); !wrong.empty()) return wrong;
    }
    if (mesh_.triangles.size() == first) return {};
    mesh_.parts.push_back({path, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(mesh_.triangles.size() - first)});
    if (transform.mirrors()) {
      ++mirrored_;
      for (std::size_t t = first; t < mesh_.triangles.size(); ++t) std::swap(mesh_.triangles[t][1], mesh_.triangles[t][2]);
    }
    return {};
  }

  std::string add_mesh(const aiMesh& mesh, const Transform& transform, const std::string& path) {
    const std::size_t base = mesh_.vertices.size();
    std::size_t triangles = 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) triangles += std::max(2u, mesh.mFaces[f].mNumIndices) - 2;
    if (mesh_.triangles.size() + triangles > kMaxTriangles || base + mesh.mNumVertices > 3 * kMaxTriangles)
      return fmt::format("has more than {} triangles", kMaxTriangles);
    if (triangles == 0) {
      for (unsigned f = 0; f < mesh.mNumFaces; ++f) ++(mesh.mFaces[f].mNumIndices == 2 ? lines_ : points_);
      return {};
    }
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const Vec3 point = scale_ * (transform * mesh.mVertices[v]);
      for (int k = 0; k < 3; ++k)
        if (!(std::abs(point[k]) <= kLargestCoordinate))
          return fmt::format("has coordinate {} m in vertex {} of '{}', which is not a number within ±{} m", point[k], v, path,
                             kLargestCoordinate);
      mesh_.vertices.push_back(point);
    }
    mesh_.triangles.reserve(mesh_.triangles.size() + triangles);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      for (unsigned i = 0; i < face.mNumIndices; ++i)
        if (face.mIndices[i] >= mesh.mNumVertices)
          return fmt::format("has vertex index {} in face {} of '{}', beyond the vertex list (size {})", face.mIndices[i], f, path,
                             mesh.mNumVertices);
      if (face.mNumIndices < 3) {
        ++(face.mNumIndices == 2 ? lines_ : points_);
        continue;
      }
      if (face.mNumIndices > 3) ++polygons_;
      const auto corner = [&](unsigned i) { return static_cast<std::uint32_t>(base + face.mIndices[i]); };
      for (unsigned i = 2; i < face.mNumIndices; ++i) mesh_.triangles.push_back({corner(0), corner(i - 1), corner(i)});
    }
    return {};
  }

  const aiScene& scene_;
  double scale_;
  const std::string& file_;
  Mesh mesh_;
  std::size_t lines_ = 0, points_ = 0, polygons_ = 0, mirrored_ = 0;
};

std::string extension_of(const std::string& path) {
  std::string out = std::filesystem::path(path).extension().string();
  std::transform(out.begin(), out.end(), out.begin(), [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return out;
}

std::string distrust(const std::string& extension, std::string_view bytes, const std::string& path) {
  if (extension == ".stl") return distrust_stl(bytes);
  if (extension == ".off") return distrust_off(bytes);
  if (extension == ".ply") return distrust_ply(bytes);
  if (extension == ".gltf" || extension == ".glb") return distrust_gltf(bytes, path);
  if (extension == ".dae") return distrust_dae(bytes);
  return {};
}

/// COLLADA states its unit, which arrives as the root node's scale.
void note_unit(const aiScene& scene, ImportReport& report) {
  const Transform root = Transform::of(scene.mRootNode->mTransformation);
  const double unit = std::sqrt(root.m[0][0] * root.m[0][0] + root.m[1][0] * root.m[1][0] + root.m[2][0] * root.m[2][0]);
  if (std::abs(unit - 1) > 1e-4) report.notes.push_back(fmt::format("the file states a unit of {:.6g} m, applied besides the scale asked for", unit));
}

/// What the library says of a failure, without the line ends and full stops that it adds.
std::string words_of(std::string text) {
  text = one_line(std::move(text));
  while (!text.empty() && (text.back() == ' ' || text.back() == '.' || text.back() == '?')) text.pop_back();
  return text;
}

}  // namespace

Result<Mesh> read_mesh(const std::string& path, double scale, ImportReport& report, const std::string& folder) {
  report = {path, {}};
  {
    const Result<FileView> file = FileView::open(path);
    if (!file) return file.error();
    if (const std::string wrong = distrust(extension_of(path), file->bytes(), path); !wrong.empty())
      return bad_value(fmt::format("'{}' {}", path, wrong));
  }
  try {
    // No post-processing: joining vertices, triangulating or sorting by type would renumber or reorder faces.
    Assimp::Importer importer;
    if (!folder.empty()) importer.SetIOHandler(new FilesBelow(folder));   // the importer's own from here on
    if (!importer.IsExtensionSupported(extension_of(path)))
      return bad_value(fmt::format("'{}' is of a kind that can't be read (extension '{}')", path, extension_of(path)));
    const aiScene* scene = importer.ReadFile(path, 0);
    if (!scene || !scene->mRootNode) return bad_value(fmt::format("'{}' can't be read: {}", path, words_of(importer.GetErrorString())));
    if (extension_of(path) == ".dae") note_unit(*scene, report);
    return Flattener(*scene, scale, path).run(report.notes);
  } catch (const std::exception& error) {
    return bad_value(fmt::format("'{}' can't be read: {}", path, words_of(error.what())));
  }
}

}  // namespace palpate
