// A recorded run: loaded once, then played, paused, scrubbed. Knows nothing of drawing.
import type {Api} from '../server/api.js';
import {FrameIndex} from './frame_index.js';
import type {Frame, Run} from '../server/protocol.js';
import {split_lines} from './text_lines.js';
import {Trace} from './trace.js';

export class Playback {
  readonly trace = new Trace();
  readonly frames = new FrameIndex();
  time = 0;
  playing = false;
  speed = 1;
  private last_frame: {index: number; frame: Frame | null} = {index: -1, frame: null};
  private fetching = -1;

  private constructor(readonly run: Run, private readonly api: Api) {}

  /** Downloads and indexes; `progress` gets 0 … 1. */
  static async load(api: Api, run: Run, progress: (part: number) => void): Promise<Playback> {
    const playback = new Playback(run, api);
    const total = Math.max(1, (run.files['trace.csv'] ?? 0) + (run.files['frames.jsonl'] ?? 0));
    let before = 0;
    const decoder = new TextDecoder();
    if (run.files['trace.csv'] !== undefined) {
      await split_lines(
          await api.run_file(run.name, 'trace.csv'), (line) => playback.trace.take(decoder.decode(line)),
          (bytes) => progress(bytes / total));
      before = run.files['trace.csv'];
    }
    if (run.files['frames.jsonl'] !== undefined) {
      await split_lines(
          await api.run_file(run.name, 'frames.jsonl'), (line, offset) => playback.frames.take(line, offset),
          (bytes) => progress((before + bytes) / total));
    }
    if (playback.trace.rows === 0)
      throw new Error(`run ${run.name} has no trace.csv with rows, and without poses nothing can be shown`);
    return playback;
  }

  get duration(): number {
    return this.trace.duration();
  }
  seek(time: number): void {
    this.time = Math.min(Math.max(0, time), this.duration);
  }
  /** Steps to the next or the previous frame that was judged. */
  step(direction: 1|- 1): void {
    const now = this.frames.at_tick(Math.round(this.time * 1000));
    const next = this.frames.entries[Math.min(Math.max(0, now + direction), this.frames.entries.length - 1)];
    if (next) this.seek(next.tick / 1000);
  }
  advance(seconds: number): void {
    if (!this.playing) return;
    this.seek(this.time + seconds * this.speed);
    if (this.time >= this.duration) this.playing = false;
  }

  /**
   * The frame that was newest at `time`; null while there is none, or while it is fetched (`then` is called
   * when it is here).
   */
  frame(then: () => void): Frame|null {
    const index = this.frames.at_tick(Math.round(this.time * 1000));
    if (index < 0) return null;
    if (this.last_frame.index === index) return this.last_frame.frame;
    const kept = this.frames.text(index);
    if (kept) {
      this.last_frame = {index, frame: this.frames.parse(kept)};
      return this.last_frame.frame;
    }
    if (this.fetching < 0) void this.fetch_line(index, then);
    return this.last_frame.frame;  // the one before, until this one is here
  }
  private async fetch_line(index: number, then: () => void): Promise<void> {
    this.fetching = index;
    const {offset, length} = this.frames.entries[index];
    try {
      const response =
          await this.api.run_file(this.run.name, 'frames.jsonl', `bytes=${offset}-${offset + length - 1}`);
      this.last_frame = {index, frame: this.frames.parse(new Uint8Array(await response.arrayBuffer()))};
    } catch { /* the picture stays at the frame before; the connection's state is shown elsewhere */
    }
    this.fetching = -1;
    then();
  }
}
