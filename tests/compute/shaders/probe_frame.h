// Both sides of the probes of lib/pose.glsl, lib/partition.glsl and lib/frame.glsl.
#ifndef PALPATE_PROBE_FRAME_H
#define PALPATE_PROBE_FRAME_H
#include "shaders/shared/base.h"
#include "shaders/shared/scene.h"

PALPATE_SHARED_BEGIN
struct PoseCase {
  int32_t rotation_q30[9];
  ivec3 translation;
  ivec3 point;
};
PALPATE_ASSERT_SIZE(PoseCase, 60);

struct PoseAnswer {
  ivec3 world, tool;  // of the point, from the tool and from the world
};
PALPATE_ASSERT_SIZE(PoseAnswer, 24);

struct PartitionCase {
  GridConstants grid;  // of at most three bricks an axis
  ivec3 point;
  ivec3 voxel;  // of the grid, or beside it
};
PALPATE_ASSERT_SIZE(PartitionCase, 64);

struct PartitionAnswer {
  ivec3 voxel;           // of the point
  uint32_t voxel_class;  // of the case's voxel, as the next
  uint32_t boundary;
};
PALPATE_ASSERT_SIZE(PartitionAnswer, 20);

// The probed partition: of brick b, and of word w of a mixed brick.
#define PALPATE_PROBE_SLOT(b) \
  ((b) % 4u == 0u ? kBrickInternal : (b) % 4u == 1u ? kBrickExternal : (b) % 4u - 2u)
#define PALPATE_PROBE_BOUNDARY(slot, w) ((0x9E3779B9u + (slot)) * (2u * (w) + 1u))
#define PALPATE_PROBE_INTERNAL(slot, w) \
  (((0x85EBCA6Bu + (slot)) * (2u * (w) + 3u)) & ~PALPATE_PROBE_BOUNDARY(slot, w))
#define PALPATE_PROBE_FIRST(slot, w) (1000u * (slot) + 40u * (w))

struct GroupsAnswer {
  uint32_t x, y, z;  // of groups_for
};
PALPATE_ASSERT_SIZE(GroupsAnswer, 12);
PALPATE_SHARED_END
#endif
