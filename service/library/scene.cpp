// Sources and scenes of palpate.h.
#include <fmt/format.h>

#include <cmath>
#include <mutex>

#include "model/generate.h"
#include "model/scene/scene_file.h"
#include "service/engines.h"
#include "service/library/open_scene.h"

using namespace palpate;
using namespace palpate::library;

struct palpate_source {
  std::string file;
  std::string text, folder;
  bool is_text = false;
  GivenMeshes meshes;
  SceneOptions options;
  bool cached = true;
};

namespace {

Parts& parts() {
  static Parts made = [] {
    Parts one = engine_parts();
    // Asking Vulkan takes a while, and what is plugged in does not change meanwhile.
    one.has_gpu = [ask = one.has_gpu] {
      static const bool has = ask();
      return has;
    };
    return one;
  }();
  return made;
}

Result<std::string> text_of(const char* text, const char* what) {
  if (text == nullptr || *text == '\0')
    return wrong_call(fmt::format("the {} is {}", what, text ? "empty" : "null"));
  return std::string(text);
}

Result<Mesh> mesh_of(const std::string& name, const double* vertices, std::size_t vertex_count,
                     const std::uint32_t* faces, std::size_t face_count) {
  constexpr std::size_t kMost = 1u << 30;  // vertices, or triangles: indices of 32 bits, with room
  if (!vertices || !faces) return wrong_call(fmt::format("mesh '{}': vertices or faces are null", name));
  if (face_count == 0) return bad_value(fmt::format("mesh '{}' has no face", name));
  if (vertex_count > kMost || face_count > kMost)
    return bad_value(fmt::format("mesh '{}' has {} vertices and {} faces; at most {} are allowed of either",
                                 name, vertex_count, face_count, kMost));
  Mesh mesh;
  mesh.vertices.resize(vertex_count);
  for (std::size_t i = 0; i < vertex_count; ++i) {
    const double* v = vertices + 3 * i;
    if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2]))
      return bad_value(
          fmt::format("mesh '{}', vertex {}: ({}, {}, {}) is not finite", name, i, v[0], v[1], v[2]));
    mesh.vertices[i] = {v[0], v[1], v[2]};
  }
  mesh.triangles.resize(face_count);
  for (std::size_t i = 0; i < face_count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t index = faces[3 * i + k];
      if (index >= vertex_count)
        return bad_value(fmt::format("mesh '{}', face {}: index {} is beyond the {} vertices", name, i, index,
                                     vertex_count));
      mesh.triangles[i][k] = index;
    }
  mesh.parts.push_back({name, 0, static_cast<std::uint32_t>(face_count), {}, {}});
  return mesh;
}

Result<Scene> scene_of(const palpate_source& source) {
  if (!source.is_text) {
    if (source.file.empty()) return wrong_call("the source has neither a scene file nor a scene's text");
    return read_scene(source.file, source.options.profile);
  }
  return read_scene_text(source.text, source.folder.empty() ? "the scene" : source.folder + "/the scene",
                         source.meshes, source.options.profile);
}

template <class Set>
std::int32_t set(palpate_source* source, palpate_error** error, Set set_it) {
  return guarded(error, nullptr, [&]() -> Result<void> {
    if (!source) return wrong_call("the source is null");
    return set_it();
  });
}

const LatticeMesh* body_of(const palpate_scene* scene, std::int32_t body) {
  if (!scene) return nullptr;
  return body == PALPATE_STATIC   ? &scene->geometry().mockup
         : body == PALPATE_MOBILE ? &scene->geometry().tool
                                  : nullptr;
}

}  // namespace

palpate_source* palpate_source_new(void) { return new (std::nothrow) palpate_source; }
void palpate_source_free(palpate_source* source) { delete source; }

std::int32_t palpate_source_file(palpate_source* source, const char* path, palpate_error** error) {
  return set(source, error, [&]() -> Result<void> {
    auto file = text_of(path, "path of the scene file");
    if (!file) return file.error();
    source->file = std::move(*file);
    source->is_text = false;
    return {};
  });
}

std::int32_t palpate_source_text(palpate_source* source, const char* json, const char* folder,
                                 palpate_error** error) {
  return set(source, error, [&]() -> Result<void> {
    auto text = text_of(json, "text of the scene");
    if (!text) return text.error();
    source->text = std::move(*text);
    source->folder = folder ? folder : "";
    source->is_text = true;
    return {};
  });
}

std::int32_t palpate_source_mesh(palpate_source* source, const char* name, const double* vertices,
                                 std::size_t vertex_count, const std::uint32_t* faces, std::size_t face_count,
                                 palpate_error** error) {
  return set(source, error, [&]() -> Result<void> {
    auto called = text_of(name, "name of the mesh");
    if (!called) return called.error();
    auto mesh = mesh_of(*called, vertices, vertex_count, faces, face_count);
    if (!mesh) return mesh.error();
    source->meshes[*called] = std::make_shared<const Mesh>(std::move(*mesh));
    return {};
  });
}

