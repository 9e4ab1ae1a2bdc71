// What is said about contact that is there before anybody moved: who touches whom, how deep, and the choice
// to leave it out.
import {element, make} from '../dom.js';
import type {Api} from '../server/api.js';
import {depth, length, type Scene} from '../server/protocol.js';
import {figure} from '../strips.js';
import {short_names, touching_words} from './part_names.js';

export class StartNote {
  private readonly host = element('start-note');
  private of = '';

  /** `leave_out`: opens the same scene without them; null where that can't be done. */
  constructor(private readonly api: Api) {}

  hide(): void {
    this.of = '';
    this.host.hidden = true;
  }
  async look(scene: Scene, leave_out: (() => void)|null): Promise<void> {
    this.hide();
    this.of = scene.id;
    if (!scene.start) return;
    if (scene.ignores_initial) {
      this.show('Contacts that are there at the start are left out, until they have opened once.', null);
      return;
    }
    const found = await this.api.query(scene.id, scene.start);
    if (this.of !== scene.id || !found.contact) return;
    const who =
        touching_words(short_names(found.parts?.tool ?? []), short_names(found.parts?.static ?? [])) ||
        'the tool and the mock-up';
    this.show(
        `At its start the tool is in contact already: ${who}, ${figure(depth(found) * 1000)} mm deep, ${
            figure(length(found.force))} N.`,
        scene.profile === 'refined' ? leave_out : null);
  }
  private show(text: string, leave_out: (() => void)|null): void {
    this.host.hidden = false;
    const paragraph = make('p', {}, text);
    this.host.replaceChildren(make('h2', {}, 'Where it starts'), paragraph);
    if (!leave_out) return;
    const button = make(
        'button', {id: 'leave-out', title: 'They give no force until they have opened once; all others do'},
        'Leave these contacts out');
    button.addEventListener('click', leave_out);
    this.host.append(make('div', {class: 'row'}, button));
  }
}
