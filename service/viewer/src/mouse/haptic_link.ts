// The connection to the server's remote loop, kept for as long as it is wanted. It is in one state at a time:
//   off → preparing (the server makes the scene ready) → connecting (until its hello) → open,   and from each
//   of the three, when it fails, → waiting → preparing …
// A change of state begins a new turn. What an older turn's promise, socket or timer still says is not heard,
// so there is never a second connection beside the wanted one.
import type {Bye, Fault, HapticHello, Wrench} from '../server/protocol.js';

export type LinkState = 'off'|'preparing'|'connecting'|'open'|'waiting';

const RETRY_MS = 1500;  // chosen
const HELLO_MS =
    20_000;  // a server that is busy preparing another scene answers late; one that is gone never does

export interface LinkEvents {
  hello: (hello: HapticHello) => void;
  wrench: (wrench: Wrench) => void;
  /** It ended, or could not begin; it begins again by itself. `reason`: what the server said, or ''. */
  lost: (reason: string) => void;
}

export class HapticLink {
  private now: LinkState = 'off';
  private turn = 0;
  private socket: WebSocket|null = null;
  private timer: ReturnType<typeof setTimeout>|undefined;

  /**
   * `ready`: resolves when the server holds the scene, ready; who refuses has said why. `connect`: begins a
   * connection.
   */
  constructor(
      private readonly ready: () => Promise<void>, private readonly connect: () => WebSocket,
      private readonly events: LinkEvents) {}

  get state(): LinkState {
    return this.now;
  }

  open(): void {
    if (this.now === 'off') void this.prepare();
  }
  /** The server was found again: don't wait any longer. */
  hurry(): void {
    if (this.now === 'waiting') void this.prepare();
  }
  close(): void {
    this.enter('off');
  }
  send(text: string): void {
    if (this.now === 'open') this.socket?.send(text);
  }

  private async prepare(): Promise<void> {
    const turn = this.enter('preparing');
    const ready = await this.ready().then(() => true, () => false);
    if (turn !== this.turn) return;
    if (ready)
      this.begin();
    else
      this.fail('');
  }
  private begin(): void {
    let turn = this.enter('connecting');
    let reason = '';
    const socket = (this.socket = this.connect());
    this.timer = setTimeout(() => {
      if (turn === this.turn) this.fail('');
    }, HELLO_MS);
    socket.onmessage = (event: MessageEvent<string>) => {
      if (turn !== this.turn) return;
      const message = JSON.parse(event.data) as HapticHello | Wrench | Bye | Fault;
      if (message.type === 'hello') {
        turn = this.enter('open', socket);
        this.events.hello(message);
      } else if (message.type === 'wrench')
        this.events.wrench(message);
      else
        reason = message.type === 'error' ? message.problem.detail || message.problem.title : message.reason;
    };
    socket.onclose = () => {
      if (turn === this.turn) this.fail(reason);
    };
  }
  private fail(reason: string): void {
    const turn = this.enter('waiting');
    this.timer = setTimeout(() => {
      if (turn === this.turn) void this.prepare();
    }, RETRY_MS);
    this.events.lost(reason);
  }

  /**
   * Leaves the turn before with all it had begun: its timer, and its socket unless that is `kept`. One that
   * is still being opened is closed once it is, for a browser calls anything else an error.
   */
  private enter(state: LinkState, kept: WebSocket|null = null): number {
    this.now = state;
    clearTimeout(this.timer);
    const {socket} = this;
    this.socket = kept;
    if (socket && socket !== kept) {
      if (socket.readyState === socket.CONNECTING)
        socket.onopen = () => socket.close();
      else
        socket.close();
    }
    return ++this.turn;
  }
}
