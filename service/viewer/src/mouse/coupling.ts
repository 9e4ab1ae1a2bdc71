// The tool between the mouse and the mock-up: a spring pulls it to where the mouse is, contact pushes it
// back, and it moves without inertia. The answer is carried on along each area's own line, F = max(0, depth −
// n·Δx)·K, as docs/SERVICE.md asks of a far loop: held forces would make it jitter.
import {Quaternion, Vector3} from 'three';
import type {Area, Pose, Vec3} from '../server/protocol.js';

export interface Answer {
  gc: Vec3;
  rotation: Quaternion;
  areas: Area[]
}

const STEP_S = 0.002;
const SETTLE_S = 0.01;       // time in which contact settles
const SPRING_SHARE = 0.25;   // of the mock-up's stiffness: contact wins
const DEEPEST_SHARE = 0.06;  // of the tool's radius: as deep as the hand may press
const TURN_SHARE = 0.4;      // a solid's radius of gyration squared, over its radius squared

function rotation_vector(rotation: Quaternion): Vector3 {
  const q = rotation.w < 0 ? new Quaternion(-rotation.x, -rotation.y, -rotation.z, -rotation.w) : rotation;
  const sine = Math.hypot(q.x, q.y, q.z);
  const scale = sine < 1e-9 ? 2 : (2 * Math.atan2(sine, q.w)) / sine;
  return new Vector3(q.x, q.y, q.z).multiplyScalar(scale);
}
const vector = (v: Vec3): Vector3 => new Vector3(v[0], v[1], v[2]);

export class Coupling {
  readonly position = new Vector3();
  readonly rotation = new Quaternion();
  readonly target_position = new Vector3();
  readonly target_rotation = new Quaternion();
  /** Of the last step: on the tool, about its centre of mass. */
  readonly force = new Vector3();
  readonly torque = new Vector3();
  stiffness = 2000;  // N/m
  radius = 0.05;     // m
  /** Whether a hand holds the tool: without one no spring pulls, and contact pushes the tool out. */
  held = false;
  private centre = new Vector3();  // of mass, tool frame
  private rest = 0;

  reset(pose: Pose, centre: Vec3): void {
    this.position.set(pose[0], pose[1], pose[2]);
    this.rotation.set(pose[3], pose[4], pose[5], pose[6]).normalize();
    this.centre.fromArray(centre);
    this.force.set(0, 0, 0);
    this.torque.set(0, 0, 0);
    this.let_go();
  }
  let_go(): void {
    this.held = false;
    this.target_position.copy(this.position);
    this.target_rotation.copy(this.rotation);
  }
  gc(position = this.position, rotation = this.rotation): Vector3 {
    return this.centre.clone().applyQuaternion(rotation).add(position);
  }
  pose(): Pose {
    return [...this.position.toArray(), this.rotation.x, this.rotation.y, this.rotation.z, this.rotation.w] as
        Pose;
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
    for (; this.rest >= STEP_S; this.rest -= STEP_S) this.step(answer);
  }

  private step(answer: Answer): void {
    // Contact, carried on from the pose that was asked to this one.
    const gc = this.gc();
    const moved = gc.clone().sub(vector(answer.gc));
    const turned = rotation_vector(this.rotation.clone().multiply(answer.rotation.clone().invert()));
    this.force.set(0, 0, 0);
    this.torque.set(0, 0, 0);
    let stiffness_sum = 0;
    for (const area of answer.areas) {
      const size = Math.hypot(...area.force);
      if (!(size > 0) || !(area.depth > 0)) continue;  // pierced, or without a direction
      const stiffness = size / area.depth;
      const normal = vector(area.force).divideScalar(size);
      const arm = vector(area.point).sub(vector(answer.gc));
      const shift = moved.clone().add(turned.clone().cross(arm)).dot(normal);
      const push = normal.multiplyScalar(Math.max(0, area.depth - shift) * stiffness);
      stiffness_sum += stiffness;
      this.force.add(push);
      this.torque.add(arm.clone().cross(push));
    }
    // The hand: a spring with a limit, so that nobody presses through a wall.
    if (!this.held) this.let_go();
    const spring = this.stiffness * SPRING_SHARE;
    const pull = this.gc(this.target_position, this.target_rotation).sub(gc).multiplyScalar(spring);
    pull.clampLength(0, this.stiffness * this.radius * DEEPEST_SHARE);
    const inertia = TURN_SHARE * this.radius * this.radius;
    const twist = rotation_vector(this.target_rotation.clone().multiply(this.rotation.clone().invert()))
                      .multiplyScalar(spring * inertia);
    twist.clampLength(0, this.stiffness * this.radius * this.radius * DEEPEST_SHARE);

    // Without inertia, velocity is force over damping; the damping grows with the areas so that the step
    // stays stable.
    const damping = (spring + Math.max(this.stiffness, stiffness_sum)) * SETTLE_S;
    const way = pull.add(this.force).multiplyScalar(STEP_S / damping).clampLength(0, this.radius * 0.05);
    const turn = twist.add(this.torque).multiplyScalar(STEP_S / (damping * inertia)).clampLength(0, 0.05);
    const angle = turn.length();
    const next_gc = gc.add(way);
    if (angle > 1e-12)
      this.rotation.premultiply(new Quaternion().setFromAxisAngle(turn.divideScalar(angle), angle))
          .normalize();
    this.position.copy(next_gc.sub(this.centre.clone().applyQuaternion(this.rotation)));
  }
}
