// Look-ups in a voxel partition. The file that includes this names its buffers first:
//   #define PARTITION_GRID   scene.mockup.grid        (GridConstants)
//   #define PARTITION_SLOTS  mockup_brick_slot        (WORDS, one a brick)
//   #define PARTITION_BRICKS mockup_bricks            (WORDS: Brick)
//   #define PARTITION(name)  mockup_##name            (prefix of the functions)
// and may include it again with other names for the other body (it has no include guard, and undefines them).
// All outside the grid is V_ext.

// The voxel that holds lattice point p, half-open; some voxel off the grid when p is off it. |p − origin| <
// 2^31.
ivec3 PARTITION(voxel_of)(ivec3 p) {
  return cell_along(p - PARTITION_GRID.origin, PARTITION_GRID.size, 8 * PARTITION_GRID.bricks);
}

bool PARTITION(in_grid)(ivec3 voxel) {
  return all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, PARTITION_GRID.bricks * 8));
}

// Entry of brick_slot[] for a brick inside the grid.
uint32_t PARTITION(slot_of)(ivec3 brick) {
  ivec3 n = PARTITION_GRID.bricks;
  return PARTITION_SLOTS(uint32_t(brick.x) +
                         uint32_t(n.x) * (uint32_t(brick.y) + uint32_t(n.y) * uint32_t(brick.z)));
}

// Bit of a voxel in its brick.
uint32_t PARTITION(bit_of)(ivec3 voxel) {
  return uint32_t(voxel.x & 7) | uint32_t(voxel.y & 7) << 3 | uint32_t(voxel.z & 7) << 6;
}

// Class of any voxel: kVoxelExternal, kVoxelBoundary or kVoxelInternal.
uint32_t PARTITION(class_of)(ivec3 voxel) {
  if (!PARTITION(in_grid)(voxel)) return kVoxelExternal;
  uint32_t slot = PARTITION(slot_of)(voxel >> 3);
  if (slot >= kBrickInternal) return slot == kBrickInternal ? kVoxelInternal : kVoxelExternal;
  uint32_t bit = PARTITION(bit_of)(voxel);
  if ((PARTITION_BRICKS(kBrickWords * slot + (bit >> 5)) >> (bit & 31u) & 1u) != 0u) return kVoxelBoundary;
  return (PARTITION_BRICKS(kBrickWords * slot + kBrickInternalWord + (bit >> 5)) >> (bit & 31u) & 1u) != 0u ? kVoxelInternal
                                                                                : kVoxelExternal;
}

// Compact index of a voxel of a mixed brick, for list_begin[]; kNoVoxel if it is not V_bnd.
uint32_t PARTITION(boundary_index_in)(uint32_t slot, uint32_t bit) {
  uint32_t word = PARTITION_BRICKS(kBrickWords * slot + (bit >> 5));
  if ((word >> (bit & 31u) & 1u) == 0u) return kNoVoxel;
  return PARTITION_BRICKS(kBrickWords * slot + kBrickFirstWord + (bit >> 5)) + uint32_t(bitCount(word & ((1u << (bit & 31u)) - 1u)));
}

// Compact index of any voxel; kNoVoxel if it is not V_bnd.
uint32_t PARTITION(boundary_index)(ivec3 voxel) {
  if (!PARTITION(in_grid)(voxel)) return kNoVoxel;
  uint32_t slot = PARTITION(slot_of)(voxel >> 3);
  if (slot >= kBrickInternal) return kNoVoxel;
  return PARTITION(boundary_index_in)(slot, PARTITION(bit_of)(voxel));
}

#undef PARTITION
#undef PARTITION_GRID
#undef PARTITION_SLOTS
#undef PARTITION_BRICKS
