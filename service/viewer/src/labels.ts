// A few words beside each contact area: its depth and force.
import { Vector3 } from 'three';
import { element, make, write } from './dom.js';
import { length, type Area } from './protocol.js';
import type { SceneView } from './scene_view.js';
import { figure } from './strips.js';

const MOST = 6;

export class Labels {
  shown = true;
  private readonly host = element('labels');
  private areas: Area[] = [];

  constructor(private readonly view: SceneView) { view.before_draw = () => this.place(); }

  /** The areas to label, the strongest first. */
  set(areas: Area[]): void {
    this.areas = this.shown ? [...areas].filter((area) => length(area.force) > 0).sort((a, b) => length(b.force) - length(a.force)).slice(0, MOST) : [];
    while (this.host.childElementCount < this.areas.length) this.host.append(make('div'));
    [...this.host.children].forEach((label, i) => {
      (label as HTMLElement).hidden = i >= this.areas.length;
      if (i < this.areas.length) write(label as HTMLElement, `${figure(this.areas[i].depth * 1000)} mm · ${figure(length(this.areas[i].force))} N`);
    });
  }
  private place(): void {
    this.areas.forEach((area, i) => {
      const label = this.host.children[i] as HTMLElement;
      const place = this.view.project(new Vector3(...area.point));
      label.hidden = !place;
      if (place) label.style.transform = `translate(${Math.round(place.x + 14)}px, ${Math.round(place.y + 10 + 3 * i)}px)`;
    });
  }
}
