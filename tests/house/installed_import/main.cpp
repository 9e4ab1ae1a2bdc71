// Reads a mesh through the installed library, whose importer is a program that find_package(palpate) knows.
#include <model/mesh/mesh_import.h>

#include <cstdio>

int main(int, char** argv) {
  palpate::ImportReport report;
  const auto mesh = palpate::import_mesh(argv[1], 1, report);
  if (!mesh)
    return std::fprintf(stderr, "%s\n", mesh.error().sentence.c_str()), static_cast<int>(mesh.error().code);
  std::printf("%zu triangles\n", mesh->triangles.size());
}
