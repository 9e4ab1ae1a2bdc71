'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const { summary, settings, curves } = data;
  const byId = (id) => document.getElementById(id);
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
  const number = (value, digits = 3) =>
    Math.abs(value) >= 10000 ? Math.round(value).toLocaleString('en') : String(Number(Number(value).toPrecision(digits)));
  const count = (value) => Number(value).toLocaleString('en');

  // ---- words and tables -------------------------------------------------------------------------------------------
  document.title = 'palpate · ' + data.name;
  byId('title').textContent = data.name;
  byId('subtitle').textContent = data.subtitle;

  if (summary.real_time) {
    const line = byId('real-time');
    line.hidden = false;
    line.className = summary.real_time.kept_up ? '' : 'notes';
    line.textContent = 'In real time ' + summary.real_time.sentence + '.';
  }

  const tile = (value, label) => {
    const box = document.createElement('div');
    box.className = 'tile';
    const strong = document.createElement('b');
    strong.textContent = value;
    const span = document.createElement('span');
    span.textContent = label;
    box.append(strong, span);
    byId('tiles').append(box);
  };
  tile(count(summary.static_triangles), 'triangles in the mock-up');
  tile(count(summary.tool_triangles), 'triangles in the tool');
  tile(number(summary.frame_us.p50 / 1000) + ' ms', 'a frame, median (p99 ' + number(summary.frame_us.p99 / 1000) + ' ms)');
  tile(summary.areas_max, 'contact areas at once');
  tile(number(summary.force_max_N) + ' N', 'largest force sent');
  tile(number(summary.torque_max_Nm) + ' N·m', 'largest torque sent');
  if (data.notes.length) {
    byId('notes').hidden = false;
    for (const note of data.notes) byId('notes').appendChild(document.createElement('p')).textContent = note + (/[.!?]$/.test(note) ? '' : '.');
  }

  const row = (table, cells, tag = 'td') => {
    const tr = table.insertRow();
    for (const cell of cells) {
      const td = document.createElement(tag);
      td.textContent = cell;
      tr.append(td);
    }
  };
  const stageTable = byId('stage-table');
  row(stageTable, ['stage', 's', 'force N', 'torque N·m', 'areas', 'contact triangles', 'frame ms, mean', 'at most'], 'th');
  for (const s of data.stage_figures)
    row(stageTable, [s.name, number(s.seconds, 4), number(s.force_max), number(s.torque_max), s.areas_max, count(s.triangles_max),
                     number(s.frame_us_mean / 1000), number(s.frame_us_max / 1000)]);
  for (const [name, value] of data.summary_rows) row(byId('summary-table'), [name, value]);
  for (const [name, value] of settings) row(byId('settings-table'), [name, value]);

  // ---- charts -----------------------------------------------------------------------------------------------------
  const charts = [];
  const lines = (specs) => specs.filter((s) => s.points && s.points.length).map((s) => ({
    label: s.label, data: s.points.map(([x, y]) => ({ x, y })), colourName: s.colour, fillName: s.fill ? s.colour : null,
    borderWidth: s.width ?? 1.5, stepped: s.stepped ?? false, fill: s.fill ?? false, pointRadius: 0, pointHitRadius: 6,
    borderJoinRound: true, order: s.order ?? 0, stack: s.stack,
  }));

  // Shades every second stage and names it where the chart is tall enough.
  const stageBands = {
    id: 'stageBands',
    beforeDatasetsDraw(chart, _args, options) {
      if (!options.stages) return;
      const { ctx, chartArea: area, scales: { x } } = chart;
      ctx.save();
      ctx.font = '11px system-ui, sans-serif';
      ctx.textBaseline = 'top';
      data.stages.forEach((s) => {
        if (s.stage <= 0) return;
        const left = Math.max(x.getPixelForValue(s.begin), area.left);
        const right = Math.min(x.getPixelForValue(s.end), area.right);
        if (s.stage % 2 === 0) {
          ctx.fillStyle = colour('band');
          ctx.fillRect(left, area.top, right - left, area.bottom - area.top);
        }
        ctx.fillStyle = colour('band-edge');
        ctx.fillRect(left, area.top, 1, area.bottom - area.top);
        ctx.fillStyle = colour('soft');
        let text = options.names ? s.name : String(s.stage);
        const room = right - left - 8;
        while (text.length > 1 && ctx.measureText(text).width > room) text = text.slice(0, -2) + '…';
        if (text.length > 1 || ctx.measureText(text).width <= room) ctx.fillText(text, left + 4, area.top + 3);
      });
      ctx.restore();
    },
  };

  const begin = data.stages.length ? data.stages[0].begin : 0;
  const end = data.stages.length ? data.stages[data.stages.length - 1].end : 1;
  const draw = (id, datasets, { range = [begin, end], stages = true, names = false, integers = false, stacked = false, headroom = 0, zero = true } = {}) => {
    const chart = new Chart(byId(id), {
      type: 'line',
      data: { datasets },
      plugins: [stageBands],
      options: {
        animation: false, parsing: false, normalized: true, responsive: true, maintainAspectRatio: false,
        interaction: { mode: 'nearest', axis: 'x', intersect: false },
        plugins: {
          stageBands: { stages, names },
          legend: { align: 'end', labels: { boxWidth: 14, boxHeight: 2, font: { size: 12 }, padding: 10 } },
          tooltip: { callbacks: {
            title: (items) => items.length ? number(items[0].parsed.x, 6) + ' s' : '',
            label: (item) => ' ' + item.dataset.label + '  ' + number(item.parsed.y, 4),
          } },
        },
        scales: {
          x: { type: 'linear', min: range[0], max: range[1], ticks: { maxRotation: 0, includeBounds: false, callback: (v) => number(v, 6) + ' s' } },
          y: { stacked, grace: headroom, beginAtZero: zero, ticks: { maxTicksLimit: 6, precision: integers ? 0 : undefined },
               afterFit: (scale) => { scale.width = 58; } },   // one width, so that the time axes line up
        },
      },
    });
    charts.push(chart);
  };

  const axes = (kind) => ['x', 'y', 'z'].map((a) => ({ label: a, colour: a, points: curves[kind + '_' + a] }));
  draw('torque', lines(axes('response_torque')), { names: true, headroom: '12%' });
  draw('force', lines(axes('response_force')), { headroom: '12%' });
  draw('triangles', lines(['cst', 'bst', 'est', 'cmt', 'bmt', 'imt'].map((k) => ({ label: k.toUpperCase(), colour: k, points: curves[k], width: 1.3 }))),
       { integers: true, headroom: '12%' });
  draw('areas', lines([{ label: 'areas', colour: 'accent', points: curves.areas, stepped: true, width: 1.3 }]), { integers: true, headroom: '12%' });
  const milliseconds = (points) => (points || []).map(([x, y]) => [x, y / 1000]);
  // The stages that take most of the time, in the order of a frame; the others together.
  const mean = (points) => points.reduce((sum, p) => sum + p[1], 0) / Math.max(1, points.length);
  const entries = Object.entries(data.stage_us).map(([name, points]) => ({ name: name.replaceAll('_', ' '), points, mean: mean(points) }));
  const ranked = [...entries].sort((a, b) => b.mean - a.mean);
  const shown = entries.filter((entry) => ranked.indexOf(entry) < 5);
  const others = ranked.slice(5);
  if (others.length)
    shown.push({ name: 'others', points: others[0].points.map(([x], i) => [x, others.reduce((sum, entry) => sum + (entry.points[i]?.[1] ?? 0), 0)]) });
  draw('time', lines([
    { label: 'frame', colour: 'soft', points: milliseconds(curves.frame_us), width: 0.8, order: 2, stack: 'frame' },
    ...shown.map(({ name, points }, i) => ({ label: name, colour: name === 'others' ? 't9' : 't' + [0, 2, 5, 6, 8][i], points: milliseconds(points), width: 0.6,
                                             fill: i === 0 ? 'origin' : '-1', order: 1, stack: 'stages' })),
  ]), { headroom: '12%', stacked: shown.length > 0 });

  // ---- with and without the law: the component that moves most, of torque and of force ------------------------------
  const rows = data.highlight;   // time, force xyz and torque xyz without the law, the same with it
  if (!rows.length) {
    byId('control-lead').textContent = 'This run had no contact.';
    byId('control').querySelector('.pair').hidden = true;
  } else {
    byId('control-lead').textContent = 'The ' + rows.length + ' ticks around the strongest contact. Without: the newest collision response, held until the next one, '
      + 'as far as the device’s axes can exert it. With: what the control law sent to the device each millisecond. (The chapter’s figure 13.)';
    const range = (column) => rows.reduce((r, v) => [Math.min(r[0], v[column]), Math.max(r[1], v[column])], [Infinity, -Infinity]);
    const extent = (column) => { const [low, high] = range(column); return high - low; };
    const law = (id, kind, unit, without, sent) => {
      const best = [0, 1, 2].reduce((b, axis) => extent(without + axis) > extent(without + b) ? axis : b, 0);
      byId(id + '-caption').innerHTML = kind + ' ' + 'xyz'[best] + ' <span>' + unit + '</span>';
      draw(id, lines([
        { label: 'without', colour: 'without', points: rows.map((v) => [v[0], v[without + best]]), stepped: true, width: 1.2 },
        { label: 'with', colour: 'with', points: rows.map((v) => [v[0], v[sent + best]]), width: 2 },
      ]), { range: [rows[0][0], rows[rows.length - 1][0]], stages: false, zero: false, headroom: '8%' });
    };
    law('law-torque', 'Torque', 'N·m', 4, 10);
    law('law-force', 'Force', 'N', 1, 7);
  }

  // ---- punctuality: histograms, each bin as wide as it is on its axis -----------------------------------------------------
  const late = summary.lateness_histogram_us, ages = summary.result_age_histogram_ticks;
  byId('lateness-figure').hidden = !late.length;
  byId('punctual-lead').textContent = late.length
    ? count(summary.missed_ticks) + ' of ' + count(summary.ticks) + ' ticks were missed. Both axes of the lateness are logarithmic, for one tick in a hundred thousand matters.'
    : 'In virtual time no tick is late.';
  const histogram = (id, bins, log) => {
    if (!bins.length) return;
    const steps = [];
    bins.forEach(([low, high, n], i) => {   // a gap falls to the floor
      if (i > 0 && bins[i - 1][1] < low) steps.push([low, 0.5]);
      steps.push([low, n], [high, n]);
      if (i + 1 === bins.length || bins[i + 1][0] > high) steps.push([high, 0.5]);
    });
    const chart = new Chart(byId(id), {
      type: 'line',
      data: { datasets: lines([{ label: 'ticks', colour: 'accent', points: [[bins[0][0], 0.5], ...steps], width: 1.2, fill: 'start' }]) },
      options: {
        animation: false, parsing: false, normalized: true, responsive: true, maintainAspectRatio: false,
        layout: { padding: { top: 18 } },   // below the caption
        plugins: { legend: { display: false }, tooltip: { enabled: false } },
        scales: {
          x: { type: log ? 'logarithmic' : 'linear', ticks: { maxRotation: 0, callback: (v) => !log || /^1/.test(String(v).replace(/^0\.0*/, '')) ? number(v) : '' } },
          y: { type: 'logarithmic', min: 0.5, max: 10 ** Math.ceil(Math.log10(1.2 * Math.max(...bins.map((bin) => bin[2])))), ticks: { callback: (v) => /^10*$/.test(String(v)) ? count(v) : '' }, afterFit: (scale) => { scale.width = 58; } },
        },
      },
    });
    charts.push(chart);
  };
  histogram('lateness', late.map(([low, high, n]) => [Math.max(low, 0.05), high, n]), true);
  histogram('age', ages.map(([low, high, n]) => [low - 0.5, high - 0.5, n]), false);

  // ---- colours follow the reader's light or dark setting ------------------------------------------------------------
  const paint = () => {
    for (const chart of charts) {
      for (const set of chart.data.datasets) {
        set.borderColor = colour(set.colourName);
        set.backgroundColor = set.fillName ? colour(set.fillName) + '59' : colour(set.colourName);
      }
      const { scales, plugins } = chart.options;
      for (const scale of [scales.x, scales.y]) {
        scale.ticks.color = colour('soft');
        scale.grid.color = colour('grid');
        scale.grid.borderColor = colour('rule');
      }
      scales.x.grid.display = false;
      plugins.legend.labels.color = colour('ink');
      chart.update('none');
    }
  };
  paint();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', paint);
})();
