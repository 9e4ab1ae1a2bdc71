// Where the tool is, for the camera: its triangles may lie far from its file's origin.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {BoxGeometry, DoubleSide, FrontSide, Scene} from 'three';

import {Bodies} from '../src/draw/bodies.js';
import {with_faces} from '../src/draw/flat_shading.js';
import {sharp_edges} from '../src/draw/sharp_edges.js';
import {is_solid} from '../src/draw/solid_surface.js';

const box_at = (x: number) => {
  const vertices = new Float32Array([x, 0, 0, x + 2, 0, 0, x, 2, 0]);
  return {vertices, corners: new Uint32Array([0, 1, 2]), ids: new Uint32Array([0])};
};

test('the tool is where its triangles are, not at its file\'s origin', () => {
  const bodies = new Bodies(new Scene());
  bodies.set({reduced: false, mockup: box_at(0), tool: box_at(50)});
  bodies.move([0, 0, 3, 0, 0, 1, 0]);  // half a turn about z, and up
  const {center, radius} = bodies.tool_sphere();
  assert.ok(Math.hypot(center.x + 51, center.y + 1, center.z - 3) < 1e-4, JSON.stringify(center));
  assert.ok(Math.abs(radius - Math.SQRT2) < 1e-4);
});

/** A box of eight vertices. */
const box = () => {
  const {index, attributes} = new BoxGeometry(1, 2, 3);
  const known = new Map<string, number>();
  const vertices: number[] = [];
  const corners = Uint32Array.from(index!.array, (corner) => {
    const at = [0, 1, 2].map((axis) => attributes['position'].array[3 * corner + axis]);
    if (!known.has(at.join())) {
      known.set(at.join(), known.size);
      vertices.push(...at);
    }
    return known.get(at.join())!;
  });
  return {vertices: Float32Array.from(vertices), corners};
};

test('a box has twelve edges, and no diagonal of a side is one; an open edge comes first', () => {
  const {vertices, corners} = box();
  const length = (edges: Uint32Array, i: number) => Math.hypot(
      ...[0, 1, 2].map((axis) => vertices[3 * edges[2 * i] + axis] - vertices[3 * edges[2 * i + 1] + axis]));
  const edges = sharp_edges(vertices, corners, 100);
  assert.deepEqual(
      Array.from({length: edges.length / 2}, (_, i) => length(edges, i)).sort(),
      [1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3]);
  const open = sharp_edges(vertices, corners.subarray(3), 3);  // one triangle is missing
  assert.equal(open.length, 6);
  const missing = new Set(corners.subarray(0, 3));
  assert.ok(open.every((corner) => missing.has(corner)));
});

test('each triangle has a corner of its own with its normal, and stays where it was', () => {
  const {vertices, corners} = box();
  const faced = with_faces(vertices, corners);
  assert.equal(faced.vertices.length / 3, 12);  // eight, and four copies for twelve triangles
  const at = (list: Float32Array, corner: number) => [...list.subarray(3 * corner, 3 * corner + 3)];
  const owners = new Set<number>();
  for (let t = 0; t < 12; ++t) {
    const before = [0, 1, 2].map((k) => at(vertices, corners[3 * t + k]).join());
    const after = [0, 1, 2].map((k) => at(faced.vertices, faced.corners[3 * t + k]).join());
    assert.ok(
        [0, 1, 2].some((turn) => before.every((corner, k) => corner === after[(k + turn) % 3])),
        `triangle ${t}: ${before.join(' ')} became ${after.join(' ')}`);
    const own = faced.corners[3 * t + 2];
    owners.add(own);
    const axis = [0, 1, 2].find(
        (k) => new Set([0, 1, 2].map((i) => faced.vertices[3 * faced.corners[3 * t + i] + k])).size === 1)!;
    assert.equal(faced.faces[4 * own + axis], 32767 * Math.sign(faced.vertices[3 * own + axis]));
  }
  assert.equal(owners.size, 12);
});

test('a solid is closed and faces outwards, each piece of it', () => {
  const {vertices, corners} = box();
  assert.ok(is_solid(vertices, corners));
  assert.ok(!is_solid(vertices, corners.slice(3)), 'open');
  const inwards = corners.map((_, i) => corners[i - (i % 3) + (2 - (i % 3))]);
  assert.ok(!is_solid(vertices, inwards), 'inside out');
  const two = (second: Uint32Array) => is_solid(
      Float32Array.from([...vertices, ...vertices.map((v) => v / 9 + 7)]),
      Uint32Array.from([...corners, ...second.map((corner) => corner + vertices.length / 3)]));
  assert.ok(two(corners));
  assert.ok(!two(inwards), 'a small piece beside a large one');
  assert.ok(!is_solid(vertices, new Uint32Array(0)));
});

test('a solid tool has no far side where that is not wanted, an open one always', () => {
  const bodies = new Bodies(new Scene());
  const {vertices, corners} = box();
  const tool = (some: Uint32Array) => ({vertices, corners: some, ids: new Uint32Array(some.length / 3)});
  for (const [shape, on, side] of [
           [corners, false, FrontSide], [corners, true, DoubleSide], [corners.slice(3), false, DoubleSide]] as
       const) {
    bodies.set({reduced: false, mockup: box_at(0), tool: tool(shape)});
    bodies.show_far_side(on);
    assert.equal(bodies.tool_mesh.material.side, side);
  }
});

test(
    'coarse pictures have the tool in few triangles, without its hidden parts; all else has the whole',
    () => {
      const bodies = new Bodies(new Scene());
      const shape = (triangles: number) => {
        const one = box_at(0);
        return {
          ...one,
          corners: Uint32Array.from({length: 3 * triangles}, (_, i) => i % 3),
          ids: Uint32Array.from({length: triangles}, (_, i) => i * 12 / triangles)
        };
      };
      const drawn = () => bodies.tool_mesh.geometry.index!.count / 3;
      bodies.set({reduced: false, mockup: box_at(0), tool: shape(12)}, shape(4));
      assert.equal(drawn(), 12);
      bodies.draw_few(true);
      assert.equal(drawn(), 4);
      bodies.draw_few(false);
      bodies.hide(
          {static: [], tool: [{path: 'a', triangles: 6}, {path: 'b', triangles: 6}]},
          {mockup: new Set(), tool: new Set([1])});
      assert.equal(drawn(), 6);
      bodies.draw_few(true);
      assert.equal(drawn(), 2);
      bodies.draw_few(false);
      bodies.clear();
      bodies.set({reduced: false, mockup: box_at(0), tool: shape(3)});
      bodies.draw_few(true);
      assert.equal(drawn(), 3, 'one that has few anyway');
    });
