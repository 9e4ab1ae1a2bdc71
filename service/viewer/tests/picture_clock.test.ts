// When a question is asked so that its answer just makes the next picture.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {PictureClock} from '../src/mouse/picture_clock.js';

test('a question is sent so long before the next picture as its answer takes, and half as long again', () => {
  const clock = new PictureClock();
  assert.ok(Number.isNaN(clock.ask_at(10, 0)), 'no picture yet');
  clock.tick(1000);
  assert.ok(Number.isNaN(clock.ask_at(10, 0)), 'one is no row');
  for (const at of [1033, 1066, 1116, 1149]) clock.tick(at);  // one of them late
  assert.equal(clock.ask_at(10, 1135), 1149 + 33 - 19);
  assert.equal(clock.ask_at(100, 1100), 1149, 'longer than a picture: at once');
});
test('one that was sent late enough does for the picture', () => {
  const clock = new PictureClock();
  for (const at of [0, 33, 66]) clock.tick(at);
  assert.ok(Number.isNaN(clock.ask_at(10, 80)));
  assert.equal(clock.ask_at(10, 70), 80);
});
test('after a rest there is no row of pictures', () => {
  const clock = new PictureClock();
  for (const at of [0, 33, 66, 500]) clock.tick(at);
  assert.ok(Number.isNaN(clock.ask_at(10, 0)));
  clock.tick(533);
  assert.equal(clock.ask_at(10, 500), 533 + 33 - 19);
});
