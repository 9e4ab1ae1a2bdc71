// When the next picture is due, from when the last ones came. What is asked so that its answer just makes it
// is as fresh in the picture as can be, and one question a picture is enough.

const REMEMBERED =
    4;  // chosen: the shortest of these is the period, for a picture that comes late is the exception
const LONGEST_MS = 100;  // longer ones are no row of pictures
const ROUND_SHARE = 1.5,
      AHEAD_MS = 4;  // of the way to the server and back, and for the page to hear of it; chosen

export class PictureClock {
  private last = NaN;
  private periods: number[] = [];

  /** A picture comes, at a time in ms. */
  tick(now: number): void {
    const period = now - this.last;
    this.last = now;
    if (period > LONGEST_MS)
      this.periods = [];
    else if (period > 0)
      this.periods = [...this.periods, period].slice(-REMEMBERED);
  }
  /**
   * When to ask for the next picture, where the way there and back takes `round_ms`; a question that was sent
   * at `asked_at` does for it, if it was late enough. NaN: there is no row of pictures, or it has been asked.
   */
  ask_at(round_ms: number, asked_at: number): number {
    if (this.periods.length === 0) return NaN;
    const lead = Math.min(ROUND_SHARE * round_ms + AHEAD_MS, Math.min(...this.periods));
    const at = this.last + Math.min(...this.periods) - lead;
    return asked_at < at - lead / 2 ? at : NaN;
  }
}
