#include "model/import/mesh_read.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "model/files/file_view.h"
#include "model/files/one_line.h"
#include "model/import/bad_coordinate.h"
#include "model/import/import_checks.h"
#include "model/import/part_names.h"
#include "model/import/polygon_split.h"
#include "model/import/threemf_read.h"
#include "model/mesh/weld.h"

namespace palpate {
namespace {

/// What the library reads: `text` for the file at `path`, where there is one; the others as they are, but
/// where a folder is given only those below it, all symbolic links followed.
class Files final : public Assimp::DefaultIOSystem {
 public:
  /// `text` outlives this.
  Files(std::string folder, std::string path, std::string_view text)
      : folder_(std::move(folder)), path_(std::move(path)), text_(text) {}
  bool Exists(const char* path) const override { return allowed(path) && DefaultIOSystem::Exists(path); }
  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (!allowed(path)) return nullptr;
    if (text_.empty() || path != path_) return DefaultIOSystem::Open(path, mode);
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size());
  }

 private:
  bool allowed(const char* path) const {
    if (folder_.empty()) return true;
    std::error_code error;
    const std::filesystem::path real = std::filesystem::canonical(path, error);
    return !error &&
           std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end()).first == folder_.end();
  }
  std::filesystem::path folder_;
  std::string path_;
  std::string_view text_;
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
        out.m[r][c] =
            m[r][0] * b.m[0][c] + m[r][1] * b.m[1][c] + m[r][2] * b.m[2][c] + (c == 3 ? m[r][3] : 0);
    return out;
  }
  Vec3 operator*(const aiVector3D& p) const {
    Vec3 out;
    for (int r = 0; r < 3; ++r)
      out[r] = m[r][0] * static_cast<double>(p.x) + m[r][1] * static_cast<double>(p.y) +
               m[r][2] * static_cast<double>(p.z) + m[r][3];
    return out;
  }
  /// Mirrors: the triangles must be turned, or their normals would point inwards.
  bool mirrors() const {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
           0;
  }
};

/// The name that a file gives a node or a mesh; empty where the importer had to invent one ("<STL_BINARY>",
/// "<OFFRoot>", "nodes[3]", …).
std::string given_name(const aiString& text) {
  std::string name(text.data, text.length);
  const bool invented = (name.starts_with("nodes[") || name.starts_with("meshes[")) && name.ends_with(']');
  std::replace(name.begin(), name.end(), kBlankOfName, ' ');
  if (invented || (name.size() > 1 && name.front() == '<' && name.back() == '>')) name.clear();
  return clean_name(std::move(name));
}

/// glTF's colours are linear; a part's is sRGB.
std::uint32_t srgb_of(const aiColor4D& linear) {
  std::uint32_t out = 0;
  for (const double part : {std::clamp<double>(linear.r, 0, 1), std::clamp<double>(linear.g, 0, 1),
                            std::clamp<double>(linear.b, 0, 1)})
    out = out << 8 |
          static_cast<std::uint32_t>(std::lround(
              255 * (part <= 0.0031308 ? 12.92 * part
                                       : 1.055 * std::pow(part, 1 / 2.4) - 0.055)));  // IEC 61966-2-1
  return out;
}

/// The base colour of each material of a glTF file; none where a texture gives it, and for the material that
/// the library adds behind the file's own.
std::vector<std::optional<std::uint32_t>> colours_of(const aiScene& scene) {
  std::vector<std::optional<std::uint32_t>> out(scene.mNumMaterials);
  for (unsigned m = 0; m + 1 < scene.mNumMaterials; ++m) {
    const aiMaterial& material = *scene.mMaterials[m];
    aiColor4D base;
    if (material.GetTextureCount(aiTextureType_BASE_COLOR) == 0 &&
        material.GetTextureCount(aiTextureType_DIFFUSE) == 0 &&
        material.Get(AI_MATKEY_BASE_COLOR, base) == aiReturn_SUCCESS)
      out[m] = srgb_of(base);
  }
  return out;
}

class Flattener {
 public:
  /// `turn`: what the file's coordinates are turned by before all else. `colours`: of the materials; empty:
  /// none are read.
  Flattener(const aiScene& scene, double scale, const std::string& file, const Transform& turn,
            std::vector<std::optional<std::uint32_t>> colours)
      : scene_(scene), scale_(scale), file_(file), turn_(turn), colours_(std::move(colours)) {}

