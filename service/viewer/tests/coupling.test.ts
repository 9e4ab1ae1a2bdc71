// The mouse's tool against a wall that answers late, as a server does.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Quaternion} from 'three';
import {Coupling, type Answer} from '../src/mouse/coupling.js';
import type {Plane} from '../src/server/protocol.js';

const STIFFNESS = 2000;  // N/m

/**
 * What a server would answer for a point tool and a wall z < 0 that is `firm` times as stiff as the spring.
 */
function wall(coupling: Coupling, firm: number): Answer {
  const gc = coupling.gc(), stiffness = firm * STIFFNESS;
  const planes: Plane[] =
      gc.z < 0 ? [{normal: [0, 0, 1], lever: [0, 0, 0], force: -stiffness * gc.z, stiffness}] : [];
  return {gc: gc.toArray(), rotation: coupling.rotation.clone(), planes};
}
function pushed(late: number, firm = 1): {coupling: Coupling; lowest: number} {
  const coupling = new Coupling();
  coupling.stiffness = STIFFNESS;
  coupling.reset([0, 0, 0.01, 0, 0, 0, 1], [0, 0, 0]);
  coupling.held = true;
  coupling.target_position.set(0.02, 0, -0.05);  // the hand goes 50 mm into the wall
  const answers: Answer[] = [];
  let lowest = 0;
  for (let i = 0; i < 500; ++i) {  // 2 s
    answers.push(wall(coupling, firm));
    coupling.advance(0.004, answers[Math.max(0, i - late)]);
    lowest = Math.min(lowest, coupling.position.z);
  }
  return {coupling, lowest};
}

test(
    'contact stops the tool where its force and the hand\'s limit balance, and it slides along the wall',
    () => {
      for (const late of [0, 3])  // answers up to 12 ms old
        for (const firm of [1, 30, 1000]) {
          const {coupling, lowest} = pushed(late, firm);
          const limit = STIFFNESS * 0.05 * 0.06;  // N: the hand's pull, for a tool of 50 mm
          const told = `${firm} times as firm, ${late} steps late`;
          assert.ok(
              Math.abs(coupling.force.z - limit) < 0.05 * limit,
              `${coupling.force.z} N against ${limit} N, ${told}`);
          // 3 mm is 6 N at the spring's own stiffness
          assert.ok(
              Math.abs(coupling.position.z + 0.003 / firm) < 2e-4 / firm,
              `${coupling.position.z} m, ${told}`);
          assert.ok(lowest > -0.02, `${lowest} m at most, ${told}`);
          assert.ok(
              Math.abs(coupling.position.x - 0.02) < 0.001,
              `${coupling.position.x} m along the wall, ${told}`);
        }
    });
test('between two walls the tool stands in the middle, and a couple turns it', () => {
  const coupling = new Coupling();
  coupling.stiffness = STIFFNESS;
  coupling.reset([0, 0, 0.001, 0, 0, 0, 1], [0, 0, 0]);
  coupling.held = true;
  coupling.target_position.set(0, 0, 0.001);
  const stiffness = 50 * STIFFNESS;
  for (let i = 0; i < 250; ++i) {
    // Two pads above and two below, 10 mm to either side; each is pressed in by a millimetre to begin with.
    const z = coupling.gc().z, turn = 2 * coupling.rotation.y;
    const planes: Plane[] = [-1, 1].flatMap((up) => [-0.01, 0.01].map((x): Plane => {
      const depth = 0.001 + up * (z - x * turn);
      return {normal: [0, 0, -up], lever: [0, up * x, 0], force: stiffness * depth, stiffness};
    }));
    coupling.advance(0.004, {gc: coupling.gc().toArray(), rotation: coupling.rotation.clone(), planes});
    if (i === 0) coupling.rotation.setFromAxisAngle({x: 0, y: 1, z: 0} as never, 0.01);
  }
  // The spring of a quarter of K against 4 walls of 50 K each, a millimetre away from the middle.
  const apart = 0.001 * 0.25 / (0.25 + 4 * 50);
  assert.ok(Math.abs(coupling.gc().z - apart) < 0.05 * apart, `${coupling.gc().z} m for ${apart} m`);
  assert.ok(coupling.rotation.angleTo(coupling.target_rotation) < 1e-4, 'righted');
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
  for (let i = 0; i < 250; ++i) coupling.advance(0.004, wall(coupling, 1));
  assert.ok(coupling.force.length() < 0.01, `${coupling.force.length()} N`);
});
test('no plane pulls, however far the tool went since the answer', () => {
  const coupling = new Coupling();
  coupling.reset([0, 0, 0.03, 0, 0, 0, 1], [0, 0, 0]);
  coupling.advance(0.004, {
    gc: [0, 0, -0.001],
    rotation: new Quaternion(),
    planes: [{normal: [0, 0, 1], lever: [0, 0, 0], force: 2, stiffness: STIFFNESS}]
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
    coupling.advance(0.004, {gc: centre.toArray(), rotation: coupling.rotation.clone(), planes: []});
  assert.ok(coupling.gc().distanceTo(centre) < 1e-6);
  assert.ok(
      coupling.rotation.angleTo(coupling.target_rotation) < 1e-3,
      `${coupling.rotation.angleTo(coupling.target_rotation)} rad`);
});
