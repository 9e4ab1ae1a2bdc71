// What the page says and in which order: areas, flags, scenes, devices, labels.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {by_force} from '../src/words/area_table.js';
import {flag_words, KNOWN_FLAGS} from '../src/words/flag_words.js';

import {place_labels, type Box} from '../src/draw/label_layout.js';
import {offered_devices} from '../src/words/offered_devices.js';
import type {Area, Device, Scene, SceneList, Vec3} from '../src/server/protocol.js';
import {scene_rows} from '../src/words/scene_rows.js';
import {waiting_words} from '../src/mouse/waiting.js';
import {places_of, shown_corners} from '../src/draw/shown_parts.js';
import {clearance_words} from '../src/words/clearance_words.js';

const area = (id: number, force: Vec3, depth: number): Area =>
    ({id, force, depth, normal: [0, 0, 1], point: [0, 0, 0], torque: [0, 0, 0]});

test('areas that push come first, the strongest on top', () => {
  const areas =
      [area(1, [0, 0, 0], 0.3), area(2, [1, 0, 0], 0.1), area(3, [0, 0, -2], 0.05), area(4, [0, 0, 0], 0.5)];
  assert.deepEqual(by_force(areas).map(({id}) => id), [3, 2, 4, 1]);
});

test('each flag of the server has a sentence of its own, without its own name in it', () => {
  assert.deepEqual([...KNOWN_FLAGS].sort(), [
    'cancelled', 'no_direction', 'sheet', 'tool_open', 'unsettled'
  ]);  // flag_names of model/contact/contacts.h
  for (const flag of KNOWN_FLAGS)
    assert.ok(flag_words(flag).long.length > 40 && !flag_words(flag).long.includes('_'), flag);
  assert.equal(flag_words('quite_new').short, 'quite new');
});

test('labels lie neither over each other nor over what else is there, and inside the picture', () => {
  const frame = {x: 0, y: 0, width: 600, height: 400};
  const readout = {x: 10, y: 10, width: 200, height: 120};
  const points = [...Array(8)].map(
      (_, i) => ({x: 100 + i, y: 100 + i}));  // eight areas at one place, behind the readout
  const places = place_labels(
      [...points, null, {x: 598, y: 398}], [...Array(10)].map(() => ({width: 90, height: 20})), [readout],
      frame);
  const boxes = places.filter((place): place is Box => place !== null);
  assert.ok(boxes.length >= 8, `${boxes.length} have room`);
  const over = (a: Box, b: Box) =>
      a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
  boxes.forEach((box, i) => {
    assert.ok(!over(box, readout), 'over the readout');
    assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= 600 && box.y + box.height <= 400, 'outside');
    for (const other of boxes.slice(i + 1)) assert.ok(!over(box, other), 'over another');
  });
  assert.equal(places[8], null);
});

test('an open scene has one row, and the last of a file that changed', () => {
  const held = (id: string, name: string) => ({id, name, state: 'ready'}) as Scene;
  const list: SceneList = {
    scenes: [held('1', 'a/scene.json'), held('2', 'upload'), held('3', 'a/scene.json')],
    available: ['a/scene.json', 'b/scene.json']
  };
  assert.deepEqual(scene_rows(list, '').map(({value}) => value), ['id:2', 'id:3', 'at:b/scene.json']);
  assert.deepEqual(scene_rows(list, '1').map(({value}) => value), ['id:1', 'id:2', 'at:b/scene.json']);
});

test('replay is offered for a scene that names a file alone', () => {
  const devices: Device[] = [
    {kind: 'haptic', name: 'replay', usable: true, reason: ''},
    {kind: 'haptic', name: 'simulated', usable: true, reason: ''},
    {kind: 'compute', name: 'cpu', usable: true, reason: ''}
  ];
  assert.deepEqual(offered_devices(devices, {driver: 'simulated'}).map(({usable}) => usable), [false, true]);
  assert.deepEqual(offered_devices(devices, {driver: 'replay'}).map(({usable}) => usable), [true, true]);
});

test('an answer that is away is said as a time and an engine', () => {
  assert.equal(
      waiting_words(1340, 'cpu', 2210), 'this contact takes more than 1.3 s on cpu; the last one took 2.2 s');
  assert.equal(waiting_words(310, '', NaN), 'this contact takes more than 310 ms');
});

test('a clearance is said as a length, with the parts and who measured', () => {
  assert.equal(
      clearance_words({
        engine: 'cpu',
        touches: false,
        clearance: 0.0123,
        parts: {static: 'case/cover', mobile: 'handle'}
      }),
      '12.3 mm apart: handle ↔ cover (measured by cpu)');
  assert.equal(clearance_words({engine: 'cpu', touches: true, clearance: 0}), '');
  assert.equal(clearance_words({engine: 'cpu', touches: false, clearance: null}), '');
});

test('hidden parts leave no triangle, whatever level is drawn', () => {
  const parts = [{path: 'a', triangles: 2}, {path: 'b', triangles: 3}, {path: 'c', triangles: 1}];
  const place = places_of(parts);
  assert.deepEqual([0, 1, 2, 4, 5].map(place), [0, 0, 1, 1, 2]);
  const body = {
    vertices: new Float32Array(9),
    corners: Uint32Array.from([0, 1, 2, 1, 2, 0, 2, 0, 1, 0, 2, 1]),
    ids: Uint32Array.from([1, 2, 4, 5])
  };  // two are left out by the level
  assert.equal(shown_corners(body, parts, new Set()), body.corners);
  assert.deepEqual([...shown_corners(body, parts, new Set([1]))], [0, 1, 2, 0, 2, 1]);
  assert.deepEqual([...shown_corners(body, parts, new Set([0, 1, 2]))], []);
});
