// Of each contact area: n_c, the contact point cp, and the ray heights (mean as a bar, largest as a thin
// line) at `gain` times their size. Of the whole: force at the centre of mass, torque as an arrow with a
// ring.
import * as three from 'three';

import {Arrow} from './arrow.js';

import type {Theme} from './palette.js';
import {length, type Area, type Vec3} from '../server/protocol.js';
import {round_down} from './scene_view.js';

const MOST_AREAS = 24;
const vector = (v: Vec3): three.Vector3 => new three.Vector3(v[0], v[1], v[2]);

class Mark {
  readonly object = new three.Group();
  readonly normal: Arrow;
  private readonly point: three.Mesh;
  private readonly mean: three.Mesh;
  private readonly most: three.Mesh;
  constructor(private readonly materials: {
    normal: three.MeshBasicMaterial; point: three.MeshBasicMaterial; height: three.MeshBasicMaterial
  }) {
    this.normal = new Arrow(0xffffff);
    this.point = new three.Mesh(new three.SphereGeometry(1, 12, 8), materials.point);
    const bar = new three.CylinderGeometry(1, 1, 1, 8);
    this.mean = new three.Mesh(bar, materials.height);
    this.most = new three.Mesh(bar, materials.height);
    for (const mesh of [this.point, this.mean, this.most]) mesh.renderOrder = 9;
    this.object.add(this.normal.object, this.point, this.mean, this.most);
  }
  set(area: Area, size: number, gain: number, show: {normals: boolean; heights: boolean}): void {
    const at = vector(area.point);
    const up = vector(area.normal);
    const width = size * 0.012;
    this.normal.material.color.copy(this.materials.normal.color);
    if (show.normals && up.lengthSq() > 0.5)
      this.normal.set(at, up, size * 0.55, width);
    else
      this.normal.hide();
    this.point.position.copy(at);
    this.point.scale.setScalar(size * 0.03);
    const turn = new three.Quaternion().setFromUnitVectors(
        new three.Vector3(0, 1, 0), up.lengthSq() > 0.5 ? up : new three.Vector3(0, 1, 0));
    for (const [bar, height, thick] of [
             [this.mean, area.depth, 2.4], [this.most, area.max_depth ?? 0, 0.8]] as const) {
      bar.visible = show.heights && height > 0;
      bar.position.copy(at).addScaledVector(
          up, (-height * gain) / 2);  // heights go into the tool's way: against n_c
      bar.quaternion.copy(turn);
      bar.scale.set(width * thick, Math.max(height * gain, 1e-9), width * thick);
    }
  }
}

export class AreaLayer {
  readonly object = new three.Group();
  readonly show = {normals: true, heights: true, wrench: true};
  /** How many metres an arrow has for a newton and a newton metre; how much heights are drawn larger. */
  metres_per_newton = 0.01;
  metres_per_newton_metre = 0.1;
  gain = 1;
  private size = 0.1;
  private readonly marks: Mark[] = [];
  private readonly force = new Arrow(0);
  private readonly torque = new Arrow(0);
  private readonly ring: three.Mesh;
  private readonly materials:
      {normal: three.MeshBasicMaterial; point: three.MeshBasicMaterial; height: three.MeshBasicMaterial};

  constructor() {
    const material = (opacity: number) =>
        new three.MeshBasicMaterial({toneMapped: false, depthTest: false, transparent: true, opacity});
    this.materials = {normal: material(1), point: material(1), height: material(0.75)};
    this.ring = new three.Mesh(new three.TorusGeometry(1, 0.06, 8, 40, Math.PI * 1.6), this.torque.material);
    this.ring.renderOrder = 10;
    this.ring.visible = false;
    this.object.add(this.force.object, this.torque.object, this.ring);
  }

  /**
   * Scales, fixed for a scene: `radius` of the tool (m), `force` (N) that is a strong one, stiffness (N/m).
   */
  set_scale(radius: number, force: number, stiffness: number): void {
    this.size = radius;
    this.metres_per_newton = round_down((1.6 * radius) / force);
    this.metres_per_newton_metre = round_down((1.6 * radius) / (force * radius));
    this.gain = Math.max(1, round_down((0.9 * radius) / (force / stiffness)));
  }
  theme(theme: Theme): void {
    this.materials.normal.color.setHex(theme.normal);
    this.materials.point.color.setHex(theme.point);
    this.materials.height.color.setHex(theme.height);
    this.force.material.color.setHex(theme.force);
    this.torque.material.color.setHex(theme.torque);
  }

  set(areas: Area[], centre: three.Vector3, force: Vec3, torque: Vec3): void {
    const shown = this.show.normals || this.show.heights ? Math.min(areas.length, MOST_AREAS) : 0;
    while (this.marks.length < shown) {
      const mark = new Mark(this.materials);
      this.marks.push(mark);
      this.object.add(mark.object);
    }
    this.marks.forEach((mark, i) => {
      mark.object.visible = i < shown;
      if (i < shown) mark.set(areas[i], this.size, this.gain, this.show);
    });
    this.force.hide();
    this.torque.hide();
    this.ring.visible = false;
    if (!this.show.wrench) return;
    const newtons = length(force);
    if (newtons > 1e-6)
      this.force.set(
          centre, vector(force).divideScalar(newtons), newtons * this.metres_per_newton, this.size * 0.018);
    const turning = length(torque);
    if (turning > 1e-9) {
      const axis = vector(torque).divideScalar(turning);
      const reach = turning * this.metres_per_newton_metre;
      this.torque.set(centre, axis, reach, this.size * 0.01);
      this.ring.visible = reach > this.size * 0.02;
      this.ring.position.copy(centre).addScaledVector(axis, reach * 0.5);
      this.ring.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), axis);
      this.ring.scale.setScalar(Math.min(this.size * 0.25, reach * 0.35));
    }
  }
}
