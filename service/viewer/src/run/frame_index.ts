// frames.jsonl: where each line lies, what the strips need of it, and its text only while it is small enough
// to keep.
import {depth, type Frame} from '../server/protocol.js';

const KEEP_BYTES = 192 * 1024 * 1024;

export interface FrameEntry {
  tick: number;
  offset: number;
  length: number;
  depth: number;
  frame_us: number
}

export class FrameIndex {
  readonly entries: FrameEntry[] = [];
  private kept: Uint8Array[] = [];
  private kept_bytes = 0;
  private readonly decoder = new TextDecoder();

  /** Takes a line; false when it is no frame (a last line that was cut short). */
  take(line: Uint8Array, offset: number): boolean {
    let frame: Frame;
    try {
      frame = this.parse(line);
    } catch {
      return false;
    }
    this.entries.push({
      tick: frame.tick,
      offset,
      length: line.length,
      depth: depth(frame),
      frame_us: frame.time_us?.['total'] ?? NaN
    });
    // Beyond the budget lines are fetched again one by one.
    if (this.kept_bytes + line.length <= KEEP_BYTES && this.kept.length === this.entries.length - 1) {
      this.kept.push(line.slice());
      this.kept_bytes += line.length;
    }
    return true;
  }
  parse(line: Uint8Array): Frame {
    const frame = JSON.parse(this.decoder.decode(line)) as Frame;
    if (typeof frame.tick !== 'number' || !Array.isArray(frame.areas))
      throw new Error('frames.jsonl: a line is no frame');
    return frame;
  }
  /** The newest frame at or before `tick`, -1 when there is none. */
  at_tick(tick: number): number {
    let low = -1;
    let high = this.entries.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.entries[middle].tick <= tick)
        low = middle;
      else
        high = middle - 1;
    }
    return low;
  }
  text(index: number): Uint8Array|null {
    return this.kept[index] ?? null;
  }
}
