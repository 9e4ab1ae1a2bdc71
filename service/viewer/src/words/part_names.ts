// Which parts touch: triangles' ids belong to parts in the order of the scene.
import {places_of} from '../draw/shown_parts.js';
import type {Area, Frame, NamedPart, SceneParts} from '../server/protocol.js';

const MOST = 3;

/** The last names of paths; whole paths where two have the same last one. */
export function short_names(paths: readonly string[]): string[] {
  const last = paths.map((path) => path.slice(path.lastIndexOf('/') + 1));
  return paths.map(
      (path, i) => (last.filter((other) => other === last[i]).length > 1 ? path : last[i]) || 'unnamed');
}

class Body {
  private readonly at: (triangle: number) => number;
  private readonly names: string[];
  constructor(parts: readonly NamedPart[]) {
    this.at = places_of(parts);
    this.names = short_names(parts.map(({path}) => path));
  }
  touched(...lists: (readonly number[]|undefined)[]): string[] {
    const places = new Set<number>();
    for (const list of lists)
      for (const triangle of list ?? []) places.add(this.at(triangle));
    return [...places]
        .sort((a, b) => a - b)
        .map((place) => this.names[place])
        .filter((name) => name !== undefined);
  }
}
const listed = (names: string[]): string =>
    (names.length <= MOST ? names.join(', ') :
                            `${names.slice(0, MOST).join(', ')} and ${names.length - MOST} more`);
/** "handle ↔ cover, wall"; '' where a side is not known. */
export const touching_words = (tool: string[], mockup: string[]): string =>
    (tool.length === 0 || mockup.length === 0 ? '' : `${listed(tool)} ↔ ${listed(mockup)}`);

export class PartNames {
  private readonly mockup: Body;
  private readonly tool: Body;
  constructor(parts: SceneParts) {
    this.mockup = new Body(parts.static);
    this.tool = new Body(parts.tool);
  }
  of_area(area: Area): string {
    return touching_words(this.tool.touched(area.mobile), this.mockup.touched(area.static));
  }
  /** As the server counts them: of the intersecting triangles and the areas. */
  of_frame(frame: Pick<Frame, 'cst'|'cmt'|'areas'>): string {
    return touching_words(
        this.tool.touched(frame.cmt, ...frame.areas.map((area) => area.mobile)),
        this.mockup.touched(frame.cst, ...frame.areas.map((area) => area.static)));
  }
}
