// Numbers over the picture: what is felt now, the areas, and the legend's counts.
import { element, make, write } from './dom.js';
import type { Moment } from './moment.js';
import { KIND_TEXT } from './palette.js';
import { KINDS, length, type Frame, type Kind } from './protocol.js';
import { figure } from './strips.js';

const MOST_ROWS = 8;

export class Readout {
  private readonly counts = {} as Record<Kind, HTMLElement>;
  private table_of: Frame | null | undefined;

  /** `toggled`: a kind's button was pressed. */
  constructor(toggled: (kind: Kind, on: boolean) => void) {
    const legend = element('legend');
    KINDS.forEach((kind, i) => {
      const count = make('b');
      const button = make('button', { 'aria-pressed': 'true', title: `${KIND_TEXT[kind]} (key ${i + 1})`, 'data-kind': kind }, make('i', { class: `swatch ${kind}` }), kind.toUpperCase(), count);
      button.addEventListener('click', () => {
        const on = button.getAttribute('aria-pressed') !== 'true';
        button.setAttribute('aria-pressed', String(on));
        toggled(kind, on);
      });
      this.counts[kind] = count;
      legend.append(button);
    });
  }

  show(moment: Moment | null, stages: string[]): void {
    write(element('force'), moment ? figure(length(moment.force)) : '–');
    write(element('torque'), moment ? figure(length(moment.torque)) : '–');
    write(element('depth'), moment ? figure(moment.depth * 1000) : '–');
    const state = element('contact');
    const frame = moment?.frame ?? null;
    write(state, !moment ? 'no source' : moment.note || (moment.contact ? 'contact' : 'free'));
    const kind_of_state = moment?.note ? 'note' : moment?.contact ? 'contact' : 'free';
    if (state.dataset['state'] !== kind_of_state) state.dataset['state'] = kind_of_state;
    write(element('stage'), moment && moment.stage > 0 ? `${moment.stage}  ${stages[moment.stage - 1] ?? ''}` : '');
    write(element('warning'), frame?.truncated ? 'A list was too small for this frame: no force.' : (frame?.flags ?? []).join(', '));
    for (const kind of KINDS) write(this.counts[kind], frame ? frame[kind].length.toLocaleString('en') : '');
    if (frame !== this.table_of) this.table(frame);
  }

  private table(frame: Frame | null): void {
    this.table_of = frame;
    const areas = frame?.contact ? frame.areas : [];
    const rows = areas.slice(0, MOST_ROWS).map((area) => make('tr', {},
      make('td', { title: `smallest triangle ${area.id}` }, String(area.id)),
      make('td', {}, String(area.zones?.length ?? '–')),
      make('td', {}, figure(area.depth * 1000)),
      make('td', {}, figure((area.max_depth ?? NaN) * 1000)),
      make('td', {}, figure(length(area.force))),
      make('td', { class: 'flags' }, (area.flags ?? []).join(', '))));
    element('areas').replaceChildren(...rows);
    element('areas-more').textContent = areas.length === 0 ? 'No contact area.' : areas.length > MOST_ROWS ? `and ${areas.length - MOST_ROWS} more` : '';
  }
}
