// Which scene is shown: those that the server holds, and scene files that it could open. Waits while one is prepared.
import { ApiError, type Api } from './api.js';
import { element, fill, make } from './dom.js';
import type { Scene, SceneList } from './protocol.js';

const POLL_MS = 400;

export class ScenePicker {
  current: Scene | null = null;
  /** The file that the current scene was opened from: after a restart of the server it can be opened again. */
  path = '';
  list: SceneList = { scenes: [], available: [] };
  private readonly select = element<HTMLSelectElement>('scene');
  private turn = 0;

  constructor(private readonly api: Api, private readonly opened: (scene: Scene) => Promise<void>, private readonly failed: (error: unknown) => void) {
    this.select.addEventListener('change', () => {
      const [kind, value] = [this.select.value.slice(0, 3), this.select.value.slice(3)];
      if (kind === 'id:') void this.open_id(value); else if (kind === 'at:') void this.open_path(value);
    });
  }

  async refresh(): Promise<void> {
    this.list = await this.api.scenes();
    this.fill();
  }
  private fill(): void {
    const held = this.list.scenes.map((scene) => ({ value: `id:${scene.id}`, text: `${scene.name}${scene.state === 'ready' ? '' : `, ${scene.state}`}` }));
    const files = this.list.available.map((path) => ({ value: `at:${path}`, text: `open ${path}` }));
    const head = this.current ? [] : [{ value: '', text: 'choose…', disabled: true }];
    fill(this.select, [...head, ...held, ...files]);
    this.select.value = this.current ? `id:${this.current.id}` : '';
  }

  open_path(path: string): Promise<void> {
    return this.open(() => this.api.open_scene(path), path);
  }
  open_id(id: string): Promise<void> {
    return this.open(() => this.api.scene(id), id === this.current?.id ? this.path : '');
  }

  /** Waits while a scene is prepared, for as long as `goes_on`, which is shown each state, says so. */
  async prepared(scene: Scene, goes_on: (scene: Scene) => boolean): Promise<Scene> {
    while ((scene.state === 'queued' || scene.state === 'preparing' || scene.state === 'evicted') && goes_on(scene)) {
      // Whoever asks for something of an evicted scene has it prepared again.
      if (scene.state === 'evicted') await this.api.geometry(scene.id, 100).catch((error: unknown) => { if (!(error instanceof ApiError) || error.status !== 503) throw error; });
      await new Promise((resolve) => setTimeout(resolve, POLL_MS));
      scene = await this.api.scene(scene.id);
    }
    return scene;
  }
  /** `first` asks for the scene; then it is waited for, however long that takes, unless another is chosen meanwhile. */
  private async open(first: () => Promise<Scene>, path: string): Promise<void> {
    const turn = ++this.turn;
    try {
      const scene = await this.prepared(await first(), (now) => { if (turn === this.turn) this.show_progress(now); return turn === this.turn; });
      if (turn !== this.turn) return;
      if (scene.state !== 'ready') throw new ApiError(409, scene.error, scene.error?.detail ?? `The scene is ${scene.state}.`);
      this.current = scene;
      this.path = path;
      this.hide();
      await this.opened(scene);
      await this.refresh();
    } catch (error) {
      if (turn !== this.turn) return;
      if (!this.current) this.show_empty();
      this.fill();
      this.failed(error);
    }
  }

  show_empty(): void {
    element('empty').hidden = false;
    element('empty-title').textContent = 'No scene is open';
    element('empty-text').textContent = this.list.available.length + this.list.scenes.length > 0 ? 'Choose a mock-up and its tool:'
      : 'There is no scene file below the server\'s root. Start it with another --root, or upload a scene (POST /v1/scenes).';
    element('empty-progress').hidden = true;
    const choice = (text: string, act: () => void) => {
      const button = make('button', {}, text);
      button.addEventListener('click', act);
      return button;
    };
    element('empty-list').replaceChildren(...this.list.scenes.map((scene) => choice(scene.name, () => void this.open_id(scene.id))),
      ...this.list.available.map((path) => choice(path, () => void this.open_path(path))));
  }
  private show_progress(scene: Scene): void {
    element('empty').hidden = false;
    element('empty-title').textContent = scene.name;
    element('empty-text').textContent = scene.state === 'queued' ? 'Waiting for its turn to be prepared' : `Preparing: ${scene.step ?? 'reading'}`;
    const bar = element<HTMLProgressElement>('empty-progress');
    bar.hidden = false;
    if (scene.progress === null) bar.removeAttribute('value'); else bar.value = scene.progress;
    element('empty-list').replaceChildren();
  }
  private hide(): void { element('empty').hidden = true; }
}
