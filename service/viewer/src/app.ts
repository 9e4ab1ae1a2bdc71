// Ties the parts together: a scene, a source of moments (device, mouse or recorded run), the picture, the
// strips, the panel.
import {read_address, write_address} from './address.js';
import {take_files} from './assembly/file_drop.js';
import {Workshop} from './assembly/workshop.js';
import {element, write} from './dom.js';
import {Api, ApiError} from './server/api.js';
import {Connection} from './server/connection.js';

import {listen, type Action} from './keys.js';
import {Labels} from './draw/labels.js';
import type {Moment} from './moment.js';
import type {Drag} from './mouse/mouse_drag.js';
import {MouseSource} from './mouse/mouse_source.js';
import {PathPanel} from './mouse/path_panel.js';
import {SpaceMouse} from './mouse/space_mouse.js';
import {Banner} from './words/banner.js';
import {PartNames} from './words/part_names.js';
import {show_scene} from './words/scene_facts.js';
import {StartNote} from './words/start_note.js';
import {DARK, LIGHT} from './draw/palette.js';
import {Picture} from './draw/picture.js';
import {offer_picture_options} from './draw/picture_options.js';
import {Player} from './run/player.js';
import type {Pose, Scene, SceneParts} from './server/protocol.js';
import {Readout} from './words/readout.js';
import {Samples} from './samples.js';
import {CameraShots} from './tools/camera_shots.js';
import {ClearanceLine} from './tools/clearance_line.js';
import {Headset} from './tools/headset.js';
import {Measure} from './tools/measure.js';
import {Section} from './tools/section.js';
import {Triad} from './tools/triad.js';
import {ScenePartsPanel} from './scene_parts_panel.js';
import {ScenePicker} from './scene_picker.js';
import {Sessions} from './sessions.js';
import {Strips, figure} from './strips.js';

type Source = 'live'|'mouse'|'run';
const REFRESH_MS = 3000;
const TURN = 0.1;  // rad of a key that turns the view; chosen
const STEPS: Partial<Record<Action, [number, number, number]>> = {
  'turn-left': [-TURN, 0, 0],
  'turn-right': [TURN, 0, 0],
  'turn-up': [0, TURN, 0],
  'turn-down': [0, -TURN, 0],
  'nearer': [0, 0, 0.1],
  'farther': [0, 0, -0.1]
};
// From one change of figures and curves to the next: more often they can't be read, and to lay them out takes
// as long as a picture, which without a GPU the engine lacks. Chosen.
const WORDS_MS = 80, WORDS_MS_WITHOUT_GPU = 160;
const FELT: Record<Source, string> = {
  live: 'to the device',
  mouse: 'to the hand',
  run: 'to the device'
};
const LATE: Record<Source, [string, string]> = {
  live: ['Lateness', 'µs'],
  mouse: ['There and back', 'ms'],
  run: ['Age of result', 'ticks']
};

