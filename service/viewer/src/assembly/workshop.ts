// From uploaded meshes to a scene: parts are seen and chosen, one is taken out as the tool, placed, and felt
// or saved.
import * as three from 'three';

import {element, make, write} from '../dom.js';

import type {Picture} from '../draw/picture.js';
import {DARK, LIGHT} from '../draw/palette.js';
import type {Api} from '../server/api.js';
import type {Assembly, Pose, Scene} from '../server/protocol.js';
import {AT_HOME, History, USUAL, scene_of, type Draft, type Order} from './draft.js';
import type {Taken} from './file_drop.js';
import {Gizmo} from './gizmo.js';
import {PartList, type RowLook} from './part_list.js';
import {find_node, part_tree, type PartNode} from './part_nodes.js';
import {PartPicture} from './part_picture.js';
import {SettingsForm} from './settings_form.js';
import {UNITS, joined, likely_unit, longest_side, sides_words, size_words, type Unit} from './units.js';
import {zip} from './zip.js';

const POLL_MS = 300;
const MOST_DRAWN = 1_500_000;
const MOST_DRAWN_BY_PROCESSOR = 250_000;  // chosen: where WebGL is drawn without a GPU

export interface WorkshopHooks {
  /** `stay`: the scene that is felt with other settings, the tool where it is. */
  open: (make: () => Promise<Scene>, name: string, stay: boolean) => Promise<void>;
  /** Whether the scene that is felt may be made anew now; says why not. */
  may_change: () => boolean;
  entered: (building: boolean) => void;
  say: (text: string, bad?: boolean) => void;
  failed: (error: unknown) => void;
}

export class Workshop {
  assembly: Assembly|null = null;
  /** A path that was recorded with the tool, for the scene that is saved or replayed. */
  path: {time: number; pose: Pose}[] = [];
  building = false;
  /** The scene that was made of it last. */
  made = '';
  private draft: Draft = this.fresh();
  private history = new History('');
  private roots: PartNode[] = [];
  private geometry: Awaited<ReturnType<Api['geometry']>>|null = null;
  private files: Taken[] = [];
  private selected = '';
  private hovered = '';
  private dark = false;
  private cancel: AbortController|null = null;
  private readonly parts = new PartPicture();
  private readonly list = new PartList(element('part-tree'), {
    select: (node) => this.select(node.key),
    hover: (node) => this.hover(node?.key ?? ''),
    toggle: (node) => this.toggle(node.key),
  });
  private readonly gizmo: Gizmo;
  private readonly settings = new SettingsForm((settings) => {
    if (this.building)
      this.change({settings});
    else if (this.hooks.may_change()) {
      this.change({settings});
      void this.feel(true);
    } else
      this.draw();
  });

  constructor(
      private readonly api: Api, private readonly picture: Picture, private readonly hooks: WorkshopHooks) {
    const fields = ['place-x', 'place-y', 'place-z', 'place-rx', 'place-ry', 'place-rz'].map(
        (id) => element<HTMLInputElement>(id));
    this.gizmo = new Gizmo(picture.view, fields, (place) => {
      this.move(place);
    }, (place) => this.change({place}));
    this.parts.object.visible = false;
    picture.view.scene.add(this.parts.object);
    picture.view.kept.add(this.parts.object, () => this.parts.changes());
    this.wire();
  }
  private fresh(): Draft {
    return {units: {}, tool: '', place: AT_HOME, hidden: [], ignore_initial: false, settings: {...USUAL}};
  }
  get tool(): PartNode|null {
    return this.draft.tool ? find_node(this.roots, this.draft.tool) : null;
  }
  get name(): string {
    const {tool, assembly} = this;
    return assembly ?
        `${assembly.files.find((file) => file.mesh)?.name ?? 'assembly'}${tool ? `, ${tool.name}` : ''}` :
                                                                                 '';
  }

  // ---- files come

