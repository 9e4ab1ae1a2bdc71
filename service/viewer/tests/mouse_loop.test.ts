// The mouse's end of the remote loop: how often it asks, and for what.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {MouseLoop} from '../src/mouse/mouse_loop.js';

import type {Scene} from '../src/server/protocol.js';

const SCENE = {
  id: 's',
  start: [0, 0, 0, 0, 0, 0, 1],
  tool_gc: [0, 0, 0],
  tool_radius: 0.05,
  stiffness: 2000,
  backend: 'cpu'
} as unknown as Scene;
interface Asked {
  seq: number;
  full: boolean;
  area_lists: boolean;
  planes: boolean;
  pose: number[]
}

/** A server that answers when it is told to. */
class Socket {
  readonly CONNECTING = 0;
  readyState = 1;
  asked: Asked[] = [];
  onmessage: (event: {data: string}) => void = () => {};
  onclose = (): void => {};
  send(text: string): void {
    this.asked.push(JSON.parse(text) as Asked);
  }
  close(): void {
    this.onclose();
  }
  say(message: unknown): void {
    this.onmessage({data: JSON.stringify(message)});
  }
  answer(): void {
    const {seq, full, area_lists} = this.asked.at(-1)!;
    const empty = {contact: false, planes: [], force: [0, 0, 0], torque: [0, 0, 0]};
    this.say({
      type: 'wrench',
      seq,
      server_us: 100,
      truncated: false,
      gc: [0, 0, 0],
      engine: 'cpu',
      ...empty,
      ...(full ? {frame: {...empty, areas: [{id: 7, ...(area_lists ? {static: [1], mobile: [2]} : {})}]}} :
                 {})
    });
  }
}

// A clock of our own: what is due then is called then, however busy the machine is.
let clock = 0;
let due: {at: number; call: () => void; id: number}[] = [];
let ids = 0;
Object.defineProperty(globalThis, 'performance', {value: {now: () => clock}, configurable: true});
globalThis.setTimeout = ((call: () => void, ms = 0) => {
                          due.push({at: clock + ms, call, id: ++ids});
                          return ids;
                        }) as unknown as typeof setTimeout;
globalThis.clearTimeout = ((id: number) => {
                            due = due.filter((one) => one.id !== id);
                          }) as unknown as typeof clearTimeout;
function pass(ms: number): void {
  for (const end = clock + ms;;) {
    const next = due.filter(({at}) => at <= end).sort((a, b) => a.at - b.at)[0];
    if (!next) {
      clock = end;
      return;
    }
    due = due.filter((one) => one !== next);
    clock = Math.max(clock, next.at);
    next.call();
  }
}
/** A picture, with a hand that is where the test left it. */
function picture(mouse: MouseLoop, lists = false): void {
  const {held} = mouse.coupling;
  mouse.picture({held, target: mouse.coupling.target(), paused: false}, lists);
}
async function begun() {
  const socket = new Socket();
  const mouse = new MouseLoop(
      SCENE, null, async () => {}, () => socket as unknown as WebSocket, {moved: () => {}, lost: () => {}});
  for (let i = 0; i < 5; ++i) await Promise.resolve();  // the scene is ready
  socket.say(
      {type: 'hello', scene: 's', stiffness: 2000, watchdog_ms: 20, tool_gc: [0, 0, 0], start: SCENE.start});
  return {socket, mouse};
}

test(
    'between two pictures a moving tool is asked about again, and a picture alone asks for its frame',
    async () => {
      const {socket, mouse} = await begun();
      assert.deepEqual(socket.asked.map(({full}) => full), [true]);
      socket.answer();
      mouse.coupling.held = true;
      mouse.coupling.target_position.set(0.1, 0, 0);
      pass(40);  // no picture meanwhile
      assert.ok(socket.asked.length === 2, `${socket.asked.length} questions`);
      assert.equal(socket.asked[1].full, false);
      assert.ok(socket.asked[1].pose[0] > 0);
      mouse.close();
    });

test('a tool that has come to rest is shown with its own frame', async () => {
  const {socket, mouse} = await begun();
  socket.answer();
  mouse.coupling.held = true;
  mouse.coupling.target_position.set(0.001, 0, 0);
  pass(40);
  socket.answer();          // without a frame
  mouse.coupling.let_go();  // nothing moves any more
  picture(mouse);
  pass(30);
  assert.deepEqual([socket.asked.length, socket.asked.at(-1)!.full], [3, true]);
  socket.answer();
  pass(20);
  picture(mouse);
  assert.equal(socket.asked.length, 3);  // at rest nothing is asked
  mouse.close();
});

test('without pictures nothing goes on', async () => {
  const {socket, mouse} = await begun();
  picture(mouse);
  mouse.coupling.held = true;
  mouse.coupling.target_position.set(0.1, 0, 0);
  pass(650);
  const before = socket.asked.length;
  socket.answer();
  pass(50);
  assert.equal(socket.asked.length, before);
  mouse.close();
});

test('planes are asked for, and what has hardly moved since rests', async () => {
  const {socket, mouse} = await begun();
  socket.answer();
  mouse.coupling.held = true;
  mouse.coupling.target_position.set(0.001, 0, 0);
  picture(mouse);
  for (let i = 0, answered = 1; i < 100; ++i) {  // 2 s
    for (; answered < socket.asked.length; ++answered) socket.answer();
    pass(20);
    picture(mouse);
  }
  const {pose, planes, full} = socket.asked.at(-1)!;
  assert.deepEqual([planes, full], [true, true]);
  assert.ok(Math.abs(pose[0] - 0.001) < 1e-6, `${pose[0]} m of 1 mm`);
  const asked = socket.asked.length;
  assert.ok(asked > 10 && asked < 50, `${asked} questions`);
  pass(1000);
  picture(mouse);
  assert.equal(socket.asked.length, asked);
  mouse.close();
});

test('areas\' triangles are asked for seldom, but where they are shown, and at rest', async () => {
  const {socket, mouse} = await begun();
  mouse.coupling.held = true;
  mouse.coupling.target_position.set(0.1, 0, 0);
  const go_on = (ms: number, lists: boolean) => {
    const before = socket.asked.length;
    for (let i = 0, answered = before - 1; i < ms / 20; ++i) {
      for (; answered < socket.asked.length; ++answered) socket.answer();
      pass(20);
      picture(mouse, lists);
    }
    const asked = socket.asked.slice(before);
    return {all: asked.length, with_lists: asked.filter(({area_lists}) => area_lists).length};
  };
  const seldom = go_on(1000, false);
  assert.ok(seldom.all >= 40 && seldom.with_lists >= 4 && seldom.with_lists <= 8, JSON.stringify(seldom));
  const always = go_on(400, true);
  assert.equal(always.with_lists, always.all);
  go_on(100, false);
  mouse.coupling.let_go();  // nothing moves any more
  go_on(100, false);
  assert.ok(socket.asked.at(-1)!.area_lists);
  const asked = socket.asked.length;
  go_on(400, false);
  assert.equal(socket.asked.length, asked);
  mouse.close();
});
