// The rows of the list of scenes: one a scene, whether the server holds it already or would have to read its
// file.
import type {SceneList} from '../server/protocol.js';

export interface SceneRow {
  value: string;
  text: string
}

/**
 * Of a file that was opened before and after a change, the scene that was used last stands for both, or the
 * one that is shown.
 */
export function scene_rows(list: SceneList, shown: string): SceneRow[] {
  const files = new Set(list.available);
  const of_file = new Map<string, string>();
  for (const scene of list.scenes)
    if (files.has(scene.name) && of_file.get(scene.name) !== shown) of_file.set(scene.name, scene.id);
  const held = list.scenes.filter((scene) => !files.has(scene.name) || of_file.get(scene.name) === scene.id)
                   .map((scene) => ({
                          value: `id:${scene.id}`,
                          text: `${scene.name}${scene.state === 'ready' ? '' : `, ${scene.state}`}`
                        }));
  return [
    ...held,
    ...list.available.filter((path) => !of_file.has(path))
        .map((path) => ({value: `at:${path}`, text: `open ${path}`}))
  ];
}
