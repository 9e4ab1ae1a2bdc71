// Strips over time: force, torque, depth, time a frame, lateness. Live they show the last seconds; of a
// recorded run the whole, and a press there seeks. Curves are drawn when they change, so a recorded run's
// once; what moves while it plays is a mark over them.
import {write} from './dom.js';
import {Samples, round_up, type Column} from './samples.js';

const LIVE_SECONDS = 10;

interface Line {
  column: Column;
  label: string;
  colour: string
}
interface Definition {
  title: string;
  unit: string;
  lines: Line[];
  signed: boolean;
  least: number
}
const xyz = (letter: 'f'|'t'): Line[] =>
    (['x', 'y', 'z'] as const)
        .map((axis) => ({column: `${letter}${axis}` as Column, label: axis, colour: `--${axis}`}));
const STRIPS: Definition[] = [
  {title: 'Force', unit: 'N', lines: xyz('f'), signed: true, least: 0.5},
  {title: 'Torque', unit: 'N·m', lines: xyz('t'), signed: true, least: 0.02},
  {
    title: 'Depth',
    unit: 'mm',
    lines: [{column: 'depth', label: '', colour: '--depth'}],
    signed: false,
    least: 0.2
  },
  {
    title: 'Time a frame',
    unit: 'ms',
    lines: [{column: 'frame', label: '', colour: '--time'}],
    signed: false,
    least: 1
  },
  {
    title: 'Lateness',
    unit: 'µs',
    lines: [{column: 'late', label: '', colour: '--late'}],
    signed: false,
    least: 1
  },
];

const FORMATS = [0, 1, 2, 3].map(
    (digits) => new Intl.NumberFormat(
        'en', {maximumFractionDigits: digits}));  // to make one takes longer than to use it

export const figure = (value: number): string => {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size < 5e-4) return '0';
  return FORMATS[size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3].format(value).replace('-', '−');
};

export class Strips {
  samples = new Samples();
  /** Of a recorded run: its length, and where it is; null when live. */
  recorded: {duration: number; time: number}|null = null;
  seek: (time: number) => void = () => {};
  private readonly canvases: HTMLCanvasElement[] = [];
  private readonly marks: HTMLElement[] = [];
  private readonly drawn: unknown[][] = STRIPS.map(() => []);  // what each canvas shows
  private look = 0;                                            // grows with colours and titles
  private readonly values: HTMLElement[] = [];
  private readonly titles: HTMLElement[] = [];
  private colours: Record<string, string> = {};