export class App {
  private readonly api = new Api();
  private readonly banner = new Banner();
  private readonly picture = new Picture(this.api, element('canvas'), (error) => this.failed(error));
  private readonly labels = new Labels(this.picture.view);
  private readonly strips = new Strips(element('strips'));
  private readonly readout = new Readout((kind, on) => {
    if (on)
      this.picture.contact.shown.add(kind);
    else
      this.picture.contact.shown.delete(kind);
    this.picture.redraw_contact();
  });
  private readonly picker =
      new ScenePicker(this.api, (scene) => this.opened(scene), (error) => this.failed(error));
  private readonly player = new Player(this.api, () => this.run_changed(), (error) => this.failed(error));
  private readonly sessions = new Sessions(
      this.api,
      (moment) => {
        this.live_samples.add_moment(moment);
        this.touch();
      },
      (error) => this.failed(error),
      (text) => {
        this.say(text);
        this.connection.doubt();
      });
  private readonly connection = new Connection(this.api, (up) => void this.link_changed(up));
  private readonly workshop = new Workshop(this.api, this.picture, {
    open: async (make, name, stay) => {
      if (!stay) this.source = 'mouse';
      this.stay = stay ? this.picture.pose_of_tool() : null;
      await this.picker.open_made(make, name).finally(() => {
        this.stay = null;
      });
    },
    may_change:
        () => {
          if (this.sessions.live) this.say('A device runs on this scene: stop it, then change it.', true);
          return !this.sessions.live;
        },
    entered:
        (building) => {
          if (building)
            this.sessions.leave();
          else if (!this.picker.current)
            this.picker.show_empty();
          if (building) this.keep_mouse(null);
          this.remember();
          this.touch();
        },
    say: (text, bad) => this.say(text, bad),
    failed: (error) => this.failed(error),
  });
  private readonly start_note = new StartNote(this.api);
  private readonly paths = new PathPanel((rows) => {
    this.workshop.path = rows;
  }, () => void this.replay(), (poses) => this.api.path_page(this.picker.current!.id, poses));
  private readonly clearance =
      new ClearanceLine(this.api, this.picture.view, () => this.touch(), (error) => this.failed(error));
  private readonly space_mouse = new SpaceMouse(() => this.touch(), (error) => this.failed(error));
  private readonly part_panel: ScenePartsPanel = new ScenePartsPanel((hidden) => {
    this.picture.bodies.hide(this.scene_parts, hidden);
    this.picture.view.request();
  });
  private scene_parts: SceneParts = {static: [], tool: []};
  private stay: Pose|null = null;  // where the tool is to go on when the scene that is felt is made anew
  private mouse: MouseSource|null = null;
  private holding: Promise<void>|null = null;
  private source: Source = 'live';
  private kept = '';                       // the scene that was saved
  private readonly wish = read_address();  // as the page was called, before it is kept up to date
  private live_samples = new Samples();
  private mouse_samples = new Samples();
  private dirty = true;
  private awake = false;
  private rest_timer = 0;
  private mouse_rests = false;
  private last_tick = NaN;
  private told: Moment|null = null;
  private words_at = -Infinity;
  private words_timer = 0;

  constructor() {
    this.wire_panel();
    listen((action) => this.act(action), (...way) => {
      if (!this.mouse) return false;
      this.picture.drag.nudge(...way);
      this.touch();
      return true;
    });
    this.wire_tools();
    this.apply_theme(
        localStorage.getItem('palpate.theme') ??
        (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) => {
      if (!localStorage.getItem('palpate.theme')) this.apply_theme(event.matches ? 'dark' : 'light');
    });
    // As in theme.css: a narrow panel lies over the picture, and opens when it is asked for.
    const narrow = matchMedia('(max-width: 860px)');
    const fold = () => {
      document.body.classList.toggle('no-panel', narrow.matches);
    };
    fold();
    narrow.addEventListener('change', fold);
    this.picture.levelled = () => this.show_scales();
    this.picture.add(this.clearance.object);
    new ResizeObserver(() => {
      this.touch();
    }).observe(element('strips'));
    this.strips.seek = (time) => {
      this.player.playback?.seek(time);
      this.run_changed();
    };
    void this.choose(
        ['live', 'mouse', 'run'].includes(this.wish.source ?? '') ? (this.wish.source as Source) : 'live');
    this.sessions.show();
    void this.begin();
    setInterval(() => void this.refresh(), REFRESH_MS);
    this.touch();
  }

  /** Something is to be shown anew. The page rests until then. */
  private touch(): void {
    this.dirty = true;
    this.wake();
  }
  private wake(): void {
    clearTimeout(this.rest_timer);
    if (this.awake || this.picture.view.presenting) return;
    this.awake = true;
    this.picture.view.before_next((now) => {
      this.awake = false;
      this.tick(now);
      if (this.source === 'run' && this.player.playback?.playing) this.wake();
      // A mouse that moves nothing is looked at ten times a second.
      else if (this.source === 'mouse' && this.mouse) {
        if (this.mouse_rests)
          this.rest_timer = window.setTimeout(() => this.wake(), 100);
        else
          this.wake();
      }
      if (!this.awake) this.last_tick = NaN;
    });
  }

