// The mouse's tool against a wall that answers late, as a server does.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Quaternion} from 'three';
import {Coupling, type Answer} from '../src/mouse/coupling.js';

const STIFFNESS = 2000;  // N/m

/** What a server would answer for a point tool and the wall z < 0. */
function wall(coupling: Coupling): Answer {
  const gc = coupling.gc();
  const depth = Math.max(0, -gc.z);
  const areas = depth === 0 ? [] : [{
    id: 0,
    normal: [0, 0, 1] as [number, number, number],
    depth,
    point: gc.toArray(),
    force: [0, 0, STIFFNESS * depth] as [number, number, number],
    torque: [0, 0, 0] as [number, number, number]
  }];
  return {gc: gc.toArray(), rotation: coupling.rotation.clone(), areas};
}
function pushed(late: number): {coupling: Coupling; lowest: number} {
  const coupling = new Coupling();
  coupling.stiffness = STIFFNESS;
  coupling.reset([0, 0, 0.01, 0, 0, 0, 1], [0, 0, 0]);
  coupling.held = true;
  coupling.target_position.set(0.02, 0, -0.05);  // the hand goes 50 mm into the wall
  const answers: Answer[] = [];
  let lowest = 0;
  for (let i = 0; i < 500; ++i) {  // 2 s
    answers.push(wall(coupling));
    coupling.advance(0.004, answers[Math.max(0, i - late)]);
    lowest = Math.min(lowest, coupling.position.z);
  }
  return {coupling, lowest};
}

test(
    'contact stops the tool where its force and the hand\'s limit balance, and it slides along the wall',
    () => {
      for (const late of [0, 3]) {  // answers up to 12 ms old
        const {coupling, lowest} = pushed(late);
        const limit = STIFFNESS * 0.05 * 0.06;  // N: the hand's pull, for a tool of 50 mm
        assert.ok(
            Math.abs(coupling.force.z - limit) < 0.05 * limit,
            `${coupling.force.z} N against ${limit} N, ${late} steps late`);
        assert.ok(
            coupling.force.z > 0 && coupling.position.z > -0.0035,
            `${coupling.position.z} m`);  // 3 mm is 6 N
        assert.ok(lowest > -0.02, `${lowest} m at most`);
        assert.ok(Math.abs(coupling.position.x - 0.02) < 0.006, `${coupling.position.x} m along the wall`);
      }
    });
test('without an answer nothing moves and nothing is felt', () => {
  const coupling = new Coupling();
  coupling.reset([0, 0, 0, 0, 0, 0, 1], [0, 0, 0]);
  coupling.held = true;
  coupling.target_position.set(1, 0, 0);
  coupling.advance(1, null);
  assert.deepEqual([coupling.position.x, coupling.force.length()], [0, 0]);
});
test('the hand lets go: contact pushes the tool out, and no force is left', () => {
  const {coupling} = pushed(0);
  assert.ok(coupling.force.length() > 1);
  coupling.let_go();
  for (let i = 0; i < 250; ++i) coupling.advance(0.004, wall(coupling));
  assert.ok(coupling.force.length() < 0.01, `${coupling.force.length()} N`);
});
test('no area pulls, however far the tool went since the answer', () => {
  const coupling = new Coupling();
  coupling.reset([0, 0, 0.03, 0, 0, 0, 1], [0, 0, 0]);
  coupling.advance(0.004, {
    gc: [0, 0, -0.001],
    rotation: new Quaternion(),
    areas: [{id: 0, normal: [0, 0, 1], depth: 0.001, point: [0, 0, 0], force: [0, 0, 2], torque: [0, 0, 0]}]
  });
  assert.equal(coupling.force.z, 0);
});
test('turning about the centre of mass leaves it where it is', () => {
  const coupling = new Coupling();
  coupling.reset([0, 0, 0, 0, 0, 0, 1], [0.1, 0, 0]);
  coupling.held = true;
  coupling.target_rotation.setFromAxisAngle({x: 0, y: 0, z: 1} as never, 0.5);
  const centre = coupling.gc();
  coupling.target_position.add(
      centre.clone().sub(coupling.gc(coupling.target_position, coupling.target_rotation)));
  for (let i = 0; i < 1000; ++i)
    coupling.advance(0.004, {gc: centre.toArray(), rotation: coupling.rotation.clone(), areas: []});
  assert.ok(coupling.gc().distanceTo(centre) < 1e-6);
  assert.ok(
      coupling.rotation.angleTo(coupling.target_rotation) < 1e-3,
      `${coupling.rotation.angleTo(coupling.target_rotation)} rad`);
});