  Result<Mesh> run(std::vector<std::string>& notes) {
    // Depth first with a stack of our own, children in order: pushed back to front.
    std::vector<Visit> stack{{scene_.mRootNode, turn_, ""}};
    stack.back().path = given_name(scene_.mRootNode->mName);
    if (stack.back().path.empty())
      stack.back().path = clean_name(std::filesystem::path(file_).stem().string());
    while (!stack.empty()) {
      const Visit visit = std::move(stack.back());
      stack.pop_back();
      const Transform here = visit.above * Transform::of(visit.node->mTransformation);
      if (std::string wrong = add_node(*visit.node, here, visit.path); !wrong.empty())
        return bad_value(fmt::format("'{}' {}", file_, wrong));
      SiblingNames siblings;
      const std::size_t first = stack.size();
      for (unsigned i = 0; i < visit.node->mNumChildren; ++i) {
        const aiNode* child = visit.node->mChildren[i];
        // A file without names, such as an STL, is one part, named like the file.
        const bool nameless = visit.node->mNumChildren == 1 && given_name(visit.node->mName).empty() &&
                              given_name(child->mName).empty();
        const std::string name = node_name(*child);
        stack.push_back(
            {child, here,
             nameless ? visit.path : visit.path + "/" + siblings.unique(name.empty() ? "node" : name)});
      }
      std::reverse(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.end());
    }
    if (mesh_.triangles.empty())
      return bad_value(
          fmt::format("'{}' has no triangles{}", file_, lines_ + points_ ? ", only lines or points" : ""));
    if (lines_) notes.push_back(fmt::format("dropped {} line primitives", lines_));
    if (points_) notes.push_back(fmt::format("dropped {} point primitives", points_));
    if (polygons_) notes.push_back(fmt::format("split {} polygons into triangles", polygons_));
    if (crossing_)
      notes.push_back(
          fmt::format("{} polygons cross themselves, the first is face {} of '{}': they bound no one area, "
                      "and were split as fans from their first corners",
                      crossing_, first_crossing_, crossing_path_));
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
      if (node.mMeshes[i] >= scene_.mNumMeshes)
        return fmt::format("has a node '{}' with a mesh that does not exist", path);
      if (std::string wrong = add_mesh(*scene_.mMeshes[node.mMeshes[i]], transform, path); !wrong.empty())
        return wrong;
    }
    if (mesh_.triangles.size() == first) return {};
    mesh_.parts.push_back({path, static_cast<std::uint32_t>(first),
                           static_cast<std::uint32_t>(mesh_.triangles.size() - first), other_name(node),
                           colour_of(node)});
    if (transform.mirrors()) {
      ++mirrored_;
      for (std::size_t t = first; t < mesh_.triangles.size(); ++t)
        std::swap(mesh_.triangles[t][1], mesh_.triangles[t][2]);
    }
    return {};
  }

  /// The colour of most of a node's triangles.
  std::optional<std::uint32_t> colour_of(const aiNode& node) const {
    std::map<std::optional<std::uint32_t>, std::uint64_t> triangles;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
      if (mesh.mMaterialIndex < colours_.size()) triangles[colours_[mesh.mMaterialIndex]] += mesh.mNumFaces;
    }
    const auto most = std::max_element(triangles.begin(), triangles.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == triangles.end() ? std::nullopt : most->first;
  }

  /// The name of a node's mesh; empty: none.
  std::string mesh_name(const aiNode& node) const {
    if (node.mNumMeshes == 0 || node.mMeshes[0] >= scene_.mNumMeshes) return {};
    std::string name = given_name(scene_.mMeshes[node.mMeshes[0]]->mName);
    // The library numbers the meshes that it makes of one mesh with several primitives.
    if (node.mNumMeshes > 1 && name.ends_with("-0")) name.resize(name.size() - 2);
    return name;
  }

  /// A node's own name, else its mesh's.
  std::string node_name(const aiNode& node) const {
    const std::string name = given_name(node.mName);
    return name.empty() ? mesh_name(node) : name;
  }

  /// The name of a node's mesh, where that is not the node's.
  std::string other_name(const aiNode& node) const {
    const std::string name = mesh_name(node);
    return name == node_name(node) ? std::string() : name;
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
          return bad_coordinate(point[k], fmt::format("vertex {} of '{}'", v, path));
      mesh_.vertices.push_back(point);
    }
    mesh_.triangles.reserve(mesh_.triangles.size() + triangles);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      for (unsigned i = 0; i < face.mNumIndices; ++i)
        if (face.mIndices[i] >= mesh.mNumVertices)
          return fmt::format("has vertex index {} in face {} of '{}', beyond the vertex list (size {})",
                             face.mIndices[i], f, path, mesh.mNumVertices);
      if (face.mNumIndices < 3) {
        ++(face.mNumIndices == 2 ? lines_ : points_);
        continue;
      }
      if (face.mNumIndices > 3) ++polygons_;
      corners_.clear();
      split_.clear();
      for (unsigned i = 0; i < face.mNumIndices; ++i)
        corners_.push_back(mesh_.vertices[base + face.mIndices[i]]);
      if (split_polygon(corners_, split_) == PolygonKind::kCrossing && ++crossing_ == 1) {
        first_crossing_ = f;
        crossing_path_ = path;
      }
      const auto corner = [&](std::uint32_t i) {
        return static_cast<std::uint32_t>(base + face.mIndices[i]);
      };
      for (const auto& [a, b, c] : split_) mesh_.triangles.push_back({corner(a), corner(b), corner(c)});
    }
    return {};
  }

  const aiScene& scene_;
  double scale_;
  const std::string& file_;
  Transform turn_;
  std::vector<std::optional<std::uint32_t>> colours_;
  Mesh mesh_;
  std::size_t lines_ = 0, points_ = 0, polygons_ = 0, mirrored_ = 0, crossing_ = 0;
  unsigned first_crossing_ = 0;
  std::string crossing_path_;
  std::vector<Vec3> corners_;  ///< of the face at hand
  std::vector<std::array<std::uint32_t, 3>> split_;
};

