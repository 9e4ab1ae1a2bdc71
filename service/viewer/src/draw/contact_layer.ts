// Contact triangles, exact at every level of detail, coloured by kind, area or zone. What lies behind other
// surfaces shows through them, weaker.
import * as three from 'three';

import {coloured_material} from './flat_shading.js';
import {CYCLE, KIND_COLOUR} from './palette.js';

import {KINDS, MOBILE_KINDS, STATIC_KINDS, type Frame, type Kind} from '../server/protocol.js';
import type {TriangleStore} from './triangle_store.js';

export type Colouring = 'kind'|'area'|'zone';

/** Red, green and blue as they are shown (sRGB), 0 to 1. */
type Shown = readonly[number, number, number];
const shown_as =
    (colour: number): Shown => [(colour >> 16 & 255) / 255, (colour >> 8 & 255) / 255, (colour & 255) / 255];

/** One body's coloured triangles. */
class Patch {
  readonly object = new three.Group();
  private geometry = new three.BufferGeometry();
  private readonly front: three.Mesh;
  private readonly behind: three.Mesh;
  private capacity = 0;
  private positions = new Float32Array(0);
  private colours = new Float32Array(0);  // bytes would be turned into floats anew for each picture
  count = 0;

  constructor(private readonly store: TriangleStore) {
    this.front = new three.Mesh(this.geometry, coloured_material());
    this.behind = new three.Mesh(
        this.geometry, coloured_material(0.45, {depthFunc: three.GreaterDepth, depthWrite: false}));
    this.front.frustumCulled = this.behind.frustumCulled = false;
    this.front.renderOrder = 2;
    this.behind.renderOrder = 3;
    this.object.add(this.front, this.behind);
  }
  begin(most: number): void {
    this.count = 0;
    if (most <= this.capacity) return;
    this.capacity = Math.max(1024, 2 * most);
    this.positions = new Float32Array(9 * this.capacity);
    this.colours = new Float32Array(9 * this.capacity);
    this.geometry.dispose();
    this.geometry = new three.BufferGeometry();
    this.geometry.setAttribute(
        'position', new three.BufferAttribute(this.positions, 3).setUsage(three.DynamicDrawUsage));
    this.geometry.setAttribute(
        'colour', new three.BufferAttribute(this.colours, 3).setUsage(three.DynamicDrawUsage));
    this.front.geometry = this.behind.geometry = this.geometry;
  }
  add(id: number, [red, green, blue]: Shown): void {
    const end = 9 * (this.count + 1);
    if (!this.store.copy(id, this.positions, end - 9)) return;
    for (let at = end - 9; at < end; at += 3) {
      this.colours[at] = red;
      this.colours[at + 1] = green;
      this.colours[at + 2] = blue;
    }
    ++this.count;
  }
  end(): void {
    this.geometry.setDrawRange(0, 3 * this.count);
    for (const name of ['position', 'colour']) {
      const attribute = this.geometry.getAttribute(name) as three.BufferAttribute | undefined;
      if (!attribute) continue;
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, 9 * this.count);
      attribute.needsUpdate = true;
    }
    this.store.flush();
  }
}

export class ContactLayer {
  readonly mockup: Patch;
  readonly tool: Patch;
  readonly shown = new Set<Kind>(KINDS);
  colouring: Colouring = 'kind';
  private readonly kind_colours =
      Object.fromEntries(KINDS.map((kind) => [kind, shown_as(KIND_COLOUR[kind])])) as Record<Kind, Shown>;
  private readonly cycle = CYCLE.map(shown_as);

  constructor(mockup_store: TriangleStore, tool_store: TriangleStore) {
    this.mockup = new Patch(mockup_store);
    this.tool = new Patch(tool_store);
  }

  set(frame: Frame|null): void {
    const group = this.colouring === 'kind' ? null : this.groups(frame);
    for (const [patch, kinds, groups] of [
             [this.mockup, STATIC_KINDS, group?.mockup], [this.tool, MOBILE_KINDS, group?.tool]] as const) {
      const shown = frame ? kinds.filter((kind) => this.shown.has(kind)) : [];
      patch.begin(shown.reduce((sum, kind) => sum + frame![kind].length, 0));
      for (const kind of shown)
        for (const id of frame![kind]) {
          const index = groups?.get(id);
          if (!groups)
            patch.add(id, this.kind_colours[kind]);
          else if (index !== undefined)
            patch.add(id, this.cycle[index % this.cycle.length]);
        }
      patch.end();
    }
  }

  /**
   * Which area, or zone, each triangle belongs to. A tool triangle has no zone: it takes its area's first.
   */
  private groups(frame: Frame|null): {mockup: Map<number, number>; tool: Map<number, number>} {
    const mockup = new Map<number, number>();
    const tool = new Map<number, number>();
    let next = 0;
    for (const area of frame?.areas ?? []) {
      const first = next++;
      for (const id of area.static ?? []) mockup.set(id, first);
      for (const id of area.mobile ?? []) tool.set(id, first);
      if (this.colouring === 'zone')
        (area.zones ?? []).forEach((zone, i) => {
          if (i > 0) ++next;
          for (const id of zone) mockup.set(id, first + i);
        });
    }
    return {mockup, tool};
  }
}
