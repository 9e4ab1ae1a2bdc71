// Units of files that state none, and sizes in words.
import type {Box, Vec3} from '../server/protocol.js';

export const UNITS = { m: 1, mm: 1e-3, cm: 1e-2, in: 0.0254 } as const;
export type Unit = keyof typeof UNITS;

const SAID: [number, number, string][] = [[1000, 1e-3, 'km'], [1, 1, 'm'], [1e-3, 1e3, 'mm'], [0, 1e6, 'µm']];
const digits = (value: number): string => Number(value.toPrecision(3)).toLocaleString('en');

/** A length in metres as one would say it: "120 mm", "1.5 m", "80 µm". */
export function length_words(metres: number): string {
  const [, factor, unit] = SAID.find(([from]) => metres >= from)!;
  return `${digits(metres * factor)} ${unit}`;
}
/** Three lengths in the unit of the longest. */
export function sides_words(sides: readonly number[]): string {
  const [, factor, unit] = SAID.find(([from]) => Math.max(...sides) >= from)!;
  return `${sides.map((side) => digits(side * factor)).join(' × ')} ${unit}`;
}
export const size_words = (box: Box, scale: number): string =>
    sides_words([0, 1, 2].map((k) => (box.max[k] - box.min[k]) * scale));

/**
 * The unit to begin with, where a file states none: that in which the longest side is a thing one could hold
 * or lift, millimetres above all.
 */
export function likely_unit(longest: number, in_metres: boolean): Unit {
  if (in_metres && longest < 100) return 'm';
  return longest >= 5 ? 'mm' : 'm';
}

export function joined(boxes: (Box|null)[]): Box|null {
  const known = boxes.filter((box): box is Box => box !== null);
  if (known.length === 0) return null;
  const pick =
      (choose: (...values: number[]) => number,
       end: 'min'|'max') => [0, 1, 2].map((k) => choose(...known.map((box) => box[end][k]))) as Vec3;
  return {min: pick(Math.min, 'min'), max: pick(Math.max, 'max')};
}
export const longest_side = (box: Box|null): number =>
    (box ? Math.max(...[0, 1, 2].map((k) => box.max[k] - box.min[k])) : 0);
