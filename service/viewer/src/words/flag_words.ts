// What flags of frames and areas mean, in plain words. Their names are those of docs/SERVICE.md.
const WORDS: Record<string, [string, string]> = {
  cancelled: [
    'directions cancel',
    'The directions of this area\'s triangles cancel each other, so it has none and gives no force.'
  ],
  sheet: [
    'open surface',
    'An open surface (a sheet, without an inside) takes part: it pushes the shortest way out of the body that it is in. Where two meet, neither has an inside: walls make them push.'
  ],
  tool_open: [
    'tool is open',
    'The tool\'s surface is not closed and no inside was found: it pushes as an open surface does.'
  ],
  no_direction: ['no direction', 'There is contact, and nothing says which way out: no force.'],
  unsettled:
      ['no balance', 'No balance of spring and contact was found here: the force is the nearest to one.'],
};

/** A few words for a flag, and a sentence that explains them. */
export function flag_words(flag: string): {short: string; long: string} {
  const [short, long] =
      WORDS[flag] ?? [flag.replaceAll('_', ' '), `The server says "${flag}", which this page does not know.`];
  return {short, long};
}
export const KNOWN_FLAGS = Object.keys(WORDS);
