// A page rests while nothing is to be shown anew.

const LOOK_MS = 100;  // between looks at a mouse that moves nothing; chosen
const LEAP_S = 0.25;  // after a rest, or a hidden page, time goes on by no more; chosen

/** Draws pictures: as SceneView has these. */
export interface Drawing {
  readonly presenting: boolean;  // a headset asks for pictures by itself
  before_next(call: (now: number) => void): void;
}
/** What comes after a picture: the next one, a look some time later, or nothing until somebody wakes. */
export type Next = 'picture'|'look'|'rest';

export class Wakefulness {
  private awake = false;
  private timer: ReturnType<typeof setTimeout>|undefined;
  private last_tick = NaN;

  /** `tick` is called before each picture, `next` after it. */
  constructor(
      private readonly view: Drawing, private readonly tick: (now: number) => void,
      private readonly next: () => Next) {}

  /** Another picture is wanted. */
  wake(): void {
    clearTimeout(this.timer);
    if (this.awake || this.view.presenting) return;
    this.awake = true;
    this.view.before_next((now) => {
      this.awake = false;
      this.tick(now);
      const next = this.next();
      if (next === 'picture')
        this.wake();
      else if (next === 'look')
        this.timer = setTimeout(() => this.wake(), LOOK_MS);
      if (!this.awake) this.last_tick = NaN;
    });
  }
  /** Seconds since it was last asked, in which the page did not rest. */
  seconds(now: number): number {
    const out = Number.isNaN(this.last_tick) ? 0 : Math.min((now - this.last_tick) / 1000, LEAP_S);
    this.last_tick = now;
    return out;
  }
}