  // ---- beginning, and beginning again

  private async begin(): Promise<void> {
    const {wish} = this;
    const in_parts = !wish.scene && !wish.path;
    if (wish.assembly && await this.workshop.restore(wish.assembly, in_parts) && in_parts) return;
    const run = wish.run;  // until it is known to be here or missing, no other is shown in its place
    try {
      await this.picker.refresh();
      await this.player.refresh();
      const held = this.picker.list.scenes.find((scene) => scene.id === wish.scene);
      if (held) {
        await this.picker.open_id(held.id);
        this.picker.path = wish.path ?? '';
        this.remember();
      } else if (wish.path && this.picker.list.available.includes(wish.path))
        await this.picker.open_path(wish.path);
      else if (wish.path || wish.scene) {
        this.picker.show_refusal(
            'The scene of this link is not here',
            wish.path ?
                `There is no ${wish.path} below the server's root, and the server holds no scene ${
                    wish.scene ?? ''} either. Choose another:` :
                `The server holds no scene ${
                    wish.scene}. It may have been started anew since: scenes that were uploaded are gone then. Choose another:`);
      } else if (this.picker.list.scenes.length > 0)
        await this.picker.open_id(this.picker.list.scenes[0].id);
      else
        this.picker.show_empty();
      wish.run = '';
      if (run && this.player.has(run))
        await this.player.load(wish.run);
      else if (run)
        this.say(`The run of this link, ${run}, is not below the server's root.`, true, true);
    } catch (error) {
      this.picker.show_empty();
      this.failed(error);
    }
  }
  private async opened(scene: Scene): Promise<void> {
    this.sessions.leave();
    this.keep_mouse(null);
    this.live_samples.clear();
    this.mouse_samples.clear();
    const {stay} = this;
    this.workshop.enter(false);
    if (!stay) element('panel').scrollTop = 0;  // what is to be said of a scene stands on top
    this.start_note.hide();
    this.clearance.forget();
    if (!stay) this.paths.clear();
    await this.picture.open(scene, stay);
    this.labels.with_force = scene.profile === 'paper';
    this.readout.set_profile(scene.profile);
    show_scene(scene);
    void this.look_closer(scene, stay !== null);
    this.remember();
    await this.choose(this.source);
  }
  /** What takes longer than a picture: names of parts, and what touches at the start. */
  private async look_closer(scene: Scene, stays: boolean): Promise<void> {
    const made_here = this.workshop.made === scene.id;
    const {path} = this.picker;
    this.workshop.offer_settings(made_here);
    this.paths.replay_refusal = made_here ?
        '' :
        'Only a scene that was made here, from its parts, can be given a path: open the files';
    this.readout.names = () => '';
    this.readout.touching = () => '';
    try {
      const parts = await this.api.scene_parts(scene.id);
      if (this.picker.current !== scene) return;
      const names = new PartNames(parts);
      this.scene_parts = parts;
      this.part_panel.set(parts, stays ? null : (made_here ? this.workshop.hidden_paths : []));
      this.readout.names = (area) => names.of_area(area);
      this.readout.touching = this.paths.names = (frame) => names.of_frame(frame);
      const leave_out = made_here ?
          () => {
            this.workshop.set_ignore_initial(true);
            void this.workshop.feel();
          } :
          path ? () => void this.picker.open_made(() => this.api.open_scene(path, true), scene.name) :
                 null;
      await this.start_note.look(scene, leave_out);
    } catch (error) {
      this.failed(error);
    }
  }
  /** The simulated hand follows what was recorded. */
  private async replay(): Promise<void> {
    await this.workshop.feel();
    await this.choose('live');
    element<HTMLSelectElement>('device').value = 'simulated';
    this.sessions.show();
    this.sessions.toggle();
  }
  private async link_changed(up: boolean): Promise<void> {
    element('link').dataset['state'] = up ? 'up' : 'down';
    element('link-text').textContent = up ? 'connected' : 'no server';
    element('stage-box').classList.toggle('stale', !up);
    if (!up) {
      this.say('The server does not answer. What you see is the last picture; trying again.', true, true);
      return;
    }
    this.banner.hide();
    try {
      if (!this.picker.current) {
        await this.begin();
        return;
      }
      await this.hold();
      await this.choose(this.source);
      this.mouse?.hurry();
      this.say('Connected again.');
    } catch (error) {
      this.failed(error);
    }
  }
  /**
   * Resolves when the server holds the scene that is shown, ready. It may be another process than before:
   * then the scene is opened again by its path. Whoever asks meanwhile waits for the same.
   */
  private hold(): Promise<void> {
    return (this.holding ??= this.make_held().finally(() => {
      this.holding = null;
    }));
  }
  private async make_held(): Promise<void> {
    await this.picker.refresh();
    const {current, path} = this.picker;
    if (!current) return;
    const listed = this.picker.list.scenes.find(
        (scene) => scene.id === current.id && scene.state !== 'failed');  // perhaps still being prepared
    if (!listed && !path) throw new Error('The server no longer holds this scene. Open it again to go on.');
    const scene = listed ?? (await this.api.open_scene(path));
    // The same scene is not drawn anew; the file may have another by now.
    if (scene.id !== current.id) {
      await this.picker.open_path(path);
      return;
    }
    const held = await this.picker.prepared(scene, () => this.picker.current === current);
    if (held.state === 'failed') throw new Error(held.error?.detail ?? 'The scene is failed.');
    if (!listed) await this.picker.refresh();  // the list was without it
  }

