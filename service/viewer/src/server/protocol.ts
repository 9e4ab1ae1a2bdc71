// What the server says, as docs/SERVICE.md defines it: JSON shapes, and the binary forms for drawing. SI
// units; a pose is world from tool.

export type Vec3 = [number, number, number];
/** x, y, z in metres, then a unit quaternion x, y, z, w. */
export type Pose = [number, number, number, number, number, number, number];

export interface Problem {
  type: string;
  title: string;
  status: number;
  detail: string;
  field?: string
}

export interface Scene {
  id: string;
  name: string;
  state: 'queued'|'preparing'|'ready'|'failed'|'evicted';
  step: string|null;
  progress: number|null;
  error: Problem|null;
  memory_bytes: number|null;
  profile: string|null;
  stiffness: number|null;
  static_triangles: number|null;
  tool_triangles: number|null;
  backend: string|null;
  device: string|null;
  voxel_size: number|null;
  bounds: {min: Vec3; max: Vec3}|null;
  tool_radius: number|null;
  tool_gc: Vec3|null;
  start: Pose|null;
  stages: string[]|null;
  driver: string|null;
  ignores_initial?: boolean|null;
  warnings: string[];
}
export interface SceneList {
  scenes: Scene[];
  available: string[]
}
export interface Device {
  kind: string;
  name: string;
  usable: boolean;
  reason: string
}
export interface Session {
  id: string;
  scene: string;
  device: string;
  state: 'starting'|'running'|'paused'|'ended'|'failed';
  tick: number;
  time_s: number;
  error: string|Problem|null;
}
export interface Run {
  name: string;
  files: Record<string, number>;
  modified: number;
  static_triangles: number|null;
  tool_triangles: number|null;
  backend: string|null;
  ticks: number|null;
}

export interface Box {
  min: Vec3;
  max: Vec3
}
/** A part of a scene's body; its first triangle is the sum of those before it. */
export interface NamedPart {
  path: string;
  triangles: number
}
export interface SceneParts {
  static: NamedPart[];
  tool: NamedPart[]
}

/**
 * A line of a query for clearance, m; null: further than is measured. The points and parts: of two that are
 * apart.
 */
export interface ClearanceAnswer {
  engine: string;
  touches: boolean;
  clearance: number|null;
  on_static?: Vec3;
  on_mobile?: Vec3;
  parts?: {static: string; mobile: string}
}

/** Mesh files that were uploaded together. Coordinates are file units, metres where `states_unit`. */
export interface AssemblyFile {
  name: string;
  bytes: number;
  mesh: boolean;
  states_unit: boolean;
  in_metres: boolean;
  triangles: number|null;
  error: string|null;
  notes: string[]
}
export interface AssemblyPart {
  file: number;
  path: string;
  also: string;
  first_triangle: number;
  triangles: number;
  colour: string|null;
  box: Box|null
}
export interface Assembly {
  id: string;
  state: 'reading'|'ready'|'failed';
  step: string;
  progress: number;
  error: Problem|null;
  files: AssemblyFile[];
  parts: AssemblyPart[]
}

/** The contact sets: static triangles first, then those of the tool. */
export const KINDS = ['cst', 'bst', 'est', 'cmt', 'bmt', 'imt'] as const;
export type Kind = (typeof KINDS)[number];
export const STATIC_KINDS: readonly Kind[] = ['bst', 'est', 'cst'];
export const MOBILE_KINDS: readonly Kind[] = ['bmt', 'imt', 'cmt'];

/** Whether it is said which triangles belong to each area. */
export const has_lists = (frame: Frame|null): boolean =>
    frame?.areas?.every((area) => area.static !== undefined) ?? true;
export interface Area {
  id: number;
  zones?: number[][];
  static?: number[];
  mobile?: number[];
  normal: Vec3;
  depth: number;
  point: Vec3;
  force: Vec3;
  torque: Vec3;
  flags?: string[];
  rays?: number;
  max_depth?: number;
}
/** A line of frames.jsonl. */
export interface Frame extends Record<Kind, number[]> {
  tick: number;
  pose?: Pose;
  contact: boolean;
  pairs: number;
  areas: Area[];
  force: Vec3;
  torque: Vec3;
  flags: string[];
  truncated: boolean;
  time_us: Record<string, number>;
}

export interface StreamHello {
  type: 'hello';
  session: string;
  scene: string;
  stiffness: number;
  device: string;
  max_force: number;
  stages: string[]
}
export interface Telemetry {
  type: 'telemetry';
  seq: number;
  dropped: number;
  tick: number;
  time_s: number;
  pose: Pose;
  force: Vec3;
  torque: Vec3;
  response_force: Vec3;
  response_torque: Vec3;
  result_age_ticks: number;
  contact: boolean;
  stage: number;
  lateness_us: number;
  lateness_max_us: number;
  missed_ticks: number;
  frame_us: number;
  paused: boolean;
  frame: Frame|null;
  frame_pose: Pose|null;
}
export interface HapticHello {
  type: 'hello';
  scene: string;
  stiffness: number;
  watchdog_ms: number;
  tool_gc: Vec3;
  start: Pose
}
/** What pushes along `normal` with max(0, force − stiffness·(normal·Δgc + lever·Δturn)), N and N/m. */
export interface Plane {
  normal: Vec3;
  lever: Vec3;
  force: number;
  stiffness: number
}
export interface Wrench {
  type: 'wrench';
  seq: number;
  time: number;
  skipped: number;
  server_us: number;
  contact: boolean;
  truncated: boolean;
  engine?: string|null;
  pairs: number;
  gc: Vec3;
  force: Vec3;
  torque: Vec3;
  planes: Plane[];
  frame?: Frame;
}
export interface Bye {
  type: 'bye';
  reason: string
}
export interface Fault {
  type: 'error';
  problem: Problem
}

export const ZERO: Vec3 = [0, 0, 0];
export const length = (v: Vec3): number => Math.hypot(v[0], v[1], v[2]);
/** The largest depth of a frame's areas, m. */
export const depth = (frame: {areas: Area[]}|null): number =>
    (frame ? frame.areas.reduce((most, area) => Math.max(most, area.depth), 0) : 0);
