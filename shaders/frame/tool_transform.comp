#version 460
#extension GL_GOOGLE_include_directive : require
// Moves the tool to the pose. An invocation a vertex; reads tool_vertices, writes tool_world.
#include "shaders/lib/frame.glsl"

READ_ONE(kBindScene, SceneConstants, scene);
READ_ONE(kBindFrameInput, FrameInput, frame_input);
READ(kBindToolVertices, ivec3, tool_vertices);
EDIT(kBindToolWorld, ivec3, tool_world);

#include "shaders/lib/pose.glsl"

void main() {
  const uint32_t i = flat_invocation();
  if (i >= scene.tool.vertices) return;
  tool_world[i] = world_from_tool(tool_vertices[i]);
}
