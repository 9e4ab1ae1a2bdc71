// trace.csv: a row a tick. Columns are found by their names in the header.
import type {Pose, Vec3} from '../server/protocol.js';

const COLUMNS = [
  'time_s', 'x_m', 'y_m', 'z_m', 'qx', 'qy', 'qz', 'qw', 'force_x_N', 'force_y_N', 'force_z_N', 'torque_x_Nm',
  'torque_y_Nm', 'torque_z_Nm', 'result_age_ticks', 'contact', 'stage'
] as const;
const WIDTH = COLUMNS.length;

export class Trace {
  rows = 0;
  private places: number[]|null = null;
  private data = new Float64Array(WIDTH * 4096);

  /** Takes a line; the first is the header. A line that was cut short (a run that was killed) is left out. */
  take(line: string): void {
    const cells = line.trim().split(',');
    if (!this.places) {
      this.places = COLUMNS.map((name) => cells.indexOf(name));
      const missing = this.places.indexOf(-1);
      if (missing >= 0) throw new Error(`trace.csv: no column ${COLUMNS[missing]}`);
      return;
    }
    if (cells.length <= Math.max(...this.places)) return;
    if ((this.rows + 1) * WIDTH > this.data.length) {
      const larger = new Float64Array(this.data.length * 2);
      larger.set(this.data);
      this.data = larger;
    }
    const at = this.rows * WIDTH;
    for (let i = 0; i < WIDTH; ++i) this.data[at + i] = Number(cells[this.places[i]]);
    ++this.rows;
  }

  private vec(row: number, column: number): Vec3 {
    const at = row * WIDTH + column;
    return [this.data[at], this.data[at + 1], this.data[at + 2]];
  }
  time(row: number): number {
    return this.data[row * WIDTH];
  }
  pose(row: number): Pose {
    return Array.from(this.data.subarray(row * WIDTH + 1, row * WIDTH + 8)) as Pose;
  }
  force(row: number): Vec3 {
    return this.vec(row, 8);
  }
  torque(row: number): Vec3 {
    return this.vec(row, 11);
  }
  result_age(row: number): number {
    return this.data[row * WIDTH + 14];
  }
  contact(row: number): boolean {
    return this.data[row * WIDTH + 15] !== 0;
  }
  stage(row: number): number {
    return this.data[row * WIDTH + 16];
  }
  duration(): number {
    return this.rows > 0 ? this.time(this.rows - 1) : 0;
  }

  /** The last row at or before `time`, s. */
  row_at(time: number): number {
    let low = 0;
    let high = this.rows - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time(middle) <= time)
        low = middle;
      else
        high = middle - 1;
    }
    return low;
  }
}
