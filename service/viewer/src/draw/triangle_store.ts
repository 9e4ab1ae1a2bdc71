// Exact corners of triangles by id: from the drawn geometry when it is whole, else asked of the server and
// kept.
import type {Api} from '../server/api.js';
import {ids_within, type Body} from '../server/binary.js';

const CHARACTERS_A_REQUEST = 1800;  // of ids: the server takes targets of 2048
const KEPT = 400_000;

export class TriangleStore {
  private known = new Map<number, Float32Array>();
  private places: Int32Array|null = null;
  private body: Body|null = null;
  private asking = false;
  private wanted = new Set<number>();
  /** Called when more corners have come. */
  arrived: () => void = () => {};

  constructor(private readonly api: Api, private readonly which: 'static'|'tool') {}

  reset(scene: string): void {
    this.scene = scene;
    this.known.clear();
    this.wanted.clear();
    this.places = null;
    this.body = null;
  }
  private scene = '';

  /** The drawn body; `whole`: not reduced, so that its corners are exact. */
  set_body(body: Body, whole: boolean): void {
    this.body = whole ? body : null;
    this.places = null;
    if (!whole) return;
    let most = 0;
    for (const id of body.ids) most = Math.max(most, id);
    this.places = new Int32Array(most + 1).fill(-1);
    body.ids.forEach((id, place) => {
      this.places![id] = place;
    });
  }

  /** Writes nine floats at `at`; false when they are not known yet (they are asked for at the next flush). */
  copy(id: number, target: Float32Array, at: number): boolean {
    const place = this.places?.[id] ?? -1;
    if (this.body && place >= 0) {
      for (let corner = 0; corner < 3; ++corner) {
        const vertex = 3 * this.body.corners[3 * place + corner];
        for (let axis = 0; axis < 3; ++axis)
          target[at + 3 * corner + axis] = this.body.vertices[vertex + axis];
      }
      return true;
    }
    const corners = this.known.get(id);
    if (corners) {
      target.set(corners, at);
      return true;
    }
    if (!this.body) this.wanted.add(id);
    return false;
  }

  flush(): void {
    if (this.asking || this.wanted.size === 0) return;
    const {ids, text} = ids_within([...this.wanted], CHARACTERS_A_REQUEST);
    this.wanted.clear();  // what is still in contact is wanted again by the next frame
    this.asking = true;
    const scene = this.scene;
    this.api.triangles(scene, this.which, text)
        .then((corners) => {
          if (scene !== this.scene) return;
          if (this.known.size > KEPT) this.known.clear();
          ids.forEach((id, i) => this.known.set(id, corners.subarray(9 * i, 9 * i + 9)));
          this.arrived();
        })
        .catch(() => {/* asked again with the next frame */})
        .finally(() => {
          this.asking = false;
        });
  }
}
