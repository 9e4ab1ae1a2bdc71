// Columns of numbers over time, as the strips draw them.
import type {Moment} from './moment.js';

export const COLUMNS = ['fx', 'fy', 'fz', 'tx', 'ty', 'tz', 'depth', 'frame', 'late'] as const;
export type Column = (typeof COLUMNS)[number];

export class Samples {
  count = 0;
  times: Float64Array;
  private columns: Record<Column, Float32Array>;

  constructor(private capacity = 4096) {
    this.times = new Float64Array(capacity);
    this.columns = Object.fromEntries(COLUMNS.map((name) => [name, new Float32Array(capacity)])) as
        Record<Column, Float32Array>;
  }
  /** Adds a sample; when the room is used up the older half goes. Time that runs backwards begins anew. */
  add(time: number, values: readonly number[]): void {
    if (this.count > 0 && time < this.times[this.count - 1]) this.count = 0;
    if (this.count === this.capacity) {
      const half = this.capacity >> 1;
      this.times.copyWithin(0, half);
      for (const name of COLUMNS) this.columns[name].copyWithin(0, half);
      this.count -= half;
    }
    this.times[this.count] = time;
    COLUMNS.forEach((name, i) => {
      this.columns[name][this.count] = values[i];
    });
    ++this.count;
  }
  add_moment(moment: Moment): void {
    this.add(
        moment.time,
        [...moment.force, ...moment.torque, moment.depth * 1000, moment.frame_us / 1000, moment.late]);
  }
  clear(): void {
    this.count = 0;
  }
  column(name: Column): Float32Array {
    return this.columns[name];
  }
  /** The first sample at or after `time`. */
  first_at(time: number): number {
    let low = 0;
    let high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] < time)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }
  last(name: Column): number {
    return this.count > 0 ? this.columns[name][this.count - 1] : NaN;
  }
}

/** The smallest 1, 2 or 5 times a power of ten at or above `value`. */
export function round_up(value: number): number {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value) + 1e-12);
  const lead = value / power;
  return power * (lead <= 1.0000001 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10);
}
