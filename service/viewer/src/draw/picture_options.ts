// What the panel offers to be shown or not.
import {element} from '../dom.js';
import type {ClearanceLine} from '../tools/clearance_line.js';
import type {Colouring} from './contact_layer.js';
import type {Labels} from './labels.js';
import type {Picture} from './picture.js';

/** `changed`: something is to be shown anew. */
export function offer_picture_options(
    picture: Picture, labels: Labels, clearance: ClearanceLine, changed: () => void,
    failed: (error: unknown) => void): void {
  const check = (id: string, set: (on: boolean) => void) => {
    const box = element<HTMLInputElement>(id);
    box.addEventListener('change', () => {
      set(box.checked);
      changed();
      picture.redraw_contact();
    });
  };
  const colouring = element<HTMLSelectElement>('colouring');
  colouring.addEventListener('change', () => {
    picture.contact.colouring = colouring.value as Colouring;
    picture.redraw_contact();
  });
  const voxels = element<HTMLSelectElement>('voxels');
  voxels.addEventListener('change', () => {
    if (voxels.value === 'internal' && !element<HTMLInputElement>('glass-mockup').checked)
      element('glass-mockup').click();  // or they would be hidden by what they fill
    picture.show_voxels((voxels.value || null) as 'boundary' | 'internal' | null).catch((error: unknown) => {
      voxels.value = '';
      failed(error);
    });
  });
  check('show-normals', (on) => {
    picture.areas.show.normals = on;
  });
  check('show-heights', (on) => {
    picture.areas.show.heights = on;
  });
  check('show-wrench', (on) => {
    picture.areas.show.wrench = on;
  });
  check('show-clearance', (on) => clearance.set_on(on));
  check('show-labels', (on) => {
    labels.shown = on;
  });
  check('glass-mockup', (on) => picture.bodies.glass('mockup', on));
  check('glass-tool', (on) => picture.bodies.glass('tool', on));
}
