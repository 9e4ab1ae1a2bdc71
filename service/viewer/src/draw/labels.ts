// A few words beside each contact area: its depth, and its force where the response is the sum of those. (In
// profile refined the tool's spring is between: areas tell what the field would push.)
import {Vector3} from 'three';

import {element, make, write} from '../dom.js';

import {place_labels, type Box} from './label_layout.js';
import {length, type Area} from '../server/protocol.js';
import type {SceneView} from './scene_view.js';
import {figure} from '../strips.js';

const MOST = 6;

export class Labels {
  shown = true;
  with_force = false;
  private readonly host = element('labels');
  private readonly obstacles = ['readout', 'bottom', 'banner'].map((id) => element(id));
  private areas: Area[] = [];

  constructor(private readonly view: SceneView) {
    view.before_draw.push(() => this.place());
  }

  /** The areas to label, the strongest first. */
  set(areas: Area[]): void {
    this.areas = this.shown ? [...areas]
                                  .filter((area) => length(area.force) > 0)
                                  .sort((a, b) => length(b.force) - length(a.force))
                                  .slice(0, MOST) :
                              [];
    while (this.host.childElementCount < this.areas.length) this.host.append(make('div'));
    [...this.host.children].forEach((label, i) => {
      (label as HTMLElement).hidden = i >= this.areas.length;
      if (i < this.areas.length)
        write(
            label as HTMLElement,
            `${figure(this.areas[i].depth * 1000)} mm${
                this.with_force ? ` · ${figure(length(this.areas[i].force))} N` : ''}`);
    });
  }
  private place(): void {
    const frame = this.host.getBoundingClientRect();
    const box_of = (target: Element): Box => {
      const box = target.getBoundingClientRect();
      return {x: box.x - frame.x, y: box.y - frame.y, width: box.width, height: box.height};
    };
    const labels = this.areas.map((_, i) => this.host.children[i] as HTMLElement);
    for (const label of labels) label.hidden = false;  // to be measured
    const taken = this.obstacles.filter((obstacle) => !obstacle.hidden).map(box_of);
    const places = place_labels(
        this.areas.map((area) => this.view.project(new Vector3(...area.point))), labels.map(box_of), taken,
        {x: 0, y: 0, width: frame.width, height: frame.height});
    labels.forEach((label, i) => {
      const place = places[i];
      label.hidden = !place;
      if (place) label.style.transform = `translate(${place.x}px, ${place.y}px)`;
    });
  }
}