  async take(files: Taken[]): Promise<void> {
    this.cancel?.abort();
    const cancel = (this.cancel = new AbortController());
    // Files dropped beside an open assembly join it.
    const all = this.building ?
        [...this.files.filter((old) => !files.some((file) => file.name === old.name)), ...files] :
        files;
    const bytes = all.reduce((sum, {blob}) => sum + blob.size, 0);
    const what = all.length === 1 ? all[0].name : `${all.length} files`;
    const show = (text: string, part: number|null) => this.progress(what, text, part);
    try {
      show(`Uploading ${(bytes / 1e6).toFixed(1)} MB`, 0);
      let assembly = await this.api.upload(
          all, (part) => show(`Uploading ${(bytes / 1e6).toFixed(1)} MB`, part), cancel.signal);
      while (assembly.state === 'reading') {
        show(`Reading ${assembly.step}`, assembly.progress);
        await new Promise((resolve) => setTimeout(resolve, POLL_MS));
        if (cancel.signal.aborted) return;
        assembly = await this.api.assembly(assembly.id);
      }
      if (assembly.state === 'failed')
        throw new Error(assembly.error?.detail ?? 'these files can\'t be read');
      if (cancel.signal.aborted) return;
      this.files = all;
      this.path = [];
      this.draft = this.fresh();
      assembly.files.forEach((file, i) => {
        if (file.mesh && !file.states_unit)
          this.draft.units[i] = likely_unit(longest_side(this.box_of_file(assembly, i)), file.in_metres);
      });
      await this.show(assembly);
    } catch (error) {
      if (!cancel.signal.aborted) this.refused(what, error instanceof Error ? error.message : String(error));
    } finally {
      if (this.cancel === cancel) this.cancel = null;
    }
  }
  /**
   * An assembly that the server still has, as after a reload; `enter`: it is shown. False: the server has it
   * no longer.
   */
  async restore(id: string, enter: boolean): Promise<boolean> {
    try {
      const assembly = await this.api.assembly(id);
      if (assembly.state !== 'ready') return false;
      const kept = sessionStorage.getItem(`palpate.draft.${id}`);
      this.draft = kept ? {...this.fresh(), ...(JSON.parse(kept) as Draft)} : this.fresh();
      this.draft.settings = {...USUAL, ...this.draft.settings};  // kept by a page that knew fewer
      this.made = sessionStorage.getItem(`palpate.made.${id}`) ?? '';
      await this.show(assembly, enter);
      return true;
    } catch {
      return false;
    }
  }
  private progress(title: string, text: string, part: number|null): void {
    element('empty').hidden = false;
    element('empty').dataset['state'] = 'busy';
    element('empty-drop').hidden = true;
    write(element('empty-title'), title);
    write(element('empty-text'), text);
    const bar = element<HTMLProgressElement>('empty-progress');
    bar.hidden = false;
    if (part === null)
      bar.removeAttribute('value');
    else
      bar.value = part;
    if (!element('empty-list').querySelector('.cancel')) {
      const button = make('button', {class: 'cancel'}, 'Cancel');
      button.addEventListener('click', () => {
        this.cancel?.abort();
        this.back();
      });
      element('empty-list').replaceChildren(button);
    }
  }
  private refused(title: string, text: string): void {
    element('empty').dataset['state'] = 'bad';
    write(element('empty-title'), `${title} can't be read`);
    write(element('empty-text'), text);
    element('empty-progress').hidden = true;
    const button = make('button', {class: 'main'}, 'Back');
    button.addEventListener('click', () => this.back());
    element('empty-list').replaceChildren(button);
  }
  private back(): void {
    if (this.building || this.picture.scene)
      element('empty').hidden = true;
    else
      this.hooks.entered(false);  // the first page again
  }
  private box_of_file(assembly: Assembly, file: number) {
    return joined(assembly.parts.filter((part) => part.file === file).map((part) => part.box));
  }
  private scale(file: number): number {
    return this.assembly?.files[file].states_unit ? 1 : UNITS[this.draft.units[file] ?? 'm'];
  }

