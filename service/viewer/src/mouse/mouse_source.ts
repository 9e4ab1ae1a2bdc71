// The mouse as a device: poses go to the server's remote loop, wrenches come back, the coupling moves the
// tool between them.
import {Quaternion, Vector3} from 'three';
import {Coupling, type Answer} from './coupling.js';
import {HapticLink} from './haptic_link.js';
import type {Moment} from '../moment.js';
import {waiting_words} from './waiting.js';
import {depth, type Frame, type HapticHello, type Pose, type Scene, type Wrench} from '../server/protocol.js';

const ASK_MS = 8;  // from one question to the next where the answer is sooner; chosen: with the answer's own
                   // time it is not 20 ms old in any picture
const ASK_SHARE =
    2;  // of the server's time for an answer: half of a processor is left to who draws the pictures; chosen
const UNWATCHED_MS = 600;  // without a picture for so long nobody looks, and between pictures nothing moves;
                           // chosen: longer than a slow picture takes
const RESTS_SHARE = 1e-6;  // of the tool's radius, and rad: a tool that has moved no further since it was
                           // asked about rests; chosen: far less than a pixel

export class MouseSource {
  /**
   * Stays the same when the connection is lost and found again: so does the tool, and the hand that holds
   * it.
   */
  readonly coupling = new Coupling();
  readonly link: HapticLink;
  paused = false;
  private hello: HapticHello|null = null;
  private answer: Answer|null = null;
  private asked: {seq: number; pose: Pose; at: number}|null = null;
  private asked_at = -Infinity;
  private readonly asked_position = new Vector3();
  private readonly asked_rotation = new Quaternion();
  private stale = true;
  private seq = 0;
  private frame: Frame|null = null;
  private contact = false;
  private server_us = NaN;
  private round_ms = NaN;
  private response: Moment['response'] = null;
  private engine: string;
  private wants_frame = true;  // a picture has come since the last frame was asked for
  private framed = true;       // the newest answer has its frame
  private timer: ReturnType<typeof setTimeout>|undefined;
  private last_picture = performance.now();
  private last_advance = performance.now();
  private readonly began = performance.now();

  /**
   * `at`: where the tool begins. `ready`, `connect`: as HapticLink has them. `lost`: the connection ended,
   * with the server's reason or ''; it begins again by itself.
   */
  constructor(
      readonly scene: Scene, at: Pose|null, ready: () => Promise<void>, connect: () => WebSocket,
      lost: (reason: string) => void) {
    this.coupling.radius = scene.tool_radius ?? 0.05;
    this.coupling.stiffness = scene.stiffness ?? 2000;
    this.engine = scene.backend ?? '';
    this.restart(at);
    this.link = new HapticLink(ready, connect, {
      hello: (hello) => {
        this.hello = hello;
        this.coupling.stiffness = hello.stiffness;
        this.forget();
        this.ask();
      },
      wrench: (wrench) => this.take(wrench),
      lost: (reason) => {
        this.hello = null;
        this.forget();
        lost(reason);
      },
    });
    this.link.open();
  }

  /** The tool goes to `at`, or to the scene's start; the connection stays. */
  restart(at: Pose|null = null): void {
    this.coupling.reset(at ?? this.scene.start ?? [0, 0, 0, 0, 0, 0, 1], this.scene.tool_gc ?? [0, 0, 0]);
    this.frame = null;
    this.contact = false;
    this.forget();
  }
  /** What was answered or asked holds no longer: the tool stands still until the next answer. */
  private forget(): void {
    this.answer = null;
    this.response = null;
    this.asked = null;
    this.asked_at = -Infinity;
  }

  private take(wrench: Wrench): void {
    if (!this.asked || wrench.seq !== this.asked.seq)
      return;  // one question is under way at a time: anything else is stale
    const pose = this.asked.pose;
    this.round_ms = performance.now() - this.asked.at;
    this.asked = null;
    this.server_us = wrench.server_us;
    this.framed = wrench.frame !== undefined;
    if (this.framed) this.contact = wrench.contact;  // with the frame that shows it
    this.response = {force: wrench.force, torque: wrench.torque};
    this.engine = wrench.engine ?? this.engine;
    this.frame = wrench.frame ?? this.frame;
    // Of a cut answer nothing is felt; the tool can be drawn back, or it would be stuck where lists are too
    // small.
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      if (performance.now() - this.last_picture < UNWATCHED_MS) this.move();
    }, Math.max(0, Math.max(ASK_MS, (wrench.server_us * ASK_SHARE) / 1000) - this.round_ms));
    this.answer = {
      gc: wrench.gc,
      rotation: new Quaternion(pose[3], pose[4], pose[5], pose[6]),
      planes: wrench.truncated ? [] : wrench.planes
    };
  }

  private ask(): void {
    if (this.link.state !== 'open' || this.asked) return;
    const {position, rotation, radius} = this.coupling;
    const rests = position.distanceTo(this.asked_position) <= RESTS_SHARE * radius &&
        rotation.angleTo(this.asked_rotation) <= RESTS_SHARE;
    // At rest nothing is asked, but once in 20 s: the server closes a connection that says nothing for a
    // minute.
    if (rests && (this.framed || !this.wants_frame) && performance.now() - this.asked_at < 20_000) return;
    const pose = this.coupling.pose();
    this.asked_at = performance.now();
    this.asked_position.copy(position);
    this.asked_rotation.copy(rotation);
    this.asked = {seq: ++this.seq, pose, at: this.asked_at};
    this.link.send(JSON.stringify({
      type: 'pose',
      seq: this.seq,
      time: (this.asked_at - this.began) / 1000,
      pose,
      full: this.wants_frame,
      planes: true  // the coupling has a spring of its own
    }));
    this.wants_frame = false;
  }

  /**
   * Before each picture: moves on to now, and asks about where the tool is. Between pictures it goes on by
   * itself as soon as an answer is there.
   */
  advance(): void {
    this.last_picture = performance.now();
    this.wants_frame = true;
    this.move();
  }
  private move(): void {
    const now = performance.now();
    const seconds = (now - this.last_advance) / 1000;
    this.last_advance = now;
    // Past the watchdog an unanswered question means that nobody knows what the tool touches. (At rest no
    // question is open.)
    const patience = Math.max(this.hello?.watchdog_ms ?? 20, 250);
    this.stale = this.asked !== null && now - this.asked.at > patience;
    if (this.paused) this.coupling.let_go();
    this.coupling.advance(seconds, this.stale || this.paused ? null : this.answer);
    this.ask();
  }

  moment(): Moment {
    const {force, torque} = this.coupling;
    return {
      time: (performance.now() - this.began) / 1000,
      pose: this.coupling.pose(),
      frame: this.frame,
      force: [force.x, force.y, force.z],
      torque: [torque.x, torque.y, torque.z],
      response: this.response,
      depth: depth(this.frame),
      contact: this.contact,
      frame_us: this.server_us,
      late: this.round_ms,
      stage: 0,
      note: this.paused              ? 'paused' :
          this.link.state !== 'open' ? 'connecting' :
          this.stale                 ? this.waiting() :
          this.answer                ? '' :
                                       'asking',
    };
  }
  private waiting(): string {
    return this.asked ? waiting_words(performance.now() - this.asked.at, this.engine, this.round_ms) : '';
  }
  close(): void {
    clearTimeout(this.timer);
    this.link.close();
  }
}
