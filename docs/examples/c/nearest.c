/* Lowers a tool along z until it touches, and says where. Built against the installed library:
 *   cc nearest.c $(pkg-config --cflags --libs palpate) -o nearest && ./nearest scene.json 0.1 */
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>

static int failed(palpate_error* error) {
  fprintf(stderr, "%s\n", palpate_error_sentence(error));
  const int code = palpate_error_code(error);
  palpate_error_free(error);
  return code;
}

int main(int argc, char** argv) {
  if (argc != 3) return fprintf(stderr, "usage: nearest SCENE.json METRES\n"), PALPATE_USAGE;
  palpate_error* error = NULL;
  palpate_scene* scene = NULL;
  if (palpate_scene_open_file(argv[1], NULL, &scene, &error) != PALPATE_OK) return failed(error);

  const double height = atof(argv[2]);
  const double from[7] = {0, 0, height, 0, 0, 0, 1}, to[7] = {0, 0, 0, 0, 0, 0, 1};
  double gap = 0, time = 0;
  uint8_t kind = 0;
  const palpate_distances distances = {.size = sizeof distances, .distance = &gap};
  const palpate_motions motions = {.size = sizeof motions, .kind = &kind, .time = &time};
  if (palpate_clearance(scene, from, 1, 1e300, &distances, NULL, &error) != PALPATE_OK ||
      palpate_first_contact(scene, from, to, 1, 0, &motions, NULL, &error) != PALPATE_OK) {
    palpate_scene_close(scene);
    return failed(error);
  }
  printf("engine %s: ", palpate_scene_engine(scene));
  if (isinf(gap))
    printf("further than is measured, ");  /* beyond the scene's reach */
  else
    printf("%.6f m free, ", gap);
  if (kind == PALPATE_MOTION_CLEAR)
    printf("clear all the way\n");
  else
    printf("first contact at height %.6f m\n", height * (1 - time));
  palpate_scene_close(scene);
  return 0;
}