  private async refresh(): Promise<void> {
    if (!this.connection.up || document.hidden) return;
    try {
      if (this.source === 'live' && this.picker.current) await this.sessions.refresh(this.picker.current);
      if (this.source === 'run' && !this.player.playback?.playing) await this.player.refresh();
      if (!this.picker.current) await this.picker.refresh();
    } catch (error) {
      this.failed(error);
    }
  }

  // ---- sources

  private async choose(source: Source): Promise<void> {
    if (source !== this.source) {
      this.readout.show(null, []);
      this.picture.redraw_contact();
      if (this.connection.up) this.banner.hide();  // it was about what was shown before
    }
    this.source = source;
    for (const tab of document.querySelectorAll<HTMLElement>('[data-source]'))
      tab.setAttribute('aria-selected', String(tab.dataset['source'] === source));
    for (const part of document.querySelectorAll<HTMLElement>('[data-for]'))
      part.hidden = part.dataset['for'] !== source;
    element('player').hidden = source !== 'run';
    document.body.classList.toggle('recorded', source === 'run');
    this.strips.set_late(...LATE[source]);
    write(element('felt-title'), FELT[source]);
    this.remember();
    this.touch();
    this.keep_mouse(source === 'mouse' ? this.picker.current : null);
    const scene = this.picker.current;
    try {
      if (source === 'live' && scene) await this.sessions.refresh(scene);
      if (source === 'run') {
        await this.player.refresh();
        // A run that was recorded with this scene is shown at once.
        const fitting = this.player.playback || !scene || this.wish.run ?
            undefined :
            this.player.runs.find((run) => run.static_triangles !== null && Player.fits(run, scene));
        if (fitting && this.source === 'run') await this.player.load(fitting.name);
      }
    } catch (error) {
      this.failed(error);
    }
  }
  /**
   * The mouse moves the tool of this scene, from where it is; null: of none. Only here does a mouse begin
   * and end.
   */
  private keep_mouse(scene: Scene|null): void {
    if (this.mouse?.scene.id === scene?.id) return;
    this.mouse?.close();
    this.mouse = scene &&
        new MouseSource(
                     scene, this.picture.bodies.tool.visible ? this.picture.pose_of_tool() : null,
                     this.api.socket_address(`v1/scenes/${scene.id}/haptic`), {
                       ready: () => this.hold_for_mouse(),
                       moved: () => this.wake(),
                       lost: (reason) => this.mouse_lost(reason)
                     });
    this.picture.drag.hand = this.mouse?.hand ?? null;
    element('mouse-pause').textContent = 'Pause';
    this.wake();
  }
  private async hold_for_mouse(): Promise<void> {
    if (!this.connection.up) throw new Error('no server');
    try {
      await this.hold();
    } catch (error) {
      this.failed(error);
      throw error;
    }
  }
  private mouse_lost(reason: string): void {
    if (reason) this.say(reason, true);
    if (this.connection.up)
      this.connection.doubt();  // perhaps the loop alone ended, perhaps the whole server went
  }
  private run_changed(): void {
    this.touch();
    this.remember();
    const {playback} = this.player;
    const scene = this.picker.current;
    const fits = !playback || !scene || Player.fits(playback.run, scene);
    if (!fits)
      element('run-note').textContent =
          `Recorded with another scene (${playback!.run.static_triangles?.toLocaleString('en')} + ${
              playback!.run.tool_triangles?.toLocaleString(
                  'en')} triangles): open that one to see where it touches.`;
  }