  constructor(host: HTMLElement) {
    for (const definition of STRIPS) {
      const strip = document.createElement('figure');
      const caption = document.createElement('figcaption');
      const title = document.createElement('span');
      title.className = 'strip-title';
      const value = document.createElement('output');
      const plot = document.createElement('div');
      plot.className = 'strip-plot';
      const canvas = document.createElement('canvas');
      canvas.setAttribute('role', 'img');
      const mark = document.createElement('i');
      caption.append(title, value);
      plot.append(canvas, mark);
      strip.append(caption, plot);
      host.append(strip);
      this.titles.push(title);
      this.values.push(value);
      this.canvases.push(canvas);
      this.marks.push(mark);
      canvas.addEventListener('pointerdown', (event) => {
        if (!this.recorded) return;
        canvas.setPointerCapture(event.pointerId);
        this.press(canvas, event);
      });
      canvas.addEventListener('pointermove', (event) => {
        if (this.recorded && canvas.hasPointerCapture(event.pointerId)) this.press(canvas, event);
      });
      this.name(this.titles.length - 1, definition);
    }
    this.theme();
  }
  private press(canvas: HTMLCanvasElement, event: PointerEvent): void {
    const box = canvas.getBoundingClientRect();
    this.seek(Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)) * this.recorded!.duration);
  }
  private name(index: number, definition: Definition): void {
    this.canvases[index].setAttribute('aria-label', `${definition.title} over time, ${definition.unit}`);
    this.titles[index].replaceChildren(
        definition.title, ...definition.lines.filter((line) => line.label).map((line) => {
          const key = document.createElement('i');
          key.className = `key-${line.label}`;
          key.textContent = line.label;
          return key;
        }));
  }
  /** What the last strip is about: lateness of a loop, age of a result, way to the server and back. */
  set_late(title: string, unit: string): void {
    STRIPS[4] = {...STRIPS[4], title, unit};
    ++this.look;
    this.name(4, STRIPS[4]);
  }
  theme(): void {
    const style = getComputedStyle(document.documentElement);
    ++this.look;
    for (const name of ['--x', '--y', '--z', '--depth', '--time', '--late', '--grid', '--soft', '--card'])
      this.colours[name] = style.getPropertyValue(name).trim();
  }

  draw(): void {
    const {samples} = this;
    const end = this.recorded ? this.recorded.duration :
        samples.count > 0     ? samples.times[samples.count - 1] :
                                0;
    const begin = this.recorded ? 0 : end - LIVE_SECONDS;
    const now = this.recorded ?
        Math.max(0, Math.min(samples.count - 1, samples.first_at(this.recorded.time))) :
        samples.count - 1;
    const ratio = window.devicePixelRatio || 1;
    const sizes = this.canvases.map(
        (canvas) =>
            [Math.round(canvas.clientWidth * ratio),
             Math.round(canvas.clientHeight * ratio)]);  // all before anything is written: one layout
    STRIPS.forEach((strip, i) => {
      const shown = [samples, samples.count, begin, end, ...sizes[i], this.look];
      if (shown.some((value, k) => value !== this.drawn[i][k])) {
        this.drawn[i] = shown;
        this.draw_one(strip, this.canvases[i], sizes[i][0], sizes[i][1], begin, end);
      }
      this.marks[i].hidden = !this.recorded;
      if (this.recorded) this.marks[i].style.left = `${(100 * this.recorded.time) / Math.max(end, 1e-9)}%`;
      const at = (column: Column) => (now >= 0 && samples.count > 0 ? samples.column(column)[now] : NaN);
      const value = strip.lines.length === 3 ?
          Math.hypot(at(strip.lines[0].column), at(strip.lines[1].column), at(strip.lines[2].column)) :
          at(strip.lines[0].column);
      write(this.values[i], `${figure(value)} ${strip.unit}`);
    });
  }

  private draw_one(
      strip: Definition, canvas: HTMLCanvasElement, width: number, height: number, begin: number,
      end: number): void {
    const ratio = window.devicePixelRatio || 1;
    if (width === 0 || height === 0) return;
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    // Small canvases with fine lines: the processor draws them sooner than a GPU is told to, and far sooner
    // than one that is a program.
    const pen = canvas.getContext('2d', {willReadFrequently: true})!;
    pen.clearRect(0, 0, width, height);

    // The range: what is seen, rounded up, so that it moves seldom.
    const {samples} = this;
    const first = Math.max(0, samples.first_at(begin) - 1);
    let most = 0;
    for (const line of strip.lines) {
      const column = samples.column(line.column);
      for (let i = first; i < samples.count; ++i)
        if (Math.abs(column[i]) > most) most = Math.abs(column[i]);
    }
    const range =
        round_up(Math.max(most * 1.04, strip.least));  // a line along the very edge would be hard to see
    const bottom = height - 4 * ratio;
    const top = 4 * ratio;
    const y = (value: number) =>
        (strip.signed ? (top + bottom) / 2 - (value / range) * ((bottom - top) / 2) :
                        bottom - (value / range) * (bottom - top));

    pen.strokeStyle = this.colours['--grid'];
    pen.lineWidth = ratio;
    pen.beginPath();
    for (const value of strip.signed ? [range, 0, -range] : [range, range / 2, 0]) {
      pen.moveTo(0, Math.round(y(value)) + 0.5);
      pen.lineTo(width, Math.round(y(value)) + 0.5);
    }
    pen.stroke();

    const x = (time: number) => ((time - begin) / Math.max(end - begin, 1e-9)) * width;
    for (const line of strip.lines)
      this.trace(pen, samples.column(line.column), first, x, y, this.colours[line.colour], ratio);

    pen.font = `${10.5 * ratio}px system-ui, sans-serif`;
    pen.textBaseline = 'middle';
    const label = (text: string, left: number, middle: number) => {
      pen.fillStyle = this.colours['--card'];
      pen.globalAlpha = 0.8;
      pen.fillRect(left - 3 * ratio, middle - 7 * ratio, pen.measureText(text).width + 6 * ratio, 14 * ratio);
      pen.globalAlpha = 1;
      pen.fillStyle = this.colours['--soft'];
      pen.fillText(text, left, middle);
    };
    label(`${strip.signed ? '±' : ''}${figure(range)} ${strip.unit}`, 4 * ratio, top + 8 * ratio);
    const span = this.recorded ? `${figure(end)} s` : `last ${LIVE_SECONDS} s`;
    label(span, width - pen.measureText(span).width - 4 * ratio, bottom - 8 * ratio);
  }

  /**
   * One line; where many samples share a column of pixels, their extremes are drawn, so that no peak is
   * lost.
   */
  private trace(
      pen: CanvasRenderingContext2D, values: Float32Array, first: number, x: (time: number) => number,
      y: (value: number) => number, colour: string, ratio: number): void {
    pen.strokeStyle = colour;
    pen.lineWidth = 1.4 * ratio;
    pen.lineJoin = 'round';
    pen.beginPath();
    let open = false;
    for (let i = first; i < this.samples.count;) {
      if (!Number.isFinite(values[i])) {
        open = false;
        ++i;
        continue;
      }
      const column = Math.floor(x(this.samples.times[i]));
      let low = values[i];
      let high = values[i];
      let last = values[i];
      const start = values[i];
      let next = i + 1;
      for (; next < this.samples.count && Math.floor(x(this.samples.times[next])) === column &&
           Number.isFinite(values[next]);
           ++next) {
        last = values[next];
        if (last < low) low = last;
        if (last > high) high = last;
      }
      const points = next === i + 1 ? [start] : [start, low, high, last];
      for (const value of points) {
        if (open)
          pen.lineTo(column + 0.5, y(value));
        else
          pen.moveTo(column + 0.5, y(value));
        open = true;
      }
      i = next;
    }
    pen.stroke();
  }
}
