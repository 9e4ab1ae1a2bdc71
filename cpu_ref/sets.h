#pragma once
#include "cpu_ref/frame.h"

namespace palpate::cpu_ref {

/// Moves the tool to the pose: vertices, triangles, box. Returns the boxes to build the tool's tree from.
std::vector<Box> transform_tool(Frame& frame);

/// All intersecting pairs, CST and CMT.
void find_pairs(Frame& frame, Contacts& out);

/// The voxels that the tool touches, IMT, BMT and BST.
void find_voxel_sets(Frame& frame, Contacts& out);

/// World lattice point to the tool's frame: ((Rᵀ (p − t) + 2^29) >> 30). Components within 3 · 2^30 · 2^29.
Int3 to_tool(const LatticePose& pose, const Int3& point);

/// Whether a world lattice point lies inside the tool (EXACTNESS section 4). `refined`, tool with inside.
bool inside_tool(const Frame& frame, const Int3& point);

/// EST and the counting samples; then C_s, C_m and whether there is contact.
void find_samples(Frame& frame, Contacts& out);

}  // namespace palpate::cpu_ref
