// What a person has decided about an assembly, as plain data; the scene file that it makes; and undo.
import type {Assembly, Pose} from '../server/protocol.js';
import type {PartNode} from './part_nodes.js';
import type {Unit} from './units.js';

/** Which engine answers; '': the server's choice. */
export type Engine = ''|'gpu'|'cpu'|'ref';
export interface Settings {
  stiffness: number;
  voxel_mm: number|null;
  walls: string;  // of open surfaces: '', 'auto', or mm
  profile: 'refined'|'paper';
  law: 'corrected'|'printed';
  budget_us: number;
  engine: Engine
}
export interface Draft {
  units: Record<number, Unit>;  // of files that state none
  tool: string;                 // a node's key; '' none
  place: Pose;                  // world from the tool's file
  hidden: string[];             // keys of nodes that are not drawn
  ignore_initial: boolean;
  settings: Settings;
}
const THINNEST_MM = 0.001, THICKEST_MM = 1000;  // scenes/scene.schema.json
/** What is wrong with the walls of open surfaces as they are typed; '': nothing. */
export function wrong_walls(text: string): string {
  const mm = Number(text);
  return text === '' || text === 'auto' || (mm >= THINNEST_MM && mm <= THICKEST_MM) ?
      '' :
      `Empty, "auto", or from ${THINNEST_MM} to ${THICKEST_MM} mm.`;
}

export const AT_HOME: Pose = [0, 0, 0, 0, 0, 0, 1];
export const USUAL: Settings = {
  stiffness: 2000,
  voxel_mm: null,
  walls: '',
  profile: 'refined',
  law: 'corrected',
  budget_us: 4000,
  engine: ''
};

const HEADER = 'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n';
/** A path file of what was recorded, or of a tool that rests. */
export function path_text(rows: {time: number; pose: Pose}[]): string {
  return HEADER +
      rows.map(
              ({time, pose}) => `${time.toFixed(4)},${
                  pose.map((value, i) => value.toPrecision(i < 3 ? 9 : 12)).join(',')},0`)
          .join('\n') +
      '\n';
}

export interface Order {
  scene: Record<string, unknown>;
  path?: string
}
/**
 * The scene file of a draft that has a tool: the rest of all files is the mock-up. `path`: recorded, if any.
 * Error: nothing would be left.
 */
export function scene_of(
    assembly: Assembly, draft: Draft, tool: PartNode, path: {time: number; pose: Pose}[] = []): Order {
  const {settings} = draft, {walls} = settings;
  const body = (file: number): Record<string, unknown> => {
    const {name, states_unit} = assembly.files[file];
    return {
      mesh: name,
      ...(states_unit || !draft.units[file] ? {} : {units: draft.units[file]}),
      ...(walls ? {sheet_thickness: walls === 'auto' ? walls : Number(walls) / 1000} : {})
    };
  };
  const whole = tool.path === '' ||
      assembly.parts.every((part, i) => part.file !== tool.file || tool.parts.includes(i));
  const others = assembly.files.map((file, i) => ({file, i}))
                     .filter(({file, i}) => file.mesh && !file.error && (i !== tool.file || !whole));
  if (others.length === 0)
    throw new Error('Without this part nothing is left as a mock-up: take out a smaller one, or add a file.');
  const rows = path.length > 0 ? path :
      draft.place.some((value, i) => value !== AT_HOME[i]) ?
                                 [{time: 0, pose: draft.place}, {time: 1, pose: draft.place}] :
                                 [];
  const scene: Record<string, unknown> = {
    static: others.map(({i}) => ({...body(i), ...(i === tool.file ? {without: [tool.path]} : {})})),
    tool: {...body(tool.file), ...(whole ? {} : {part: tool.path})},
    response: {
      profile: settings.profile,
      stiffness: settings.stiffness,
      budget_us: settings.budget_us,
      ...(settings.voxel_mm === null ? {} : {voxel_size: settings.voxel_mm / 1000})
    },
    control: {law: settings.law},
    ...(rows.length > 0 ? {device: {driver: 'simulated', path: 'path.csv'}} : {}),
    ...(draft.ignore_initial ? {start: 'ignore_initial'} : {}),
  };
  return {scene, ...(rows.length > 0 ? {path: path_text(rows)} : {})};
}

/** States before the present one, as text. */
export class History {
  private before: string[] = [];
  private after: string[] = [];
  constructor(private now: string) {}
  take(next: string): void {
    if (next === this.now) return;
    this.before.push(this.now);
    this.after = [];
    this.now = next;
  }
  get can_undo(): boolean {
    return this.before.length > 0;
  }
  get can_redo(): boolean {
    return this.after.length > 0;
  }
  undo(): string {
    return this.step(this.before, this.after);
  }
  redo(): string {
    return this.step(this.after, this.before);
  }
  private step(from: string[], to: string[]): string {
    const state = from.pop();
    if (state !== undefined) {
      to.push(this.now);
      this.now = state;
    }
    return this.now;
  }
}
