// How far the tool is, in words.
import {length_words} from '../assembly/units.js';
import type {ClearanceAnswer} from '../server/protocol.js';
import {short_names, touching_words} from './part_names.js';

/** "12.3 mm apart: handle ↔ cover (measured by cpu)"; '' where there is nothing to say. */
export function clearance_words(answer: ClearanceAnswer): string {
  if (answer.touches || answer.clearance === null) return '';
  const who = answer.parts ?
      touching_words(short_names([answer.parts.mobile]), short_names([answer.parts.static])) :
      '';
  return `${length_words(answer.clearance)} apart${who ? `: ${who}` : ''} (measured by ${answer.engine})`;
}