  // ---- each picture

  private tick(now: number): void {
    const seconds = Number.isNaN(this.last_tick) ?
        0 :
        Math.min((now - this.last_tick) / 1000, 0.25);  // after a rest, or a hidden page, time does not leap
    this.last_tick = now;
    let moment: Moment|null = null;
    if (this.source === 'mouse') {
      if (this.mouse) {
        if (this.paths.recorder.playing) {
          moment = this.paths.recorder.advance(seconds);
          if (!moment) this.paths.show();
        } else {
          if (this.picture.drag.steer(this.space_mouse.wish(), seconds)) this.dirty = true;
          this.mouse.advance(this.paths.recorder.recording || this.picture.contact.colouring !== 'kind');
        }
        moment ??= this.mouse.moment();
        this.paths.take(moment);
        if (this.paths.recorder.recording) this.paths.show();
        this.mouse_samples.add_moment(moment);
        this.mouse_rests = this.idle(moment) && this.picture.drag.holding === null &&
            !this.paths.recorder.recording && !this.paths.recorder.playing;
        this.dirty ||= !this.mouse_rests;
      }
    } else if (this.source === 'run') {
      if (this.player.playback?.playing) {
        this.player.playback.advance(seconds);
        this.touch();
      }
    }
    if (!this.dirty) return;
    this.dirty = false;
    if (this.source === 'live') moment = this.sessions.moment;
    if (this.source === 'run') moment = this.player.moment();
    if (this.source === 'run' && moment && this.player.playback && this.picker.current &&
        !Player.fits(this.player.playback.run, this.picker.current))
      moment = {...moment, frame: null};

    if (moment) this.picture.show(moment);
    if (moment && this.picker.current && !this.workshop.building)
      this.clearance.want(this.picker.current.id, moment.pose, moment.contact);
    this.labels.set(moment?.frame?.contact ? moment.frame.areas : []);
    this.told = moment;
    clearTimeout(this.words_timer);
    const pause = this.picture.view.software ? WORDS_MS_WITHOUT_GPU : WORDS_MS;
    const wait = pause - (performance.now() - this.words_at);
    if (wait > 0)
      this.words_timer = window.setTimeout(() => this.tell(), wait);
    else
      this.tell();
  }
  /** The moment in figures and curves. */
  private tell(): void {
    this.words_at = performance.now();
    this.readout.show(this.told, this.picker.current?.stages ?? []);
    this.player.show();
    this.strips.samples = this.source === 'run' ? this.player.samples :
        this.source === 'mouse'                 ? this.mouse_samples :
                                                  this.live_samples;
    this.strips.recorded = this.source === 'run' && this.player.playback ?
        {duration: this.player.playback.duration, time: this.player.playback.time} :
        null;
    this.strips.draw();
    this.show_scales();
  }
  private last_shown = '';
  /** Whether a mouse moment looks like the one before: then nothing is drawn. */
  private idle(moment: Moment): boolean {
    const text = `${moment.pose.join()} ${moment.force.join()} ${moment.frame?.tick} ${moment.note} ${
        this.picture.drag.holding}`;
    const same = text === this.last_shown && moment.frame === this.last_frame;
    this.last_shown = text;
    this.last_frame = moment.frame;
    return same;
  }
  private last_frame: unknown = null;

