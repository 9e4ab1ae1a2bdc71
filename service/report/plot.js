'use strict';
// Charts of lines as SVG: sharp in print, their colours are the page's variables, so light, dark and paper
// need no second drawing. Plot.draw(figure, spec, group): `group` (Plot.group()) shares a cursor and a zoomed
// range among charts with the same x axis.
const Plot = (() => {
  const safe = (text) =>
      String(text).replace(/[&<>"]/g, (c) => ({'&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;'})[c]);
  const number = (value, digits = 3) => Math.abs(value) >= 1e6 || (value !== 0 && Math.abs(value) < 1e-4) ?
      Number(value).toExponential(Math.max(0, digits - 2)).replace('e+', 'e') :
      Math.abs(value) >= 10000 ? Math.round(value).toLocaleString('en') :
                                 String(Number(Number(value).toPrecision(digits)));

  // ---- axes
  // ---------------------------------------------------------------------------------------------------------
  // `knee`: up to it a symmetric logarithm is nearly linear.
  const transforms = {
    linear: () => (v) => v,
    log: () => (v) => Math.log10(v),
    symlog: (knee) => (v) => Math.asinh(v / knee),
  };
  const linearTicks = (low, high, wanted, whole) => {
    const raw = (high - low) / wanted, size = 10 ** Math.floor(Math.log10(raw));
    let step = size * (raw / size > 5 ? 10 : raw / size > 2 ? 5 : raw / size > 1 ? 2 : 1);
    if (whole) step = Math.max(1, Math.round(step));
    const out = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; ++k) out.push(k * step);
    return out;
  };
  const logTicks = (low, high, most = 7) => {
    const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9),
          step = Math.max(1, Math.ceil((last - first) / most));
    const out = [];
    for (let k = first; k <= last; k += step) out.push(10 ** k);
    return out.length > 1 ? out : [low, high];
  };
  const ticksOf = (kind, low, high, knee, wanted, whole) => {
    if (kind === 'linear') return linearTicks(low, high, wanted, whole);
    if (kind === 'log') return logTicks(low, high);
    const size = Math.max(Math.abs(low), Math.abs(high)), first = Math.floor(Math.log10(knee)),
          last = Math.floor(Math.log10(size));
    const step = Math.max(1, Math.ceil((last - first) / 3)), out = [0];
    for (let k = last; k >= first; k -= step) out.push(10 ** k, -(10 ** k));
    return out.filter((v) => v >= low && v <= high);
  };
  const quantile = (values, part) => {
    const sorted = Float64Array.from(values).sort();
    return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))] : 0;
  };
  // Whether a few values are so far out that a linear axis shows nothing but them. `usual`: the part of the
  // values that must be seen.
  const hidden = (values, usual) => {
    const sizes = values.map(Math.abs).filter((v) => v > 0);
    return sizes.length > 20 && Math.max(...sizes) > 15 * quantile(sizes, usual);
  };

  // ---- groups
  // -------------------------------------------------------------------------------------------------------
  const group = () => ({charts: [], range: null, cursor: null});
  const everyone = [];
  // Paper has a width of its own: what was drawn for a wide window would come out too small to read.
  let paper = false;
  const onPaper = (is) => {
    paper = is;
    for (const chart of everyone) chart.render();
  };
  addEventListener('beforeprint', () => onPaper(true));
  addEventListener('afterprint', () => onPaper(false));

  class Chart {
    constructor(figure, spec, shared) {
      Object.assign(this, {figure, spec, shared, off: new Set(), kind: 'linear'});
      this.series = spec.series.filter((s) => s.points && s.points.length);
      const values = this.series.flatMap((s) => s.points.map((p) => p[1]).filter((v) => v !== null));
      this.signed = values.some((v) => v < 0);
      this.other = this.signed ? 'symlog' : 'log';
      this.knee = Math.max(quantile(values.map(Math.abs).filter((v) => v > 0), 0.5), 1e-12);
      if (spec.kind)
        this.kind = spec.kind;
      else if (hidden(values, spec.usual ?? 0.95))
        this.kind = this.other;
      figure.classList.add('plot');
      figure.innerHTML = `<figcaption>${safe(spec.title)} <span>${safe(spec.unit ?? '')}</span></figcaption>
        <div class="legend">${
          this.series
              .map(
                  (s, i) => `<button type="button" aria-pressed="true" data-series="${
                      i}"><i style="background:var(--${s.colour})${s.dash ? ';opacity:.6' : ''}"></i>${
                      safe(s.label)}<output></output></button>`)
              .join('')}</div>
        <div class="tools">${
          this.shared ? '<button type="button" data-do="whole" hidden>whole</button>' : ''}${
          spec.fixed ?
              '' :
              '<button type="button" data-do="kind"></button>'}<button type="button" data-do="csv">CSV</button><button type="button" data-do="svg">SVG</button></div>
        <div class="canvas" tabindex="0"></div>${spec.note ? `<p class="note">${safe(spec.note)}</p>` : ''}`;
      this.canvas = figure.querySelector('.canvas');
      figure.querySelector('.legend').addEventListener('click', (event) => {
        const button = event.target.closest('button');
        if (!button) return;
        const i = Number(button.dataset.series);
        if (!this.off.delete(i)) this.off.add(i);
        button.setAttribute('aria-pressed', String(!this.off.has(i)));
        this.render();
      });
      figure.querySelector('.tools').addEventListener('click', (event) => {
        const what = event.target.dataset.do;
        if (what === 'kind') {
          this.kind = this.kind === 'linear' ? this.other : 'linear';
          this.render();
        }
        if (what === 'whole') this.zoom(null);
        if (what === 'csv') save(`${slug(spec.title)}.csv`, this.csv(), 'text/csv');
        if (what === 'svg') save(`${slug(spec.title)}.svg`, this.svg(), 'image/svg+xml');
      });
      this.listen();
      everyone.push(this);
      if (shared) shared.charts.push(this);
      new ResizeObserver(() => {
        if (!paper && Math.abs(this.canvas.clientWidth - this.width) > 1) this.render();
      }).observe(this.canvas);
      this.render();
    }

    whole() {
      if (this.spec.range) return this.spec.range;
      let low = Infinity, high = -Infinity;
      for (const s of this.series)
        for (const p of s.points) {
          low = Math.min(low, p[0]);
          high = Math.max(high, p[0]);
        }
      return low < high ? [low, high] : [low - 1, low + 1];
    }

    zoom(range) {
      this.shared.range = range;
      for (const chart of this.shared.charts) chart.render();
    }

    // Of stacked series, each stands on those below it, at the x of the first.
    shapes() {
      const shown = this.series.map((s, i) => ({...s, i})).filter((s) => !this.off.has(s.i));
      if (!this.spec.stacked || this.kind !== 'linear') return shown;
      const stack = shown.filter((s) => s.stack);
      if (!stack.length) return shown;
      const longest = stack.reduce((a, b) => (b.points.length > a.points.length ? b : a)).points;
      const base = longest.map(() => 0);
      return shown.map((s) => {
        if (!s.stack) return s;
        const low = [...base];
        let k = 0;
        const points = longest.map(([x, y], i) => {
          while (k + 1 < s.points.length && s.points[k + 1][0] <= x) ++k;
          base[i] += s.points[k][0] <= x ? s.points[k][1] ?? 0 : 0;
          return [x, y === null ? null : base[i]];
        });
        return {...s, points, below: longest.map(([x], i) => [x, low[i]])};
      });
    }

    render() {
      const {spec} = this;
      this.width =
          paper ? (this.figure.closest('.pair') ? 310 : 660) : Math.max(240, this.canvas.clientWidth || 640);
      const height = (spec.height ?? 220) * (paper ? 0.75 : 1), left = 58, right = 10, top = 8, bottom = 24;
      const shapes = this.shapes();
      const [x0, x1] = (this.shared && this.shared.range) || this.whole();
      const xf = transforms[spec.xLog ? 'log' : 'linear']();
      // The part in view, and the next point on either side.
      for (const s of shapes) {
        let a = s.points.findIndex((p) => p[0] >= x0), b = s.points.length;
        if (a < 0) a = s.points.length;
        while (b > 0 && s.points[b - 1][0] > x1) --b;
        s.from = Math.max(0, a - 1);
        s.to = Math.min(s.points.length, b + 1);
      }
      let low = Infinity, high = -Infinity;
      for (const s of shapes)
        for (let i = s.from; i < s.to; ++i) {
          const y = s.points[i][1];
          if (y === null || (this.kind === 'log' && !(y > 0))) continue;
          low = Math.min(low, y);
          high = Math.max(high, y);
        }
      if (!(low <= high)) {
        low = this.kind === 'log' ? 0.1 : 0;
        high = 1;
      }
      if (this.kind === 'log') {
        low = spec.floor ?? 10 ** Math.floor(Math.log10(low) + 1e-9);
        high = 10 ** Math.ceil(Math.log10(high * 1.05));
        if (low >= high) high = low * 10;
      } else {
        if (spec.zero !== false) {
          low = Math.min(low, 0);
          high = Math.max(high, 0);
        }
        const room = (high - low || Math.abs(high) || 1) * 0.1;
        high += high > 0 || low === high ? room : 0;
        low -= low < 0 ? room : 0;
        if (this.kind === 'symlog') {
          high *= 1.4;
          low *= 1.4;
        }
      }
      const yf = transforms[this.kind](this.knee);
      const at = (v) => {
        const part = (xf(v) - xf(x0)) / (xf(x1) - xf(x0));
        return left + (spec.xReverse ? 1 - part : part) * (this.width - left - right);
      };
      const up = (v) => height - bottom -
          ((yf(this.kind === 'log' ? Math.max(v, low) : v) - yf(low)) / (yf(high) - yf(low))) *
              (height - bottom - top);
      Object.assign(
          this,
          {at, plotArea: {left, right: this.width - right, top, bottom: height - bottom}, view: [x0, x1]});

      const out = [];
      const floor = height - bottom;
      for (const band of spec.bands ?? []) {
        if (band.stage <= 0 || band.end < x0 || band.begin > x1) continue;
        const ends = [at(Math.max(band.begin, x0)), at(Math.min(band.end, x1))].sort((p, q) => p - q),
              room = ends[1] - ends[0];
        if (band.stage % 2 === 0)
          out.push(`<rect x="${ends[0].toFixed(1)}" y="${top}" width="${room.toFixed(1)}" height="${
              floor - top}" fill="var(--band)"/>`);
        out.push(`<path d="M${ends[0].toFixed(1)} ${top}V${floor}" stroke="var(--band-edge)"/>`);
        let text = spec.bandNames ? band.name : String(band.stage);
        const fits = Math.floor((room - 6) / 5.8);
        if (text.length > fits) text = fits > 3 ? text.slice(0, fits - 1) + '…' : String(band.stage);
        if (text.length <= fits)
          out.push(`<text x="${(ends[0] + 4).toFixed(1)}" y="${top + 11}" fill="var(--soft)">${
              safe(text)}</text>`);
      }
      const marked = [];
      for (const v of ticksOf(this.kind, low, high, this.knee, 5, spec.integers)) {
        if (marked.some((y) => Math.abs(y - up(v)) < 12)) continue;  // its number would lie on another's
        marked.push(up(v));
        out.push(
            `<path d="M${left} ${up(v).toFixed(1)}H${this.width - right}" stroke="var(--grid)"/><text x="${
                left -
                6}" y="${(up(v) + 4).toFixed(1)}" text-anchor="end" fill="var(--soft)">${number(v)}</text>`);
      }
      const xTicks = spec.xLog ?
          logTicks(x0, x1, Math.max(2, Math.floor(this.width / 80))) :
          linearTicks(x0, x1, Math.max(3, Math.floor(this.width / 95)), spec.xIntegers);
      const digits =
          Math.max(3, Math.ceil(Math.log10(Math.max(Math.abs(x0), Math.abs(x1)) / (x1 - x0) + 1)) + 3);
      xTicks.forEach((v) => {
        const px = at(v), anchor = px > this.width - right - 24 ? 'end' : 'middle';
        out.push(`<path d="M${px.toFixed(1)} ${floor}v4" stroke="var(--soft)"/><text x="${
            px.toFixed(1)}" y="${floor + 17}" text-anchor="${anchor}" fill="var(--soft)">${
            number(v, digits)}${spec.xUnit ? ' ' + safe(spec.xUnit) : ''}</text>`);
      });
      out.push(`<path d="M${left} ${floor}H${this.width - right}" stroke="var(--rule)"/>`);
      const box = [
        left, top - 2, this.width - left - right, floor - top + 4
      ];  // a picture in the picture cuts off what lies beyond
      out.push(`<svg x="${box[0]}" y="${box[1]}" width="${box[2]}" height="${box[3]}" viewBox="${
          box.join(' ')}" fill="none" stroke-linejoin="round">`);
      // The stretches without a null.
      const pieces = (points, from, to) => {
        const found = [];
        for (let i = from; i < to; ++i)
          if (points[i][1] !== null) {
            if (found.length && found[found.length - 1][1] === i)
              found[found.length - 1][1] = i + 1;
            else
              found.push([i, i + 1]);
          }
        return found;
      };
      const line = (points, from, to, stepped) => {
        let d = '', pen = false, last = 0;
        for (let i = from; i < to; ++i) {
          const [x, y] = points[i];
          if (y === null || (this.kind === 'log' && !(y > 0))) {
            pen = false;
            continue;
          }
          const px = at(x).toFixed(1), py = up(y).toFixed(1);
          d += pen && stepped ? `H${px}V${py}` : `${pen ? 'L' : 'M'}${px} ${py}`;
          pen = true;
          last = px;
        }
        return d || `M${last} 0`;
      };
      // What goes behind first.
      for (const s of [...shapes].sort((p, q) => (q.order ?? 0) - (p.order ?? 0))) {
        const ink = `var(--${s.colour})`, path = line(s.points, s.from, s.to, s.stepped);
        if (s.below) {
          for (const [from, to] of pieces(s.points, s.from, s.to)) {
            const back = s.below.slice(from, to)
                             .reverse()
                             .map(([x, y]) => `L${at(x).toFixed(1)} ${up(y).toFixed(1)}`)
                             .join('');
            out.push(`<path d="${line(s.points, from, to, s.stepped)}${back}Z" fill="${
                ink}" fill-opacity="0.4"/>`);
          }
        } else if (s.fill && s.to > s.from) {
          out.push(`<path d="${path}V${floor}H${at(s.points[s.from][0]).toFixed(1)}Z" fill="${
              ink}" fill-opacity="0.3"/>`);
        }
        out.push(`<path d="${path}" stroke="${ink}" stroke-width="${s.width ?? 1.5}"${
            s.dash ? ' stroke-dasharray="6 4"' : ''}/>`);
      }
      out.push(
          '</svg><path class="cursor" d="" stroke="var(--soft)" stroke-dasharray="3 3" fill="none"/><rect class="chosen" y="' +
          top + '" height="' + (floor - top) + '" width="0" fill="var(--band-edge)"/>');
      this.canvas.innerHTML = `<svg viewBox="0 0 ${this.width} ${height}" role="img" aria-label="${
          safe(this.describe())}" font-size="11" font-family="system-ui, sans-serif">${out.join('')}</svg>`;
      const kind = this.figure.querySelector('[data-do=kind]');
      if (kind) {
        this.figure.querySelector('figcaption span').textContent =
            [spec.unit, this.kind === 'linear' ? '' : 'logarithmic axis'].filter(Boolean).join(', ');
        kind.textContent = this.kind === 'linear' ? 'log' : 'linear';
        kind.title =
            'The values’ axis: ' + (this.kind === 'linear' ? 'make it logarithmic' : 'logarithmic now');
      }
      this.figure.classList.toggle('logged', this.kind !== 'linear');
      const whole = this.figure.querySelector('[data-do=whole]');
      if (whole) whole.hidden = !this.shared.range;
      this.point(this.shared ? this.shared.cursor : null);
    }

    // In words, for who does not see it.
    describe() {
      const {spec} = this;
      const parts = this.series.map((s) => {
        let low = null, high = null;
        for (const p of s.points)
          if (p[1] !== null) {
            if (!low || p[1] < low[1]) low = p;
            if (!high || p[1] > high[1]) high = p;
          }
        return low ? `${s.label}: from ${number(low[1])} at ${number(low[0], 5)} to ${number(high[1])} at ${
                         number(high[0], 5)}` :
                     `${s.label}: nothing`;
      });
      const [x0, x1] = this.whole();
      return `${spec.title}${spec.unit ? ', ' + spec.unit : ''}, over ${spec.xName ?? 'time'} from ${
                 number(x0, 5)} to ${number(x1, 5)}${spec.xUnit ? ' ' + spec.xUnit : ''}` +
          `${this.kind === 'linear' ? '' : ', logarithmic axis'}. ${parts.join('; ')}.`;
    }

    valueAt(s, x) {
      let low = 0, high = s.points.length - 1;
      if (x < s.points[0][0] - 1e-9) return null;
      while (low < high) {
        const mid = (low + high + 1) >> 1;
        if (s.points[mid][0] <= x)
          low = mid;
        else
          high = mid - 1;
      }
      return s.points[low][1];
    }

    point(x) {
      const line = this.canvas.querySelector('.cursor');
      if (!line) return;
      const visible = x !== null && x >= this.view[0] && x <= this.view[1];
      line.setAttribute(
          'd', visible ? `M${this.at(x).toFixed(1)} ${this.plotArea.top}V${this.plotArea.bottom}` : '');
      this.figure.querySelectorAll('.legend output').forEach((output, i) => {
        const value = visible ? this.valueAt(this.series[i], x) : null;
        output.textContent = value === null ? '' : number(value, 4);
      });
      this.figure.dataset.at =
          visible ? `${number(x, 6)}${this.spec.xUnit ? ' ' + this.spec.xUnit : ''}` : '';
    }

    listen() {
      const {canvas} = this;
      const xOf = (event) => {
        const box = canvas.getBoundingClientRect(), {left, right} = this.plotArea;
        let part = Math.min(
            1, Math.max(0, ((event.clientX - box.left) * (this.width / box.width) - left) / (right - left)));
        if (this.spec.xReverse) part = 1 - part;
        const [a, b] = this.view;
        return this.spec.xLog ? a * (b / a) ** part : a + part * (b - a);
      };
      const cursor = (x) => {
        if (!this.shared) {
          this.point(x);
          return;
        }
        this.shared.cursor = x;
        for (const chart of this.shared.charts) chart.point(x);
      };
      let from = null;
      canvas.addEventListener('pointermove', (event) => {
        const x = xOf(event);
        cursor(x);
        if (from === null) return;
        const ends = [this.at(from), this.at(x)].sort((a, b) => a - b),
              rect = canvas.querySelector('.chosen');
        rect.setAttribute('x', ends[0]);
        rect.setAttribute('width', ends[1] - ends[0]);
      });
      canvas.addEventListener('pointerleave', () => cursor(null));
      canvas.addEventListener('pointerdown', (event) => {
        if (!this.shared || event.button !== 0 || event.pointerType === 'touch') return;
        from = xOf(event);
        canvas.setPointerCapture(event.pointerId);
      });
      canvas.addEventListener('pointerup', (event) => {
        if (from === null) return;
        const ends = [from, xOf(event)].sort((a, b) => a - b);
        from = null;
        if (Math.abs(this.at(ends[1]) - this.at(ends[0])) > 6)
          this.zoom(ends);
        else
          canvas.querySelector('.chosen').setAttribute('width', 0);
      });
      canvas.addEventListener('dblclick', () => this.shared && this.zoom(null));
      canvas.addEventListener('keydown', (event) => {
        const [a, b] = this.view, middle = (a + b) / 2, half = (b - a) / 2, [w0, w1] = this.whole();
        const to = {
          '+': [middle - half / 2, middle + half / 2],
          '-': [middle - half * 2, middle + half * 2],
          ArrowLeft: [a - half / 2, b - half / 2],
          ArrowRight: [a + half / 2, b + half / 2]
        }[event.key];
        if (!this.shared || (!to && event.key !== 'Escape')) return;
        event.preventDefault();
        if (!to || to[1] - to[0] >= w1 - w0) {
          this.zoom(null);
          return;
        }
        const shift = Math.max(0, w0 - to[0]) + Math.min(0, w1 - to[1]);
        this.zoom([to[0] + shift, to[1] + shift]);
      });
    }

    csv() {
      const cell = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
      const rows = [
        `series,${cell(this.spec.xName ?? 'time') + (this.spec.xUnit ? '_' + this.spec.xUnit : '')},value`
      ];
      for (const s of this.series)
        for (const [x, y] of s.points) rows.push(`${cell(s.label)},${x},${y ?? ''}`);
      return rows.join('\n') + '\n';
    }

    // By itself: with its title and legend, in the colours of light paper.
    svg() {
      const copy = this.canvas.querySelector('svg').cloneNode(true), root = document.documentElement;
      copy.querySelectorAll('.cursor, .chosen').forEach((element) => element.remove());
      root.dataset.light = '';
      const style = getComputedStyle(root);
      let legend = '', at = 58;
      this.series.forEach((s, i) => {
        if (this.off.has(i)) return;
        legend += `<rect x="${at}" y="-15" width="12" height="3" fill="var(--${s.colour})"/><text x="${
            at + 16}" y="-10" fill="var(--ink)">${safe(s.label)}</text>`;
        at += 30 + 6.2 * s.label.length;
      });
      let text = new XMLSerializer()
                     .serializeToString(copy)
                     .replace(
                         /viewBox="0 0 ([\d.]+) ([\d.]+)"/,
                         (_, w, h) =>
                             `viewBox="0 -44 ${w} ${Number(h) + 48}" width="${w}" height="${Number(h) + 48}"`)
                     .replace(
                         /<\/svg>$/,
                         `<text x="8" y="-28" font-size="14" fill="var(--ink)">${safe(this.spec.title)}${
                             this.spec.unit ? ', ' + safe(this.spec.unit) : ''}</text>${legend}</svg>`);
      text = text.replace(/var\(--([a-z0-9-]+)\)/g, (_, name) => style.getPropertyValue('--' + name).trim());
      delete root.dataset.light;
      return text;
    }
  }

  const slug = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, '_').replace(/^_|_$/g, '');
  const save = (name, text, type) => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], {type}));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  // Steps between values that are counted: [[low, high, count], …] as a line; on a logarithmic axis what has
  // none lies on the axis, which begins at half a count.
  const kNone = 0.5;
  const outline = (bins) => {
    const out = bins.length ? [[bins[0][0], kNone]] : [];
    bins.forEach(([low, high, n], i) => {
      if (i > 0 && bins[i - 1][1] < low) out.push([low, kNone]);
      out.push([low, Math.max(n, kNone)], [high, Math.max(n, kNone)]);
      if (i + 1 === bins.length || bins[i + 1][0] > high) out.push([high, kNone]);
    });
    return out;
  };
  return {group, kNone, outline, number, draw: (figure, spec, shared) => new Chart(figure, spec, shared)};
})();