  private async show(assembly: Assembly, enter = true): Promise<void> {
    this.assembly = assembly;
    this.geometry = await this.api.assembly_geometry(
        assembly.id, this.picture.view.software ? MOST_DRAWN_BY_PROCESSOR : MOST_DRAWN);
    this.roots = part_tree(assembly);
    this.selected = this.hovered = '';
    this.history = new History(JSON.stringify(this.draft));
    element<HTMLInputElement>('save-name').value =
        (assembly.files.find((file) => file.mesh)?.name ?? 'assembly').replace(/\.[^.]*$/, '');
    if (enter) this.enter(true);
    this.load();
    this.draw();  // what was just loaded is drawn by nobody else
    if (enter) this.focus_all();
  }
  /** To the parts, or away from them to a scene. */
  enter(on: boolean): void {
    this.building = on && this.assembly !== null;
    this.parts.object.visible = this.building;
    this.picture.set_visible(!this.building);
    document.body.classList.toggle('building', this.building);
    element('workshop').hidden = !this.building;
    element('scene-panel').hidden = this.building;
    if (this.building) element('panel').scrollTop = 0;
    this.offer_settings(this.building);
    this.picture.view.name(
        this.building ? 'The parts' : 'The scene',
        this.building ? 'assembly-words part-name tool-name' : 'facts contact touching clearance-words');
    element('back-to-parts').hidden = this.assembly === null;
    element('save-box').hidden = this.assembly === null;
    if (this.building) {
      document.body.classList.remove('no-scene');
      element('empty').hidden = true;
      this.draw();
    } else
      this.gizmo.hide();
    this.hooks.entered(this.building);
    this.picture.view.request();
  }
  /** Whether the numbers of the contact can be changed: of the scene to be, or of one that was made here. */
  offer_settings(on: boolean): void {
    element('contact-settings').hidden = !on;
    element('feel-row').hidden = !this.building;
    element('settings-note').hidden = this.building;
  }
  private focus_all(): void {
    this.picture.view.set_bounds(this.parts.box(this.assembly!.parts.map((_, i) => i)));
    this.picture.view.look_at_all(true);
  }
  box(): three.Box3 {
    return this.parts.box(this.assembly?.parts.map((_, i) => i) ?? []);
  }
  meet(ray: three.Ray): three.Vector3|null {
    return this.parts.pick(ray)?.point ?? null;
  }
  look_at_all(): void {
    this.picture.view.look_at_all();
  }
  look_at_selected(): void {
    const node = find_node(this.roots, this.selected) ?? this.tool;
    const box = node ? this.parts.box(node.parts) : null;
    if (box && !box.isEmpty()) {
      const sphere = box.getBoundingSphere(new three.Sphere());
      this.picture.view.look_at(sphere.center, sphere.radius * 1.6);
    }
  }

  // ---- what is decided

  private change(change: Partial<Draft>, redo_geometry = false): void {
    if (change.tool !== undefined || change.place !== undefined)
      this.path = [];  // it was another tool's, or began elsewhere
    this.draft = {...this.draft, ...change};
    this.history.take(JSON.stringify(this.draft));
    this.keep();
    if (redo_geometry) {
      this.load();
      this.focus_all();
    }
    this.draw();
  }
  private keep(): void {
    if (this.assembly)
      sessionStorage.setItem(`palpate.draft.${this.assembly.id}`, JSON.stringify(this.draft));
  }
  undo(): void {
    if (this.history.can_undo) this.go_to(this.history.undo());
  }
  redo(): void {
    if (this.history.can_redo) this.go_to(this.history.redo());
  }
  private go_to(state: string): void {
    const units = JSON.stringify(this.draft.units);
    this.draft = JSON.parse(state) as Draft;
    this.keep();
    if (JSON.stringify(this.draft.units) !== units) {
      this.load();
      this.focus_all();
    }
    this.draw();
  }
  private select(key: string): void {
    this.selected = this.selected === key ? '' : key;
    this.draw();
  }
  private hover(key: string): void {
    if (this.hovered !== key) {
      this.hovered = key;
      this.colour();
    }
  }
  private toggle(key: string): void {
    this.change({
      hidden: this.draft.hidden.includes(key) ? this.draft.hidden.filter((other) => other !== key) :
                                                [...this.draft.hidden, key]
    });
  }
  private move(place: Pose): void {
    this.parts.tool_matrix.compose(
        new three.Vector3(place[0], place[1], place[2]),
        new three.Quaternion(place[3], place[4], place[5], place[6]), new three.Vector3(1, 1, 1));
    this.picture.view.request();
  }
  /** The paths, in their files, of what is not drawn. */
  get hidden_paths(): string[] {
    return this.draft.hidden.flatMap((key) => {
      const node = find_node(this.roots, key);
      return node && node.path !== '' ? [node.path] : [];
    });
  }
  set_ignore_initial(on: boolean): void {
    this.change({ignore_initial: on});
  }
  order(): Order {
    const {assembly, tool} = this;
    if (!assembly || !tool) throw new Error('First take a part out: that is the tool.');
    return scene_of(assembly, this.draft, tool, this.path);
  }
  async feel(stay = false): Promise<void> {
    try {
      const order = this.order();
      const {id} = this.assembly!;
      const {engine} = this.draft.settings;
      await this.hooks.open(async () => {
        const scene = await this.api.make_scene(id, {...order, name: this.name, ...(engine ? {engine} : {})});
        sessionStorage.setItem(`palpate.made.${id}`, this.made = scene.id);
        return scene;
      }, this.name, stay);
    } catch (error) {
      this.hooks.failed(error);
    }
  }

  // ---- how it looks

