// What a scene is, in figures: beside its name, and in the panel.
import {element, make} from '../dom.js';
import type {Scene} from '../server/protocol.js';
import {figure} from '../strips.js';

export function show_scene(scene: Scene): void {
  const whole = (value: number|null) => (value === null ? '–' : value.toLocaleString('en'));
  element('facts').textContent =
      `${whole(scene.static_triangles)} + ${whole(scene.tool_triangles)} triangles`;
  const rows: [string, string][] = [
    ['mock-up', `${whole(scene.static_triangles)} triangles`],
    ['tool', `${whole(scene.tool_triangles)} triangles`],
    ['profile', scene.profile ?? '–'],
    ['stiffness', scene.stiffness === null ? '–' : `${figure(scene.stiffness)} N/m`],
    ['voxel', scene.voxel_size === null ? '–' : `${figure(scene.voxel_size * 1000)} mm`],
    [
      'memory',
      scene.memory_bytes === null || scene.memory_bytes === undefined ?
          '–' :
          `${figure(scene.memory_bytes / 1048576)} MiB`
    ],
    ['engine', scene.backend ? `${scene.backend} on ${scene.device}` : '–'],
  ];
  element('scene-facts')
      .replaceChildren(
          make('h2', {}, scene.name),
          make('dl', {}, ...rows.flatMap(([name, value]) => [make('dt', {}, name), make('dd', {}, value)])),
          ...(scene.warnings ?? []).map((warning) => make('p', {class: 'warn'}, warning)));
  document.title = `${scene.name}, palpate`;
}
