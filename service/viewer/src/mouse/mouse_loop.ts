// The loop of the mouse as a device: poses go to the server's remote loop, wrenches come back, the coupling
// moves the tool between them. In the page it runs beside the thread that draws (mouse_worker.ts).
import {Quaternion, Vector3} from 'three';
import {Coupling, type Answer} from './coupling.js';
import {HapticLink} from './haptic_link.js';
import type {HandTold} from './messages.js';
import type {Moment} from '../moment.js';
import {PictureClock} from './picture_clock.js';
import {waiting_words} from './waiting.js';
import {depth, has_lists, type Frame, type HapticHello, type Pose, type Scene, type Wrench} from '../server/protocol.js';

const ASK_MS = 33;  // from one question to the next, where no picture wants one sooner; chosen
const ASK_SHARE =
    2;  // of the server's time for an answer: half of a processor is left to who draws the pictures; chosen
const UNWATCHED_MS = 600;  // without a picture for so long nobody looks, and between pictures nothing moves;
                           // chosen: longer than a slow picture takes
const LISTS_MS = 150;  // the table of areas has their parts no more often; chosen: it can't be read faster
const RESTS_SHARE = 1e-6;  // of the tool's radius, and rad: a tool that has moved no further since it was
                           // asked about rests; chosen: far less than a pixel

export interface LoopHooks {
  /** The tool has moved, or what is known of it has changed. */
  moved: () => void;
  /** The connection ended, with the server's reason or ''; it begins again by itself. */
  lost: (reason: string) => void;
}

export class MouseLoop {
  /**
   * Stays the same when the connection is lost and found again: so does the tool, and the hand that holds
   * it.
   */
  readonly coupling = new Coupling();
  readonly link: HapticLink;
  private hello: HapticHello|null = null;
  private answer: Answer|null = null;
  private asked: {seq: number; pose: Pose; at: number}|null = null;
  private asked_at = -Infinity;
  private next_at = -Infinity;  // when the next question may be asked
  private readonly clock = new PictureClock();
  private paused = false;
  private readonly asked_position = new Vector3();
  private readonly asked_rotation = new Quaternion();
  private stale = true;
  /** When the newest answer was asked for, as performance.now() has it; NaN: there is none. */
  answered = NaN;
  private seq = 0;
  private frame: Frame|null = null;
  private contact = false;
  private server_us = NaN;
  private round_ms = NaN;
  private response: Moment['response'] = null;
  private engine: string;
  private wants_frame = true;     // a picture has come since the last frame was asked for
  private framed = true;          // the newest answer has its frame
  private wants_lists = false;    // of which triangles belong to each area
  private listed = true;          // the newest answer has them
  private listed_at = -Infinity;  // when the last one that has was asked for
  private timer: ReturnType<typeof setTimeout>|undefined;
  private last_picture = performance.now();
  private last_advance = performance.now();
  private readonly began = performance.now();

  /** `at`: where the tool begins. `ready`, `connect`: as HapticLink has them. */
  constructor(
      private readonly scene: Scene, at: Pose|null, ready: () => Promise<void>, connect: () => WebSocket,
      private readonly hooks: LoopHooks) {
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
        hooks.lost(reason);
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
    const {pose, at: asked} = this.asked;
    this.round_ms = performance.now() - asked;
    this.clock.answered(this.round_ms);
    this.asked = null;
    this.answered = asked;
    this.server_us = wrench.server_us;
    this.framed = wrench.frame !== undefined;
    this.listed = wrench.frame !== undefined && has_lists(wrench.frame);
    if (this.listed) this.listed_at = asked;
    if (this.framed) this.contact = wrench.contact;  // with the frame that shows it
    this.response = {force: wrench.force, torque: wrench.torque};
    this.engine = wrench.engine ?? this.engine;
    this.frame = wrench.frame ?? this.frame;
    // Of a cut answer nothing is felt; the tool can be drawn back, or it would be stuck where lists are too
    // small.
    this.answer = {
      gc: wrench.gc,
      rotation: new Quaternion(pose[3], pose[4], pose[5], pose[6]),
      planes: wrench.truncated ? [] : wrench.planes
    };
    this.next_at = asked + (wrench.server_us * ASK_SHARE) / 1000;
    this.move();
  }

  private ask(): void {
    const now = performance.now();
    clearTimeout(this.timer);
    if (this.link.state !== 'open' || this.asked || now - this.last_picture >= UNWATCHED_MS) return;
    const for_picture = this.clock.ask_at(this.asked_at);
    const at = Math.max(this.next_at, Number.isNaN(for_picture) ? this.asked_at + ASK_MS : for_picture);
    if (now < at) {
      this.timer = setTimeout(() => this.move(), at - now);
      return;
    }
    const {position, rotation, radius} = this.coupling;
    const rests = position.distanceTo(this.asked_position) <= RESTS_SHARE * radius &&
        rotation.angleTo(this.asked_rotation) <= RESTS_SHARE;
    // At rest nothing is asked, but once in 20 s: the server closes a connection that says nothing for a
    // minute.
    if (rests && ((this.framed && this.listed) || !this.wants_frame) && now - this.asked_at < 20_000) return;
    const pose = this.coupling.pose();
    this.asked_at = now;
    this.asked_position.copy(position);
    this.asked_rotation.copy(rotation);
    this.asked = {seq: ++this.seq, pose, at: this.asked_at};
    this.link.send(JSON.stringify({
      type: 'pose',
      seq: this.seq,
      time: (this.asked_at - this.began) / 1000,
      pose,
      full: this.wants_frame,
      area_lists: this.wants_lists || rests || now - this.listed_at >= LISTS_MS,
      planes: true  // the coupling has a spring of its own
    }));
    this.wants_frame = false;
  }

  /** Before each picture: what the hand does, and whether each area's triangles are to be shown. */
  picture({held, target, paused}: HandTold, lists: boolean): void {
    this.wants_lists = lists;
    this.last_picture = performance.now();
    this.clock.tick(this.last_picture);
    this.wants_frame = true;
    this.paused = paused;
    this.coupling.held = held;
    this.coupling.target_position.set(target[0], target[1], target[2]);
    this.coupling.target_rotation.set(target[3], target[4], target[5], target[6]);
    this.move();
  }
  /** Moves on to now, and asks about where the tool is. Between pictures answers set it going. */
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
    this.hooks.moved();
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
