// Numbers over the picture: what is felt now, the areas, and the legend's counts.
import {element, make, write} from '../dom.js';

import {flag_chips, show_areas} from './area_table.js';

import type {Moment} from '../moment.js';
import {KIND_TEXT} from '../draw/palette.js';
import {KINDS, length, type Area, type Frame, type Kind, type Vec3} from '../server/protocol.js';
import {figure} from '../strips.js';

export class Readout {
  private readonly counts = {} as Record<Kind, HTMLElement>;
  private warned_of: Frame|null|undefined;
  private table_of: Frame|null|undefined;
  /** Which parts an area's triangles belong to; '' when nobody knows. */
  names: (area: Area) => string = () => '';
  /**
   * What the areas' forces are: of the response its parts, or of the field, which the tool's spring passes
   * on softened.
   */
  set_profile(profile: string|null): void {
    const [word, sentence] = profile === 'paper' ? ['force N', 'What the area adds to the response'] : [
      'field N',
      'What the field pushes where the tool is asked about. A device\'s tool hangs on a spring and gives way, so its response is less'
    ];
    write(element('areas-force'), word);
    element('areas-force').title = sentence;
  }
  /** Which parts touch in a frame. */
  touching: (frame: Frame) => string = () => '';

  /** `toggled`: a kind's button was pressed. */
  constructor(toggled: (kind: Kind, on: boolean) => void) {
    const legend = element('legend');
    KINDS.forEach((kind, i) => {
      const count = make('b');
      const button = make(
          'button', {'aria-pressed': 'true', title: `${KIND_TEXT[kind]} (key ${i + 1})`, 'data-kind': kind},
          make('i', {class: `swatch ${kind}`}), kind.toUpperCase(), count);
      button.addEventListener('click', () => {
        const on = button.getAttribute('aria-pressed') !== 'true';
        button.setAttribute('aria-pressed', String(on));
        toggled(kind, on);
      });
      this.counts[kind] = count;
      legend.append(button);
    });
  }

  show(moment: Moment|null, stages: string[]): void {
    this.pair('force', moment?.force, moment?.response?.force);
    this.pair('torque', moment?.torque, moment?.response?.torque);
    write(element('depth'), moment ? figure(moment.depth * 1000) : '–');
    const state = element('contact');
    const frame = moment?.frame ?? null;
    write(state, !moment ? 'no source' : moment.note || (moment.contact ? 'contact' : 'free'));
    const kind_of_state = moment?.note ? 'note' : moment?.contact ? 'contact' : 'free';
    if (state.dataset['state'] !== kind_of_state) state.dataset['state'] = kind_of_state;
    write(
        element('stage'),
        moment && moment.stage > 0 ? `${moment.stage}  ${stages[moment.stage - 1] ?? ''}` : '');
    for (const kind of KINDS) write(this.counts[kind], frame ? frame[kind].length.toLocaleString('en') : '');
    if (frame !== this.warned_of) {
      this.warned_of = frame;
      element('warning').replaceChildren(
          ...(frame?.truncated ? ['A list was too small for this frame: no force.'] :
                                 flag_chips(frame?.flags ?? [])));
    }
    const listed = frame?.contact ? moment?.listed ?? frame : frame;  // names need to know whose areas are
    if (listed === this.table_of) return;
    this.table_of = listed;
    write(element('touching'), listed?.contact ? this.touching(listed) : '');
    show_areas(listed?.contact ? listed.areas : [], this.names);
  }
  /**
   * What the contact answers, and what the hand gets of it: two figures where both are known, else the one.
   */
  private pair(name: 'force'|'torque', felt: Vec3|undefined, response: Vec3|undefined): void {
    write(element(name), felt ? figure(length(felt)) : '–');
    write(element(`${name}-response`), response ? figure(length(response)) : '–');
  }
}
