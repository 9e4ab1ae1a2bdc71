// What takes hold of the tool, and where it wants it to be.
import {Quaternion, Vector3} from 'three';
import type {Pose, Vec3} from '../server/protocol.js';

export class Hand {
  /** The tool's place. */
  readonly position = new Vector3();
  readonly rotation = new Quaternion();
  /** Where the hand wants it. */
  readonly target_position = new Vector3();
  readonly target_rotation = new Quaternion();
  radius = 0.05;  // of the tool, m
  /** Whether a hand holds the tool: without one no spring pulls, and contact pushes the tool out. */
  held = false;
  protected centre = new Vector3();  // of mass, tool frame

  /** The tool begins at `pose`, in no hand. */
  reset(pose: Pose, centre: Vec3): void {
    this.centre.fromArray(centre);
    this.put(pose);
    this.let_go();
  }
  /** The tool is at `pose`; an open hand goes with it. */
  put(pose: Pose): void {
    this.position.set(pose[0], pose[1], pose[2]);
    this.rotation.set(pose[3], pose[4], pose[5], pose[6]).normalize();
    if (!this.held) this.let_go();
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
    return pose_of(this.position, this.rotation);
  }
  target(): Pose {
    return pose_of(this.target_position, this.target_rotation);
  }
}

function pose_of(position: Vector3, rotation: Quaternion): Pose {
  return [...position.toArray(), rotation.x, rotation.y, rotation.z, rotation.w] as Pose;
}