std::string extension_of(const std::string& path) {
  std::string out = std::filesystem::path(path).extension().string();
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return out;
}

std::string distrust(const std::string& extension, std::string_view bytes, const std::string& path) {
  if (extension == ".stl") return distrust_stl(bytes);
  if (extension == ".off") return distrust_off(bytes);
  if (extension == ".ply") return distrust_ply(bytes);
  if (extension == ".gltf" || extension == ".glb") return distrust_gltf(bytes, path);
  if (extension == ".dae") return distrust_dae(bytes);
  if (extension == ".obj") return distrust_obj(bytes);
  return {};
}

/// COLLADA states its unit, which arrives as the root node's scale.
void note_unit(const aiScene& scene, ImportReport& report) {
  const Transform root = Transform::of(scene.mRootNode->mTransformation);
  const double unit =
      std::sqrt(root.m[0][0] * root.m[0][0] + root.m[1][0] * root.m[1][0] + root.m[2][0] * root.m[2][0]);
  if (std::abs(unit - 1) > 1e-4)
    report.notes.push_back(
        fmt::format("the file states a unit of {:.6g} m, applied besides the scale asked for", unit));
}

/// One rule for all formats: coordinates are the file's own, whichever axis is up. The library turns two
/// formats so that y is up: COLLADA, where it can be told not to, and 3DS.
Transform undo_turn(const std::string& extension) {
  if (extension == ".3ds") return {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
  return {};
}

void note_up_axis(const std::string& extension, std::string_view bytes, ImportReport& report) {
  if (extension == ".3ds") report.notes.push_back("z is up in 3DS files; coordinates are the file's own");
  if (extension != ".dae") return;
  constexpr std::string_view kTag = "<up_axis>";
  const std::size_t at = bytes.find(kTag);
  const std::string_view axis = at == std::string_view::npos ? "Y_UP" : bytes.substr(at + kTag.size(), 4);
  if (axis != "Y_UP" && (axis == "Z_UP" || axis == "X_UP"))
    report.notes.push_back(fmt::format("the file says that {} is up; coordinates are the file's own",
                                       axis == "Z_UP" ? "z" : "x"));
}

/// Whether the library would pass over the first byte of a binary PLY's data: it skips a line end behind the
/// header's, and a number may begin like one.
bool begins_like_a_line_end(const std::string& extension, std::string_view bytes) {
  if (extension != ".ply") return false;
  const std::size_t format = bytes.substr(0, 4096).find("format binary"), end = bytes.find("end_header");
  if (format == std::string_view::npos || end == std::string_view::npos || format > end) return false;
  const std::size_t data = bytes.find('\n', end);
  return data != std::string_view::npos && data + 1 < bytes.size() && bytes[data + 1] == '\n';
}

/// The same file with one byte more in front of its data: an edge, for which nobody asks. (Of elements that
/// it does not know the library gets the number wrong.)
std::string with_a_first_byte(std::string_view bytes) {
  const std::size_t end = bytes.find("end_header"), data = bytes.find('\n', end) + 1,
                    first = std::min(bytes.find("\nelement") + 1, end);
  std::string out(bytes.substr(0, first));
  out += "element edge 1\nproperty uchar begin\n";
  out += bytes.substr(first, data - first);
  out += '.';
  out += bytes.substr(data);
  return out;
}

/// A copy of a text with changes, made as soon as there is one.
class Changed {
 public:
  explicit Changed(std::string_view text) : text_(text) {}
  /// In place of what stands from `at` on, `size` bytes of it. Places ascend.
  void put(std::size_t at, std::size_t size, std::string_view other) {
    out_ += text_.substr(copied_, at - copied_);
    out_ += other;
    copied_ = at + size;
  }
  /// The whole; empty: nothing was changed.
  std::string finish() {
    if (copied_ > 0 || !out_.empty()) put(text_.size(), 0, "");
    return std::move(out_);
  }

 private:
  std::string_view text_;
  std::string out_;
  std::size_t copied_ = 0;
};

constexpr std::string_view kBlanks = " \t";
constexpr std::string_view kMark = "\xEF\xBB\xBF";  ///< that a text is UTF-8

/// Puts kBlankOfName for the blanks in a name, the rest of a line from `from` on; `at`: the line's place.
void keep_name_whole(std::string_view line, std::size_t from, std::size_t at, Changed& out) {
  const std::size_t first = line.find_first_not_of(kBlanks, from), last = line.find_last_not_of(" \t\r");
  for (std::size_t i = first; first != std::string_view::npos && i < last; ++i)
    if (kBlanks.find(line[i]) != std::string_view::npos)
      out.put(at + i, 1, std::string_view(&kBlankOfName, 1));
}

/// An OBJ as the library reads it rightly. It passes over lines that begin with blanks, and over the mark in
/// front of the first; a number that begins with its point ends a line of numbers; a comment that ends in a
/// backslash takes the next line with it; and a blank ends the name of an object, of which two may then have
/// one. Lines keep their numbers. Empty: nothing needs a change.
std::string obj_for_the_library(std::string_view bytes) {
  Changed out(bytes);
  std::size_t at = bytes.starts_with(kMark) ? kMark.size() : 0;
  if (at > 0) out.put(0, at, "");
  bool numbers = false,
       goes_on = false;  // of a vertex, a place on a texture or a normal; from the line before
  while (at < bytes.size()) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string_view line = bytes.substr(at, end - at);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!goes_on) {
      if (const std::size_t first = std::min(line.find_first_not_of(kBlanks), line.size()); first > 0) {
        out.put(at, first, "");
        line.remove_prefix(first);
        at += first;
      }
      numbers = line.starts_with('v');
    }
    const std::size_t comment =
        numbers || line.starts_with('f') || line.starts_with('#') ? line.find('#') : std::string_view::npos;
    if (line.ends_with('\\') && comment != std::string_view::npos) {
      line = line.substr(0, comment);
      out.put(at + comment, end - at - comment, "");
    }
    goes_on = line.ends_with('\\');
    if (line.starts_with("o ") || line.starts_with("o\t")) keep_name_whole(line, 1, at, out);
    for (std::size_t point = 0; numbers && (point = line.find('.', point)) != std::string_view::npos; ++point)
      if ((point == 0 || kBlanks.find(line[point - 1]) != std::string_view::npos) &&
          point + 1 < line.size() && line[point + 1] >= '0' && line[point + 1] <= '9')
        out.put(at + point, 0, "0");
    at = end + 1;
  }
  return out.finish();
}

