#include "model/import/threemf_read.h"

#include <Model/COM/NMR_DLLInterfaces.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "model/files/one_line.h"
#include "model/import/bad_coordinate.h"
#include "model/import/part_names.h"
#include "model/mesh/weld.h"

namespace palpate {
namespace {

constexpr int kDeepest = 256;                ///< components within components (chosen)
constexpr std::size_t kMostParts = 100'000;  ///< instances counted (chosen)

struct Release {
  void operator()(NMR::PLib3MFBase* object) const { NMR::lib3mf_release(object); }
};
template <class T>
using Owned = std::unique_ptr<T, Release>;

/// A call that fills in an object which is ours from then on; null where it fails.
template <class T, class Call>
Owned<T> made(Call call) {
  T* object = nullptr;
  if (call(&object) != 0) object = nullptr;
  return Owned<T>(object);
}

/// 3MF's way round: a point is a row, m[3] is added.
struct Affine {
  double m[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};

  static Affine of(const NMR::MODELTRANSFORM& t) {
    Affine out;
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 3; ++c) out.m[r][c] = static_cast<double>(t.m_fFields[c][r]);
    return out;
  }
  Vec3 operator()(const Vec3& p) const {
    Vec3 out;
    for (int c = 0; c < 3; ++c) out[c] = p.x * m[0][c] + p.y * m[1][c] + p.z * m[2][c] + m[3][c];
    return out;
  }
  /// First this, then `next`.
  Affine then(const Affine& next) const {
    Affine out;
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 3; ++c)
        out.m[r][c] = m[r][0] * next.m[0][c] + m[r][1] * next.m[1][c] + m[r][2] * next.m[2][c] +
                      (r == 3 ? next.m[3][c] : 0);
    return out;
  }
  bool mirrors() const {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
           0;
  }
};

std::string name_of(NMR::PLib3MFModelObjectResource* object) {
  ULONG needed = 0;
  if (NMR::lib3mf_object_getnameutf8(object, nullptr, 0, &needed) != 0 || needed == 0) return {};
  std::string name(needed + 1, '\0');
  if (NMR::lib3mf_object_getnameutf8(object, name.data(), static_cast<ULONG>(name.size()), &needed) != 0)
    return {};
  return clean_name(name.c_str());
}

struct Unit {
  const char* name;
  double metres;
};

Unit unit_of(NMR::PLib3MFModel* model) {
  constexpr std::array<Unit, 6> kUnits{{{"micron", 1e-6},
                                        {"millimetre", 1e-3},
                                        {"centimetre", 1e-2},
                                        {"inch", 0.0254},
                                        {"foot", 0.3048},
                                        {"metre", 1}}};
  DWORD unit = NMR::MODELUNIT_MILLIMETER;
  NMR::lib3mf_model_getunit(model, &unit);
  return kUnits[std::min<std::size_t>(unit, kUnits.size() - 1)];
}

class Builder {
 public:
  explicit Builder(double scale) : scale_(scale) {}

  /// Empty, or what is wrong: the rest of a sentence that begins with the file's name.
  std::string add(NMR::PLib3MFModelObjectResource* object, const Affine& place, const std::string& folder,
                  SiblingNames& siblings, int depth = 0) {
    if (depth > kDeepest) return fmt::format("has components more than {} deep", kDeepest);
    std::string name = name_of(object);
    const std::string path = folder + siblings.unique(name.empty() ? "object" : name);
    BOOL is_mesh = false;
    NMR::lib3mf_object_ismeshobject(object, &is_mesh);
    if (is_mesh) return add_mesh(object, place, path);
    DWORD count = 0;
    if (NMR::lib3mf_componentsobject_getcomponentcount(object, &count) != 0)
      return fmt::format("has an object '{}' that is neither a mesh nor made of components", path);
    SiblingNames below;
    for (DWORD i = 0; i < count; ++i) {
      const auto component = made<NMR::PLib3MFModelComponent>(
          [&](auto** out) { return NMR::lib3mf_componentsobject_getcomponent(object, i, out); });
      const auto part = component ? made<NMR::PLib3MFModelObjectResource>([&](auto** out) {
        return NMR::lib3mf_component_getobjectresource(component.get(), out);
      })
                                  : nullptr;
      NMR::MODELTRANSFORM transform{};
      if (!part || NMR::lib3mf_component_gettransform(component.get(), &transform) != 0)
        return fmt::format("has a component {} of '{}' that can't be read", i, path);
      if (std::string wrong =
              add(part.get(), Affine::of(transform).then(place), path + "/", below, depth + 1);
          !wrong.empty())
        return wrong;
    }
    return {};
  }

  Mesh take() { return std::move(mesh_); }
  std::size_t mirrored() const { return mirrored_; }