  private load(): void {
    if (!this.geometry || !this.assembly) return;
    this.parts.load(this.geometry, this.assembly.parts, (file) => this.scale(file));
    const box = this.parts.box(this.assembly.parts.map((_, i) => i));
    const size = box.getSize(new three.Vector3());
    const total = this.assembly.parts.reduce((sum, part) => sum + part.triangles, 0);
    write(
        element('assembly-words'),
        `${this.assembly.parts.length.toLocaleString('en')} parts, ${total.toLocaleString('en')} triangles, ${
            sides_words(size.toArray())}${
            this.geometry.reduced ?
                `; ${this.parts.drawn_triangles.toLocaleString('en')} triangles are drawn` :
                ''}`);
  }
  theme(dark: boolean): void {
    this.dark = dark;
    this.colour();
  }
  private hidden(i: number): boolean {
    return this.draft.hidden.some((key) => find_node(this.roots, key)?.parts.includes(i));
  }
  private colour_of(i: number): three.Color {
    return new three.Color(this.assembly!.parts[i].colour ?? (this.dark ? DARK : LIGHT).mockup);
  }
  private colour(): void {
    if (!this.assembly) return;
    const selected = new Set(find_node(this.roots, this.selected)?.parts ?? []);
    const hovered = new Set(find_node(this.roots, this.hovered)?.parts ?? []);
    const tool = new Set(this.tool?.parts ?? []);
    const hidden = new Set(this.draft.hidden.flatMap((key) => find_node(this.roots, key)?.parts ?? []));
    const accent = new three.Color(this.dark ? 0x58b5dc : 0x0b8ec6);
    this.parts.show(this.assembly.parts.map((_, i) => {
      const colour = this.colour_of(i);
      if (tool.has(i)) colour.copy(new three.Color(0xe69f00));
      if (selected.has(i))
        colour.lerp(accent, 0.85);
      else if (hovered.has(i))
        colour.lerp(accent, 0.45);
      return {colour, hidden: hidden.has(i), with_tool: tool.has(i)};
    }));
    this.picture.view.request();
  }
  private size(node: PartNode): string {
    return node.box ? size_words(node.box, this.scale(node.file)) : '';
  }
  private look(node: PartNode): RowLook {
    return {
      colour: node.children.length === 0 && node.parts.length === 1 ?
          `#${this.colour_of(node.parts[0]).getHexString()}` :
          '',
      selected: node.key === this.selected,
      tool: node.key === this.draft.tool,
      hidden: node.parts.length > 0 && node.parts.every((i) => this.hidden(i)),
      size: this.size(node),
    };
  }
  private draw(): void {
    const {assembly, tool} = this;
    if (!assembly) return;
    this.list.show(this.roots, (node) => this.look(node));
    this.move(this.draft.place);
    this.colour();
    this.show_files();
    const node = find_node(this.roots, this.selected);
    element('part-card').hidden = node === null;
    if (node) {
      write(element('part-name'), node.name);
      write(
          element('part-words'),
          `${this.size(node)}, ${node.triangles.toLocaleString('en')} triangles${
              node.parts.length > 1 ? ` in ${node.parts.length} parts` : ''}`);
      element<HTMLButtonElement>('take-out').disabled = node.key === this.draft.tool;
      write(element('hide-part'), this.draft.hidden.includes(node.key) ? 'Show' : 'Hide');
    }
    element('tool-card').hidden = tool === null;
    write(element('tool-name'), tool?.name ?? '');
    element<HTMLButtonElement>('feel').disabled = tool === null;
    if (tool && this.building)
      this.gizmo.show(this.draft.place, this.parts.box(tool.parts, false).getCenter(new three.Vector3()));
    else
      this.gizmo.hide();
    element<HTMLButtonElement>('undo').disabled = !this.history.can_undo;
    element<HTMLButtonElement>('redo').disabled = !this.history.can_redo;
    this.settings.show(this.draft.settings);
  }
  private show_files(): void {
    const {assembly} = this;
    element('assembly-files').replaceChildren(...assembly!.files.map((file, i) => {
      if (!file.mesh) return make('p', {class: 'soft'}, `${file.name}: read by the others`);
      if (file.error) return make('p', {class: 'warn'}, `${file.name}: ${file.error}`);
      const box = this.box_of_file(assembly!, i);
      const words = box ? size_words(box, this.scale(i)) : '';
      const row = make(
          'div', {class: 'file'}, make('strong', {}, file.name),
          make(
              'span', {class: 'soft'},
              file.states_unit ? `${words}, as the file states` : `is ${words} long, if its unit is`));
      if (!file.states_unit) {
        const select = make(
            'select', {'aria-label': `Unit of ${file.name}`},
            ...Object.keys(UNITS).map((unit) => make('option', {value: unit}, unit)));
        select.value = this.draft.units[i] ?? 'm';
        select.addEventListener(
            'change', () => this.change({units: {...this.draft.units, [i]: select.value as Unit}}, true));
        row.append(select);
      }
      return row;
    }));
  }

