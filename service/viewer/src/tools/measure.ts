// The distance of two points that are clicked, as a line with its length.
import * as three from 'three';

import {length_words} from '../assembly/units.js';
import {element} from '../dom.js';

import type {SceneView} from '../draw/scene_view.js';

export class Measure {
  private on = false;
  private readonly points: three.Vector3[] = [];
  private readonly line = new three.Line(
      new three.BufferGeometry(),
      new three.LineBasicMaterial({depthTest: false, transparent: true, color: 0xb3261e}));
  private readonly label = element('measure-label');

  /** `meet`: where a ray meets what is drawn. */
  constructor(
      private readonly view: SceneView, private readonly meet: (ray: three.Ray) => three.Vector3 | null) {
    this.line.renderOrder = 20;
    this.line.frustumCulled = false;
    this.line.visible = false;
    view.scene.add(this.line);
    element('measure').addEventListener('click', () => this.toggle());
    let pressed: {x: number; y: number}|null = null;
    view.canvas.addEventListener('pointerdown', (event) => {
      pressed = {x: event.clientX, y: event.clientY};
    });
    view.canvas.addEventListener('pointerup', (event) => {
      if (this.on && pressed && Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) < 4)
        this.take(event);
    });
  }
  toggle(on = !this.on): void {
    this.on = on;
    element('measure').setAttribute('aria-pressed', String(on));
    this.points.length = 0;
    this.show();
  }
  private take(event: PointerEvent): void {
    const box = this.view.canvas.getBoundingClientRect();
    const caster = new three.Raycaster();
    caster.setFromCamera(
        new three.Vector2(
            ((event.clientX - box.left) / box.width) * 2 - 1,
            1 - ((event.clientY - box.top) / box.height) * 2),
        this.view.camera);
    const point = this.meet(caster.ray);
    if (!point) return;
    if (this.points.length === 2) this.points.length = 0;
    this.points.push(point);
    this.show();
  }
  private show(): void {
    this.line.visible = this.points.length === 2;
    if (this.line.visible) this.line.geometry.setFromPoints(this.points);
    this.view.request();
  }
  /** Before each picture. */
  place(): void {
    const at = this.points.length === 0 ?
        null :
        this.view.project(
            this.points.length === 2 ? this.points[0].clone().lerp(this.points[1], 0.5) : this.points[0]);
    this.label.hidden = !this.on || (this.points.length > 0 && !at);
    if (this.label.hidden) return;
    this.label.textContent = this.points.length === 2 ?
        length_words(this.points[0].distanceTo(this.points[1])) :
        this.points.length === 1 ? 'now the second point' :
                                   'click two points';
    this.label.style.transform =
        at ? `translate(${Math.round(at.x + 10)}px, ${Math.round(at.y + 10)}px)` : 'translate(12px, 50%)';
  }
}
