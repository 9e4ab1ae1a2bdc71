// A device of the server's machine: picked, started, paused, stopped; its telemetry shown. A session that
// others started is joined.
import type {Api} from './server/api.js';
import {element, fill} from './dom.js';
import {LiveSource} from './live_source.js';
import type {Moment} from './moment.js';
import {offered_devices} from './words/offered_devices.js';
import {ZERO, type Scene, type Session} from './server/protocol.js';

export class Sessions {
  live: LiveSource|null = null;
  moment: Moment|null = null;
  private readonly device = element<HTMLSelectElement>('device');
  private readonly buttons = {
    start: element<HTMLButtonElement>('start'),
    pause: element<HTMLButtonElement>('pause'),
    stop: element<HTMLButtonElement>('stop')
  };
  private scene_id = '';
  private busy = false;

  constructor(
      private readonly api: Api, private readonly took: (moment: Moment) => void,
      private readonly failed: (error: unknown) => void, private readonly say: (text: string) => void) {
    const act = (work: () => Promise<unknown>) => () => {
      if (this.busy) return;
      this.busy = true;
      this.show();
      work().catch(this.failed).finally(() => {
        this.busy = false;
        this.show();
      });
    };
    this.buttons.start.addEventListener(
        'click',
        act(async () => this.join(await this.api.start(
                this.scene_id, this.device.value, element<HTMLInputElement>('record-as').value.trim()))));
    this.buttons.pause.addEventListener('click', act(async () => {
                                          if (this.live)
                                            await this.api.pause(this.live.session, !this.live.paused);
                                        }));
    this.buttons.stop.addEventListener('click', act(async () => {
                                         if (this.live) await this.api.stop(this.live.session);
                                       }));
  }

  /** Lists the devices and joins a session that is running on the scene. */
  async refresh(scene: Scene): Promise<void> {
    const scene_id = (this.scene_id = scene.id);
    const devices = offered_devices(await this.api.devices(), scene);
    fill(this.device, devices.map((device) => ({
                                    value: device.name,
                                    text: device.usable ? device.name : `${device.name}: ${device.reason}`,
                                    disabled: !device.usable,
                                    title: device.reason
                                  })));
    if (this.device.selectedOptions[0]?.disabled !== false)
      this.device.value = devices.find((device) => device.usable)?.name ?? '';
    if (!this.live) {
      const running = (await this.api.sessions())
                          .find(
                              (session) => session.scene === scene_id &&
                                  (session.state === 'running' || session.state === 'paused' ||
                                   session.state === 'starting'));
      if (running) this.join(running);
    }
    this.show();
  }
  private join(session: Session): void {
    this.leave();
    const live = new LiveSource(
        this.api, session.id,
        (moment) => {
          this.moment = moment;
          this.took(moment);
          this.show();
        },
        (reason) => {
          if (this.live !== live) return;
          this.live = null;
          if (this.moment)
            this.took((this.moment = {...this.moment, force: ZERO, torque: ZERO, note: 'ended'}));
          this.show();
          this.say(reason ? `The session ended: ${reason}` : 'The session ended.');
        });
    this.live = live;
  }
  leave(): void {
    this.live?.close();
    this.live = null;
    this.moment = null;
  }
  toggle(): void {
    if (this.live)
      this.buttons.pause.click();
    else
      this.buttons.start.click();
  }

  show(): void {
    const running = this.live !== null;
    this.buttons.start.disabled = running || this.busy || this.device.value === '' || this.scene_id === '';
    this.buttons.pause.disabled = this.buttons.stop.disabled = !running || this.busy;
    this.buttons.pause.textContent = this.live?.paused ? 'Go on' : 'Pause';
    const {live} = this;
    element('live-note').textContent = !live ?
        'No session runs on this scene.' :
        `${live.hello?.device ?? 'session'}, ${live.missed_ticks.toLocaleString('en')} ticks missed${
            live.dropped > 0 ? `, ${live.dropped.toLocaleString('en')} pictures left out` : ''}`;
  }
}
