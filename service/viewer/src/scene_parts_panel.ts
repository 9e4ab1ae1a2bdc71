// The parts of the scene that is felt, in the panel: each can be hidden from the picture, and found by its
// name.
import {element, make, write} from './dom.js';
import type {SceneParts} from './server/protocol.js';
import {short_names} from './words/part_names.js';

const MOST_ROWS = 300;  // more are found by their name

export interface HiddenParts {
  mockup: ReadonlySet<number>;
  tool: ReadonlySet<number>
}

export class ScenePartsPanel {
  private parts: SceneParts = {static: [], tool: []};
  private readonly hidden = {mockup: new Set<number>(), tool: new Set<number>()};
  private readonly list = element('scene-parts');
  private readonly filter = element<HTMLInputElement>('scene-part-filter');

  /** `changed`: others are hidden now. */
  constructor(private readonly changed: (hidden: HiddenParts) => void) {
    this.filter.addEventListener('input', () => this.draw());
    element('show-all-parts').addEventListener('click', () => {
      this.hidden.mockup.clear();
      this.hidden.tool.clear();
      this.draw();
      this.changed(this.hidden);
    });
  }
  /**
   * `paths`: what was hidden when the scene was made; parts at these paths, and below, begin hidden. Null:
   * the scene before with other settings, and what is hidden stays so.
   */
  set(parts: SceneParts, paths: readonly string[]|null): void {
    this.parts = parts;
    if (!paths) {
      this.changed(this.hidden);
      return;
    }
    const starts = (list: SceneParts['static']) => new Set(list.flatMap(
        ({path}, i) => (paths.some((above) => path === above || path.startsWith(`${above}/`)) ? [i] : [])));
    this.hidden.mockup = starts(parts.static);
    this.hidden.tool = starts(parts.tool);
    this.filter.value = '';
    this.draw();
    this.changed(this.hidden);
  }
  private draw(): void {
    const wanted = this.filter.value.trim().toLowerCase();
    const rows = ([['tool', this.parts.tool], ['mockup', this.parts.static]] as const)
                     .flatMap(([body, list]) => {
                       const names = short_names(list.map(({path}) => path));
                       return list.map(({path}, place) => ({body, place, name: names[place], path}));
                     })
                     .filter(
                         ({path, name}) => wanted === '' || path.toLowerCase().includes(wanted) ||
                             name.toLowerCase().includes(wanted));
    element('scene-parts-box').hidden = this.parts.static.length + this.parts.tool.length < 2;
    this.list.replaceChildren(...rows.slice(0, MOST_ROWS).map(({body, place, name, path}) => {
      const box = make('input', {type: 'checkbox'});
      box.checked = !this.hidden[body].has(place);
      box.addEventListener('change', () => {
        if (box.checked)
          this.hidden[body].delete(place);
        else
          this.hidden[body].add(place);
        this.count();
        this.changed(this.hidden);
      });
      return make(
          'label', {class: 'check', title: path}, box,
          make('span', {}, body === 'tool' ? `${name} (tool)` : name));
    }));
    write(
        element('scene-parts-more'),
        rows.length > MOST_ROWS ? `and ${rows.length - MOST_ROWS} more: find them by name` : '');
    this.count();
  }
  private count(): void {
    const all = this.parts.static.length + this.parts.tool.length;
    const hidden = this.hidden.mockup.size + this.hidden.tool.size;
    write(
        element('scene-parts-words'),
        `Parts: ${hidden === 0 ? `all ${all} are drawn` : `${all - hidden} of ${all} are drawn`}`);
  }
}
