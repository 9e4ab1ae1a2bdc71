// How many triangles to ask the server for, from how long a picture takes. Contact triangles are exact at every level.

export const LEVELS = [30_000, 120_000, 400_000, 1_500_000];
const SLOW_MS = 40;   // chosen: below 25 pictures a second dragging feels sticky
const FAST_MS = 9;    // chosen: four times as much would still be smooth

/** The level to move to; `total`: triangles of the whole mock-up. */
export function next_level(level: number, picture_ms: number, total: number): number {
  if (picture_ms > SLOW_MS && level > 0) return level - 1;
  if (picture_ms < FAST_MS && level + 1 < LEVELS.length && LEVELS[level] < total) return level + 1;
  return level;
}

/** Watches pictures of moving scenes; says when to change the level, and never goes back up to one that was too slow. */
export class LevelKeeper {
  level = 1;
  private ceiling = LEVELS.length - 1;
  private times: number[] = [];

  /** Takes the time since the picture before, ms; true when the level changed. */
  take(picture_ms: number, total: number): boolean {
    if (picture_ms > 500) return false;   // the page was hidden, or nothing moved
    this.times.push(picture_ms);
    if (this.times.length < 40) return false;
    const median = this.times.sort((a, b) => a - b)[20];
    this.times = [];
    const next = Math.min(next_level(this.level, median, total), this.ceiling);
    if (next === this.level) return false;
    if (next < this.level) this.ceiling = next;
    this.level = next;
    return true;
  }
}
