// Which scene is shown: those that the server holds, and scene files that it could open. Waits while one is
// prepared.
import {ApiError, type Api} from './server/api.js';
import {element, fill, make} from './dom.js';
import type {Scene, SceneList} from './server/protocol.js';
import {scene_rows} from './words/scene_rows.js';

const POLL_MS = 400;

export class ScenePicker {
  current: Scene|null = null;
  /**
   * The file that the current scene was opened from: after a restart of the server it can be opened again.
   */
  path = '';
  list: SceneList = {scenes: [], available: []};
  private readonly select = element<HTMLSelectElement>('scene');
  private turn = 0;

  constructor(
      private readonly api: Api, private readonly opened: (scene: Scene) => Promise<void>,
      private readonly failed: (error: unknown) => void) {
    this.select.addEventListener('change', () => {
      const [kind, value] = [this.select.value.slice(0, 3), this.select.value.slice(3)];
      if (kind === 'id:')
        void this.open_id(value);
      else if (kind === 'at:')
        void this.open_path(value);
    });
  }

  async refresh(): Promise<void> {
    this.list = await this.api.scenes();
    this.fill();
  }
  private fill(): void {
    const head = this.current ? [] : [{value: '', text: 'choose…', disabled: true}];
    fill(this.select, [...head, ...scene_rows(this.list, this.current?.id ?? '')]);
    this.select.value = this.current ? `id:${this.current.id}` : '';
  }

  open_path(path: string): Promise<void> {
    return this.open(() => this.api.open_scene(path), path, path);
  }
  /** A scene that is made of an assembly. */
  open_made(make: () => Promise<Scene>, name: string): Promise<void> {
    return this.open(make, '', name);
  }
  open_id(id: string): Promise<void> {
    const name = this.list.scenes.find((scene) => scene.id === id)?.name ?? id;
    // A scene of a file bears the file's name.
    return this.open(
        () => this.api.scene(id),
        id === this.current?.id                ? this.path :
            this.list.available.includes(name) ? name :
                                                 '',
        name);
  }

  /** Waits while a scene is prepared, for as long as `goes_on`, which is shown each state, says so. */
  async prepared(scene: Scene, goes_on: (scene: Scene) => boolean): Promise<Scene> {
    while ((scene.state === 'queued' || scene.state === 'preparing' || scene.state === 'evicted') &&
           goes_on(scene)) {
      // Whoever asks for something of an evicted scene has it prepared again.
      if (scene.state === 'evicted')
        await this.api.geometry(scene.id, 100).catch((error: unknown) => {
          if (!(error instanceof ApiError) || error.status !== 503) throw error;
        });
      await new Promise((resolve) => setTimeout(resolve, POLL_MS));
      scene = await this.api.scene(scene.id);
    }
    return scene;
  }
  /**
   * `first` asks for the scene; then it is waited for, however long that takes, unless another is chosen
   * meanwhile.
   */
  private async open(first: () => Promise<Scene>, path: string, name: string): Promise<void> {
    const turn = ++this.turn;
    try {
      const scene = await this.prepared(await first(), (now) => {
        if (turn === this.turn) this.show_progress(now);
        return turn === this.turn;
      });
      if (turn !== this.turn) return;
      if (scene.state !== 'ready')
        throw new ApiError(409, scene.error, scene.error?.detail ?? `The scene is ${scene.state}.`);
      this.current = scene;
      this.path = path;
      this.hide();
      await this.opened(scene);
      await this.refresh();
    } catch (error) {
      if (turn !== this.turn) return;
      this.fill();
      // No answer, or a token that is wanted: not the scene's fault, and said elsewhere.
      if (error instanceof ApiError && (error.status === 0 || error.status === 401)) {
        if (!this.current) this.show_empty();
        this.failed(error);
        return;
      }
      this.show_refusal(`${name} can't be opened`, error instanceof Error ? error.message : String(error));
    }
  }

  /**
   * Instead of a picture, so that no other scene's stands behind what is said; what was open can be gone
   * back to.
   */
  show_refusal(title: string, text: string): void {
    this.show_empty();
    element('empty').dataset['state'] = 'bad';
    element('empty-title').textContent = title;
    element('empty-text').textContent = text;
    element('empty-drop').hidden = true;
    const {current} = this;
    if (current)
      element('empty-list').prepend(this.choice(`Back to ${current.name}`, () => this.hide(), 'main'));
  }
  private choice(text: string, act: () => void, kind = ''): HTMLButtonElement {
    const button = make('button', {class: kind}, text);
    button.addEventListener('click', act);
    return button;
  }
  show_empty(): void {
    element('empty').hidden = false;
    element('empty').dataset['state'] = '';
    document.body.classList.toggle('no-scene', this.current === null);
    element('empty-drop').hidden = false;
    element('empty-title').textContent = 'No scene is open';
    element('empty-text').textContent = this.list.available.length + this.list.scenes.length > 0 ?
        'Open your own parts, or one of these scenes:' :
        'Open your own parts. There is no scene file below the server\'s root.';
    element('empty-progress').hidden = true;
    element('empty-list')
        .replaceChildren(...scene_rows(this.list, '')
                             .map(
                                 ({value, text}) => this.choice(
                                     text,
                                     () => void (
                                         value.startsWith('id:') ? this.open_id(value.slice(3)) :
                                                                   this.open_path(value.slice(3))))));
  }
  private show_progress(scene: Scene): void {
    element('empty').hidden = false;
    element('empty').dataset['state'] = '';
    element('empty-drop').hidden = true;
    element('empty-title').textContent = scene.name;
    element('empty-text').textContent = scene.state === 'queued' ? 'Waiting for its turn to be prepared' :
                                                                   `Preparing: ${scene.step ?? 'reading'}`;
    const bar = element<HTMLProgressElement>('empty-progress');
    bar.hidden = false;
    if (scene.progress === null)
      bar.removeAttribute('value');
    else
      bar.value = scene.progress;
    element('empty-list').replaceChildren();
  }
  private hide(): void {
    element('empty').hidden = true;
    document.body.classList.remove('no-scene');
  }
}
