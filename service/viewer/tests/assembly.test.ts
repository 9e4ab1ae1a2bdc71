// From files to a scene file: names, units, the tree of parts, what a draft makes, undo, the archive.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {test} from 'node:test';
import {Box3, Matrix4, Ray, Vector3} from 'three';
import {AT_HOME, History, USUAL, path_text, scene_of, wrong_walls, type Draft} from '../src/assembly/draft.js';
import {named_apart, plain_name} from '../src/assembly/file_drop.js';
import {numbers_of, place_of} from '../src/assembly/gizmo.js';
import {find_node, part_tree} from '../src/assembly/part_nodes.js';
import {PartPicture} from '../src/assembly/part_picture.js';
import {length_words, likely_unit, size_words} from '../src/assembly/units.js';
import {zip} from '../src/assembly/zip.js';
import type {Assembly, AssemblyPart, Pose, Vec3} from '../src/server/protocol.js';

const part = (file: number, path: string, first: number, x = 0): AssemblyPart => ({
  file,
  path,
  also: '',
  first_triangle: first,
  triangles: 1,
  colour: null,
  box: {min: [x, 0, 0], max: [x + 1, 1, 0]}
});
const file = (name: string, states_unit = false) =>
    ({name, bytes: 1, mesh: true, states_unit, in_metres: states_unit, triangles: 1, error: null, notes: []});
const assembly = (files: Assembly['files'], parts: AssemblyPart[]): Assembly =>
    ({id: 'x', state: 'ready', step: '', progress: 1, error: null, files, parts});
const draft = (change: Partial<Draft>): Draft => ({
  units: {},
  tool: '',
  place: AT_HOME,
  hidden: [],
  ignore_initial: false,
  settings: {...USUAL},
  ...change
});

test('file names become plain ones, each its own', () => {
  assert.equal(plain_name('Gehäuse (Öl) 2.STEP'), 'Gehause__Ol__2.STEP');
  assert.equal(plain_name('.hidden.stl'), 'hidden.stl');
  assert.ok(
      plain_name('x'.repeat(300) + '.glb').length === 100 &&
      plain_name('x'.repeat(300) + '.glb').endsWith('.glb'));
  const blob = new Blob();
  assert.deepEqual(
      named_apart([
        {name: 'a.stl', blob}, {name: 'a.stl', blob}, {name: '.DS_Store', blob}, {name: 'scene.json', blob}
      ]).map(({name}) => name),
      ['a.stl', 'a_2.stl', 'scene_2.json']);
});

test('sizes are said in words, and a unit is proposed', () => {
  assert.deepEqual(
      [0.0000123, 0.0123, 0.123, 1.5, 1234].map(length_words),
      ['12.3 µm', '12.3 mm', '123 mm', '1.5 m', '1.23 km']);
  assert.equal(size_words({min: [0, 0, 0], max: [120, 80, 5]}, 1e-3), '120 × 80 × 5 mm');
  assert.equal(likely_unit(120, false), 'mm');
  assert.equal(likely_unit(0.12, false), 'm');
  assert.equal(likely_unit(3, true), 'm');
  assert.equal(likely_unit(300, true), 'mm');
});

test('the tree has files, nodes and parts, also parts with others below them', () => {
  const roots = part_tree(assembly(
      [file('a.glb'), file('b.stl')],
      [part(0, 'gear', 0), part(0, 'gear/axle', 1, 5), part(0, 'case/lid', 2), part(1, 'b', 3)]));
  assert.deepEqual(
      roots.map(({name, parts, children}) => [name, parts, children.map((child) => child.name)]),
      [['a.glb', [0, 1, 2], ['gear', 'case']], ['b.stl', [3], ['b']]]);
  const gear = find_node(roots, '0:gear')!;
  assert.deepEqual([gear.parts, gear.triangles, gear.box], [[0, 1], 2, {min: [0, 0, 0], max: [6, 1, 0]}]);
  assert.equal(find_node(roots, '0:none'), null);
});