  // ---- buttons, pointer

  private wire(): void {
    const click = (id: string, act: () => void) => element(id).addEventListener('click', act);
    click('take-out', () => {
      const tool = this.selected;
      this.selected = '';
      this.change({tool, place: AT_HOME, ignore_initial: false});
    });
    click('hide-part', () => this.toggle(this.selected));
    click('look-part', () => this.look_at_selected());
    click('put-back', () => this.change({tool: '', place: AT_HOME}));
    click('home-part', () => this.change({place: AT_HOME}));
    click('show-all', () => this.change({hidden: []}));
    click('undo', () => this.undo());
    click('redo', () => this.redo());
    click('feel', () => void this.feel());
    click('back-to-parts', () => {
      this.enter(true);
      this.focus_all();
    });
    click('save', () => void this.save());
    click('download', () => void this.download());
    for (const mode of ['move', 'turn'] as const)
      click(`gizmo-${mode}`, () => {
        this.gizmo.turning = mode === 'turn';
        for (const other of ['move', 'turn'])
          element(`gizmo-${other}`).setAttribute('aria-pressed', String(other === mode));
      });
    element<HTMLInputElement>('part-filter')
        .addEventListener('input', (event) => this.list.set_filter((event.target as HTMLInputElement).value));
    const {canvas} = this.picture.view;
    let pressed: {x: number; y: number}|null = null;
    let due = false;
    canvas.addEventListener('pointermove', (event) => {
      if (!this.building || event.buttons !== 0 || due) return;
      due = true;
      requestAnimationFrame(() => {
        due = false;
        if (this.building) this.hover(this.at(event));
      });
    });
    canvas.addEventListener('pointerleave', () => this.hover(''));
    canvas.addEventListener('pointerdown', (event) => {
      pressed = this.building && event.button === 0 && !this.gizmo.grips ?
          {x: event.clientX, y: event.clientY} :
          null;
    });
    canvas.addEventListener('pointerup', (event) => {
      if (!pressed || Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > 4)
        return;  // a turn of the camera
      const key = this.at(event);
      this.selected = key;
      this.draw();
      if (key) this.list.reveal(key);
    });
  }
  /** The node of the part under the pointer. */
  private at(event: PointerEvent): string {
    const box = this.picture.view.canvas.getBoundingClientRect();
    const caster = new three.Raycaster();
    caster.setFromCamera(
        new three.Vector2(
            ((event.clientX - box.left) / box.width) * 2 - 1,
            1 - ((event.clientY - box.top) / box.height) * 2),
        this.picture.view.camera);
    const part = this.parts.pick(caster.ray)?.part ?? -1;
    return part < 0 ? '' : `${this.assembly!.parts[part].file}:${this.assembly!.parts[part].path}`;
  }

  // ---- keeping

  private async save(): Promise<void> {
    try {
      const saved = await this.api.save_scene(
          this.assembly!.id, {...this.order(), folder: element<HTMLInputElement>('save-name').value.trim()});
      this.hooks.say(`Saved as ${saved.path}, ${(saved.bytes / 1e6).toFixed(1)} MB.`);
      document.dispatchEvent(new CustomEvent('palpate-saved', {detail: saved.path}));
    } catch (error) {
      this.hooks.failed(error);
    }
  }
  private async download(): Promise<void> {
    try {
      const order = this.order();
      const files = [
        {name: 'scene.json', bytes: new TextEncoder().encode(JSON.stringify(order.scene, null, 2))},
        ...(order.path ? [{name: 'path.csv', bytes: new TextEncoder().encode(order.path)}] : [])
      ];
      for (const {name, blob} of this.files)
        files.push({name, bytes: new Uint8Array(await blob.arrayBuffer())});
      save_as(zip(files), `${element<HTMLInputElement>('save-name').value.trim() || 'scene'}.zip`);
      if (this.files.length === 0)
        this.hooks.say(
            'The page was loaded anew since the upload: the meshes are not in this download. Save keeps them.',
            true);
    } catch (error) {
      this.hooks.failed(error);
    }
  }
}

/** Hands a file to the browser's downloads. */
export function save_as(blob: Blob, name: string): void {
  const link = make('a', {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
