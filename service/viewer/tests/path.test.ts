// A recorded path: times, playing, what it touched, and the names of what touches.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import type {Moment} from '../src/moment.js';
import {PathRecorder, touches} from '../src/mouse/path_recorder.js';
import type {Area, Frame} from '../src/server/protocol.js';
import {PartNames, short_names} from '../src/words/part_names.js';

const area: Area = {
  id: 1,
  static: [12],
  mobile: [0],
  normal: [0, 0, 1],
  depth: 0.001,
  point: [0, 0, 0],
  force: [0, 0, 1],
  torque: [0, 0, 0]
};
const frame = {
  cst: [],
  cmt: [],
  areas: [area]
} as unknown as Frame;
const moment = (time: number, contact = false, depth = 0): Moment => ({
  time,
  pose: [time, 0, 0, 0, 0, 0, 1],
  frame: contact ? frame : null,
  force: [0, 0, 0],
  torque: [0, 0, 0],
  response: {force: [0, 0, depth * 1000], torque: [0, 0, 0]},
  depth,
  contact,
  frame_us: 1,
  late: 1,
  stage: 0,
  note: '',
});

test('a recording begins at 0, ascends, and plays as it went', () => {
  const recorder = new PathRecorder();
  recorder.take(moment(1));
  assert.equal(recorder.rows.length, 0);
  recorder.start();
  for (const time of [5, 5.5, 5.5, 5.4, 6]) recorder.take(moment(time));
  assert.deepEqual(recorder.rows.map(({time}) => time), [0, 0.5, 1]);
  recorder.play();
  assert.deepEqual(
      [recorder.advance(0.4)?.pose[0], recorder.advance(0.2)?.pose[0], recorder.advance(1), recorder.playing],
      [5, 5.5, null, false]);
});

test('a path tells when it touched what, and how much', () => {
  const rows =
      [moment(0), moment(0.1, true, 0.001), moment(0.5, true, 0.003), moment(0.6), moment(1, true, 0.002)];
  const told = touches(rows, () => 'a ↔ b');
  assert.deepEqual(told.map(({from, to, depth}) => [from, to, depth]), [[0.1, 0.5, 0.003], [1, 1, 0.002]]);
  assert.deepEqual([told[0].parts, told[0].force], ['a ↔ b', 3]);
});

test('triangles give the names of parts, last names where they tell apart', () => {
  assert.deepEqual(short_names(['x/bolt', 'y/bolt', 'y/nut']), ['x/bolt', 'y/bolt', 'nut']);
  const names = new PartNames({
    static: [{path: 'case/wall', triangles: 12}, {path: 'case/lid', triangles: 8}],
    tool: [{path: 'handle', triangles: 4}]
  });
  assert.equal(names.of_area(area), 'handle ↔ lid');
  assert.equal(names.of_frame({cst: [0], cmt: [], areas: [area]}), 'handle ↔ wall, lid');
  assert.equal(names.of_frame({cst: [], cmt: [], areas: []}), '');
});
