// A plane that cuts the picture open, across x, y or z; the contact in front of it is cut, too.
import * as three from 'three';
import type {SceneView} from '../draw/scene_view.js';
import {element} from '../dom.js';

export class Section {
  private readonly plane = new three.Plane();
  private readonly axis = element<HTMLSelectElement>('section-axis');
  private readonly place = element<HTMLInputElement>('section-place');

  /** `box`: what there is to cut. */
  constructor(private readonly view: SceneView, private readonly box: () => three.Box3) {
    this.axis.addEventListener('change', () => this.cut());
    this.place.addEventListener('input', () => this.cut());
  }
  cut(): void {
    const [side, axis] = [this.axis.value.slice(0, 1), this.axis.value.slice(1)];
    this.place.disabled = axis === '';
    if (axis === '')
      this.view.renderer.clippingPlanes = [];
    else {
      const k = 'xyz'.indexOf(axis) as 0 | 1 | 2;
      const {min, max} = this.box();
      const at = min.getComponent(k) + (max.getComponent(k) - min.getComponent(k)) * Number(this.place.value);
      const normal = new three.Vector3().setComponent(k, side === '+' ? -1 : 1);
      this.plane.set(normal, side === '+' ? at : -at);
      this.view.renderer.clippingPlanes = [this.plane];
    }
    this.view.request();
  }
  /** Whether a point is cut away. */
  hides(point: three.Vector3): boolean {
    return this.view.renderer.clippingPlanes.length > 0 && this.plane.distanceToPoint(point) < 0;
  }
}
