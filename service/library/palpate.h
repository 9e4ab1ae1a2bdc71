/*
 * palpate as a shared library: contact, force and distance between a tool and a large mock-up, for C and for
 * whatever calls C. docs/LIBRARY.md is the guide; docs/PYTHON.md the Python package over it.
 *
 * Errors. A function that can fail returns PALPATE_OK or a code, and, where `error` is not null, sets *error
 * to an error that says why in one sentence, or to null. The caller frees it by palpate_error_free. No C++
 * exception leaves the library, and nothing is printed. A callback that throws one cancels the call.
 *
 * Threads. Any function may be called by any thread at any time, on the same scene, too, but for
 * palpate_scene_close and palpate_source_free, which must be a handle's last. A call on many poses uses all
 * processors by itself, and such calls on one scene take turns; calls on few poses run side by side. Open
 * scenes for the engine "gpu" before other threads read the environment: Vulkan drivers are told by it. After
 * fork() a scene belongs to the parent: in the child every call on it is refused, and closing it does
 * nothing.
 *
 * Arrays belong to the caller and are neither kept nor freed. Text that a handle gives belongs to it and
 * lives as long as it. Every string is UTF-8 and ends with a zero.
 *
 * Poses are rows of seven doubles: x y z in metres and the unit quaternion qx qy qz qw, world from tool.
 * Triangles keep the numbers that they have in their files, bodies in the order of the scene, from 0.
 *
 * Later versions add functions, constants, and members at the ends of the structs that begin with `size`, and
 * change or remove nothing while the library is called libpalpate.so.0. A caller sets `size` to sizeof of its
 * own struct and all members that it does not use to zero; a library that is older than a member refuses it,
 * unless it is zero.
 */
#ifndef PALPATE_H
#define PALPATE_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What a call came to: the exit codes of the command line, and one more. */
#define PALPATE_OK 0
#define PALPATE_INTERNAL 1  /* a fault of the library or of what it rests on */
#define PALPATE_USAGE 2     /* a call that is wrong whatever the values are */
#define PALPATE_BAD_VALUE 3 /* a value in a file or an argument */
#define PALPATE_NO_DEVICE 4 /* no usable Vulkan device */
#define PALPATE_CANCELLED 64

/* "0.1.0": of the library that is loaded. */
PALPATE_API const char* palpate_version(void);

typedef struct palpate_error palpate_error;
PALPATE_API int32_t palpate_error_code(const palpate_error* error);         /* PALPATE_OK of null */
PALPATE_API const char* palpate_error_sentence(const palpate_error* error); /* "" of null */
PALPATE_API void palpate_error_free(palpate_error* error);                  /* null is allowed */

/* Who follows long work, and may end it. A null pointer to it: nobody. */
typedef struct palpate_watch {
  size_t size;
  /* Not 0: stop. May be set by another thread or a signal handler at any time; may be null. */
  const volatile int32_t* cancel;
  /* Told by the calling thread what goes on and how much of it is done, 0 to 1. Not 0 stops. May be null.
   * Must not ask the scene that is at work. */
  int32_t (*progress)(void* context, const char* what, double done);
  /* Told by the calling thread what a user should know, a sentence each. May be null. */
  void (*note)(void* context, const char* sentence);
  void* context;
} palpate_watch;

/* ---- scenes ------------------------------------------------------------------------------------------ */

/* What a scene is made of. Setters replace what was said before. */
typedef struct palpate_source palpate_source;
PALPATE_API palpate_source* palpate_source_new(void); /* null: no memory */
PALPATE_API void palpate_source_free(palpate_source* source);

/* A scene file (scenes/scene.schema.json). */
PALPATE_API int32_t palpate_source_file(palpate_source* source, const char* path, palpate_error** error);
/* The text of one; the files that it names lie in `folder` (null: the working directory). */
PALPATE_API int32_t palpate_source_text(palpate_source* source, const char* json, const char* folder,
                                        palpate_error** error);
/* A mesh in memory, for a scene's text to name: {"mesh": NAME, …}. `vertices`: (vertex_count, 3) coordinates
 * in the unit that the text says ("units", "scale"), metres by default. `faces`: (face_count, 3) indices from
 * 0. Both are copied. */
PALPATE_API int32_t palpate_source_mesh(palpate_source* source, const char* name, const double* vertices,
                                        size_t vertex_count, const uint32_t* faces, size_t face_count,
                                        palpate_error** error);
/* "auto" (the default: the quicker of gpu and cpu on a GPU, else cpu), "gpu", "cpu" or "ref". All give the
   same answers. */
