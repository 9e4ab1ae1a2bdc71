// A SpaceMouse through the browser's WebHID: as far as its cap is pushed, so fast does the tool go, as the
// camera sees it. Buttons do nothing here.
import {at_rest, MODELS, take_report, type Cap} from './cap_report.js';
import {element, write} from '../dom.js';

const DEAD = 0.06;  // of a full deflection: a cap that nobody touches is not quite at rest (chosen)

/** The cap without what a resting one says. */
export function deflection(cap: Cap): number[] {
  return cap.axes.map((axis) => (Math.abs(axis) < DEAD ? 0 : axis));
}

export class SpaceMouse {
  private cap = at_rest();
  private device: HIDDevice|null = null;
  private readonly button = element<HTMLButtonElement>('space-mouse');
  private readonly note = element('space-mouse-note');

  /** `moved`: the cap spoke. */
  constructor(private readonly moved: () => void, private readonly failed: (error: unknown) => void) {
    const {hid} = navigator;
    this.button.hidden = !hid;
    if (!hid) return;
    this.button.addEventListener('click', () => void this.choose(hid).catch(this.failed));
    hid.addEventListener('disconnect', (event) => {
      if (event.device === this.device) this.lost();
    });
    // One that was allowed before needs no question.
    void hid.getDevices().then((known) => {
      const ours = known.find(
          ({vendorId, productId}) =>
              MODELS.some((model) => model.vendorId === vendorId && model.productId === productId));
      if (ours) void this.take(ours).catch(this.failed);
    }, this.failed);
  }
  private async choose(hid: HID): Promise<void> {
    if (this.device) {
      await this.device.close();
      this.lost();
      return;
    }
    const [chosen] = await hid.requestDevice({filters: MODELS});
    if (chosen) await this.take(chosen);
  }
  private async take(device: HIDDevice): Promise<void> {
    if (!device.opened) await device.open();
    this.device = device;
    this.cap = at_rest();
    device.addEventListener('inputreport', (event) => {
      if (device === this.device && take_report(this.cap, event.reportId, event.data)) this.moved();
    });
    write(this.button, 'Let the SpaceMouse go');
    write(this.note, `${device.productName || 'SpaceMouse'}: push its cap, and the tool goes that way.`);
  }
  private lost(): void {
    this.device = null;
    this.cap = at_rest();
    write(this.button, 'Take a SpaceMouse');
    write(this.note, '');
    this.moved();
  }
  /** What the cap wants, −1 … 1: right, up, away, and turns about these. All 0: nothing. */
  wish(): number[] {
    const [x, y, z, rx, ry, rz] = deflection(this.cap);
    return [x, -z, -y, rx, -rz, -ry].map((value) => value + 0);
  }
}
