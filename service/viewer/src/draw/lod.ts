// How many triangles to ask the server for, from how long a picture takes. Contact triangles are exact at
// every level.

export const LEVELS = [30_000, 120_000, 400_000, 1_500_000];
const SLOW_MS = 36;  // chosen: what is paced (scene_view.ts) at 33 ms, and a tenth
const FAST_MS =
    18;  // chosen: keeps up with a screen of 60 Hz; whether four times as much does, too, is tried once
const FRESH_SHARE = 0.5;  // chosen: an answer older than this part of SLOW_MS makes a picture slow
const ENOUGH = 40;        // pictures that tell; where they are slow, those of ENOUGH_MS, and FEWEST at least
const ENOUGH_MS = 1500;
const FEWEST = 4;  // one that waits for something else does not decide

/** The level to move to; `total`: triangles of the whole mock-up. */
export function next_level(level: number, picture_ms: number, total: number): number {
  if (picture_ms > SLOW_MS && level > 0) return Math.max(0, level - (picture_ms > 4 * SLOW_MS ? 2 : 1));
  if (picture_ms < FAST_MS && level + 1 < LEVELS.length && LEVELS[level] < total) return level + 1;
  return level;
}

/**
 * Watches pictures of moving scenes; says when to change the level, and never goes back up to one that was
 * too slow.
 */
export class LevelKeeper {
  level = 1;
  /**
   * Pictures of what moves are to have half the width and height: where that helps (`may_coarsen`) it is
   * given up before triangles are, for at rest it comes back.
   */
  coarse = false;
  may_coarsen = false;
  private ceiling = LEVELS.length - 1;
  private times: number[] = [];
  private spent = 0;

  /**
   * Takes the time since the picture before in an unbroken row of them, ms, however long; true when the
   * level changed. `answer_ms`: how old the engine's answer in the picture is. Pictures that come in time but
   * leave the engine too little of the processors are too slow, too.
   */
  take(picture_ms: number, total: number, answer_ms = 0): boolean {
    const slow_ms = Math.max(picture_ms, answer_ms / FRESH_SHARE);
    this.times.push(slow_ms);
    this.spent += slow_ms;
    if (this.times.length < ENOUGH && (this.times.length < FEWEST || this.spent < ENOUGH_MS)) return false;
    // The mean without the longest: a browser that draws without a GPU shows two pictures at once and then
    // none for long.
    const typical = (this.spent - Math.max(...this.times)) / (this.times.length - 1);
    this.times = [];
    this.spent = 0;
    if (typical > SLOW_MS && this.may_coarsen && !this.coarse) {
      this.coarse = true;
      return false;
    }
    const next = Math.min(next_level(this.level, typical, total), this.ceiling);
    if (next === this.level) return false;
    if (next < this.level) this.ceiling = next;
    this.level = next;
    return true;
  }
}
