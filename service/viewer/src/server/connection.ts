// Whether the server is there. Asked now and then, and at once when something failed.
import type {Api} from './api.js';

const CALM_MS = 4000;
const FIRST_RETRY_MS = 500;
const LAST_RETRY_MS = 5000;

export class Connection {
  up = true;
  private timer = 0;
  private retry = FIRST_RETRY_MS;

  /** `changed`: the server went, or came back. */
  constructor(private readonly api: Api, private readonly changed: (up: boolean) => void) {
    this.later(CALM_MS);
  }

  /** Somebody got no answer: look now. */
  doubt(): void {
    this.later(0);
  }
  private later(ms: number): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.look(), ms);
  }
  private async look(): Promise<void> {
    const up = await this.api.alive();
    this.retry = up ? FIRST_RETRY_MS : Math.min(this.retry * 1.6, LAST_RETRY_MS);
    if (up !== this.up) {
      this.up = up;
      this.changed(up);
    }
    this.later(up ? CALM_MS : this.retry);
  }
}
