// Nodes of the graph of components: 0 is what lies beyond the border, 1 + b is brick b if it is uniform, and
// then the components of the mixed bricks, slot by slot. The file that includes this declares, before:
//   Brick bricks[], uint32_t component_first[] (slots + 1), uint32_t labels[], and NODE_BRICKS.

// What is looked up once for all voxels of a mixed brick.
struct BrickNodes {
  uint32_t slot;
  uint32_t first;    // node of its first component
  uint32_t count;    // of components
};

BrickNodes brick_nodes(uint32_t slot) {
  uint32_t first = component_first[slot];
  return BrickNodes(slot, 1u + NODE_BRICKS + first, component_first[slot + 1u] - first);
}

uint32_t uniform_node(uint32_t brick) { return 1u + brick; }

// Node of a voxel that is not boundary.
uint32_t voxel_node(BrickNodes brick, uint32_t bit) {
  uint32_t component = 0u;
  for (uint32_t plane = 0u; 1u << plane < brick.count; ++plane)
    component |= (labels[brick.slot * 128u + plane * 16u + (bit >> 5)] >> (bit & 31u) & 1u) << plane;
  return brick.first + component;
}
