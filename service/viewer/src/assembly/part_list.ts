// The tree of parts as a list that one walks with the arrow keys: names, sizes, colours, shown or not.
import {make} from '../dom.js';
import type {PartNode} from './part_nodes.js';

const MOST_SHOWN = 400;  // rows below one node; more are found by the filter

export interface PartListEvents {
  select: (node: PartNode) => void;
  hover: (node: PartNode|null) => void;
  toggle: (node: PartNode) => void;
}
export interface RowLook {
  colour: string;
  hidden: boolean;
  selected: boolean;
  tool: boolean;
  size: string
}

export class PartList {
  private roots: PartNode[] = [];
  private readonly open = new Set<string>();
  private filter = '';
  private look: (node: PartNode) => RowLook = () =>
      ({colour: '', hidden: false, selected: false, tool: false, size: ''});

  constructor(private readonly host: HTMLElement, private readonly events: PartListEvents) {
    host.setAttribute('role', 'tree');
    host.addEventListener('keydown', (event) => this.key(event));
    host.addEventListener('pointerleave', () => this.events.hover(null));
  }

  show(roots: PartNode[], look: (node: PartNode) => RowLook): void {
    this.roots = roots;
    this.look = look;
    for (const root of roots) this.open.add(root.key);
    // A chain of only children is opened to where there is a choice.
    for (let nodes = roots; nodes.length === 1; nodes = nodes[0].children) this.open.add(nodes[0].key);
    this.draw();
  }
  set_filter(text: string): void {
    this.filter = text.trim().toLowerCase();
    this.draw();
  }
  /** Opens what a node lies in, and scrolls to it. */
  reveal(key: string): void {
    const file = key.slice(0, key.indexOf(':') + 1);
    const path = key.slice(file.length).split('/');
    this.open.add(file);
    for (let i = 1; i < path.length; ++i) this.open.add(file + path.slice(0, i).join('/'));
    this.draw();
    this.row(key)?.scrollIntoView({block: 'nearest'});
  }

  /** Rows are made anew only when which there are has changed; else their state alone. */
  draw(): void {
    const focused =
        (document.activeElement as HTMLElement | null)?.closest<HTMLElement>('[data-node]')?.dataset['node'];
    this.host.replaceChildren(...this.rows(this.roots, 0));
    const rows = [...this.host.querySelectorAll<HTMLElement>('[data-node]')];
    const stop = rows.find((row) => row.dataset['node'] === focused) ??
        rows.find((row) => row.getAttribute('aria-selected') === 'true') ?? rows[0];
    if (stop) stop.tabIndex = 0;
    if (focused && stop?.dataset['node'] === focused) stop.focus({preventScroll: true});
  }
  private matches(node: PartNode): boolean {
    return node.path.toLowerCase().includes(this.filter) || node.name.toLowerCase().includes(this.filter) ||
        node.children.some((child) => this.matches(child));
  }
  private rows(nodes: readonly PartNode[], depth: number): HTMLElement[] {
    const wanted = this.filter ? nodes.filter((node) => this.matches(node)) : nodes;
    const out: HTMLElement[] = [];
    for (const node of wanted.slice(0, MOST_SHOWN)) {
      const expanded = node.children.length > 0 && (this.filter !== '' || this.open.has(node.key));
      out.push(this.make_row(node, depth, expanded));
      if (expanded) out.push(...this.rows(node.children, depth + 1));
    }
    if (wanted.length > MOST_SHOWN)
      out.push(make('p', {class: 'soft'}, `and ${wanted.length - MOST_SHOWN} more: find them by name`));
    return out;
  }
  private make_row(node: PartNode, depth: number, expanded: boolean): HTMLElement {
    const look = this.look(node);
    const twist = make(
        'span', {class: 'twist', 'aria-hidden': 'true'},
        node.children.length === 0 ? '' :
            expanded               ? '▾' :
                                     '▸');
    const swatch = make('i', {class: 'swatch', 'aria-hidden': 'true'});
    if (look.colour)
      swatch.style.background = look.colour;
    else
      swatch.hidden = true;
    const eye = make(
        'span', {class: 'eye', 'aria-hidden': 'true', title: look.hidden ? 'Show (h)' : 'Hide (h)'},
        look.hidden ? '○' : '●');
    const row = make(
        'div', {
          role: 'treeitem',
          'data-node': node.key,
          tabindex: '-1',
          'aria-level': String(depth + 1),
          'aria-selected': String(look.selected),
          'aria-label':
              `${node.name}${look.tool ? ', the tool' : ''}${look.hidden ? ', hidden' : ''}, ${look.size}`,
          ...(node.children.length > 0 ? {'aria-expanded': String(expanded)} : {}),
        },
        twist, swatch, make('span', {class: 'name', title: node.path || node.name}, node.name),
        ...(look.tool ? [make('em', {}, 'tool')] : []), make('span', {class: 'size'}, look.size), eye);
    row.style.paddingLeft = `${4 + 14 * depth}px`;
    row.classList.toggle('hidden-part', look.hidden);
    row.addEventListener('click', (event) => {
      if (event.target === eye)
        this.events.toggle(node);
      else if (event.target === twist)
        this.twist(node);
      else
        this.events.select(node);
    });
    row.addEventListener('dblclick', () => this.twist(node));
    row.addEventListener('pointerenter', () => this.events.hover(node));
    return row;
  }
  private twist(node: PartNode): void {
    if (this.open.has(node.key))
      this.open.delete(node.key);
    else
      this.open.add(node.key);
    this.draw();
  }
  private row(key: string): HTMLElement|null {
    return [...this.host.querySelectorAll<HTMLElement>('[data-node]')].find(
               (row) => row.dataset['node'] === key) ??
        null;
  }
  private node(key: string, among = this.roots): PartNode|null {
    for (const node of among) {
      if (node.key === key) return node;
      const below = this.node(key, node.children);
      if (below) return below;
    }
    return null;
  }

  private key(event: KeyboardEvent): void {
    const row = (event.target as HTMLElement).closest<HTMLElement>('[data-node]');
    const node = row && this.node(row.dataset['node']!);
    if (!row || !node) return;
    const rows = [...this.host.querySelectorAll<HTMLElement>('[data-node]')];
    const go = (to: HTMLElement|undefined) => {
      if (to) {
        row.tabIndex = -1;
        to.tabIndex = 0;
        to.focus();
        this.events.hover(this.node(to.dataset['node']!));
      }
    };
    const at = rows.indexOf(row);
    switch (event.key) {
      case 'ArrowDown':
        go(rows[at + 1]);
        break;
      case 'ArrowUp':
        go(rows[at - 1]);
        break;
      case 'Home':
        go(rows[0]);
        break;
      case 'End':
        go(rows.at(-1));
        break;
      case 'ArrowRight':
        if (node.children.length > 0 && !this.open.has(node.key))
          this.twist(node);
        else
          go(rows[at + 1]);
        break;
      case 'ArrowLeft':
        if (node.children.length > 0 && this.open.has(node.key))
          this.twist(node);
        else
          go(rows.slice(0, at).reverse().find((other) => Number(other.ariaLevel) < Number(row.ariaLevel)));
        break;
      case 'Enter':
      case ' ':
        this.events.select(node);
        break;
      case 'h':
        this.events.toggle(node);
        break;
      default:
        return;
    }
    event.preventDefault();
    event.stopPropagation();
  }
}