/// STL text of which the names of solids reach the library whole: it ends them at the first blank.
std::string stl_for_the_library(std::string_view bytes) {
  const bool marked = bytes.starts_with(kMark);
  if (!is_stl_text(bytes.substr(marked ? kMark.size() : 0))) return {};
  Changed out(bytes);
  if (marked) out.put(0, kMark.size(), "");
  for (std::size_t at = marked ? kMark.size() : 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    const std::string_view line = bytes.substr(at, end - at);
    constexpr std::string_view kSolid = "solid";
    if (const std::size_t word = line.find_first_not_of(kBlanks);
        word != std::string_view::npos && line.substr(word).starts_with(kSolid))
      keep_name_whole(line, word + kSolid.size(), at, out);
    at = end + 1;
  }
  return out.finish();
}

/// What the library says of a failure, without the line ends and full stops that it adds.
std::string words_of(std::string text) {
  text = one_line(std::move(text));
  while (!text.empty() && (text.back() == ' ' || text.back() == '.' || text.back() == '?')) text.pop_back();
  return text;
}

}  // namespace

Result<Mesh> read_mesh(const std::string& path, double scale, ImportReport& report, const std::string& folder,
                       const Tessellation&, const TellHowFar&, bool /*colours*/) {
  report = {path, {}};
  const std::string extension = extension_of(path);
  std::string in_memory;                       // what is read in the file's place, if anything
  std::map<std::string, std::uint64_t> faces;  // that a glTF's meshes must have
  {
    const Result<FileView> file = FileView::open(path);
    if (!file) return file.error();
    if (extension == ".obj") in_memory = obj_for_the_library(file->bytes());
    if (extension == ".stl") in_memory = stl_for_the_library(file->bytes());
    const std::string_view bytes = in_memory.empty() ? file->bytes() : std::string_view(in_memory);
    if (const std::string wrong = distrust(extension, bytes, path); !wrong.empty())
      return bad_value(fmt::format("'{}' {}", path, wrong));
    note_up_axis(extension, bytes, report);
    if (begins_like_a_line_end(extension, bytes)) in_memory = with_a_first_byte(file->bytes());
    if (extension == ".gltf" || extension == ".glb") faces = faces_of_gltf(bytes);
  }
  try {
    if (extension == ".3mf") return read_3mf(path, scale, report);
    // No post-processing: joining vertices, triangulating or sorting by type would renumber or reorder faces.
    Assimp::Importer importer;
    importer.SetIOHandler(new Files(folder, path, in_memory));  // the importer's own from here on
    if (!importer.IsExtensionSupported(extension))
      return bad_value(fmt::format("'{}' is of a kind that can't be read (extension '{}')", path, extension));
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    importer.SetPropertyBool(
        AI_CONFIG_IMPORT_NO_SKELETON_MESHES,
        true);  // else a file of cameras and lamps alone has triangles, which the library makes up
    const aiScene* scene = importer.ReadFile(path, 0);
    if (!scene || !scene->mRootNode)
      return bad_value(fmt::format("'{}' can't be read: {}", path, words_of(importer.GetErrorString())));
    if (extension == ".dae") note_unit(*scene, report);
    // The library leaves out what it can't make sense of.
    std::map<std::string, std::uint64_t> read;
    for (unsigned m = 0; m < scene->mNumMeshes && !faces.empty(); ++m)
      read[std::string(scene->mMeshes[m]->mName.data, scene->mMeshes[m]->mName.length)] +=
          scene->mMeshes[m]->mNumFaces;
    for (const auto& [name, count] : read)
      if (const auto wanted = faces.find(name); wanted != faces.end() && count < wanted->second)
        return bad_value(
            fmt::format("'{}' has {} triangles in mesh '{}' of which {} can be read: the others name "
                        "vertices that don't exist",
                        path, wanted->second, one_line(name), count));
    const bool gltf = extension == ".gltf" || extension == ".glb";
    return Flattener(*scene, scale, path, undo_turn(extension),
                     gltf ? colours_of(*scene) : std::vector<std::optional<std::uint32_t>>{})
        .run(report.notes);
  } catch (const std::exception& error) {
    return bad_value(fmt::format("'{}' can't be read: {}", path, words_of(error.what())));
  }
}

}  // namespace palpate
