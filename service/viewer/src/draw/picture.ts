// The picture of a moment: bodies, contact, areas, voxels in one view, at a level of detail that stays
// smooth.
import * as three from 'three';
import {ApiError, type Api} from '../server/api.js';
import {AreaLayer} from './area_layer.js';
import {Bodies} from './bodies.js';
import {ContactLayer} from './contact_layer.js';
import {Ghost} from '../mouse/ghost.js';
import {LEVELS, LevelKeeper} from './lod.js';
import type {Moment} from '../moment.js';
import {MouseDrag} from '../mouse/mouse_drag.js';
import {DARK, LIGHT} from './palette.js';
import type {Frame, Pose, Scene} from '../server/protocol.js';
import {SceneView} from './scene_view.js';
import {TriangleStore} from './triangle_store.js';
import {VoxelLayer} from './voxel_layer.js';

const FEW = 3000;  // triangles of the tool in a coarse picture; chosen: that has 300 pixels across, no more
const LATE_MS = 250;  // an answer older than this is none that came late: what rests is not asked about
const STRONG_N = 3;   // chosen: arrows and heights are scaled so that this fills the tool's size

export class Picture {
  readonly view: SceneView;
  readonly bodies: Bodies;
  readonly contact: ContactLayer;
  readonly areas = new AreaLayer();
  readonly voxels = new VoxelLayer();
  readonly ghost: Ghost;
  readonly drag: MouseDrag;
  readonly levels = new LevelKeeper();
  private readonly pace =
      new LevelKeeper();  // of pictures that have no mock-up to draw: they may be coarse, and have no level
  scene: Scene|null = null;
  drawn_triangles = 0;
  reduced = false;
  /** Called when another level is drawn. */
  levelled: () => void = () => {};
  private readonly shown = new three.Group();
  private readonly stores: {mockup: TriangleStore; tool: TriangleStore};
  private shown_frame: Frame|null = null;
  private asked_at = NaN;
  private loading: AbortController|null = null;
  private centre = new three.Vector3();
  private following = false;

  constructor(
      private readonly api: Api, host: HTMLElement, private readonly failed: (error: unknown) => void) {
    this.view = new SceneView(host);
    this.view.scene.add(this.shown);
    this.bodies = new Bodies(this.shown);
    this.view.kept.add(this.bodies.mockup_mesh);
    this.stores = {mockup: new TriangleStore(api, 'static'), tool: new TriangleStore(api, 'tool')};
    this.contact = new ContactLayer(this.stores.mockup, this.stores.tool);
    this.ghost = new Ghost(this.bodies);
    this.drag = new MouseDrag(this.view, this.bodies);
    this.shown.add(this.contact.mockup.object, this.areas.object, this.voxels.object, this.ghost.object);
    this.bodies.tool.add(this.contact.tool.object);
    for (const store of [this.stores.mockup, this.stores.tool])
      store.arrived = () => {
        this.redraw_contact();
      };
    this.levels.may_coarsen = this.pace.may_coarsen = this.view.software;
    this.pace.level = 0;
    this.view.before_draw.push(() => {
      // One that is cut open shows its inside.
      this.bodies.show_far_side(!this.view.software || this.view.renderer.clippingPlanes.length > 0);
      this.bodies.draw_few(this.view.draws_coarsely);
    });
    this.view.after_draw.push((ms, whole) => {
      this.bodies.draw_few(false);
      if (!this.scene || !Number.isFinite(ms)) return;
      if (whole === 2 && this.levels.take(ms, this.scene.static_triangles ?? 0))
        void this.load_level(this.scene);
      if (whole === 0) this.pace.take(ms, 0, this.age());
      this.view.coarse = this.levels.coarse;
      this.view.coarse_standing = this.pace.coarse;
    });
  }

  /** Something else that belongs to the scene. */
  add(object: three.Object3D): void {
    this.shown.add(object);
  }
  /** Whether the scene is drawn at all. */
  set_visible(on: boolean): void {
    this.shown.visible = on;
    this.view.request();
  }
  /**
   * Shows a scene that is ready; the camera goes to it. `stay`: it is the one before with other settings,
   * the tool is here and the camera stays.
   */
  async open(scene: Scene, stay: Pose|null = null): Promise<void> {
    this.scene = scene;
    this.bodies.clear();  // what is shown of another scene is no longer true
    this.stores.mockup.reset(scene.id);
    this.stores.tool.reset(scene.id);
    this.voxels.clear();
    this.set_contact(null);
    this.areas.set([], this.centre, [0, 0, 0], [0, 0, 0]);
    await this.load_level(scene);
    this.bodies.move(stay ?? scene.start ?? [0, 0, 0, 0, 0, 0, 1]);
    const box = new three.Box3();
    if (scene.bounds)
      box.set(new three.Vector3(...scene.bounds.min), new three.Vector3(...scene.bounds.max));
    else
      box.copy(this.bodies.mockup_mesh.geometry.boundingBox ?? new three.Box3());
    this.view.set_bounds(box);
    this.areas.set_scale(
        scene.tool_radius ?? this.bodies.tool_sphere().radius, STRONG_N, scene.stiffness ?? 2000);
    if (!stay) {
      this.following = false;
      this.view.look_at_all(true);
    }
    this.view.make_ready();
  }
  close(): void {
    this.loading?.abort();
    this.scene = null;
    this.bodies.clear();
    this.voxels.clear();
    this.set_contact(null);
    this.areas.set([], this.centre, [0, 0, 0], [0, 0, 0]);
    this.view.request();
  }

