// An arrow that is a solid, so that it reads at any distance and any line width.
import * as three from 'three';

import {placed, type Solids} from './solids.js';

const SHAFT = new three.CylinderGeometry(1, 1, 1, 8).translate(0, 0.5, 0);
const HEAD = new three.ConeGeometry(2.6, 1, 12).translate(0, -0.5, 0);

/**
 * `direction` is a unit vector; `length` and `width` in metres. A short arrow is thinner, so that it still
 * shows where it points.
 */
export function add_arrow(
    to: Solids, from: three.Vector3, direction: three.Vector3, length: number, width: number,
    colour: three.Color): void {
  if (!(length > width * 0.05)) return;
  const thick = width * Math.min(1, Math.max(0.3, length / (width * 14)));
  const head = Math.min(thick * 7, length * 0.6);
  to.add(SHAFT, placed(from, direction, new three.Vector3(thick, length - head, thick)), colour);
  to.add(
      HEAD,
      placed(
          from.clone().addScaledVector(direction, length), direction, new three.Vector3(thick, head, thick)),
      colour);
}
