// Ties the parts together: a scene, a source of moments (device, mouse or recorded run), the picture, the
// strips, the panel.
import {act, type Acted} from './actions.js';
import {read_address, write_address} from './address.js';
import {element, write} from './dom.js';
import {HeldScene} from './held_scene.js';
import {listen} from './keys.js';
import {Stillness, type Moment, type Source} from './moment.js';
import {Paced} from './paced.js';
import {Samples} from './samples.js';
import {ScenePartsPanel} from './scene_parts_panel.js';
import {ScenePicker} from './scene_picker.js';
import {Sessions} from './sessions.js';
import {Strips, figure} from './strips.js';
import {Theme} from './theme.js';
import {Wakefulness, type Next} from './wakefulness.js';
import {take_files} from './assembly/file_drop.js';
import {Workshop} from './assembly/workshop.js';
import {Labels} from './draw/labels.js';
import {DARK, LIGHT} from './draw/palette.js';
import {Picture} from './draw/picture.js';
import {offer_picture_options} from './draw/picture_options.js';
import type {Drag} from './mouse/mouse_drag.js';
import {MouseSource} from './mouse/mouse_source.js';
import {PathPanel} from './mouse/path_panel.js';
import {SpaceMouse} from './mouse/space_mouse.js';
import {Player} from './run/player.js';
import {Api, ApiError} from './server/api.js';
import {Connection} from './server/connection.js';
import type {Pose, Scene, SceneParts} from './server/protocol.js';
import {CameraShots} from './tools/camera_shots.js';
import {ClearanceLine} from './tools/clearance_line.js';
import {Headset} from './tools/headset.js';
import {Measure} from './tools/measure.js';
import {Section} from './tools/section.js';
import {Triad} from './tools/triad.js';
import {Banner} from './words/banner.js';
import {PartNames} from './words/part_names.js';
import {Readout} from './words/readout.js';
import {show_scene} from './words/scene_facts.js';
import {StartNote} from './words/start_note.js';

const REFRESH_MS = 3000;
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

export class App implements Acted {
  private readonly api = new Api();
  readonly banner = new Banner();
  readonly picture = new Picture(this.api, element('canvas'), (error) => this.failed(error));
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
  readonly player = new Player(this.api, () => this.run_changed(), (error) => this.failed(error));
  readonly sessions = new Sessions(
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
  readonly workshop = new Workshop(this.api, this.picture, {
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
  readonly paths = new PathPanel((rows) => {
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
  source: Source = 'live';
  private kept = '';                       // the scene that was saved
  private readonly wish = read_address();  // as the page was called, before it is kept up to date
  private live_samples = new Samples();
  private mouse_samples = new Samples();
  private dirty = true;
  private mouse_rests = false;
  private told: Moment|null = null;
  private readonly held = new HeldScene(this.api, this.picker);
  private readonly stillness = new Stillness();
  private readonly wakefulness =
      new Wakefulness(this.picture.view, (now) => this.tick(now), () => this.next());
  private readonly words =
      new Paced(this.picture.view.software ? WORDS_MS_WITHOUT_GPU : WORDS_MS, () => this.tell());
  readonly theme: Theme;

  constructor() {
    this.wire_panel();
    listen((action) => act(action, this), (...way) => {
      if (!this.mouse) return false;
      this.picture.drag.nudge(...way);
      this.touch();
      return true;
    });
    this.wire_tools();
    this.theme = new Theme((dark) => {
      this.picture.theme(dark);
      this.workshop.theme(dark);
      this.clearance.theme(dark ? DARK : LIGHT);
      this.strips.theme();
      this.touch();
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
  touch(): void {
    this.dirty = true;
    this.wakefulness.wake();
  }
  private next(): Next {
    if (this.source === 'run') return this.player.playback?.playing ? 'picture' : 'rest';
    if (this.source === 'mouse' && this.mouse) return this.mouse_rests ? 'look' : 'picture';
    return 'rest';
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
      await this.held.hold();
      await this.choose(this.source);
      this.mouse?.hurry();
      this.say('Connected again.');
    } catch (error) {
      this.failed(error);
    }
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
                       moved: () => this.wakefulness.wake(),
                       lost: (reason) => this.mouse_lost(reason)
                     });
    this.picture.drag.hand = this.mouse?.hand ?? null;
    element('mouse-pause').textContent = 'Pause';
    this.wakefulness.wake();
  }
  private async hold_for_mouse(): Promise<void> {
    if (!this.connection.up) throw new Error('no server');
    try {
      await this.held.hold();
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
  run_changed(): void {
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
    const seconds = this.wakefulness.seconds(now);
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
        this.mouse_rests = this.stillness.is_still(moment, this.picture.drag.holding) &&
            this.picture.drag.holding === null && !this.paths.recorder.recording &&
            !this.paths.recorder.playing;
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
    this.words.want();
  }
  /** The moment in figures and curves. */
  private tell(): void {
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
    element('look-tool').addEventListener('click', () => act('tool', this));
    element('look-all').addEventListener('click', () => act('all', this));
    element('theme').addEventListener('click', () => act('theme', this));
    element('panel-button').addEventListener('click', () => act('panel', this));
    element('help-button').addEventListener('click', () => act('help', this));
    element('token').addEventListener('close', () => {
      this.api.set_token(element<HTMLInputElement>('token-value').value);
      void this.begin();
    });
  }
  pause_mouse(): void {
    if (!this.mouse) return;
    this.mouse.paused = !this.mouse.paused;
    element('mouse-pause').textContent = this.mouse.paused ? 'Go on' : 'Pause';
  }
}
