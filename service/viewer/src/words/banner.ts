// One sentence over the picture.
import {element} from '../dom.js';

const GOOD_MS = 3500;  // chosen: long enough to read it
const BAD_MS = 9000;

export class Banner {
  private timer = 0;

  /** `stays`: until it is hidden or another takes its place. */
  say(text: string, bad: boolean, stays: boolean): void {
    const banner = element('banner');
    banner.textContent = text;
    banner.dataset['state'] = bad ? 'bad' : 'good';
    banner.hidden = false;
    clearTimeout(this.timer);
    if (!stays) this.timer = window.setTimeout(() => this.hide(), bad ? BAD_MS : GOOD_MS);
  }
  hide(): void {
    element('banner').hidden = true;
  }
}
