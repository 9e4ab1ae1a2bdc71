// The mouse's loop in a thread of its own: the page's waits for each of its pictures, and answers with it.
import type {ToPage, ToWorker} from './messages.js';
import {MouseLoop} from './mouse_loop.js';
import type {Frame} from '../server/protocol.js';

const page = self as unknown as {
  postMessage: (message: ToPage) => void;
  onmessage: (event: MessageEvent<ToWorker>) => void;
  close: () => void
};

let loop: MouseLoop|null = null;
let turn = 0;
let told: Frame|null|undefined;  // the frame that the page has; undefined: none yet
let said = '';                   // the rest that it has
let prepared: (ready: boolean) => void = () => {};

function tell(): void {
  if (!loop) return;
  const {frame, ...moment} = loop.moment();
  const text = `${moment.pose.join()} ${moment.force.join()} ${moment.torque.join()} ${moment.note}`;
  if (text === said && frame === told) return;  // at rest the page is not woken
  said = text;
  page.postMessage({
    type: 'moment',
    turn,
    moment,
    ...(frame === told ? {} : {frame}),
    asked_at: performance.timeOrigin + loop.answered
  });
  told = frame;
}

page.onmessage = ({data}) => {
  switch (data.type) {
    case 'begin':
      loop = new MouseLoop(
          data.scene, data.at, () => new Promise<void>((resolve, reject) => {
                                 prepared = (ready) => ready ? resolve() : reject(new Error('not ready'));
                                 page.postMessage({type: 'prepare'});
                               }),
          () => new WebSocket(data.url, data.protocols),
          {moved: tell, lost: (reason) => page.postMessage({type: 'lost', reason})});
      break;
    case 'prepared':
      prepared(data.ready);
      break;
    case 'picture':
      loop?.picture(data.hand, data.lists);
      break;
    case 'restart':
      turn = data.turn;
      said = '';
      loop?.restart(data.at);
      break;
    case 'hurry':
      loop?.link.hurry();
      break;
    case 'close':
      loop?.close();
      page.close();
      break;
  }
};
