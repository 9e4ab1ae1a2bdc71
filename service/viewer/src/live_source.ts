// A session's telemetry: the newest message is kept, frames are kept until the next one.
import type {Api} from './server/api.js';
import type {Moment} from './moment.js';
import {depth, type Bye, type Frame, type Pose, type StreamHello, type Telemetry} from './server/protocol.js';

export class LiveSource {
  hello: StreamHello|null = null;
  dropped = 0;
  missed_ticks = 0;
  private newest: Telemetry|null = null;
  private frame: Frame|null = null;
  private tool: Pose|null = null;  // which contact holds back where the device is further
  private readonly socket: WebSocket;
  private closed = false;

  /** `took`: a moment has come. `ended`: the stream is over, with the server's reason or ''. */
  constructor(
      api: Api, readonly session: string, took: (moment: Moment) => void, ended: (reason: string) => void) {
    this.socket = api.socket(`v1/sessions/${session}/stream`);
    let reason = '';
    this.socket.onmessage = (event: MessageEvent<string>) => {
      const message = JSON.parse(event.data) as StreamHello | Telemetry | Bye;
      if (message.type === 'hello')
        this.hello = message;
      else if (message.type === 'bye')
        reason = message.reason;
      else {
        this.newest = message;
        this.frame = message.frame ?? this.frame;
        this.tool = message.frame_pose ?? this.tool;
        this.dropped = message.dropped;
        this.missed_ticks = message.missed_ticks;
        took(this.moment()!);
      }
    };
    this.socket.onclose = () => {
      if (!this.closed) ended(reason);
    };
  }
  moment(): Moment|null {
    const now = this.newest;
    if (!now) return null;
    return {
      time: now.time_s,
      pose: this.tool ?? now.pose,
      frame: this.frame,
      force: now.force,
      torque: now.torque,
      response: {force: now.response_force, torque: now.response_torque},
      depth: depth(this.frame),
      contact: now.contact,
      frame_us: now.frame_us,
      late: now.lateness_max_us,
      stage: now.stage,
      note: now.paused ? 'paused' : '',
    };
  }
  get paused(): boolean {
    return this.newest?.paused ?? false;
  }
  close(): void {
    this.closed = true;
    this.socket.close();
  }
}
