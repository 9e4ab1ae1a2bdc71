// The mouse as the page has it: what it tells its worker, and what it believes.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import type {ToPage, ToWorker} from '../src/mouse/messages.js';
import {MouseSource} from '../src/mouse/mouse_source.js';

import type {Moment} from '../src/moment.js';
import type {Frame, Pose, Scene} from '../src/server/protocol.js';

const SCENE = {
  id: 's',
  start: [0, 0, 0.1, 0, 0, 0, 1],
  tool_gc: [0, 0, 0],
  tool_radius: 0.05,
} as unknown as Scene;

class Beside {
  onmessage: (event: {data: ToPage}) => void = () => {};
  onerror: (event: {message?: string}) => void = () => {};
  told: ToWorker[] = [];
  postMessage(message: ToWorker): void {
    this.told.push(message);
  }
  say(data: ToPage): void {
    this.onmessage({data});
  }
}
function begun(ready: () => Promise<void> = async () => {}) {
  const worker = new Beside();
  const heard: string[] = [];
  const mouse = new MouseSource(
      SCENE, null, {url: 'ws://here/', protocols: []},
      {ready, moved: () => heard.push('moved'), lost: (reason) => heard.push(`lost ${reason}`)},
      worker as unknown as Worker);
  return {worker, heard, mouse};
}
const moment = (pose: Pose): Omit<Moment, 'frame'> => ({
  time: 7,
  pose,
  force: [0, 0, 1],
  torque: [0, 0, 0],
  response: null,
  depth: 0,
  contact: true,
  frame_us: 900,
  late: 2,
  stage: 0,
  note: ''
});
const FRAME = {
  tick: 3
} as unknown as Frame;

test('what the loop says is the moment; a frame stays until there is another', () => {
  const {worker, heard, mouse} = begun();
  assert.deepEqual([mouse.moment().note, mouse.moment().pose], ['connecting', SCENE.start]);
  worker.say({type: 'moment', turn: 0, moment: moment([0, 0, 0.09, 0, 0, 0, 1]), frame: FRAME, asked_at: 1});
  worker.say({type: 'moment', turn: 0, moment: moment([0, 0, 0.08, 0, 0, 0, 1]), asked_at: 2});
  const {pose, frame, time} = mouse.moment();
  assert.deepEqual([pose[2], frame, heard.length], [0.08, FRAME, 2]);
  assert.ok(time < 5, 'times are the page\'s');
  worker.say({type: 'moment', turn: 0, moment: moment(pose), frame: null, asked_at: 3});
  assert.equal(mouse.moment().frame, null);
});
test('an open hand goes with the tool, one that holds it stays', () => {
  const {worker, mouse} = begun();
  worker.say({type: 'moment', turn: 0, moment: moment([0, 0, 0.05, 0, 0, 0, 1]), asked_at: 1});
  assert.equal(mouse.hand.target_position.z, 0.05);
  mouse.hand.held = true;
  mouse.hand.target_position.z = 0.01;
  worker.say({type: 'moment', turn: 0, moment: moment([0, 0, 0.04, 0, 0, 0, 1]), asked_at: 2});
  mouse.advance(false);
  assert.deepEqual([mouse.hand.position.z, mouse.hand.target_position.z], [0.04, 0.01]);
  const told = worker.told.at(-1)!;
  assert.ok(told.type === 'picture' && told.hand.held && told.hand.target[2] === 0.01);
  mouse.paused = true;
  mouse.advance(false);
  const open = worker.told.at(-1)!;
  assert.ok(open.type === 'picture' && !open.hand.held && open.hand.paused && open.hand.target[2] === 0.04);
});
test('after a restart nothing from before it counts', () => {
  const {worker, mouse} = begun();
  worker.say({type: 'moment', turn: 0, moment: moment([0, 0, 0.05, 0, 0, 0, 1]), asked_at: 1});
  mouse.restart();
  worker.say({type: 'moment', turn: 0, moment: moment([0, 0, 0.04, 0, 0, 0, 1]), asked_at: 2});
  assert.deepEqual([mouse.moment().pose, mouse.moment().note], [SCENE.start, 'connecting']);
  const told = worker.told.at(-1)!;
  assert.ok(told.type === 'restart');
  worker.say({type: 'moment', turn: told.turn, moment: moment([0, 0, 0.03, 0, 0, 0, 1]), asked_at: 3});
  assert.equal(mouse.moment().pose[2], 0.03);
});
test('the page says whether the server holds the scene', async () => {
  for (const ready of [true, false]) {
    const {worker, heard, mouse} = begun(async () => {
      if (!ready) throw new Error('no');
    });
    worker.say({type: 'prepare'});
    for (let i = 0; i < 5; ++i) await Promise.resolve();
    assert.deepEqual(worker.told.at(-1), {type: 'prepared', ready});
    worker.say({type: 'lost', reason: 'the server stops'});
    assert.deepEqual(heard, ['lost the server stops']);
    mouse.close();
    assert.deepEqual(worker.told.at(-1), {type: 'close'});
  }
});
test('a worker that fails leaves no force, and is told', () => {
  const {worker, heard, mouse} = begun();
  worker.say({type: 'moment', turn: 0, moment: moment([0, 0, 0.09, 0, 0, 0, 1]), frame: FRAME, asked_at: 1});
  assert.equal(mouse.moment().force[2], 1);
  worker.onerror({message: 'no such thing'});
  assert.deepEqual([mouse.moment().force, mouse.moment().note], [[0, 0, 0], 'stopped']);
  worker.onerror({});  // a script that can't be had has no message
  assert.match(heard.at(-2)!, /^lost .*has failed: no such thing\./);
  assert.match(heard.at(-1)!, /^lost .*has failed to load\./);
});

test('a frame without its areas\' triangles leaves the last that has them', () => {
  const {worker, mouse} = begun();
  const told = (id: number, lists: boolean) => {
    const frame = {tick: id, contact: true, areas: [{id, ...(lists ? {static: [id], mobile: [id]} : {})}]};
    worker.say({
      type: 'moment',
      turn: 0,
      moment: moment(SCENE.start!),
      frame: frame as unknown as Frame,
      asked_at: id
    });
    const {frame: newest, listed} = mouse.moment();
    return [newest?.tick, listed?.tick];
  };
  assert.deepEqual([told(1, true), told(2, false), told(3, true)], [[1, 1], [2, 1], [3, 3]]);
});