  private show_scales(): void {
    const {areas, view, drawn_triangles, reduced} = this.picture;
    write(element('scales'), !this.picture.scene ? '' : [
      `grid ${figure(view.grid_cell * 1000)} mm`,
      `1 N = ${figure(areas.metres_per_newton * 1000)} mm`,
      `1 N·m = ${figure(areas.metres_per_newton_metre * 1000)} mm`,
      ...(areas.gain > 1 ? [`heights ${figure(areas.gain)}×`] : []),
      ...(reduced ? [`drawn: ${drawn_triangles.toLocaleString('en')} triangles, contact exact`] : []),
    ].join(' · '));
  }
  // ---- words, keys, panel

  private remember(): void {
    // Of a scene that was saved the file counts: it has the path as well.
    const {current} = this.picker;
    write_address({
      scene: this.workshop.building || current?.id === this.kept ? '' : current?.id ?? '',
      path: this.workshop.building ? '' : this.picker.path,
      source: this.source,
      run: this.source === 'run' ? this.player.playback?.run.name ?? '' : '',
      assembly: this.workshop.assembly?.id ?? ''
    });
  }
  private failed(error: unknown): void {
    if (error instanceof ApiError && error.status === 0) {
      this.connection.doubt();
      return;
    }  // it says by itself that the server is gone
    if (error instanceof ApiError && error.status === 401) {
      const dialog = element<HTMLDialogElement>('token');
      if (!dialog.open) dialog.showModal();
      return;
    }
    this.say(error instanceof Error ? error.message : String(error), true);
  }
  private say(text: string, bad = false, stays = false): void {
    this.banner.say(text, bad, stays);
  }

  private apply_theme(theme: string): void {
    document.documentElement.dataset['theme'] = theme;
    this.picture.theme(theme === 'dark');
    this.workshop.theme(theme === 'dark');
    this.clearance.theme(theme === 'dark' ? DARK : LIGHT);
    this.strips.theme();
    this.touch();
  }
  private wire_tools(): void {
    const {picture, workshop} = this;
    const section = new Section(picture.view, () => (workshop.building ? workshop.box() : picture.box()));
    new CameraShots(
        picture.view, () => (workshop.building ? workshop.name : this.picker.current?.name ?? ''),
        (text, bad) => this.say(text, bad));
    new Headset(picture.view, {
      bounds: () => picture.view.bounds,
      hand: () => this.mouse?.hand ?? null,
      frame: (now) => this.tick(now),
      ended: () => this.touch(),
      failed: (error) => this.failed(error)
    });
    const measure = new Measure(picture.view, (ray) => {
      const point = workshop.building ? workshop.meet(ray) : picture.meet(ray);
      return point && section.hides(point) ? null : point;
    });
    const triad = new Triad(picture.view);
    picture.view.before_draw.push(() => {
      measure.place();
      triad.draw();
    });
    picture.view.after_draw.push((ms) => triad.count(ms));
  }
  private wire_files(): void {
    const [files, folder] =
        [element<HTMLInputElement>('files-input'), element<HTMLInputElement>('folder-input')];
    take_files([files, folder], (over) => {
      element('drop-here').hidden = !over;
    }, (taken) => void this.workshop.take(taken));
    for (const id of ['open-files', 'choose-files'])
      element(id).addEventListener('click', () => files.click());
    element('choose-folder').addEventListener('click', () => folder.click());
    document.addEventListener('palpate-saved', (event) => {
      if (this.picker.current && this.picker.current.id === this.workshop.made) {
        this.picker.path = (event as CustomEvent<string>).detail;
        this.kept = this.workshop.made;
        this.remember();
      }
      void this.picker.refresh().catch((error: unknown) => this.failed(error));
    });
  }
  private wire_panel(): void {
    this.wire_files();
    for (const tab of document.querySelectorAll<HTMLElement>('[data-source]'))
      tab.addEventListener('click', () => void this.choose(tab.dataset['source'] as Source));
    offer_picture_options(
        this.picture, this.labels, this.clearance, () => this.touch(), (error) => this.failed(error));
    element('mouse-reset').addEventListener('click', () => {
      this.mouse?.restart();
      this.touch();
    });
    const drag = element<HTMLSelectElement>('drag-mode');
    drag.addEventListener('change', () => {
      this.picture.drag.plain = drag.value as Drag;
    });
    element('mouse-pause').addEventListener('click', () => this.pause_mouse());
    element('look-tool').addEventListener('click', () => this.act('tool'));
    element('look-all').addEventListener('click', () => this.act('all'));
    element('theme').addEventListener('click', () => this.act('theme'));
    element('panel-button').addEventListener('click', () => this.act('panel'));
    element('help-button').addEventListener('click', () => this.act('help'));
    element('token').addEventListener('close', () => {
      this.api.set_token(element<HTMLInputElement>('token-value').value);
      void this.begin();
    });
  }
  private pause_mouse(): void {
    if (!this.mouse) return;
    this.mouse.paused = !this.mouse.paused;
    element('mouse-pause').textContent = this.mouse.paused ? 'Go on' : 'Pause';
  }

