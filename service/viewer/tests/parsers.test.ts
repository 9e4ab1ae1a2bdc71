// Readers of what the server sends: they take what docs/SERVICE.md defines and refuse the rest.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {FrameIndex} from '../src/run/frame_index.js';
import {LineSplitter} from '../src/run/text_lines.js';
import {Trace} from '../src/run/trace.js';
import {round_up, Samples} from '../src/samples.js';
import {id_ranges, ids_within, read_geometry, read_voxels} from '../src/server/binary.js';

function geometry_bytes(corner = 2): ArrayBuffer {
  const bytes = new ArrayBuffer(32 + 2 * (3 * 12 + 16));
  const view = new DataView(bytes);
  [...'PGEO'].forEach((letter, i) => view.setUint8(i, letter.charCodeAt(0)));
  [1, 1, 3, 1, 3, 1, 0].forEach((value, i) => view.setUint32(4 + 4 * i, value, true));
  for (const [begin, id] of [[32, 7], [84, 9]]) {
    for (let i = 0; i < 9; ++i) view.setFloat32(begin + 4 * i, i, true);
    [0, 1, corner, id].forEach((value, i) => view.setUint32(begin + 36 + 4 * i, value, true));
  }
  return bytes;
}

test('geometry: both bodies, with the ids of their triangles', () => {
  const geometry = read_geometry(geometry_bytes());
  assert.equal(geometry.reduced, true);
  assert.deepEqual([...geometry.mockup.ids, ...geometry.tool.ids], [7, 9]);
  assert.deepEqual([...geometry.tool.corners], [0, 1, 2]);
  assert.equal(geometry.tool.vertices[8], 8);
});
test('geometry: short, foreign or pointing beyond its vertices is refused', () => {
  assert.throws(() => read_geometry(geometry_bytes().slice(0, 100)), /100 bytes instead of 136/);
  assert.throws(() => read_geometry(new ArrayBuffer(8)), /8 bytes/);
  assert.throws(() => read_geometry(new ArrayBuffer(64)), /expected PGEO/);
  assert.throws(() => read_geometry(geometry_bytes(3)), /corner 3 of 3/);
});
test('voxels: origin, size, counts and cells', () => {
  const bytes = new ArrayBuffer(80);
  const view = new DataView(bytes);
  [...'PVOX'].forEach((letter, i) => view.setUint8(i, letter.charCodeAt(0)));
  view.setUint32(4, 1, true);
  [0.5, -1, 2, 0.25].forEach((value, i) => view.setFloat64(16 + 8 * i, value, true));
  [4, 5, 6].forEach((value, i) => view.setUint32(48 + 4 * i, value, true));
  view.setBigUint64(64, 2n, true);
  view.setUint32(76, 119, true);
  const voxels = read_voxels(bytes);
  assert.deepEqual(
      [voxels.origin, voxels.size, voxels.counts, [...voxels.cells]],
      [[0.5, -1, 2], 0.25, [4, 5, 6], [0, 119]]);
});
test('ids are asked for in ranges', () => {
  assert.equal(id_ranges([9, 1, 5, 6, 7, 8]), '1,5-9');
  assert.equal(id_ranges([]), '');
});
test('lines are found however the download is cut, with the offset where each begins', () => {
  const text = new TextEncoder().encode('one\ntwo\n\nlast');
  for (let cut = 1; cut < text.length; ++cut) {
    const found: [string, number][] = [];
    const splitter = new LineSplitter((line, offset) => found.push([new TextDecoder().decode(line), offset]));
    for (let at = 0; at < text.length; at += cut) splitter.push(text.slice(at, at + cut));
    splitter.finish();
    assert.deepEqual(found, [['one', 0], ['two', 4], ['', 8], ['last', 9]]);
  }
});
test('trace: columns by name, rows by time, a row that was cut is left out', () => {
  const trace = new Trace();
  const names =
      'stage,time_s,x_m,y_m,z_m,qx,qy,qz,qw,force_x_N,force_y_N,force_z_N,torque_x_Nm,torque_y_Nm,torque_z_Nm,result_age_ticks,contact';
  trace.take(names);
  trace.take('1,0,1,2,3,0,0,0,1,4,5,6,7,8,9,-1,0');
  trace.take('2,0.001,1,2,3,0,0,0,1,4,5,6,7,8,9,3,1');
  trace.take('2,0.002,1,2');
  assert.equal(trace.rows, 2);
  assert.deepEqual(trace.pose(1), [1, 2, 3, 0, 0, 0, 1]);
  assert.deepEqual([trace.force(1), trace.torque(1)], [[4, 5, 6], [7, 8, 9]]);
  assert.deepEqual([trace.row_at(0.0009), trace.row_at(5), trace.row_at(-1)], [0, 1, 0]);
  assert.deepEqual(
      [trace.contact(0), trace.contact(1), trace.stage(1), trace.result_age(1)], [false, true, 2, 3]);
  assert.throws(() => new Trace().take('time_s,x_m'), /no column y_m/);
});
test('frames: the newest at a tick, and a line that was cut is left out', () => {
  const index = new FrameIndex();
  const line = (tick: number) => new TextEncoder().encode(
      `{"tick": ${tick}, "areas": [{"depth": 0.002}, {"depth": 0.001}], "time_us": {"total": 900}}`);
  assert.equal(index.take(line(5), 0), true);
  assert.equal(index.take(line(9), 80), true);
  assert.equal(index.take(line(12).slice(0, 30), 160), false);
  assert.deepEqual([4, 5, 8, 9, 99].map((tick) => index.at_tick(tick)), [-1, 0, 0, 1, 1]);
  assert.equal(index.entries[1].depth, 0.002);
  assert.equal(index.parse(index.text(1)!).tick, 9);
});
test('ids: as many as a request holds, the smallest first', () => {
  const scattered = Array.from({length: 1000}, (_, i) => 9_999_999 - 7 * i);
  const {ids, text} = ids_within(scattered, 1800);
  assert.ok(text.length <= 1800 && ids.length > 150, `${ids.length} ids, ${text.length} characters`);
  assert.deepEqual([ids[0], text], [9_999_999 - 6993, id_ranges(ids)]);
  assert.deepEqual(ids_within([3, 1, 2], 1800), {ids: [1, 2, 3], text: '1-3'});
});
test('strips: the newest samples stay, and a range is 1, 2 or 5 times a power of ten', () => {
  const samples = new Samples(8);
  for (let i = 0; i < 11; ++i) samples.add(i, [i, 0, 0, 0, 0, 0, 0, 0, 0]);
  assert.deepEqual(
      [samples.last('fx'), samples.times[samples.count - 1], samples.first_at(9.5) === samples.count - 1],
      [10, 10, true]);
  samples.add(0, new Array(9).fill(0));  // a new session
  assert.equal(samples.count, 1);
  assert.deepEqual([0.3, 1, 2.1, 7, 0].map(round_up), [0.5, 1, 5, 10, 1]);
});