PALPATE_API int32_t palpate_source_engine(palpate_source* source, const char* engine, palpate_error** error);
/* "refined" or "paper" in place of the scene's own. */
PALPATE_API int32_t palpate_source_profile(palpate_source* source, const char* profile,
                                           palpate_error** error);
/* Not 0: all samples count, which a tolerance needs. 0 (the default): as many as the scene says. */
PALPATE_API int32_t palpate_source_all_samples(palpate_source* source, int32_t on, palpate_error** error);
/* 0: nothing is looked for nor kept in the folder of prepared scenes (docs/CACHE.md). */
PALPATE_API int32_t palpate_source_cache(palpate_source* source, int32_t on, palpate_error** error);

typedef struct palpate_scene palpate_scene;
/* Reads, checks and prepares. *scene is null on failure. `source` may be freed or used again afterwards. */
PALPATE_API int32_t palpate_scene_open(const palpate_source* source, const palpate_watch* watch,
                                       palpate_scene** scene, palpate_error** error);
/* The same of a scene file with all defaults. */
PALPATE_API int32_t palpate_scene_open_file(const char* path, const palpate_watch* watch,
                                            palpate_scene** scene, palpate_error** error);
PALPATE_API void palpate_scene_close(palpate_scene* scene); /* null is allowed */

/* "gpu", "cpu" or "ref": who answers. Should it fail later another does, which the columns `engine` tell. */
PALPATE_API const char* palpate_scene_engine(const palpate_scene* scene);
/* 32 hexadecimal digits that stand for all that decides the scene's answers: the triangles on the lattice,
 * samples, profile and stiffness, wherever the files lie. */
PALPATE_API const char* palpate_scene_hash(const palpate_scene* scene);
/* One JSON object: engine, device, hash, profile, stiffness, step, start pose, the two bodies with their
 * triangles and parts, the plan's stages, memory, notes. docs/LIBRARY.md has the members. */
PALPATE_API const char* palpate_scene_description(const palpate_scene* scene);

#define PALPATE_STATIC 0 /* the mock-up, world frame */
#define PALPATE_MOBILE 1 /* the tool, its own frame */
PALPATE_API size_t palpate_scene_triangle_count(const palpate_scene* scene, int32_t body);
/* The corners of all triangles as the engines see them, rounded to the lattice: (triangles, 3, 3), metres. */
PALPATE_API int32_t palpate_scene_triangles(const palpate_scene* scene, int32_t body, double* corners,
                                            palpate_error** error);

/* ---- questions --------------------------------------------------------------------------------------- */

#define PALPATE_NO_TRIANGLE UINT32_MAX

/* Engines in a column: who answered a pose. */
#define PALPATE_ENGINE_NONE 0 /* nobody had to be asked */
#define PALPATE_ENGINE_GPU 1
#define PALPATE_ENGINE_CPU 2
#define PALPATE_ENGINE_REF 3

/* Bits of the column `flags` (docs/EXACTNESS.md). */
#define PALPATE_FLAG_CANCELLED 1u
#define PALPATE_FLAG_SHEET 2u
#define PALPATE_FLAG_TOOL_OPEN 4u
#define PALPATE_FLAG_NO_DIRECTION 8u
#define PALPATE_FLAG_UNSETTLED 16u /* known only where force, torque or tool are asked for */

/* Where answers go: an entry, or a row, for every pose. Null: not asked for. Without force, torque, tool and
 * evaluations a pose is asked once, else until tool and spring are in balance (docs/EXACTNESS.md). */
typedef struct palpate_columns {
  size_t size;
  uint8_t* contact;                            /* 1: they touch, containment included */
  uint64_t* pairs;                             /* of triangles that intersect */
  uint32_t *cst, *bst, *cmt, *bmt, *imt, *est; /* how many triangles each set has (docs/NOTATION.md) */
  uint32_t* areas;                             /* of contact */
  double* depth;                               /* of the deepest sample, m; 0: none is inside */
  uint32_t *deepest_static, *deepest_mobile;   /* triangles of that sample, or PALPATE_NO_TRIANGLE; refined */
  double* force;                               /* (n, 3), on the tool, world axes, N */
  double* torque;                              /* (n, 3), about the tool's centre of mass, world axes, N·m */
  double* tool;                                /* (n, 7), where the tool is while the hand is at the pose */
  uint32_t* evaluations;                       /* of the field, until the balance was found */
  uint32_t* flags;                             /* PALPATE_FLAG_… */
  uint8_t* truncated;                          /* 1: a list was too small, and there is no force */
  uint8_t* engine;                             /* PALPATE_ENGINE_… */
} palpate_columns;

