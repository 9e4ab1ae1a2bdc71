// Where the tool is, for the camera: its triangles may lie far from its file's origin.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Scene } from 'three';
import { Bodies } from '../src/draw/bodies.js';

const box_at = (x: number) => {
  const vertices = new Float32Array([x, 0, 0, x + 2, 0, 0, x, 2, 0]);
  return { vertices, corners: new Uint32Array([0, 1, 2]), ids: new Uint32Array([0]) };
};

test('the tool is where its triangles are, not at its file\'s origin', () => {
  const bodies = new Bodies(new Scene());
  bodies.set({ reduced: false, mockup: box_at(0), tool: box_at(50) });
  bodies.move([0, 0, 3, 0, 0, 1, 0]);   // half a turn about z, and up
  const { center, radius } = bodies.tool_sphere();
  assert.ok(Math.hypot(center.x + 51, center.y + 1, center.z - 3) < 1e-4, JSON.stringify(center));
  assert.ok(Math.abs(radius - Math.SQRT2) < 1e-4);
});
