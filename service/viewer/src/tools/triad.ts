// The axes as the camera sees them, and how many pictures a second are drawn.
import {Vector3} from 'three';

import {element, write} from '../dom.js';

import type {SceneView} from '../draw/scene_view.js';

const REACH = 22;  // px

export class Triad {
  private readonly lines = ['x', 'y', 'z'].map((axis) => element(`triad-${axis}`));
  private times: number[] = [];

  constructor(private readonly view: SceneView) {}
  /** Before each picture. */
  draw(): void {
    const turn = this.view.camera.quaternion.clone().invert();
    this.lines.forEach((group, i) => {
      const end = new Vector3().setComponent(i, 1).applyQuaternion(turn);
      const [x, y] = [REACH * end.x, -REACH * end.y];
      const [line, text] = group.children as unknown as SVGElement[];
      line.setAttribute('x2', x.toFixed(1));
      line.setAttribute('y2', y.toFixed(1));
      text.setAttribute('x', (x * 1.3).toFixed(1));
      text.setAttribute('y', (y * 1.3).toFixed(1));
    });
  }
  /** After each: `ms` since the one before in an unbroken row. */
  count(ms: number): void {
    if (!Number.isFinite(ms)) {
      this.times = [];
      return;
    }
    this.times.push(ms);
    if (this.times.length > 30) this.times.shift();
    const mean = this.times.reduce((sum, each) => sum + each, 0) / this.times.length;
    if (this.times.length >= 5) write(element('pictures-a-second'), `${Math.round(1000 / mean)} / s`);
  }
}
