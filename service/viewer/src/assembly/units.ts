// Units of files that state none, and sizes in words.
import type { Box, Vec3 } from '../server/protocol.js';

export const UNITS = { m: 1, mm: 1e-3, cm: 1e-2, in: 0.0254 } as const;
export type Unit = keyof typeof UNITS;

/** A length in metres as one would say it: "12 cm", "1.5 m", "80 µm". */
export function length_words(metres: number): string {
  const say = (value: number, unit: string) => `${Number(value.toPrecision(value >= 100 ? 3 : 2)).toLocaleString('en')} ${unit}`;
  if (metres >= 1000) return say(metres / 1000, 'km');
  if (metres >= 1) return say(metres, 'm');
  if (metres >= 0.1) return say(metres * 100, 'cm');
  return metres >= 1e-3 ? say(metres * 1000, 'mm') : say(metres * 1e6, 'µm');
}
export function size_words(box: Box, scale: number): string {
  return [0, 1, 2].map((k) => length_words((box.max[k] - box.min[k]) * scale)).join(' × ');
}

/** The unit to begin with, where a file states none: that in which the longest side is a thing one could hold or lift, millimetres above all. */
export function likely_unit(longest: number, in_metres: boolean): Unit {
  if (in_metres && longest < 100) return 'm';
  return longest >= 5 ? 'mm' : 'm';
}

export function joined(boxes: (Box | null)[]): Box | null {
  const known = boxes.filter((box): box is Box => box !== null);
  if (known.length === 0) return null;
  const pick = (choose: (...values: number[]) => number, end: 'min' | 'max') => [0, 1, 2].map((k) => choose(...known.map((box) => box[end][k]))) as Vec3;
  return { min: pick(Math.min, 'min'), max: pick(Math.max, 'max') };
}
export const longest_side = (box: Box | null): number => (box ? Math.max(...[0, 1, 2].map((k) => box.max[k] - box.min[k])) : 0);
