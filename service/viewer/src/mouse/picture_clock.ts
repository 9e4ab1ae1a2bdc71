// When the next picture is due, from when the last ones came. What is asked so that its answer just makes it
// is as fresh in the picture as can be, and one question a picture is enough.

const REMEMBERED =
    4;  // chosen: the shortest of these is the period, for a picture that comes late is the exception
const LONGEST_MS = 100;  // longer ones are no row of pictures
// Ways to the server and back that are remembered; the longest but two is what the next may take. So five of
// six answers make their picture. To wait for the sixth would make all of them older, and their mean no less.
const ROUNDS = 16, LONGER = 2;
const AHEAD_MS = 3;  // for the page to hear of it; chosen

export class PictureClock {
  private last = NaN;
  private periods: number[] = [];
  private rounds: number[] = [];

  /** A picture comes, at a time in ms. */
  tick(now: number): void {
    const period = now - this.last;
    this.last = now;
    if (period > LONGEST_MS)
      this.periods = [];
    else if (period > 0)
      this.periods = [...this.periods, period].slice(-REMEMBERED);
  }
  /** An answer has come, so long after its question. */
  answered(round_ms: number): void {
    this.rounds = [...this.rounds, round_ms].slice(-ROUNDS);
  }
  /**
   * When to ask for the next picture; a question that was sent at `asked_at` does for it, if it was late
   * enough. NaN: there is no row of pictures, or it has been asked.
   */
  ask_at(asked_at: number): number {
    if (this.periods.length === 0) return NaN;
    const longest_first = [...this.rounds].sort((a, b) => b - a);
    const round = longest_first[Math.min(LONGER, longest_first.length - 1)] ?? 0;
    const lead = Math.min(round + AHEAD_MS, Math.min(...this.periods));
    const at = this.last + Math.min(...this.periods) - lead;
    return asked_at < at - lead / 2 ? at : NaN;
  }
}
