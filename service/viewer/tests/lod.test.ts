// When pictures are drawn coarsely, and when another level of detail is asked for.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {LevelKeeper, next_level} from '../src/draw/lod.js';

test('where pixels take the time, they go before triangles do', () => {
  const keeper = new LevelKeeper();
  keeper.may_coarsen = true;
  const feed = (ms: number, pictures: number) => {
    for (let i = 0; i < pictures; ++i) keeper.take(ms, 1e6);
    return [keeper.coarse, keeper.level];
  };
  assert.deepEqual(
      [feed(30, 40), feed(60, 25), feed(30, 40), feed(60, 25), feed(5, 40)],
      [[false, 1], [true, 1], [true, 1], [true, 0], [true, 0]]);
});
test(
    'down when pictures are slow, up when they are fast and there is more, and not back to one that was slow',
    () => {
      assert.deepEqual(
          [
            next_level(1, 60, 1e6), next_level(0, 60, 1e6), next_level(1, 5, 1e6), next_level(1, 5, 1e5),
            next_level(1, 20, 1e6)
          ],
          [0, 0, 2, 1, 1]);
      const keeper = new LevelKeeper();
      const feed = (ms: number) => {
        for (let i = 0; i < 40; ++i) keeper.take(ms, 1e6);
        return keeper.level;
      };
      assert.deepEqual([feed(5), feed(60), feed(5)], [2, 1, 1]);
    });
test('pictures of a second go down after a few, two levels at once; one that waited does not decide', () => {
  const keeper = new LevelKeeper();
  keeper.level = 3;
  assert.deepEqual([1000, 1000, 1000, 1000].map((ms) => keeper.take(ms, 1e7)), [false, false, false, true]);
  assert.equal(keeper.level, 1);
  const waited = new LevelKeeper();
  assert.deepEqual([25, 3000, 25, 25].map((ms) => waited.take(ms, 1e7)), [false, false, false, false]);
  assert.equal(waited.level, 1);
  const stutters = new LevelKeeper();
  for (let i = 0; i < 8; ++i)
    stutters.take(i % 2 ? 16 : 500, 1e7);  // two pictures at once, then none for long
  assert.equal(stutters.level, 0);
});
test('pictures in time with old answers are slow, too', () => {
  const keeper = new LevelKeeper();
  keeper.may_coarsen = true;
  const feed = (answer_ms: number) => {
    for (let i = 0; i < 40; ++i) keeper.take(33, 1e6, answer_ms);
    return keeper.coarse;
  };
  assert.deepEqual([feed(15), feed(25)], [false, true]);
});
test('one late picture in forty decides nothing', () => {
  const keeper = new LevelKeeper();
  keeper.may_coarsen = true;
  for (let i = 0; i < 200; ++i) keeper.take(i % 40 === 0 ? 600 : 33, 1e6, i % 40 === 0 ? 200 : 12);
  assert.ok(!keeper.coarse);
});
