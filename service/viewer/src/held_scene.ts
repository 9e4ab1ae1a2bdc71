// Sees to it that the server holds the scene that is shown, ready: it may be another process than before.
import type {ScenePicker} from './scene_picker.js';
import type {Api} from './server/api.js';

export class HeldScene {
  private holding: Promise<void>|null = null;

  constructor(private readonly api: Api, private readonly picker: ScenePicker) {}

  /**
   * Resolves when the server holds the scene. One that it lost is opened again by its path. Whoever asks
   * meanwhile waits for the same.
   */
  hold(): Promise<void> {
    return (this.holding ??= this.make_held().finally(() => {
      this.holding = null;
    }));
  }
  private async make_held(): Promise<void> {
    const {api, picker} = this;
    await picker.refresh();
    const {current, path} = picker;
    if (!current) return;
    const listed = picker.list.scenes.find(
        (scene) => scene.id === current.id && scene.state !== 'failed');  // perhaps still being prepared
    if (!listed && !path) throw new Error('The server no longer holds this scene. Open it again to go on.');
    const scene = listed ?? (await api.open_scene(path));
    // The same scene is not drawn anew; the file may have another by now.
    if (scene.id !== current.id) {
      await picker.open_path(path);
      return;
    }
    const held = await picker.prepared(scene, () => picker.current === current);
    if (held.state === 'failed') throw new Error(held.error?.detail ?? 'The scene is failed.');
    if (!listed) await picker.refresh();  // the list was without it
  }
}
