// The recorded run's controls: play, scrubber, speed, and the list of runs.
import type {Api} from '../server/api.js';
import {element, fill, write} from '../dom.js';
import type {Moment} from '../moment.js';
import {Playback} from './playback.js';
import {depth, type Run, type Scene} from '../server/protocol.js';
import {Samples} from '../samples.js';

export class Player {
  playback: Playback|null = null;
  samples = new Samples();
  runs: Run[] = [];
  private readonly select = element<HTMLSelectElement>('run');
  private readonly scrubber = element<HTMLInputElement>('scrubber');
  private turn = 0;

  constructor(
      private readonly api: Api, private readonly changed: () => void,
      private readonly failed: (error: unknown) => void) {
    this.select.addEventListener('change', () => void this.load(this.select.value));
    this.scrubber.addEventListener('input', () => {
      this.playback?.seek(Number(this.scrubber.value));
      this.changed();
    });
    element('play').addEventListener('click', () => this.toggle());
    const speed = element<HTMLSelectElement>('speed');
    speed.addEventListener('change', () => {
      if (this.playback) this.playback.speed = Number(speed.value);
    });
  }

  has(name: string): boolean {
    return this.runs.some((run) => run.name === name);
  }
  async refresh(): Promise<void> {
    this.runs = await this.api.runs();
    const list = this.runs.map((run) => ({value: run.name, text: run.name}));
    fill(this.select, this.playback ? list : [
      {value: '', text: this.runs.length > 0 ? 'choose…' : 'none below the root', disabled: true}, ...list
    ]);
    this.select.value = this.playback?.run.name ?? '';
  }

  async load(name: string): Promise<void> {
    const turn = ++this.turn;
    const run = this.runs.find((candidate) => candidate.name === name);
    if (!run) return;
    const note = element('run-note');
    try {
      const playback = await Playback.load(this.api, run, (part) => {
        note.textContent = `Reading ${Math.round(part * 100)} %`;
      });
      if (turn !== this.turn) return;
      this.playback = playback;
      playback.speed = Number(element<HTMLSelectElement>('speed').value);
      this.samples = this.columns(playback);
      this.scrubber.max = String(playback.duration);
      element('duration').textContent = `of ${playback.duration.toFixed(2)} s`;
      this.offer_report(run);
      note.textContent = `${playback.trace.rows.toLocaleString('en')} ticks, ${
          playback.frames.entries.length.toLocaleString('en')} frames`;
      await this.refresh();
      this.changed();
    } catch (error) {
      note.textContent = '';
      this.failed(error);
    }
  }

  /** A link to the run's own page, where there is one; a server that asks for a token would refuse it. */
  private offer_report(run: Run): void {
    const place = element('run-report');
    place.hidden = run.files['report.html'] === undefined || this.api.has_token;
    place.querySelector('a')!.href = `v1/runs/${encodeURIComponent(run.name)}/report.html`;
  }

  /** The whole run for the strips; depth and time belong to the newest frame at each tick. */
  private columns(playback: Playback): Samples {
    const {trace, frames} = playback;
    const samples = new Samples(Math.max(1, trace.rows));
    let frame = -1;
    for (let row = 0; row < trace.rows; ++row) {
      const tick = Math.round(trace.time(row) * 1000);
      while (frame + 1 < frames.entries.length && frames.entries[frame + 1].tick <= tick) ++frame;
      const entry = frame >= 0 ? frames.entries[frame] : null;
      samples.add(trace.time(row), [
        ...trace.force(row), ...trace.torque(row), (entry?.depth ?? 0) * 1000,
        (entry?.frame_us ?? NaN) / 1000, trace.result_age(row) < 0 ? NaN : trace.result_age(row)
      ]);
    }
    return samples;
  }

  toggle(): void {
    const {playback} = this;
    if (!playback) return;
    if (!playback.playing && playback.time >= playback.duration) playback.seek(0);
    playback.playing = !playback.playing;
    this.changed();
  }

  moment(): Moment|null {
    const {playback} = this;
    if (!playback) return null;
    const row = playback.trace.row_at(playback.time);
    const frame = playback.frame(this.changed);
    return {
      time: playback.time,
      pose: frame?.pose ?? playback.trace.pose(row),
      frame,
      force: playback.trace.force(row),
      torque: playback.trace.torque(row),
      response: frame && {force: frame.force, torque: frame.torque},
      depth: depth(frame),
      contact: playback.trace.contact(row),
      frame_us: frame?.time_us['total'] ?? NaN,
      late: playback.trace.result_age(row),
      stage: playback.trace.stage(row),
      note: '',
    };
  }
  show(): void {
    const {playback} = this;
    const play = element<HTMLButtonElement>('play');
    write(play, playback?.playing ? '❚❚' : '▶');
    play.setAttribute('aria-label', playback?.playing ? 'Pause' : 'Play');
    play.disabled = this.scrubber.disabled = !playback;
    write(element('clock'), `${(playback?.time ?? 0).toFixed(2)} s`);
    this.scrubber.value = String(playback?.time ?? 0);
  }

  /** Whether a run was recorded with such a scene, as far as its summary tells. */
  static fits(run: Run, scene: Scene): boolean {
    return (run.static_triangles ?? scene.static_triangles) === scene.static_triangles &&
        (run.tool_triangles ?? scene.tool_triangles) === scene.tool_triangles;
  }
}