std::int32_t palpate_source_engine(palpate_source* source, const char* engine, palpate_error** error) {
  return set(source, error, [&]() -> Result<void> {
    auto name = text_of(engine, "engine");
    if (!name) return name.error();
    if (*name != "auto" && *name != "gpu" && *name != "cpu" && *name != "ref")
      return wrong_call(fmt::format("the engine is '{}'; it must be auto, gpu, cpu or ref", *name));
    source->options.backend = std::move(*name);
    return {};
  });
}

std::int32_t palpate_source_profile(palpate_source* source, const char* profile, palpate_error** error) {
  return set(source, error, [&]() -> Result<void> {
    auto name = text_of(profile, "profile");
    if (!name) return name.error();
    if (*name != "paper" && *name != "refined")
      return wrong_call(fmt::format("the profile is '{}'; it must be paper or refined", *name));
    source->options.profile = *name == "paper" ? Profile::kPaper : Profile::kRefined;
    return {};
  });
}

std::int32_t palpate_source_all_samples(palpate_source* source, std::int32_t on, palpate_error** error) {
  return set(source, error, [&]() -> Result<void> {
    source->options.all_samples = on != 0;
    return {};
  });
}

std::int32_t palpate_source_cache(palpate_source* source, std::int32_t on, palpate_error** error) {
  return set(source, error, [&]() -> Result<void> {
    source->cached = on != 0;
    return {};
  });
}

std::int32_t palpate_scene_open(const palpate_source* source, const palpate_watch* watch,
                                palpate_scene** scene, palpate_error** error) {
  Watch watching(watch);
  if (scene) *scene = nullptr;
  return guarded(error, &watching, [&]() -> Result<void> {
    if (!source || !scene) return wrong_call("the source, or the place for the scene, is null");
    if (auto fine = watching.usable(); !fine) return fine;
    Result<Scene> read = scene_of(*source);
    if (!read) return read.error();
    const PrepareWatch prepare{
        .note = [&](const std::string& sentence) { watching.note(sentence); },
        .step = [&](const char* step) { (void)watching.tell(step, 0); },
        .progress = [&](const char* what, double done) { return watching.tell(what, done); },
        .admit = {},
        .cached = source->cached,
        .folder = {}};
    auto hosted = prepare_scene(std::move(*read), source->options, Purpose::kQuery, parts(), prepare);
    if (!hosted) return hosted.error();
    *scene = new palpate_scene(std::move(*hosted));
    return {};
  });
}

std::int32_t palpate_scene_open_file(const char* path, const palpate_watch* watch, palpate_scene** scene,
                                     palpate_error** error) {
  if (scene) *scene = nullptr;
  palpate_source source;
  if (const std::int32_t code = palpate_source_file(&source, path, error); code != PALPATE_OK) return code;
  return palpate_scene_open(&source, watch, scene, error);
}

void palpate_scene_close(palpate_scene* scene) { OpenScene::close(scene); }

const char* palpate_scene_engine(const palpate_scene* scene) { return scene ? scene->engine().c_str() : ""; }
const char* palpate_scene_hash(const palpate_scene* scene) { return scene ? scene->hash().c_str() : ""; }
const char* palpate_scene_description(const palpate_scene* scene) {
  return scene ? scene->description().c_str() : "";
}

std::size_t palpate_scene_triangle_count(const palpate_scene* scene, std::int32_t body) {
  const LatticeMesh* mesh = body_of(scene, body);
  return mesh ? mesh->triangles.size() : 0;
}

std::int32_t palpate_scene_triangles(const palpate_scene* scene, std::int32_t body, double* corners,
                                     palpate_error** error) {
  return guarded(error, nullptr, [&]() -> Result<void> {
    const LatticeMesh* mesh = body_of(scene, body);
    if (!mesh || !corners) return wrong_call("there is no such body, or the scene or the corners are null");
    const SceneGeometry& geometry = scene->geometry();
    const Vec3 origin = body == PALPATE_STATIC ? geometry.lattice.origin_m : geometry.tool_centre_m;
    for (std::uint32_t t = 0; t < mesh->triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Vec3 at = origin + geometry.lattice.step_m * Vec3(mesh->corner(t, k));
        for (int axis = 0; axis < 3; ++axis) *corners++ = at[axis];
      }
    return {};
  });
}

std::int32_t palpate_generate(const char* name, std::uint64_t triangles, std::uint64_t tool_triangles,
                              const char* folder, palpate_error** error) {
  return guarded(error, nullptr, [&]() -> Result<void> {
    const auto called = text_of(name, "name of the scene");
    if (!called) return called.error();
    const auto where = text_of(folder, "folder");
    if (!where) return where.error();
    const auto made = generate_scene(*called, triangles, tool_triangles);
    if (!made) return made.error();
    return write_generated(*made, *called, *where);
  });
}
