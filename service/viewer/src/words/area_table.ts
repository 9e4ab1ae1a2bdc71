// The table of contact areas: those that push first, the strongest on top; flags in words below the row that
// has them.
import {element, make} from '../dom.js';

import {flag_words} from './flag_words.js';

import {length, type Area} from '../server/protocol.js';
import {figure} from '../strips.js';

const MOST_ROWS = 8;
const COLUMNS = 5;

/** Strongest first; what gives no force comes last, the deepest first. */
export function by_force(areas: readonly Area[]): Area[] {
  return [...areas].sort((a, b) => length(b.force) - length(a.force) || b.depth - a.depth || a.id - b.id);
}

export function flag_chips(flags: readonly string[]): HTMLElement[] {
  return flags.map((flag) => {
    const {short, long} = flag_words(flag);
    return make('abbr', {title: long, tabindex: '0', 'data-flag': flag}, short);
  });
}

/** `names`: which parts an area's triangles belong to; '' when nobody knows. */
export function show_areas(areas: readonly Area[], names: (area: Area) => string): void {
  const rows = by_force(areas).slice(0, MOST_ROWS).flatMap((area) => {
    const flags = area.flags ?? [];
    const touching = names(area);
    const more = touching !== '' || flags.length > 0;
    const row = make(
        'tr', more ? {class: 'with-more'} : {},
        make('td', {title: `smallest triangle ${area.id}`}, String(area.id)),
        make('td', {}, String(area.zones?.length ?? '–')), make('td', {}, figure(area.depth * 1000)),
        make('td', {}, figure((area.max_depth ?? NaN) * 1000)), make('td', {}, figure(length(area.force))));
    if (!more) return [row];
    return [
      row,
      make(
          'tr', {class: 'more'},
          make(
              'td', {colspan: String(COLUMNS)},
              ...(touching ? [make('span', {class: 'touching'}, touching)] : []), ...flag_chips(flags)))
    ];
  });
  element('areas').replaceChildren(...rows);
  element('areas-table').hidden = areas.length === 0;
  element('areas-more').textContent = areas.length === 0 ? 'No contact area.' :
      areas.length > MOST_ROWS                           ? `and ${areas.length - MOST_ROWS} more` :
                                                           '';
}
