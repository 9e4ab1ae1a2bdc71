// The keyboard. Each key is listed in the help (index.html).
export type Action = 'play'|'back'|'forward'|'begin'|'end'|'theme'|'all'|'tool'|'up'|'panel'|'help'|'voxels'|
    'glass'|'close'|'undo'|'redo'|'record'|'clearance'|'turn-left'|'turn-right'|'turn-up'|'turn-down'|
    'nearer'|'farther'|'kind1'|'kind2'|'kind3'|'kind4'|'kind5'|'kind6';

const KEYS: Record<string, Action> = {
  ' ': 'play',
  ArrowLeft: 'back',
  ArrowRight: 'forward',
  Home: 'begin',
  End: 'end',
  t: 'theme',
  a: 'all',
  f: 'tool',
  u: 'up',
  p: 'panel',
  '?': 'help',
  h: 'help',
  v: 'voxels',
  g: 'glass',
  r: 'record',
  c: 'clearance',
  j: 'turn-left',
  l: 'turn-right',
  i: 'turn-up',
  k: 'turn-down',
  '+': 'nearer',
  '-': 'farther',
  Escape: 'close',
  '1': 'kind1',
  '2': 'kind2',
  '3': 'kind3',
  '4': 'kind4',
  '5': 'kind5',
  '6': 'kind6',
};

const FIELDS = 'input:not([type=range], [type=checkbox]), select, textarea';  // they take letters themselves
const STEPS: Record<string, [number, number, number]> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1]
};

/** `step`: a key that moves the tool (right, up, away; turning); false where no tool is moved by hand. */
export function listen(
    act: (action: Action) => void,
    step: (right: number, up: number, away: number, turning: boolean) => boolean): void {
  window.addEventListener('keydown', (event) => {
    const field = (event.target as HTMLElement).matches(FIELDS);
    if ((event.ctrlKey || event.metaKey) && !event.altKey && !field &&
        (event.key === 'z' || event.key === 'y')) {
      event.preventDefault();
      act(event.key === 'z' ? 'undo' : 'redo');
      return;
    }
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (document.querySelector('dialog[open]')) return;  // it has its own, Escape above all
    const target = event.target as HTMLElement;
    const way = STEPS[event.key];
    if (way && !target.matches('input, select, textarea, [role=treeitem]') && step(...way, event.shiftKey)) {
      event.preventDefault();
      return;
    }
    const action = KEYS[event.key];
    if (!action) return;
    // Fields and buttons keep the keys that work them.
    if (target.matches(FIELDS) && action !== 'close') return;
    if (target.matches('button, summary, [type=checkbox]') && event.key === ' ') return;
    event.preventDefault();
    act(action);
  });
}
