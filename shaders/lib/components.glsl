// Nodes of the graph of components: 0 is what lies beyond the border, 1 + b is brick b if it is uniform, and then the
// components of the mixed bricks, slot by slot. The file that includes this declares, before:
//   uint32_t brick_slot[], Brick bricks[], uint32_t component_first[] (slots + 1), uint32_t labels[], and NODE_BRICKS.

// Component of a voxel that is not boundary inside its mixed brick.
uint32_t local_component(uint32_t slot, uint32_t bit) {
  uint32_t count = component_first[slot + 1u] - component_first[slot];
  uint32_t component = 0u;
  for (uint32_t plane = 0u; 1u << plane < count; ++plane)
    component |= (labels[slot * 128u + plane * 16u + (bit >> 5)] >> (bit & 31u) & 1u) << plane;
  return component;
}

bool is_boundary(uint32_t slot, uint32_t bit) { return (bricks[slot].boundary[bit >> 5] >> (bit & 31u) & 1u) != 0u; }

uint32_t uniform_node(uint32_t brick) { return 1u + brick; }
uint32_t voxel_node(uint32_t slot, uint32_t bit) { return 1u + NODE_BRICKS + component_first[slot] + local_component(slot, bit); }