/* Contact and force at each of `count` poses. On an error the columns hold nothing of use. */
PALPATE_API int32_t palpate_query(palpate_scene* scene, const double* poses, size_t count,
                                  const palpate_columns* columns, const palpate_watch* watch,
                                  palpate_error** error);

/* touches[i] = 1 where tool and mock-up touch, containment included. `tolerance` in metres, 0 or more:
 * contact no deeper does not count; above 0 the scene must have been opened with all samples. This, distances
 * and motions are asked of scenes in profile refined. */
PALPATE_API int32_t palpate_touches(palpate_scene* scene, const double* poses, size_t count, double tolerance,
                                    uint8_t* touches, const palpate_watch* watch, palpate_error** error);

typedef struct palpate_distances {
  size_t size;
  double* distance;                /* m; 0: they touch; infinite: further than `within`, or beyond reach */
  uint32_t *static_id, *mobile_id; /* the nearest pair, or PALPATE_NO_TRIANGLE */
  double *on_static, *on_mobile; /* (n, 3), its nearest points, world, m; not a number where there are none */
  uint8_t* engine;               /* PALPATE_ENGINE_… */
} palpate_distances;

/* The smallest distance at each pose. What is further than `within` metres is not measured; infinite: all
 * that the lattice tells, whose `reach` the description has: a pose with a vertex of the tool beyond has
 * none. */
PALPATE_API int32_t palpate_clearance(palpate_scene* scene, const double* poses, size_t count, double within,
                                      const palpate_distances* columns, const palpate_watch* watch,
                                      palpate_error** error);

#define PALPATE_MOTION_CLEAR 0
#define PALPATE_MOTION_CONTACT 1
/* So near for so long that the search was given up: clear until `time`. */
#define PALPATE_MOTION_UNDECIDED 2

typedef struct palpate_motions {
  size_t size;
  uint8_t* kind;                   /* PALPATE_MOTION_… */
  double* time;                    /* from 0 to 1: clear until then for certain */
  double* pose;                    /* (n, 7), there */
  double* distance;                /* between the two there, m */
  uint32_t *static_id, *mobile_id; /* that come together, or PALPATE_NO_TRIANGLE */
  uint64_t* evaluations;           /* poses that were asked about */
  uint8_t* engine;                 /* PALPATE_ENGINE_… */
} palpate_motions;

/* When a tool that moves on the screw from a pose to a pose first touches; never late. `tolerance` as in
 * palpate_touches. */
PALPATE_API int32_t palpate_first_contact(palpate_scene* scene, const double* from, const double* to,
                                          size_t count, double tolerance, const palpate_motions* columns,
                                          const palpate_watch* watch, palpate_error** error);

/* All that is known of one pose. */
typedef struct palpate_contact palpate_contact;
PALPATE_API int32_t palpate_contact_at(palpate_scene* scene, const double* pose, palpate_contact** contact,
                                       palpate_error** error);
PALPATE_API void palpate_contact_free(palpate_contact* contact);

#define PALPATE_CST 0 /* triangles of the mock-up that the tool's intersect */
#define PALPATE_BST 1 /* of the mock-up, near: in a boundary voxel that the tool touches */
#define PALPATE_CMT 2 /* triangles of the tool that the mock-up's intersect */
#define PALPATE_BMT 3 /* of the tool, near: touching a boundary voxel of the mock-up */
#define PALPATE_IMT 4 /* of the tool, inside: touching an internal voxel of the mock-up */
#define PALPATE_EST 5 /* of the mock-up, inside the tool */
/* A list of triangles, ascending. Null and *count = 0: there is no such list. */
PALPATE_API const uint32_t* palpate_contact_list(const palpate_contact* contact, int32_t list, size_t* count);
/* What `palpate query --names --json` prints for the pose: one JSON object with the lists, areas, force and
 * torque. */
PALPATE_API const char* palpate_contact_json(const palpate_contact* contact);

/* ---- files ------------------------------------------------------------------------------------------- */

/* Writes a generated scene, "contacts" or "disassembly", to a folder as `palpate generate` does: scene.json,
 * meshes, path. 0 triangles: the usual count. */
PALPATE_API int32_t palpate_generate(const char* name, uint64_t triangles, uint64_t tool_triangles,
                                     const char* folder, palpate_error** error);

#ifdef __cplusplus
}
#endif
#endif