  private act(action: Action): void {
    const {playback} = this.player;
    switch (action) {
      case 'play':
        if (this.source === 'run')
          this.player.toggle();
        else if (this.source === 'live')
          this.sessions.toggle();
        else
          this.pause_mouse();
        break;
      case 'back':
      case 'forward':
        if (this.source === 'run' && playback) {
          playback.playing = false;
          playback.step(action === 'back' ? -1 : 1);
          this.run_changed();
        }
        break;
      case 'record':
        if (this.source === 'mouse' && !this.workshop.building) this.paths.toggle();
        break;
      case 'begin':
        playback?.seek(0);
        this.run_changed();
        break;
      case 'end':
        playback?.seek(playback.duration);
        this.run_changed();
        break;
      case 'theme': {
        const theme = document.documentElement.dataset['theme'] === 'dark' ? 'light' : 'dark';
        localStorage.setItem('palpate.theme', theme);
        this.apply_theme(theme);
        break;
      }
      case 'all':
        if (this.workshop.building)
          this.workshop.look_at_all();
        else
          this.picture.look_at_all();
        break;
      case 'undo':
        if (this.workshop.building) this.workshop.undo();
        break;
      case 'redo':
        if (this.workshop.building) this.workshop.redo();
        break;
      case 'tool':
        if (this.workshop.building)
          this.workshop.look_at_selected();
        else
          this.picture.follow_tool();
        break;
      case 'panel':
        document.body.classList.toggle('no-panel');
        this.touch();
        break;
      case 'help':
        element<HTMLDialogElement>('help').showModal();
        break;
      case 'glass':
        element('glass-mockup').click();
        break;
      case 'clearance':
        element('show-clearance').click();
        break;
      case 'voxels': {
        const voxels = element<HTMLSelectElement>('voxels');
        voxels.selectedIndex = (voxels.selectedIndex + 1) % voxels.options.length;
        voxels.dispatchEvent(new Event('change'));
        break;
      }
      case 'close':
        this.banner.hide();
        break;
      case 'up':
        this.picture.view.turn_up();
        break;
      default:
        if (action in STEPS)
          this.picture.view.step(...STEPS[action]!);
        else
          document.querySelectorAll<HTMLButtonElement>('#legend button')[Number(action.slice(4)) - 1]
              ?.click();
    }
  }
}
