// What the mouse did, kept as a path: poses in time, with what was felt, to be played, saved and told.
import type {Moment} from '../moment.js';
import {length, type Frame} from '../server/protocol.js';

const MOST = 60 * 60 * 10;  // ten minutes at sixty a second

export class PathRecorder {
  rows: Moment[] = [];
  recording = false;
  playing = false;
  private began = 0;
  private at = 0;

  start(): void {
    this.rows = [];
    this.recording = true;
    this.playing = false;
  }
  stop(): void {
    this.recording = false;
    this.playing = false;
  }
  get duration(): number {
    return this.rows.length > 0 ? this.rows[this.rows.length - 1].time : 0;
  }
  /** Takes a moment; times begin at 0 and ascend. False: it is full. */
  take(moment: Moment): boolean {
    if (!this.recording) return true;
    if (this.rows.length === 0) this.began = moment.time;
    const time = moment.time - this.began;
    if (this.rows.length > 0 && time <= this.duration) return true;
    this.rows.push({...moment, time});
    if (this.rows.length < MOST) return true;
    this.recording = false;
    return false;
  }
  play(): void {
    this.playing = this.rows.length > 1;
    this.recording = false;
    this.at = 0;
  }
  /** The moment `seconds` later; null at the end. */
  advance(seconds: number): Moment|null {
    this.at += seconds;
    if (this.at > this.duration) {
      this.playing = false;
      return null;
    }
    let low = 0;
    let high = this.rows.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.rows[middle].time <= this.at)
        low = middle;
      else
        high = middle - 1;
    }
    return {...this.rows[low], note: 'played'};
  }
}

export interface Touch {
  from: number;
  to: number;
  parts: string;
  depth: number;
  force: number
}
const GAP_S = 0.15;  // shorter ones do not end a touch

/** When and what a path touched, how deep, and the largest response. */
export function touches(rows: readonly Moment[], names: (frame: Frame) => string): Touch[] {
  const out: Touch[] = [];
  let unbroken = false;  // the row before was a contact, too, however long ago
  for (const {time, frame, contact, depth, response} of rows) {
    if (!contact || !frame) {
      unbroken = false;
      continue;
    }
    const parts = names(frame);
    const last = out.at(-1);
    const force = response ? length(response.force) : 0;
    const goes_on = last?.parts === parts && (unbroken || time - last.to <= GAP_S);
    unbroken = true;
    if (last && goes_on) {
      last.to = time;
      last.depth = Math.max(last.depth, depth);
      last.force = Math.max(last.force, force);
    } else
      out.push({from: time, to: time, parts, depth, force});
  }
  return out;
}
