// What keys, and the buttons that do the same, do.
import {element} from './dom.js';
import type {Action} from './keys.js';
import type {Source} from './moment.js';
import type {Sessions} from './sessions.js';
import type {Theme} from './theme.js';
import type {Workshop} from './assembly/workshop.js';
import type {Picture} from './draw/picture.js';
import type {PathPanel} from './mouse/path_panel.js';
import type {Player} from './run/player.js';
import type {Banner} from './words/banner.js';

const TURN = 0.1;  // rad of a key that turns the view; chosen
const STEPS: Partial<Record<Action, [number, number, number]>> = {
  'turn-left': [-TURN, 0, 0],
  'turn-right': [TURN, 0, 0],
  'turn-up': [0, TURN, 0],
  'turn-down': [0, -TURN, 0],
  'nearer': [0, 0, 0.1],
  'farther': [0, 0, -0.1]
};

/** What actions act on: the page. */
export interface Acted {
  readonly source: Source;
  readonly picture: Picture;
  readonly workshop: Workshop;
  readonly player: Player;
  readonly sessions: Sessions;
  readonly paths: PathPanel;
  readonly banner: Banner;
  readonly theme: Theme;
  /** The mouse stops moving the tool, or goes on. */
  pause_mouse(): void;
  /** Another instant of a recorded run is to be shown. */
  run_changed(): void;
  /** Something is to be shown anew. */
  touch(): void;
}

export function act(action: Action, on: Acted): void {
  const {picture, workshop, player, source} = on;
  const {playback} = player;
  switch (action) {
    case 'play':
      if (source === 'run')
        player.toggle();
      else if (source === 'live')
        on.sessions.toggle();
      else
        on.pause_mouse();
      break;
    case 'back':
    case 'forward':
      if (source === 'run' && playback) {
        playback.playing = false;
        playback.step(action === 'back' ? -1 : 1);
        on.run_changed();
      }
      break;
    case 'record':
      if (source === 'mouse' && !workshop.building) on.paths.toggle();
      break;
    case 'begin':
      playback?.seek(0);
      on.run_changed();
      break;
    case 'end':
      playback?.seek(playback.duration);
      on.run_changed();
      break;
    case 'theme':
      on.theme.toggle();
      break;
    case 'all':
      if (workshop.building)
        workshop.look_at_all();
      else
        picture.look_at_all();
      break;
    case 'undo':
      if (workshop.building) workshop.undo();
      break;
    case 'redo':
      if (workshop.building) workshop.redo();
      break;
    case 'tool':
      if (workshop.building)
        workshop.look_at_selected();
      else
        picture.follow_tool();
      break;
    case 'panel':
      document.body.classList.toggle('no-panel');
      on.touch();
      break;
    case 'help':
      element<HTMLDialogElement>('help').showModal();
      break;
    case 'glass':
      element('glass-mockup').click();
      break;
    case 'clearance':
      element('show-clearance').click();
      break;
    case 'voxels': {
      const voxels = element<HTMLSelectElement>('voxels');
      voxels.selectedIndex = (voxels.selectedIndex + 1) % voxels.options.length;
      voxels.dispatchEvent(new Event('change'));
      break;
    }
    case 'close':
      on.banner.hide();
      break;
    case 'up':
      picture.view.turn_up();
      break;
    default:
      if (action in STEPS)
        picture.view.step(...STEPS[action]!);
      else
        document.querySelectorAll<HTMLButtonElement>('#legend button')[Number(action.slice(4)) - 1]?.click();
  }
}