test('a draft makes a scene: the part is the tool, the rest the mock-up', () => {
  const two = assembly(
      [file('a.glb'), file('b.step', true)], [part(0, 'gear', 0), part(0, 'case', 1), part(1, 'bolt', 2)]);
  const roots = part_tree(two);
  const made = (change: Partial<Draft>, key: string) =>
      scene_of(two, draft({units: {0: 'mm'}, ...change}), find_node(roots, key)!);
  assert.deepEqual(
      made({}, '0:gear').scene['static'],
      [{mesh: 'a.glb', units: 'mm', without: ['gear']}, {mesh: 'b.step'}]);
  assert.deepEqual(made({}, '0:gear').scene['tool'], {mesh: 'a.glb', units: 'mm', part: 'gear'});
  // All that a file has: the file itself, and no mock-up with nothing in it.
  assert.deepEqual(made({}, '1:bolt').scene['tool'], {mesh: 'b.step'});
  assert.deepEqual(made({}, '1:bolt').scene['static'], [{mesh: 'a.glb', units: 'mm'}]);
  assert.equal('device' in made({}, '0:gear').scene, false);
  const placed = made(
      {place: [0, 0, 0.1, 0, 0, 0, 1], ignore_initial: true, settings: {...USUAL, voxel_mm: 2}}, '0:gear');
  assert.deepEqual(
      [
        placed.scene['device'], placed.scene['start'],
        (placed.scene['response'] as {voxel_size: number}).voxel_size
      ],
      [{driver: 'simulated', path: 'path.csv'}, 'ignore_initial', 0.002]);
  const walled = (walls: string) => made({settings: {...USUAL, walls}}, '0:gear').scene;
  assert.deepEqual(walled('auto')['static'], [
    {mesh: 'a.glb', units: 'mm', sheet_thickness: 'auto', without: ['gear']},
    {mesh: 'b.step', sheet_thickness: 'auto'}
  ]);
  assert.deepEqual(
      walled('1.5')['tool'], {mesh: 'a.glb', units: 'mm', sheet_thickness: 0.0015, part: 'gear'});
  for (const right of ['', 'auto', '0.001', '2', '1000']) assert.equal(wrong_walls(right), '');
  for (const wrong of ['0', '-1', '0.0005', '1001', 'thin', '1e9', 'Infinity', '1,5'])
    assert.match(wrong_walls(wrong), /from 0\.001 to 1000 mm/, wrong);
  assert.match(placed.path!, /^time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0\.0000,/);
  const alone = assembly([file('a.stl')], [part(0, 'a', 0)]);
  assert.throws(() => scene_of(alone, draft({}), find_node(part_tree(alone), '0:a')!), /nothing is left/);
});

test('recorded times and poses are written so that they read back', () => {
  const pose: Pose = [0.123456789, -1e-7, 2, 0, 0, Math.SQRT1_2, Math.SQRT1_2];
  const cells = path_text([{time: 0.5, pose}]).trim().split('\n')[1].split(',').map(Number);
  cells.slice(1, 8).forEach((value, i) => assert.ok(Math.abs(value - pose[i]) < 1e-8, `${i}`));
  assert.equal(cells.length, 9);
});

test('undo goes back and redo forth, until something else is decided', () => {
  const history = new History('a');
  history.take('b');
  history.take('b');
  history.take('c');
  assert.deepEqual(
      [history.undo(), history.undo(), history.undo(), history.can_undo], ['b', 'a', 'a', false]);
  assert.equal(history.redo(), 'b');
  history.take('d');
  assert.deepEqual([history.can_redo, history.undo()], [false, 'b']);
});

test('the numbers of a place are those of the middle, and come back', () => {
  const middle = new Vector3(1, 2, 3);
  const place = place_of([10, -20, 30, 20, 30, 40], middle);
  numbers_of(place, middle)
      .forEach(
          (value, i) => assert.ok(Math.abs(value - [10, -20, 30, 20, 30, 40][i]) < 1e-9, `${i}: ${value}`));
  assert.deepEqual(place_of([0, 0, 0, 0, 0, 0], middle), AT_HOME);
});

test('parts are drawn apart though they share vertices, scaled by file, and found by a ray', () => {
  const picture = new PartPicture();
  const square = new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
  const geometry = {
    reduced: true,
    mockup: {vertices: square, corners: new Uint32Array([0, 1, 2, 0, 2, 3]), ids: new Uint32Array([3, 12])},
    tool: {vertices: new Float32Array(), corners: new Uint32Array(), ids: new Uint32Array()}
  };
  const parts = [{...part(0, 'a', 0), triangles: 10}, {...part(0, 'b', 10), triangles: 10}];
  picture.load(geometry, parts, () => 0.5);
  const look = {colour: {r: 1, g: 1, b: 1} as never, hidden: false, with_tool: false};
  picture.show([look, look]);
  const size = (box: Box3): Vec3 => box.getSize(new Vector3()).toArray();
  assert.deepEqual(size(picture.box([0, 1])), [0.5, 0.5, 0]);
  const down = (x: number, y: number) =>
      picture.pick(new Ray(new Vector3(x, y, 5), new Vector3(0, 0, -1)))?.part ?? -1;
  assert.deepEqual([down(0.4, 0.1), down(0.1, 0.4), down(0.9, 0.9)], [0, 1, -1]);
  picture.show([{...look, hidden: true}, {...look, with_tool: true}]);
  picture.tool_matrix.copy(new Matrix4().makeTranslation(10, 0, 0));
  assert.deepEqual([down(0.4, 0.1), down(0.1, 0.4), down(10.1, 0.4)], [-1, -1, 1]);
});

test('the archive is one that others read', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'palpate-zip-')), path = join(folder, 'a.zip');
  const content = new TextEncoder().encode('{"a": 1}');
  writeFileSync(
      path, new Uint8Array(await zip([
                             {name: 'scene.json', bytes: content},
                             {name: 'mesh ü.bin', bytes: Uint8Array.from({length: 70_000}, (_, i) => i & 255)}
                           ]).arrayBuffer()));
  const told = spawnSync(
      'python3',
      [
        '-c',
        'import sys, zipfile; z = zipfile.ZipFile(sys.argv[1]); print(z.testzip(), [(i.filename, i.file_size) for i in z.infolist()], z.read("scene.json").decode())',
        path
      ],
      {encoding: 'utf8'});
  rmSync(folder, {recursive: true});
  assert.equal(
      told.stdout.trim(), 'None [(\'scene.json\', 8), (\'mesh ü.bin\', 70000)] {"a": 1}', told.stderr);
});
