// What the page and the mouse's worker say to each other.
import type {Moment} from '../moment.js';
import type {Frame, Pose, Scene} from '../server/protocol.js';

/** The hand, as the page knows it at a picture. */
export interface HandTold {
  held: boolean;
  target: Pose;
  paused: boolean
}

export type ToWorker =
    /** First of all. `url`, `protocols`: of the remote loop. */
    |{
  type: 'begin';
  scene: Scene;
  at: Pose|null;
  url: string;
  protocols: string[]
}
/** An answer to `prepare`: the server holds the scene, or refuses. */
|{
  type: 'prepared';
  ready: boolean
}
/** A picture is due. `lists`: in which the triangles of each area matter. */
|{
  type: 'picture';
  hand: HandTold;
  lists: boolean
}
/** The tool goes to `at`, or to the scene's start. What comes back from then on has this `turn`. */
|{
  type: 'restart';
  at: Pose|null;
  turn: number
}
/** The server was found again. */
|{type: 'hurry'}|{type: 'close'};

export type ToPage =
    /** The server is to hold the scene, ready. */
    |{type: 'prepare'} /**
                          `frame`: where it is another than before. `asked_at`: when what the tool feels was
                          asked for, ms since 1970; NaN: nothing was.
                        */
|{
  type: 'moment';
  turn: number;
  moment: Omit<Moment, 'frame'>;
  frame?: Frame|null;
  asked_at: number
}
|{
  type: 'lost';
  reason: string
};
