// The mouse as a device: poses go to the server's remote loop, wrenches come back, the coupling moves the tool between them.
import { Quaternion } from 'three';
import type { Api } from './api.js';
import { Coupling, type Answer } from './coupling.js';
import type { Moment } from './moment.js';
import { depth, type Bye, type Fault, type Frame, type HapticHello, type Pose, type Scene, type Wrench } from './protocol.js';

export class MouseSource {
  readonly coupling = new Coupling();
  paused = false;
  private socket: WebSocket | null = null;
  private hello: HapticHello | null = null;
  private answer: Answer | null = null;
  private answered_at = 0;
  private asked: { seq: number; pose: Pose; at: number } | null = null;
  private asked_at = 0;
  private seq = 0;
  private frame: Frame | null = null;
  private contact = false;
  private server_us = NaN;
  private round_ms = NaN;
  private last_pose = '';
  private last_advance = performance.now();
  private readonly began = performance.now();
  private closed = false;

  /** `lost`: the connection ended, with the server's reason or ''. */
  constructor(private readonly api: Api, private readonly scene: Scene, private readonly lost: (reason: string) => void, start: Pose | null) {
    this.coupling.radius = scene.tool_radius ?? 0.05;
    this.coupling.stiffness = scene.stiffness ?? 2000;
    this.coupling.reset(start ?? scene.start ?? [0, 0, 0, 0, 0, 0, 1], scene.tool_gc ?? [0, 0, 0]);
    this.open(start);
  }

  private open(start: Pose | null): void {
    const socket = this.api.socket(`v1/scenes/${this.scene.id}/haptic`);
    this.socket = socket;
    let reason = '';
    socket.onmessage = (event: MessageEvent<string>) => {
      const message = JSON.parse(event.data) as HapticHello | Wrench | Bye | Fault;
      if (message.type === 'hello') {
        this.hello = message;
        this.coupling.stiffness = message.stiffness;
        this.coupling.reset(start ?? message.start, message.tool_gc);
        this.ask();
      } else if (message.type === 'wrench') this.take(message);
      else reason = message.type === 'error' ? message.problem.detail || message.problem.title : message.reason;
    };
    socket.onclose = () => { this.answer = null; this.hello = null; if (!this.closed) this.lost(reason); };
  }

  private take(wrench: Wrench): void {
    if (!this.asked || wrench.seq !== this.asked.seq) return;   // one question is under way at a time: anything else is stale
    const pose = this.asked.pose;
    this.answered_at = performance.now();
    this.round_ms = this.answered_at - this.asked.at;
    this.asked = null;
    this.server_us = wrench.server_us;
    this.contact = wrench.contact;
    this.frame = wrench.frame ?? this.frame;
    // Of a cut answer nothing is felt; the tool can be drawn back, or it would be stuck where lists are too small.
    this.answer = { gc: wrench.gc, rotation: new Quaternion(pose[3], pose[4], pose[5], pose[6]), areas: wrench.truncated ? [] : wrench.areas };
  }

  private ask(): void {
    if (!this.hello || this.asked || this.socket?.readyState !== WebSocket.OPEN) return;
    const pose = this.coupling.pose();
    const text = pose.join();
    // At rest nothing is asked, but once in 20 s: the server closes a connection that says nothing for a minute.
    if (text === this.last_pose && performance.now() - this.asked_at < 20_000) return;
    this.last_pose = text;
    this.asked_at = performance.now();
    this.asked = { seq: ++this.seq, pose, at: this.asked_at };
    this.socket.send(JSON.stringify({ type: 'pose', seq: this.seq, time: (this.asked_at - this.began) / 1000, pose, full: true }));
  }

  /** Moves on to now, and asks about where the tool is. */
  advance(): void {
    const now = performance.now();
    const seconds = (now - this.last_advance) / 1000;
    this.last_advance = now;
    // Past the watchdog an unanswered question means that nobody knows what the tool touches. (At rest no question is open.)
    const patience = Math.max(this.hello?.watchdog_ms ?? 20, 250);
    const stale = this.asked !== null && now - this.asked.at > patience;
    if (this.paused) this.coupling.let_go();
    this.coupling.advance(seconds, stale || this.paused ? null : this.answer);
    this.ask();
  }

  moment(): Moment {
    const { force, torque } = this.coupling;
    return {
      time: (performance.now() - this.began) / 1000, pose: this.coupling.pose(), frame: this.frame,
      force: [force.x, force.y, force.z], torque: [torque.x, torque.y, torque.z], depth: depth(this.frame), contact: this.contact,
      frame_us: this.server_us, late: this.round_ms, stage: 0, note: this.paused ? 'paused' : this.hello ? '' : 'connecting',
    };
  }
  close(): void { this.closed = true; this.socket?.close(); }
}
