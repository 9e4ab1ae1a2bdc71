// A SpaceMouse's reports, as a browser hands them over: without their number.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {at_rest, take_report} from '../src/mouse/cap_report.js';
import {deflection} from '../src/mouse/space_mouse.js';

const view = (...values: number[]): DataView => {
  const out = new DataView(new ArrayBuffer(2 * values.length));
  values.forEach((value, i) => out.setInt16(2 * i, value, true));
  return out;
};
const bytes = (...values: number[]): DataView => new DataView(Uint8Array.from(values).buffer);

test('older models report moves and turns apart, newer ones together; full is full', () => {
  const cap = at_rest();
  assert.ok(take_report(cap, 1, view(175, -350, 700)));
  assert.deepEqual(cap.axes, [0.5, -1, 1, 0, 0, 0]);
  assert.ok(take_report(cap, 2, view(0, 35, -35)));
  assert.deepEqual(cap.axes, [0.5, -1, 1, 0, 0.1, -0.1]);
  assert.ok(take_report(cap, 1, view(0, 0, 0, 350, 0, 0)));
  assert.deepEqual(cap.axes, [0, 0, 0, 1, 0, 0]);
  assert.ok(take_report(cap, 3, bytes(0x01, 0x80)));
  assert.equal(cap.buttons, 0x8001);
});

test('what is too short, or of another number, changes nothing', () => {
  const cap = at_rest();
  take_report(cap, 1, view(350, 0, 0));
  for (const [id, data] of [[1, view(1, 2)], [2, view(1)], [3, bytes()], [23, view(1, 2, 3, 4, 5, 6)]] as
       const)
    assert.equal(take_report(cap, id, data), false);
  assert.deepEqual(cap.axes, [1, 0, 0, 0, 0, 0]);
});

test('a cap that nobody touches moves nothing', () => {
  const cap = at_rest();
  take_report(cap, 1, view(12, -15, 20, 8, -9, 3));
  assert.deepEqual(deflection(cap), [0, 0, 0, 0, 0, 0]);
});
