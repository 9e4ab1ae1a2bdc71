// Arrows, dots and bars as one mesh: what is added is shown, in its place, size and colour, and nothing of
// before.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {BoxGeometry, Color, SphereGeometry, Vector3} from 'three';

import {placed, Solids} from '../src/draw/solids.js';

const BOX = new BoxGeometry(2, 2, 2);
const RED = new Color(1, 0, 0), GREEN = new Color(0, 1, 0);

/** The corners that are drawn, with their colours: x y z r g b opacity. */
function corners_of(solids: Solids): number[][] {
  const {index, attributes, drawRange} = solids.object.geometry;
  return Array.from({length: drawRange.count}, (_, i) => {
    const at = index!.getX(drawRange.start + i);
    const row =
        (name: string, size: number) => [...attributes[name].array.slice(size * at, size * at + size)];
    return [...row('position', 3), ...row('color', 4)];
  });
}

test('a solid lies where it is placed, its y along the axis, in its colour', () => {
  const solids = new Solids();
  solids.begin();
  solids.add(BOX, placed(new Vector3(10, 0, 0), new Vector3(1, 0, 0), new Vector3(1, 5, 2)), RED, 0.5);
  solids.end();
  assert.ok(solids.object.visible);
  const corners = corners_of(solids);
  assert.equal(corners.length, BOX.index!.count);
  for (const [axis, low, high] of [[0, 5, 15], [1, -1, 1], [2, -2, 2]]) {
    const along = corners.map((corner) => corner[axis]);
    assert.ok(
        Math.abs(Math.min(...along) - low) < 1e-6 && Math.abs(Math.max(...along) - high) < 1e-6, `${axis}`);
  }
  assert.ok(corners.every(([, , , r, g, b, opacity]) => r === 1 && g === 0 && b === 0 && opacity === 0.5));
});
test('a second one is drawn after the first, from vertices of its own', () => {
  const solids = new Solids();
  solids.begin();
  solids.add(BOX, placed(new Vector3(0, 0, 0)), RED);
  solids.add(BOX, placed(new Vector3(7, 0, 0)), GREEN);
  solids.end();
  const corners = corners_of(solids);
  assert.equal(corners.length, 2 * BOX.index!.count);
  corners.forEach(([x, , , red], i) => {
    const first = i < BOX.index!.count;
    assert.equal(red, first ? 1 : 0);
    assert.ok(first ? x <= 1 : x >= 6);
  });
});
test('nothing of before is left, and nothing at all is not drawn', () => {
  const solids = new Solids();
  for (let i = 0; i < 40; ++i) {  // more than there is room for at first
    solids.begin();
    for (let k = 0; k <= i; ++k) solids.add(new SphereGeometry(1, 8, 6), placed(new Vector3(k, 0, 0)), RED);
    solids.end();
  }
  solids.begin();
  solids.add(BOX, placed(new Vector3(3, 0, 0)), GREEN);
  solids.end();
  const corners = corners_of(solids);
  assert.equal(corners.length, BOX.index!.count);
  assert.ok(corners.every(([x, , , , green]) => x >= 2 && x <= 4 && green === 1));
  solids.begin();
  solids.end();
  assert.ok(!solids.object.visible);
});
