// The tool between the mouse and the mock-up: a spring pulls it to where the mouse is, contact pushes it
// back, and it moves without inertia. The planes of the last answer say how contact goes on where the tool
// has got to since, as they do to the control law (docs/CONTROL.md): held forces would make it jitter.
import {Quaternion, Vector3} from 'three';

import {Hand} from './hand.js';
import {solve_symmetric} from './solve_symmetric.js';

import type {Plane, Pose, Vec3} from '../server/protocol.js';

export interface Answer {
  gc: Vec3;
  rotation: Quaternion;
  planes: Plane[]
}

const STEP_S = 0.004;
const SETTLE_S = 0.01;       // what contact and spring as stiff as the mock-up would settle in
const SPRING_SHARE = 0.25;   // of the mock-up's stiffness: contact wins
const DEEPEST_SHARE = 0.06;  // of the tool's radius: as far as a spring of the mock-up's stiffness may give
const TURN_SHARE = 0.4;      // a solid's radius of gyration squared, over its radius squared
const WAY_SHARE = 0.05, TURN_STEP = 0.05;  // of the tool's radius, and rad: no step leads further

function rotation_vector(rotation: Quaternion): Vector3 {
  const q = rotation.w < 0 ? new Quaternion(-rotation.x, -rotation.y, -rotation.z, -rotation.w) : rotation;
  const sine = Math.hypot(q.x, q.y, q.z);
  const scale = sine < 1e-9 ? 2 : (2 * Math.atan2(sine, q.w)) / sine;
  return new Vector3(q.x, q.y, q.z).multiplyScalar(scale);
}
const vector = (v: Vec3): Vector3 => new Vector3(v[0], v[1], v[2]);

export class Coupling extends Hand {
  /** Of the last step: on the tool, about its centre of mass. */
  readonly force = new Vector3();
  readonly torque = new Vector3();
  stiffness = 2000;  // N/m
  private rest = 0;

  override reset(pose: Pose, centre: Vec3): void {
    super.reset(pose, centre);
    this.force.set(0, 0, 0);
    this.torque.set(0, 0, 0);
  }

  /** Moves on by `seconds`, against the newest answer; with none the tool stands still and feels nothing. */
  advance(seconds: number, answer: Answer|null): void {
    if (!answer) {
      this.force.set(0, 0, 0);
      this.torque.set(0, 0, 0);
      this.rest = 0;
      return;
    }
    this.rest = Math.min(this.rest + seconds, 0.1);
    if (this.rest < STEP_S) return;
    for (; this.rest >= STEP_S; this.rest -= STEP_S) this.step(answer);
    this.feel(answer, null);
  }

  /** What contact pushes where the tool is; adds to `slope`, 6 × 6, how that gives way. */
  private feel(answer: Answer, slope: Float64Array|null): void {
    const moved = this.gc().sub(vector(answer.gc));
    const turned = rotation_vector(this.rotation.clone().multiply(answer.rotation.clone().invert()));
    this.force.set(0, 0, 0);
    this.torque.set(0, 0, 0);
    for (const {normal, lever, force, stiffness} of answer.planes) {
      const along = [...normal, ...lever];
      const way = along[0] * moved.x + along[1] * moved.y + along[2] * moved.z + along[3] * turned.x +
          along[4] * turned.y + along[5] * turned.z;
      const push = force - stiffness * way;
      if (!(push > 0)) continue;
      this.force.addScaledVector(vector(normal), push);
      this.torque.addScaledVector(vector(lever), push);
      if (!slope) continue;
      for (let row = 0; row < 6; ++row)
        for (let column = 0; column <= row; ++column)
          slope[6 * row + column] += stiffness * along[row] * along[column];
    }
  }

  /**
   * Without inertia, what pushes is velocity times a damping. The spring and the planes are taken where the
   * step leads, so that no wall is too stiff for it.
   */
  private step(answer: Answer): void {
    const slope = new Float64Array(36);
    this.feel(answer, slope);
    // The hand: a spring with a limit, so that nobody presses through a wall.
    if (!this.held) this.let_go();
    const spring = this.stiffness * SPRING_SHARE;
    const gc = this.gc();
    const pull = this.gc(this.target_position, this.target_rotation).sub(gc).multiplyScalar(spring);
    pull.clampLength(0, this.stiffness * this.radius * DEEPEST_SHARE);
    const inertia = TURN_SHARE * this.radius * this.radius;
    const twist = rotation_vector(this.target_rotation.clone().multiply(this.rotation.clone().invert()))
                      .multiplyScalar(spring * inertia);
    twist.clampLength(0, this.stiffness * this.radius * this.radius * DEEPEST_SHARE);

    const damping = (spring + this.stiffness) * SETTLE_S;
    for (let axis = 0; axis < 6; ++axis)
      slope[7 * axis] += (spring + damping / STEP_S) * (axis < 3 ? 1 : inertia);
    const step =
        solve_symmetric(slope, [...pull.add(this.force).toArray(), ...twist.add(this.torque).toArray()]);
    const way = new Vector3(step[0], step[1], step[2]).clampLength(0, this.radius * WAY_SHARE);
    const turn = new Vector3(step[3], step[4], step[5]).clampLength(0, TURN_STEP);
    const angle = turn.length();
    const next_gc = gc.add(way);
    if (angle > 1e-12)
      this.rotation.premultiply(new Quaternion().setFromAxisAngle(turn.divideScalar(angle), angle))
          .normalize();
    this.position.copy(next_gc.sub(this.centre.clone().applyQuaternion(this.rotation)));
  }
}
