// When a question is asked so that its answer just makes the next picture.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {PictureClock} from '../src/mouse/picture_clock.js';

function clock_of(pictures: number[], rounds: number[]): PictureClock {
  const clock = new PictureClock();
  for (const at of pictures) clock.tick(at);
  for (const round of rounds) clock.answered(round);
  return clock;
}

test('a question is sent so long before the next picture as the longest answer but two took', () => {
  const late = [1000, 1033, 1066, 1116, 1149];  // one of them is
  assert.ok(Number.isNaN(clock_of([], [10]).ask_at(0)), 'no picture yet');
  assert.ok(Number.isNaN(clock_of([1000], [10]).ask_at(0)), 'one is no row');
  assert.equal(clock_of(late, []).ask_at(1135), 1149 + 33 - 3, 'nothing is answered yet');
  assert.equal(clock_of(late, [10]).ask_at(1135), 1149 + 33 - 13);
  assert.equal(clock_of(late, [10, 15, 8, 90, 9, 17]).ask_at(1135), 1149 + 33 - 18);
  assert.equal(clock_of(late, [100, 100, 100]).ask_at(1100), 1149, 'longer than a picture: at once');
});
test('what took long is forgotten', () => {
  const rounds = [80, 80, 80, ...new Array<number>(13).fill(10)];
  assert.equal(clock_of([0, 33, 66], rounds).ask_at(0), 66, 'remembered');
  assert.equal(clock_of([0, 33, 66], [...rounds, 10]).ask_at(50), 66 + 33 - 13);
});
test('one that was sent late enough does for the picture', () => {
  const clock = clock_of([0, 33, 66], [15]);
  assert.ok(Number.isNaN(clock.ask_at(80)));
  assert.equal(clock.ask_at(70), 81);
});
test('after a rest there is no row of pictures', () => {
  const clock = clock_of([0, 33, 66, 500], [15]);
  assert.ok(Number.isNaN(clock.ask_at(0)));
  clock.tick(533);
  assert.equal(clock.ask_at(500), 533 + 33 - 18);
});
