// Of each contact area: n_c, the contact point cp, and the ray heights (mean as a bar, largest as a thin
// line) at `gain` times their size. Of the whole: force at the centre of mass, torque as an arrow with a
// ring.
import * as three from 'three';

import {add_arrow} from './arrow.js';
import {placed, Solids} from './solids.js';

import type {Theme} from './palette.js';
import {length, type Area, type Vec3} from '../server/protocol.js';
import {round_down} from './scene_view.js';

const MOST_AREAS = 24;
const POINT = new three.SphereGeometry(1, 8, 6);
const BAR = new three.CylinderGeometry(1, 1, 1, 8);
const RING = new three.TorusGeometry(1, 0.06, 6, 32, Math.PI * 1.6).rotateX(Math.PI / 2);  // about y
const vector = (v: Vec3): three.Vector3 => new three.Vector3(v[0], v[1], v[2]);

export class AreaLayer {
  readonly show = {normals: true, heights: true, wrench: true};
  /** How many metres an arrow has for a newton and a newton metre; how much heights are drawn larger. */
  metres_per_newton = 0.01;
  metres_per_newton_metre = 0.1;
  gain = 1;
  private size = 0.1;
  private readonly solids = new Solids();
  private readonly colour = {
    normal: new three.Color(),
    point: new three.Color(),
    height: new three.Color(),
    force: new three.Color(),
    torque: new three.Color()
  };

  get object(): three.Object3D {
    return this.solids.object;
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
    for (const what of ['normal', 'point', 'height', 'force', 'torque'] as const)
      this.colour[what].setHex(theme[what]);
  }

  set(areas: Area[], centre: three.Vector3, force: Vec3, torque: Vec3): void {
    const {solids, show, size, colour} = this;
    solids.begin();
    const shown = show.normals || show.heights ? areas.slice(0, MOST_AREAS) : [];
    for (const area of shown) this.add_heights(area);
    if (show.normals)
      for (const {point, normal} of shown)
        if (length(normal) > 0.7)  // else the area has none
          add_arrow(solids, vector(point), vector(normal), size * 0.55, size * 0.012, colour.normal);
    if (show.wrench) this.add_wrench(centre, force, torque);
    solids.end();
  }
  /** The contact point, and heights, which go into the tool's way: against n_c. */
  private add_heights({point, normal, depth, max_depth}: Area): void {
    const {solids, size, colour} = this;
    const at = vector(point), up = vector(normal), width = size * 0.012;
    solids.add(POINT, placed(at, undefined, new three.Vector3().setScalar(size * 0.03)), colour.point);
    if (!this.show.heights) return;
    for (const [height, thick] of [[depth, 2.4], [max_depth ?? 0, 0.8]] as const) {
      if (!(height > 0)) continue;
      const long = height * this.gain;
      solids.add(
          BAR,
          placed(
              at.clone().addScaledVector(up, -long / 2), up.lengthSq() > 0.5 ? up : undefined,
              new three.Vector3(width * thick, long, width * thick)),
          colour.height, 0.75);
    }
  }
  private add_wrench(centre: three.Vector3, force: Vec3, torque: Vec3): void {
    const {solids, size, colour} = this;
    const newtons = length(force);
    if (newtons > 1e-6)
      add_arrow(
          solids, centre, vector(force).divideScalar(newtons), newtons * this.metres_per_newton, size * 0.018,
          colour.force);
    const turning = length(torque);
    if (!(turning > 1e-9)) return;
    const axis = vector(torque).divideScalar(turning);
    const reach = turning * this.metres_per_newton_metre;
    add_arrow(solids, centre, axis, reach, size * 0.01, colour.torque);
    if (reach > size * 0.02)
      solids.add(
          RING,
          placed(
              centre.clone().addScaledVector(axis, reach * 0.5), axis,
              new three.Vector3().setScalar(Math.min(size * 0.25, reach * 0.35))),
          colour.torque);
  }
}