 private:
  std::string add_mesh(NMR::PLib3MFModelMeshObject* object, const Affine& place, const std::string& path) {
    DWORD vertices = 0, triangles = 0;
    if (NMR::lib3mf_meshobject_getvertexcount(object, &vertices) != 0 ||
        NMR::lib3mf_meshobject_gettrianglecount(object, &triangles) != 0)
      return fmt::format("has a mesh '{}' that can't be read", path);
    if (triangles == 0) return {};
    const std::size_t base = mesh_.vertices.size(), first = mesh_.triangles.size();
    if (first + triangles > kMaxTriangles || base + vertices > 3 * kMaxTriangles)
      return fmt::format("has more than {} triangles, instances counted", kMaxTriangles);
    if (mesh_.parts.size() >= kMostParts)
      return fmt::format("has more than {} parts, instances counted", kMostParts);
    for (DWORD i = 0; i < vertices; ++i) {
      NMR::MODELMESHVERTEX vertex{};
      if (NMR::lib3mf_meshobject_getvertex(object, i, &vertex) != 0)
        return fmt::format("has a vertex {} in '{}' that can't be read", i, path);
      const Vec3 point = scale_ * place(Vec3(static_cast<double>(vertex.m_fPosition[0]),
                                             static_cast<double>(vertex.m_fPosition[1]),
                                             static_cast<double>(vertex.m_fPosition[2])));
      for (int k = 0; k < 3; ++k)
        if (!(std::abs(point[k]) <= kLargestCoordinate))
          return bad_coordinate(point[k], fmt::format("vertex {} of '{}'", i, path));
      mesh_.vertices.push_back(point);
    }
    const bool mirrors = place.mirrors();
    if (mirrors) ++mirrored_;
    for (DWORD i = 0; i < triangles; ++i) {
      NMR::MODELMESHTRIANGLE triangle{};
      if (NMR::lib3mf_meshobject_gettriangle(object, i, &triangle) != 0)
        return fmt::format("has a triangle {} in '{}' that can't be read", i, path);
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        if (triangle.m_nIndices[k] >= vertices)
          return fmt::format("has vertex index {} in triangle {} of '{}', beyond the vertex list (size {})",
                             triangle.m_nIndices[k], i, path, vertices);
        corners[k] = static_cast<std::uint32_t>(base + triangle.m_nIndices[k]);
      }
      if (mirrors) std::swap(corners[1], corners[2]);
      mesh_.triangles.push_back(corners);
    }
    mesh_.parts.push_back({path, static_cast<std::uint32_t>(first), triangles});
    return {};
  }

  double scale_;  ///< metres per unit of the file
  Mesh mesh_;
  std::size_t mirrored_ = 0;
};

std::string last_error(NMR::PLib3MFBase* object) {
  DWORD code = 0;
  LPCSTR words = nullptr;
  if (NMR::lib3mf_getlasterror(object, &code, &words) != 0 || !words || !*words)
    return "it breaks the rules of 3MF files";
  std::string out = one_line(words);
  while (!out.empty() && (out.back() == ' ' || out.back() == '.')) out.pop_back();
  return out;
}

/// What the library complains of and reads all the same.
void note_warnings(NMR::PLib3MFModelReader* reader, ImportReport& report) {
  DWORD count = 0, code = 0;
  ULONG needed = 0;
  std::array<char, 256> words{};
  if (NMR::lib3mf_reader_getwarningcount(reader, &count) != 0 || count == 0) return;
  const bool told =
      NMR::lib3mf_reader_getwarningutf8(reader, 0, &code, words.data(), words.size(), &needed) == 0;
  report.notes.push_back(fmt::format("the file breaks rules in {} places{}", count,
                                     told ? fmt::format(", first: {}", one_line(words.data())) : ""));
}

}  // namespace

Result<Mesh> read_3mf(const std::string& path, double scale, ImportReport& report) {
  const auto model = made<NMR::PLib3MFModel>([](auto** out) { return NMR::lib3mf_createmodel(out); });
  const auto reader = model ? made<NMR::PLib3MFModelReader>([&](auto** out) {
    return NMR::lib3mf_model_queryreader(model.get(), "3mf", out);
  })
                            : nullptr;
  if (!reader)
    return Error{ErrorCode::kInternal, fmt::format("'{}' can't be read: lib3mf gives no reader", path)};
  if (NMR::lib3mf_reader_readfromfileutf8(reader.get(), path.c_str()) != 0)
    return bad_value(fmt::format("'{}' can't be read: {}", path, last_error(reader.get())));
  note_warnings(reader.get(), report);
  const Unit unit = unit_of(model.get());
  report.notes.push_back(fmt::format("its unit is the {}; coordinates are in metres", unit.name));

  Builder builder(scale * unit.metres);
  SiblingNames names;
  const auto items = made<NMR::PLib3MFModelBuildItemIterator>(
      [&](auto** out) { return NMR::lib3mf_model_getbuilditems(model.get(), out); });
  const std::string root = clean_name(std::filesystem::path(path).stem().string()) + "/";
  for (BOOL more = false; items && NMR::lib3mf_builditemiterator_movenext(items.get(), &more) == 0 && more;) {
    const auto item = made<NMR::PLib3MFModelBuildItem>(
        [&](auto** out) { return NMR::lib3mf_builditemiterator_getcurrent(items.get(), out); });
    const auto object = item ? made<NMR::PLib3MFModelObjectResource>([&](auto** out) {
      return NMR::lib3mf_builditem_getobjectresource(item.get(), out);
    })
                             : nullptr;
    NMR::MODELTRANSFORM transform{};
    if (!object || NMR::lib3mf_builditem_getobjecttransform(item.get(), &transform) != 0)
      return bad_value(fmt::format("'{}' has a build item that can't be read", path));
    if (std::string wrong = builder.add(object.get(), Affine::of(transform), root, names); !wrong.empty())
      return bad_value(fmt::format("'{}' {}", path, wrong));
  }
  if (builder.mirrored() > 0)
    report.notes.push_back(fmt::format("turned the triangles of {} mirrored parts", builder.mirrored()));
  Mesh mesh = builder.take();
  if (mesh.triangles.empty()) return bad_value(fmt::format("'{}' has no triangles in its build", path));
  return mesh;
}

}  // namespace palpate
