// When the page does something, and when it rests.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {Stillness, type Moment} from '../src/moment.js';
import {Paced} from '../src/paced.js';
import {Wakefulness, type Next} from '../src/wakefulness.js';

interface Timer {
  at: number;  // ms
  call: () => void;
}

/** Stands in for the clock and for timers while `body` runs; it gets what lets time go on. */
function with_clock(body: (pass: (ms: number) => void) => void): void {
  const [now, set, clear] = [performance.now, globalThis.setTimeout, globalThis.clearTimeout];
  let time = 1000, last = 0;
  const timers = new Map<number, Timer>();
  performance.now = () => time;
  globalThis.setTimeout = ((call: () => void, ms: number) => {
                            timers.set(++last, {at: time + ms, call});
                            return last;
                          }) as unknown as typeof setTimeout;
  globalThis.clearTimeout = ((id: number) => timers.delete(id)) as unknown as typeof clearTimeout;
  try {
    body((ms) => {
      time += ms;
      for (const [id, {at, call}] of [...timers])
        if (at <= time && timers.delete(id)) call();
    });
  } finally {
    performance.now = now;
    globalThis.setTimeout = set;
    globalThis.clearTimeout = clear;
  }
}

test(
    'what is wanted often is done at its pace, and once after the last time',
    () => with_clock((pass) => {
      let done = 0;
      const paced = new Paced(100, () => ++done);
      paced.want();
      assert.equal(done, 1, 'at once');
      for (let i = 0; i < 9; ++i) {
        pass(10);
        paced.want();
      }
      assert.equal(done, 1);
      pass(10);
      assert.equal(done, 2, 'after the pause');
      pass(1000);
      assert.equal(done, 2, 'no more than was wanted');
    }));

class Drawn {
  presenting = false;
  waiting: ((now: number) => void)[] = [];
  before_next(call: (now: number) => void): void {
    this.waiting.push(call);
  }
  draw(now: number): void {
    for (const call of this.waiting.splice(0)) call(now);
  }
}

test(
    'a page asks for a picture once, looks after a while, or rests',
    () => with_clock((pass) => {
      const view = new Drawn();
      let next: Next = 'rest';
      const seconds: number[] = [];
      const page = new Wakefulness(view, (now) => seconds.push(page.seconds(now)), () => next);
      page.wake();
      page.wake();
      assert.equal(view.waiting.length, 1, 'once');
      next = 'picture';
      view.draw(5000);
      assert.equal(view.waiting.length, 1, 'and goes on');
      view.draw(5020);
      view.draw(9000);
      next = 'look';
      view.draw(9030);
      assert.equal(view.waiting.length, 0);
      pass(99);
      assert.equal(view.waiting.length, 0);
      pass(1);
      assert.equal(view.waiting.length, 1, 'a look');
      next = 'rest';
      view.draw(9200);
      pass(1000);
      assert.equal(view.waiting.length, 0, 'it rests');
      // No time before the first picture and after a rest; no leap while the page was hidden.
      assert.deepEqual(seconds.map((s) => Math.round(1000 * s)), [0, 20, 250, 30, 0]);
      view.presenting = true;
      page.wake();
      assert.equal(view.waiting.length, 0, 'a headset asks for pictures by itself');
    }));

test('a mouse rests where pose, force, frame and note are the same', () => {
  const still = new Stillness();
  const frame = {tick: 3};
  const moment = (change: object = {}) =>
      ({pose: [0, 0, 0, 0, 0, 0, 1], force: [0, 0, 0], note: '', frame, ...change}) as unknown as Moment;
  assert.ok(!still.is_still(moment(), null), 'the first');
  assert.ok(still.is_still(moment(), null));
  for (const change of [{force: [0, 0, 1]}, {note: 'paused'}, {frame: {tick: 3}}, {pose: [1]}]) {
    assert.ok(!still.is_still(moment(change), null), JSON.stringify(change));
    assert.ok(still.is_still(moment(change), null), 'then it is again');
  }
  assert.ok(!still.is_still(moment({pose: [1]}), 'tool'), 'something else is held');
});