  private async load_level(scene: Scene): Promise<void> {
    this.loading?.abort();
    const loading = (this.loading = new AbortController());
    try {
      const geometry = await this.api.geometry(scene.id, LEVELS[this.levels.level], loading.signal);
      const few = this.view.software && geometry.tool.ids.length > FEW ?
          await this.api.tool_geometry(scene.id, FEW, loading.signal) :
          null;
      if (this.scene !== scene) return;
      this.bodies.set(geometry, few);
      this.reduced = geometry.reduced;
      this.drawn_triangles = geometry.mockup.ids.length + geometry.tool.ids.length;
      this.stores.mockup.set_body(geometry.mockup, !geometry.reduced);
      this.stores.tool.set_body(geometry.tool, !geometry.reduced);
      this.redraw_contact();
      this.levelled();
    } catch (error) {
      if (!loading.signal.aborted) this.failed(error);
    }
  }

  show(moment: Moment): void {
    this.asked_at = moment.asked_at ?? NaN;
    const before = this.bodies.tool_sphere().center;
    this.bodies.move(moment.pose);
    if (this.following && !this.drag.holding) this.view.shift(this.bodies.tool_sphere().center.sub(before));
    if (moment.frame !== this.shown_frame) this.set_contact(moment.frame);
    const gc = this.scene?.tool_gc ?? [0, 0, 0];
    this.bodies.tool.updateMatrixWorld();
    this.centre.set(gc[0], gc[1], gc[2]).applyMatrix4(this.bodies.tool.matrixWorld);
    this.areas.set(moment.frame?.contact ? moment.frame.areas : [], this.centre, moment.force, moment.torque);
    this.ghost.set(this.drag.hand, this.drag.holding !== null);
    this.view.request();
  }
  /** Of the answer that is shown, ms; 0: it rests, or nobody was asked. */
  private age(): number {
    const age = performance.timeOrigin + performance.now() - this.asked_at;
    return age < LATE_MS ? age : 0;
  }
  /** Draws the contact again, in the colours and kinds that are chosen now. */
  redraw_contact(): void {
    this.set_contact(this.shown_frame);
  }
  private set_contact(frame: Frame|null): void {
    this.shown_frame = frame;
    this.contact.set(frame);
    this.view.request();
  }

  async show_voxels(kind: 'boundary'|'internal'|null): Promise<void> {
    this.voxels.clear();
    this.view.request();
    if (!kind || !this.scene) return;
    const scene = this.scene;
    try {
      const voxels = await this.api.voxels(scene.id, kind);
      if (this.scene === scene) this.voxels.show(voxels);
    } catch (error) {
      throw error instanceof ApiError ? error : new Error(String(error));
    } finally {
      this.view.request();
    }
  }

  /** The camera goes to the tool and stays with it, until `look_at_all`. */
  follow_tool(): void {
    this.following = true;
    const {center, radius} = this.bodies.tool_sphere();
    this.view.look_at(center, radius * 2);
  }
  look_at_all(): void {
    this.following = false;
    this.view.look_at_all();
  }
  /** Where a ray meets the mock-up or the tool first. */
  meet(ray: three.Ray): three.Vector3|null {
    const caster = new three.Raycaster(ray.origin, ray.direction);
    this.bodies.tool.updateMatrixWorld();
    return caster
               .intersectObjects(
                   [this.bodies.mockup_mesh, ...(this.bodies.tool.visible ? [this.bodies.tool_mesh] : [])],
                   false)[0]
               ?.point ??
        null;
  }
  /** The box of all that is drawn. */
  box(): three.Box3 {
    const box = (this.bodies.mockup_mesh.geometry.boundingBox ?? new three.Box3()).clone();
    return this.bodies.tool.visible ? box.union(new three.Box3().setFromObject(this.bodies.tool_mesh)) : box;
  }
  pose_of_tool(): Pose {
    const {position: p, quaternion: q} = this.bodies.tool;
    return [p.x, p.y, p.z, q.x, q.y, q.z, q.w];
  }
  theme(dark: boolean): void {
    const theme = dark ? DARK : LIGHT;
    this.view.theme(theme);
    this.bodies.theme(theme);
    this.areas.theme(theme);
    this.voxels.theme(theme);
    this.ghost.theme(theme);
    this.view.request();
  }
}
