// The panel of the recorded path: record, play, hand on, and what it touched.
import {path_text} from '../assembly/draft.js';
import {save_as} from '../assembly/workshop.js';
import {element, make, write} from '../dom.js';
import type {Moment} from '../moment.js';
import type {Frame, Pose} from '../server/protocol.js';
import {figure} from '../strips.js';
import {PathRecorder, touches} from './path_recorder.js';

export class PathPanel {
  readonly recorder = new PathRecorder();
  names: (frame: Frame) => string = () => '';
  /** Whether the simulated hand can be given the path; why not otherwise. */
  replay_refusal = '';
  private shown_rows = -1;

  /**
   * `changed`: it was recorded anew; `replay`: the simulated hand is to follow it; `examine`: gives the page
   * of what the path is like.
   */
  constructor(
      private readonly changed: (rows: Moment[]) => void, replay: () => void,
      private readonly examine: (poses: Pose[]) => Promise<Blob>) {
    element('record').addEventListener('click', () => this.toggle());
    element('play-path').addEventListener('click', () => {
      if (this.recorder.playing)
        this.recorder.stop();
      else
        this.recorder.play();
      this.show();
    });
    element('replay-path').addEventListener('click', replay);
    element('examine-path').addEventListener('click', () => void this.report());
    element('download-path')
        .addEventListener(
            'click',
            () => save_as(new Blob([path_text(this.recorder.rows)], {type: 'text/csv'}), 'path.csv'));
    this.show();
  }
  clear(): void {
    this.recorder.stop();
    this.recorder.rows = [];
    this.show();
  }
  toggle(): void {
    if (this.recorder.recording) {
      this.recorder.stop();
      this.changed(this.recorder.rows);
    } else
      this.recorder.start();
    this.show();
  }
  /** The report opens as a page of its own; what it says in a line is its link. */
  private async report(): Promise<void> {
    const {rows} = this.recorder;
    const verdict = element('path-verdict');
    const button = element<HTMLButtonElement>('examine-path');
    button.disabled = true;
    verdict.replaceChildren('Examining the path…');
    try {
      const page = await this.examine(rows.map(({pose}) => pose));
      if (rows !== this.recorder.rows) return;
      const title =
          new DOMParser().parseFromString(await page.text(), 'text/html').querySelector('h1')?.textContent ??
          'The path';
      verdict.replaceChildren(
          make('a', {href: URL.createObjectURL(page), target: '_blank'}, `${title}: open the report`));
    } catch (error) {
      verdict.replaceChildren(error instanceof Error ? error.message : String(error));
    } finally {
      button.disabled = false;
    }
  }
  take(moment: Moment): void {
    if (!this.recorder.take(moment)) this.changed(this.recorder.rows);
  }
  show(): void {
    const {recorder} = this;
    const {recording, playing, rows} = recorder;
    write(element('record'), recording ? 'Stop' : '● Record');
    element('record').setAttribute('aria-pressed', String(recording));
    write(element('play-path'), playing ? 'Stop playing' : 'Play');
    const ready = !recording && rows.length > 1;
    for (const id of ['play-path', 'download-path']) element<HTMLButtonElement>(id).disabled = !ready;
    const replay = element<HTMLButtonElement>('replay-path');
    replay.disabled = !ready || this.replay_refusal !== '';
    replay.title = this.replay_refusal;
    write(
        element('path-words'),
        recording ? `Recording, ${recorder.duration.toFixed(1)} s` :
            rows.length > 1 ? `${recorder.duration.toFixed(1)} s, ${rows.length.toLocaleString('en')} poses` :
                              '');
    const shown = recording ? 0 : rows.length;
    if (shown === this.shown_rows) return;
    this.shown_rows = shown;
    element('path-verdict').replaceChildren();
    const told = ready ? touches(rows, this.names) : [];
    element('path-report').hidden = !ready;
    element('path-touches')
        .replaceChildren(...told.map(
            ({from, to, parts, depth, force}) => make(
                'li', {},
                `${from.toFixed(1)}–${to.toFixed(1)} s: ${parts || 'contact'}, ${figure(depth * 1000)} mm, ${
                    figure(force)} N`)));
    write(element('path-free'), told.length === 0 ? 'Free all the way: nothing was touched.' : '');
  }
}
