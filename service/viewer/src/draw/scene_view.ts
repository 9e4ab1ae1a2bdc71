// The picture's frame: renderer, camera, light, ground grid. Draws when something changed, and else rests.
// What moves may be drawn coarsely; at rest all is sharp.
import * as three from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

import {choose_corner} from './flat_shading.js';
import {KeptPicture} from './kept_picture.js';

import type {Theme} from './palette.js';

/** The nearest 1, 2 or 5 times a power of ten at or below `value`. */
export function round_down(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const lead = value / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

const SHARP_AFTER = 8;  // pictures' times without a picture; chosen: a hand that stops waits an eighth of a
                        // second for the sharp one

// Without a GPU, from one picture to the next, ms: as many as look smooth. More would be drawn with the
// processors that work out what the tool touches. Chosen: every second one of a screen of 60 Hz.
const PACE_MS = 25;

/**
 * Whether WebGL is drawn without a GPU: then edges are left rough, for smooth ones cost four times as much,
 * and it is pixels that take the time.
 */
function drawn_by_processor(): boolean {
  const context = document.createElement('canvas').getContext('webgl2');
  const names = context?.getExtension('WEBGL_debug_renderer_info');
  const renderer = context && names ? String(context.getParameter(names.UNMASKED_RENDERER_WEBGL)) : '';
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(renderer);
}

export class SceneView {
  readonly renderer: three.WebGLRenderer;
  readonly scene = new three.Scene();
  readonly camera = new three.PerspectiveCamera(38, 1, 0.001, 100);
  readonly controls: OrbitControls;
  /**
   * Called before each picture, and after it with the time since the last one in an unbroken row, ms (NaN
   * for the first), and how many of both were drawn with what stands still.
   */
  readonly before_draw: (() => void)[] = [];
  readonly after_draw: ((ms: number, whole: number) => void)[] = [];
  /** Whether pixels are what takes the time. */
  readonly software = drawn_by_processor();
  /** What stands still. */
  readonly kept: KeptPicture;
  /**
   * Pictures that follow one another have half the width and height: while the camera moves, and while it
   * stands.
   */
  coarse = false;
  coarse_standing = false;
  /** A headset has the pictures: here none is drawn. */
  presenting = false;
  /** The grid's cell, m. */
  grid_cell = 0;
  private grid: three.GridHelper|null = null;
  private grid_colour = 0xffffff;
  private dirty = false;
  private running = false;
  private readonly waiting: ((now: number) => void)[] = [];
  private quiet = 0;
  private last_draw = NaN;
  private drew_at = -Infinity;
  private last_whole = 0;
  private readonly sharp: number;  // pixels of the picture for one of the page
  private focus = {centre: new three.Vector3(), radius: 1, floor: 0};

  constructor(private readonly host: HTMLElement) {
    this.renderer = new three.WebGLRenderer({antialias: !this.software, powerPreference: 'high-performance'});
    const choose = () => choose_corner(this.renderer.getContext() as WebGL2RenderingContext);
    choose();
    this.canvas.addEventListener('webglcontextrestored', choose);
    this.sharp = this.software ? 1 : Math.min(window.devicePixelRatio, 2);
    this.renderer.setPixelRatio(this.sharp);
    host.append(this.renderer.domElement);
    this.canvas.setAttribute('role', 'img');
    this.name('The picture', 'empty-title');  // until there is one
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.request());
    const sky = new three.HemisphereLight(0xffffff, 0x8a8f96, 1.9);
    sky.position.set(0, 0, 1);
    const lamp = new three.DirectionalLight(
        0xffffff, 1.9);  // over the viewer's left shoulder, whichever way one looks
    lamp.position.set(-0.6, 0.9, 0.8);
    this.camera.add(lamp);
    this.scene.add(sky, this.camera);
    this.kept = new KeptPicture(this.renderer, this.scene, this.camera);
    this.kept.lit_by(sky);
    this.kept.lit_by(lamp);
    new ResizeObserver(() => this.resize()).observe(host);
    document.addEventListener('visibilitychange', () => {
      this.last_draw = NaN;
    });  // how long nobody looked is no picture's time
    this.resize();
  }

  /**
   * A picture is due. The row of pictures goes on for a while after the last that was asked for, then rests
   * until the next.
   */
  request(): void {
    this.dirty = true;
    if (!this.running) {
      this.quiet = 0;
      this.last_draw = NaN;
    }
    this.run();
  }
  /**
   * Calls `call` once, when the next picture may be drawn and before it is; that it is drawn is not asked.
   */
  before_next(call: (now: number) => void): void {
    this.waiting.push(call);
    this.run();
  }
  private run(): void {
    if (this.running || this.presenting) return;
    this.running = true;
    requestAnimationFrame(this.draw);
  }
  private readonly draw = (now: number): void => {
    if (this.presenting) {
      this.running = false;
      return;
    }
    if (this.software && (this.dirty || this.waiting.length > 0) && now - this.drew_at < PACE_MS) {
      requestAnimationFrame(this.draw);
      return;
    }
    for (const call of this.waiting.splice(0)) call(now);
    this.quiet = this.dirty ? 0 : this.quiet + 1;
    this.running = this.quiet < 20 || this.waiting.length > 0;
    if (this.running) requestAnimationFrame(this.draw);
    const before = this.renderer.getPixelRatio();
    const rests = this.quiet === SHARP_AFTER &&
        (before !== this.sharp || (this.software && this.kept.may_keep && !this.kept.ready));
    if (!this.dirty && !rests) {
      this.last_draw = NaN;
      return;
    }
    this.dirty = false;
    this.drew_at = now;
    this.camera.updateMatrixWorld();
    const stands = this.software && (this.kept.look(now) || rests) && this.kept.may_keep;
    // Coarse from the second picture of a row to the end of the motion, which a row that breaks is not:
    // another size costs a picture's time.
    const ratio = rests || !(stands ? this.coarse_standing : this.coarse) ? this.sharp :
        Number.isFinite(this.last_draw)                                   ? this.sharp / 2 :
                                                                            before;
    if (ratio !== before) this.renderer.setPixelRatio(ratio);
    for (const call of this.before_draw) call();  // labels are placed by where the camera is now
    const whole = stands && this.kept.ready ? 0 : 1;
    this.kept.draw(stands);
    for (const call of this.after_draw) call(now - this.last_draw, whole + this.last_whole);
    this.last_draw = rests ? NaN : now;
    this.last_whole = whole;
  };

  /** Whether the picture that is drawn now has half the width and height. */
  get draws_coarsely(): boolean {
    return this.renderer.getPixelRatio() < this.sharp;
  }
  /**
   * Makes the programs of all that may come to be drawn, so that the first contact does not wait for its own
   * in the middle of a motion.
   */
  make_ready(): void {
    this.renderer.compile(this.scene, this.camera);
  }

  /** Draws at once, sharp, for who reads the canvas next. */
  draw_now(): void {
    if (this.renderer.getPixelRatio() !== this.sharp) this.renderer.setPixelRatio(this.sharp);
    this.kept.look(performance.now());
    this.kept.draw(false);
  }
  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Fits the picture to its place on the page. */
  resize(): void {
    const {clientWidth: width, clientHeight: height} = this.host;
    if (width === 0 || height === 0 || this.presenting) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.request();
  }

  theme(theme: Theme): void {
    this.scene.background = new three.Color(theme.page);
    this.grid_colour = theme.grid;
    this.draw_grid();
    this.request();
  }

  /** What there is to see: the box of the mock-up. */
  set_bounds(box: three.Box3): void {
    const sphere = box.getBoundingSphere(new three.Sphere());
    this.focus = {centre: sphere.center, radius: Math.max(sphere.radius, 1e-4), floor: box.min.z};
    this.controls.minDistance = this.focus.radius * 0.005;
    this.controls.maxDistance = this.focus.radius * 20;
    this.camera.near = this.focus.radius * 0.002;
    this.camera.far = this.focus.radius * 40;
    this.camera.updateProjectionMatrix();
    this.draw_grid();
  }

  /** Looks at a sphere from where the camera is, or from the usual place. */
  look_at(centre: three.Vector3, radius: number, from_usual = false): void {
    const direction = from_usual ? new three.Vector3(0.55, -1, 0.62).normalize() :
                                   this.camera.position.clone().sub(this.controls.target).normalize();
    const half = three.MathUtils.degToRad(this.camera.fov / 2);
    const distance = radius / Math.sin(Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect)));
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(direction, distance);
    this.controls.update();
    this.request();
  }
  get bounds(): three.Sphere {
    return new three.Sphere(this.focus.centre.clone(), this.focus.radius);
  }
  look_at_all(from_usual = false): void {
    this.look_at(this.focus.centre, this.focus.radius * 1.02, from_usual);
  }

  /** What the picture is of, and which elements of the page say it in words. */
  name(text: string, described_by: string): void {
    this.canvas.setAttribute('aria-label', text);
    this.canvas.setAttribute('aria-describedby', described_by);
  }
  /**
   * Turns about what it looks at, to the right and upwards, rad; goes nearer, as a share of the way. For
   * keys.
   */
  step(right: number, up: number, nearer: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    offset.applyAxisAngle(this.camera.up, right);
    const side = new three.Vector3().crossVectors(this.camera.up, offset).normalize();
    const steep = offset.angleTo(this.camera.up);
    offset.applyAxisAngle(side, three.MathUtils.clamp(steep - up, 0.02, Math.PI - 0.02) - steep);
    this.camera.position.copy(this.controls.target).addScaledVector(offset, 1 - nearer);
    this.controls.update();
    this.request();
  }
  /** Moves camera and what it looks at. */
  shift(by: three.Vector3): void {
    this.camera.position.add(by);
    this.controls.target.add(by);
    this.request();
  }

  /** Turns y or z upwards. */
  turn_up(): void {
    const z = this.camera.up.z === 1;
    this.camera.up.set(0, z ? 1 : 0, z ? 0 : 1);
    this.controls.dispose();
    Object.assign(this, {controls: new OrbitControls(this.camera, this.canvas)});
    this.controls.addEventListener('change', () => this.request());
    this.set_bounds_again();
    this.look_at_all(true);
  }
  private set_bounds_again(): void {
    this.controls.minDistance = this.focus.radius * 0.005;
    this.controls.maxDistance = this.focus.radius * 20;
    this.draw_grid();
  }

  private draw_grid(): void {
    if (this.grid) {
      this.scene.remove(this.grid);
      this.kept.remove(this.grid);
      this.grid.dispose();
    }
    this.grid_cell = round_down(this.focus.radius / 4);
    const cells = 2 * Math.ceil((this.focus.radius * 1.6) / this.grid_cell);
    this.grid = new three.GridHelper(cells * this.grid_cell, cells, this.grid_colour, this.grid_colour);
    const snap = (value: number) => Math.round(value / this.grid_cell) * this.grid_cell;
    if (this.camera.up.z === 1) {
      this.grid.rotation.x = Math.PI / 2;
      this.grid.position.set(
          snap(this.focus.centre.x), snap(this.focus.centre.y), this.focus.floor - this.focus.radius * 0.04);
    } else {
      this.grid.position.set(
          snap(this.focus.centre.x), this.focus.centre.y - this.focus.radius * 0.7,
          snap(this.focus.centre.z));
    }
    this.scene.add(this.grid);
    this.kept.add(this.grid);
    this.request();
  }

  /** Where a point of the world is on the screen, in pixels of the canvas; null behind the camera. */
  project(point: three.Vector3): {x: number; y: number}|null {
    const place = point.clone().project(this.camera);
    if (place.z > 1) return null;
    return {
      x: ((place.x + 1) / 2) * this.canvas.clientWidth,
      y: ((1 - place.y) / 2) * this.canvas.clientHeight
    };
  }
}
