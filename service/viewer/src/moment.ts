// What is shown at one instant, whoever it comes from: a device, the mouse, a recorded run.
import type {Frame, Pose, Vec3} from './server/protocol.js';

/** Who gives moments: a session with a device, the mouse, or a recorded run. */
export type Source = 'live'|'mouse'|'run';

export interface Moment {
  time: number;  // s
  pose: Pose;
  frame: Frame|null;    // the newest one that was judged
  listed?: Frame|null;  // the newest one that says which triangles belong to an area; absent: all do
  force: Vec3;          // N, as the hand feels it, on the tool
  torque: Vec3;         // N·m, about the centre of mass
  response: {force: Vec3; torque: Vec3}|
      null;       // what the contact answers, before law, limits and the device's axes; null: not known
  depth: number;  // m, the deepest area
  contact: boolean;
  frame_us: number;  // NaN when unknown
  late: number;   // what the last strip shows: lateness in µs, age in ticks or the way there and back in ms;
                  // NaN when unknown
  stage: number;  // from 1; 0: none
  asked_at?: number;  // when the server was asked for what the tool feels, ms since 1970; NaN: never
  note: string;       // "", or what holds the force back: "paused", …
}

/** Whether moments of a mouse look like the ones before: then nothing is drawn. */
export class Stillness {
  private text = '';
  private frame: unknown = null;

  /** `holding`: what the mouse holds. */
  is_still(moment: Moment, holding: unknown): boolean {
    const text =
        `${moment.pose.join()} ${moment.force.join()} ${moment.frame?.tick} ${moment.note} ${holding}`;
    const same = text === this.text && moment.frame === this.frame;
    this.text = text;
    this.frame = moment.frame;
    return same;
  }
}
