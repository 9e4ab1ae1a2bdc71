// The mouse's connection, with sockets and a clock of our own: one connection at a time, and no word from one
// that was left.
import assert from 'node:assert/strict';
import {afterEach, beforeEach, test} from 'node:test';

import {HapticLink} from '../src/mouse/haptic_link.js';

class FakeSocket {
  readonly CONNECTING = 0;
  readyState = 0;
  closes = 0;
  onopen: (() => void)|null = null;
  onclose: (() => void)|null = null;
  onmessage: ((event: {data: string}) => void)|null = null;
  sent: string[] = [];
  accept(): void {
    this.readyState = 1;
    this.onopen?.();
  }
  say(message: object): void {
    this.onmessage?.({data: JSON.stringify(message)});
  }
  send(text: string): void {
    this.sent.push(text);
  }
  close(): void {
    ++this.closes;
    this.readyState = 2;
  }
  end(): void {
    this.readyState = 3;
    this.onclose?.();
  }
}

const HELLO = {
  type: 'hello',
  stiffness: 2000
};
let sockets: FakeSocket[] = [];
let heard: string[] = [];
let gates: {open: () => void; refuse: () => void}[] = [];
/** Promises that are settled have been heard. */
const settle = async(): Promise<void> => {
  for (let i = 0; i < 5; ++i) await Promise.resolve();
};

function make(): HapticLink {
  return new HapticLink(
      () => new Promise<void>((open, refuse) => {
        gates.push({open, refuse: () => refuse(new Error('no'))});
      }),
      () => {
        const socket = new FakeSocket();
        sockets.push(socket);
        return socket as unknown as WebSocket;
      },
      {
        hello: () => heard.push('hello'),
        wrench: (wrench) => heard.push(`wrench ${wrench.seq}`),
        lost: (reason) => heard.push(`lost ${reason}`)
      });
}
async function connected(): Promise<HapticLink> {
  const link = make();
  link.open();
  gates[0].open();
  await settle();
  sockets[0].accept();
  sockets[0].say(HELLO);
  return link;
}
const living = (): number => sockets.filter((socket) => socket.readyState < 2 && socket.closes === 0).length;

// node:test's own clock is called differently in node 18 and 20.
const real = {
  setTimeout: globalThis.setTimeout,
  clearTimeout: globalThis.clearTimeout
};
let due: {at: number; work: () => void}[] = [];
let time = 0;
function tick(ms: number): void {
  time += ms;
  for (const timer of due.filter(({at}) => at <= time)) {
    due = due.filter((other) => other !== timer);
    timer.work();
  }
}
beforeEach(() => {
  [sockets, heard, gates, due] = [[], [], [], []];
  Object.assign(globalThis, {
    setTimeout: (work: () => void, ms: number) => {
      const timer = {at: time + ms, work};
      due.push(timer);
      return timer;
    },
    clearTimeout: (timer: unknown) => {
      due = due.filter((other) => other !== timer);
    },
  });
});
afterEach(() => {
  Object.assign(globalThis, real);
});

test('off, preparing, connecting, open; only then is anything sent', async () => {
  const link = make();
  assert.equal(link.state, 'off');
  link.open();
  link.open();  // once more changes nothing
  assert.equal(gates.length, 1);
  link.send('early');
  gates[0].open();
  await settle();
  assert.equal(link.state, 'connecting');
  sockets[0].accept();
  link.send('early');
  sockets[0].say(HELLO);
  assert.equal(link.state, 'open');
  link.send('pose');
  sockets[0].say({type: 'wrench', seq: 1});
  assert.deepEqual(sockets[0].sent, ['pose']);
  assert.deepEqual(heard, ['hello', 'wrench 1']);
});

test(
    'closed and opened again while the first connection begins: the first is closed once it is open, and not heard',
    async () => {
      const link = make();
      link.open();
      gates[0].open();
      await settle();
      link.close();
      link.open();
      gates[1].open();
      await settle();
      assert.equal(sockets.length, 2);
      assert.equal(sockets[0].closes, 0, 'a browser reports a connection that is closed before it is open');
      sockets[0].accept();
      assert.equal(sockets[0].closes, 1);
      sockets[0].say(HELLO);
      sockets[0].end();
      assert.equal(link.state, 'connecting');
      sockets[1].accept();
      sockets[1].say(HELLO);
      assert.equal(link.state, 'open');
      assert.deepEqual(heard, ['hello']);
      assert.equal(living(), 1);
    });

test('closed while the scene is made ready: no connection', async () => {
  const link = make();
  link.open();
  link.close();
  gates[0].open();
  await settle();
  assert.equal(link.state, 'off');
  assert.equal(sockets.length, 0);
});

test('lost, found again by itself, with one connection', async () => {
  const link = await connected();
  sockets[0].say({type: 'bye', reason: 'the server stops'});
  sockets[0].end();
  assert.equal(link.state, 'waiting');
  assert.deepEqual(heard, ['hello', 'lost the server stops']);
  tick(1500);
  assert.equal(link.state, 'preparing');
  gates[1].refuse();
  await settle();
  assert.equal(link.state, 'waiting');
  link.hurry();
  link.hurry();  // once
  assert.equal(gates.length, 3);
  tick(10_000);  // the wait that was cut short begins nothing of its own
  assert.equal(gates.length, 3);
  gates[2].open();
  await settle();
  sockets[1].accept();
  sockets[1].say(HELLO);
  assert.equal(link.state, 'open');
  assert.equal(living(), 1);
});

test('a server that accepts and says nothing is left', async () => {
  const link = make();
  link.open();
  gates[0].open();
  await settle();
  sockets[0].accept();
  tick(20_000);
  assert.equal(link.state, 'waiting');
  assert.equal(sockets[0].closes, 1);
  const open = await (async () => {
    tick(1500);
    gates[1].open();
    await settle();
    sockets[1].accept();
    sockets[1].say(HELLO);
    return link.state;
  })();
  assert.equal(open, 'open');
  tick(60_000);
  assert.equal(link.state, 'open', 'the wait for a hello is over with it');
});

test('closed for good: no timer, no word', async () => {
  const link = await connected();
  sockets[0].end();
  link.close();
  tick(60_000);
  assert.equal(gates.length, 1);
  assert.equal(link.state, 'off');
});
