// The mouse as a device, as the page has it: the hand, and the newest moment of the loop in its worker.
import {Hand} from './hand.js';
import type {ToPage, ToWorker} from './messages.js';
import type {Moment} from '../moment.js';
import {has_lists, type Pose, type Scene} from '../server/protocol.js';

export interface SourceHooks {
  /** Resolves when the server holds the scene, ready; who refuses has said why. */
  ready: () => Promise<void>;
  /** Something is to be shown anew. */
  moved: () => void;
  /** The connection ended, with the server's reason or ''; it begins again by itself. */
  lost: (reason: string) => void;
}

export class MouseSource {
  readonly hand = new Hand();
  paused = false;
  private turn = 0;
  private newest: Moment;
  private readonly began = performance.now();

  /** `at`: where the tool begins. `url`, `protocols`: of the server's remote loop. */
  constructor(
      readonly scene: Scene, at: Pose|null, {url, protocols}: {url: string; protocols: string[]},
      hooks: SourceHooks, private readonly worker = new Worker('mouse_worker.js', {type: 'module'})) {
    this.hand.radius = scene.tool_radius ?? this.hand.radius;
    this.newest = this.begin(at);
    worker.onmessage = ({data}: MessageEvent<ToPage>) => {
      switch (data.type) {
        case 'prepare':
          void hooks.ready()
              .then(() => true, () => false)
              .then((ready) => this.tell({type: 'prepared', ready}));
          break;
        case 'moment':
          if (data.turn !== this.turn) break;  // from before a restart
          this.newest = {
            ...data.moment,
            frame: data.frame === undefined ? this.newest.frame : data.frame,
            listed: data.frame === undefined || !has_lists(data.frame) ? this.newest.listed ?? null :
                                                                         data.frame,
            asked_at: data.asked_at
          };
          this.hand.put(data.moment.pose);
          hooks.moved();
          break;
        case 'lost':
          hooks.lost(data.reason);
          break;
      }
    };
    worker.onerror = ({message}) => {
      this.newest = {...this.newest, force: [0, 0, 0], torque: [0, 0, 0], response: null, note: 'stopped'};
      hooks.lost(`The mouse moves nothing any more, for its worker has failed${
          message ? `: ${message}` : ' to load'}. Load the page again.`);
    };
    this.tell({type: 'begin', scene, at, url, protocols});
  }
  private tell(message: ToWorker): void {
    this.worker.postMessage(message);
  }
  /**
   * The tool is put to `at`, or to the scene's start; what is known of it there before it was asked about.
   */
  private begin(at: Pose|null): Moment {
    this.hand.reset(at ?? this.scene.start ?? [0, 0, 0, 0, 0, 0, 1], this.scene.tool_gc ?? [0, 0, 0]);
    return {
      time: 0,
      pose: this.hand.pose(),
      frame: null,
      listed: null,
      force: [0, 0, 0],
      torque: [0, 0, 0],
      response: null,
      depth: 0,
      contact: false,
      frame_us: NaN,
      late: NaN,
      stage: 0,
      note: 'connecting',
    };
  }

  /** The tool goes to `at`, or to the scene's start; the connection stays. */
  restart(at: Pose|null = null): void {
    this.newest = this.begin(at);
    this.tell({type: 'restart', at, turn: ++this.turn});
  }
  /** The server was found again: the connection doesn't wait any longer. */
  hurry(): void {
    this.tell({type: 'hurry'});
  }
  /** Before each picture: tells the loop what the hand does, and whether areas' triangles are shown. */
  advance(areas: boolean): void {
    if (this.paused) this.hand.let_go();
    const {held} = this.hand;
    this.tell({type: 'picture', hand: {held, target: this.hand.target(), paused: this.paused}, lists: areas});
  }
  moment(): Moment {
    return {...this.newest, time: (performance.now() - this.began) / 1000};
  }
  close(): void {
    this.tell({type: 'close'});
  }
}
