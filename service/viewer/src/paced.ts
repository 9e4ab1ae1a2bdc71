// What is done no more often than every so many milliseconds, and once more after the last time that it was
// wanted.
export class Paced {
  private done_at = -Infinity;
  private timer: ReturnType<typeof setTimeout>|undefined;

  /** `pause_ms`: at least so long from one time to the next. */
  constructor(private readonly pause_ms: number, private readonly act: () => void) {}

  want(): void {
    clearTimeout(this.timer);
    const wait = this.pause_ms - (performance.now() - this.done_at);
    if (wait > 0)
      this.timer = setTimeout(() => this.now(), wait);
    else
      this.now();
  }
  private now(): void {
    this.done_at = performance.now();
    this.act();
  }
}
