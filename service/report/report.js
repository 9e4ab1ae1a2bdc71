'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const {summary, settings, curves} = data;
  const byId = (id) => document.getElementById(id);
  const {number} = Plot;
  const count = (value) => Number(value).toLocaleString('en');

  // ---- words and tables
  // -------------------------------------------------------------------------------------------
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
  tile(
      number(summary.frame_us.p50 / 1000) + ' ms',
      'a frame, median (p99 ' + number(summary.frame_us.p99 / 1000) + ' ms)');
  tile(summary.areas_max, 'contact areas at once, those without a force, too');
  tile(number(summary.force_max_N) + ' N', 'largest force sent');
  tile(number(summary.torque_max_Nm) + ' N·m', 'largest torque sent');
  if (data.notes.length) {
    byId('notes').hidden = false;
    for (const note of data.notes)
      byId('notes').appendChild(document.createElement('p')).textContent =
          note + (/[.!?]$/.test(note) ? '' : '.');
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
  row(stageTable,
      ['stage', 's', 'force N', 'torque N·m', 'areas', 'contact triangles', 'frame ms, mean', 'at most'],
      'th');
  for (const s of data.stage_figures)
    row(stageTable, [
      s.name, number(s.seconds, 4), number(s.force_max), number(s.torque_max), s.areas_max,
      count(s.triangles_max), number(s.frame_us_mean / 1000), number(s.frame_us_max / 1000)
    ]);
  for (const [name, value] of data.summary_rows) row(byId('summary-table'), [name, value]);
  for (const [name, value] of settings) row(byId('settings-table'), [name, value]);
  for (const [name, value] of data.provenance) row(byId('provenance-table'), [name, value]);

  // ---- the scene at its stages
  // ----------------------------------------------------------------------------------------
  for (const p of data.pictures.filter((p) => p.image)) {
    byId('places').hidden = false;
    const figure = byId('pictures').appendChild(document.createElement('figure')),
          caption = document.createElement('figcaption');
    caption.textContent = p.name;
    caption.appendChild(document.createElement('span')).textContent =
        ' at ' + number(p.at, 4) + ' s' + (p.force > 0 ? ', ' + number(p.force) + ' N' : ', free');
    const image = figure.appendChild(document.createElement('img'));
    image.src = p.image;
    image.alt = 'The tool and the mock-up around it, ' + caption.textContent;
    figure.append(caption);
  }

  // ---- charts over the run's time
  // -------------------------------------------------------------------------------------
  const begin = data.stages.length ? data.stages[0].begin : 0;
  const end = data.stages.length ? data.stages[data.stages.length - 1].end : 1;
  const run = Plot.group();
  const overTime = (id, spec) =>
      Plot.draw(byId(id), {range: [begin, end], xUnit: 's', bands: data.stages, ...spec}, run);
  const axes = (kind) => ['x', 'y', 'z'].map((a) => ({label: a, colour: a, points: curves[kind + '_' + a]}));
  const milliseconds = (points) => (points || []).map(([x, y]) => [x, y === null ? null : y / 1000]);

  // ---- the chapter's figures
  // --------------------------------------------------------------------------------------- Their panels one
  // below the other, as printed: a line a panel in figure 12, which runs from right to left.
  if (data.chapter) {
    const section = byId('chapter'), twelve = data.chapter === 'disassembly';
    section.hidden = false;
    section.querySelector('h2').textContent = twelve ? 'The chapter’s figure 12' : 'The chapter’s figure 10';
    section.querySelector('h2').id = 'chapter-head';
    section.querySelector('p').textContent = twelve ?
        'Extraction of a clamp from a pipe: torque about each axis, the force along the pipe, triangles in collision and the cost of a frame; from right to left, as the tool moves.' :
        'Multiple contacts and geometrical discontinuities: torque about each axis, contact triangles and the cost of a frame.';
    const panel = (title, unit, colour, points, more = {}) => {
      const figure = document.createElement('figure');
      byId('chapter-figure').append(figure);
      Plot.draw(
          figure, {
            title,
            unit,
            range: [begin, end],
            xUnit: 's',
            bands: data.stages,
            height: 120,
            xReverse: twelve,
            series: [{label: title, colour, points, width: 1.2}],
            ...more
          },
          run);
    };
    for (const a of ['x', 'y', 'z']) panel('T_r_' + a, 'N·m', a, curves['response_torque_' + a]);
    if (twelve) panel('F_r_x', 'N', 'x', curves.response_force_x);
    panel('Triangles in collision', 'of all kinds', 'cst', curves.triangles, {integers: true});
    panel('Computational cost', 'ms a frame', 'time', milliseconds(curves.frame_us), {usual: 0.5});
  }

  overTime(
      'torque',
      {title: 'Torque', unit: 'N·m', bandNames: true, height: 250, series: axes('response_torque')});
  overTime('force', {title: 'Force', unit: 'N', series: axes('response_force')});
  overTime('depth', {
    title: 'Depth',
    unit: 'mm, of the deepest contact area',
    height: 160,
    series: [{
      label: 'depth',
      colour: 'depth',
      points: (curves.depth || []).map(([x, y]) => [x, y === null ? null : y * 1000]),
      width: 1.3
    }]
  });
  overTime('triangles', {
    title: 'Contact triangles',
    unit: 'by kind',
    integers: true,
    series: ['cst', 'bst', 'est', 'cmt', 'bmt', 'imt'].map(
        (k) => ({label: k.toUpperCase(), colour: k, points: curves[k], width: 1.3}))
  });
  overTime('areas', {
    title: 'Contact areas',
    unit: 'with a force',
    integers: true,
    height: 130,
    series: [{label: 'areas', colour: 'accent', points: curves.areas, stepped: true, width: 1.3}]
  });

  // The stages that take most of the time, in the order of a frame; the others together.
  const mean = (points) => points.reduce((sum, p) => sum + p[1], 0) / Math.max(1, points.length);
  const entries =
      Object.entries(data.stage_us)
          .map(([name, points]) => ({name: name.replaceAll('_', ' '), points, mean: mean(points)}));
  const ranked = [...entries].sort((a, b) => b.mean - a.mean);
  const shown = entries.filter((entry) => ranked.indexOf(entry) < 5);
  const others = ranked.slice(5);
  if (others.length)
    shown.push({
      name: 'others',
      points: others[0].points.map(
          ([x, y],
           i) => [x, y === null ? null : others.reduce((sum, entry) => sum + (entry.points[i]?.[1] ?? 0), 0)])
    });
  overTime('time', {
    title: 'Time of a frame',
    unit: 'ms, pose in to wrench out',
    stacked: true,
    usual: 0.5,
    series: [
      {label: 'frame', colour: 'time', points: milliseconds(curves.frame_us), width: 0.8, order: 2},
      ...shown.map(({name, points}, i) => ({
                     label: name,
                     colour: name === 'others' ? 't9' : 't' + [0, 2, 5, 6, 8][i],
                     points: milliseconds(points),
                     width: 0.6,
                     order: 1,
                     stack: true
                   })),
    ]
  });

  // ---- work
  // ------------------------------------------------------------------------------------------------------------
  const energy = (curves.energy || []).map(([x, y]) => [x, y * 1000]);
  const most = energy.reduce((m, p) => Math.max(m, p[1]), 0),
        least = energy.reduce((m, p) => Math.min(m, p[1]), 0);
  byId('energy-lead').textContent =
      'What the device’s force and torque have done on the hand, each held for its tick. Below 0 the hand has put in more than it has got back; a passive contact never rises above, but where the tool starts in one, which gives back what is stored in it. ' +
      'Here the hand has put in ' + number(-least) + ' mJ at most, got ' + number(most) +
      ' mJ at most, and ends at ' + number(energy.length ? energy[energy.length - 1][1] : 0) + ' mJ.';
  overTime('energy', {
    title: 'Work done on the hand',
    unit: 'mJ, so far',
    height: 180,
    series: [{label: 'work', colour: 'accent', points: energy}]
  });

  // ---- with and without the law: the component that moves most, of torque and of force
  // ------------------------------
  const rows = data.highlight;  // time, force xyz and torque xyz without the law, the same with it
  const thirteen = data.chapter === 'disassembly';
  if (!rows.length) {
    byId('control-lead').textContent = 'This run had no contact.';
    for (const pair of byId('control').querySelectorAll('.pair')) pair.hidden = true;
  } else {
    byId('control-lead').textContent =
        (thirteen ? 'The ' + rows.length +
                 ' ticks of stage 3 around its largest torque about x: the chapter’s figure 13. ' :
                    'The ' + rows.length + ' ticks around the strongest contact. ') +
        'Without: the newest collision response, held until the next one, as far as the device’s axes can exert it. With: what the control law sent to the device each millisecond.';
    const stretch = Plot.group();
    const range = (column) =>
        rows.reduce((r, v) => [Math.min(r[0], v[column]), Math.max(r[1], v[column])], [Infinity, -Infinity]);
    const extent = (column) => {
      const [low, high] = range(column);
      return high - low;
    };
    const law = (id, kind, unit, without, sent, axis) => {
      const best = axis ?? [0, 1, 2].reduce((b, a) => extent(without + a) > extent(without + b) ? a : b, 0);
      Plot.draw(
          byId(id), {
            title: kind + ' ' +
                'xyz'[best],
            unit,
            zero: false,
            xUnit: 's',
            height: 240,
            kind: 'linear',
            series: [
              {
                label: 'without',
                colour: 'without',
                points: rows.map((v) => [v[0], v[without + best]]),
                stepped: true,
                width: 1.2
              },
              {label: 'with', colour: 'with', points: rows.map((v) => [v[0], v[sent + best]]), width: 2},
            ]
          },
          stretch);
    };
    law('law-torque', 'Torque', 'N·m', 4, 10, thirteen ? 0 : undefined);
    law('law-force', 'Force', 'N', 1, 7);
    const both = [['without', 'without'], ['with', 'with']];
    const {roughness} = data;
    byId('steps-lead').textContent =
        'Over the whole run. A hand feels steps of force, not its size: the largest from one tick to the next is ' +
        number(roughness.without.largest) + ' N without the law and ' + number(roughness.with.largest) +
        ' N with it; ' + count(roughness.without.still) + ' and ' + count(roughness.with.still) +
        ' ticks had none and are not counted in the chart. ' +
        'The spectrum (Welch, pieces of 1,024 ticks) is of the force as it is.';
    Plot.draw(byId('steps'), {
      title: 'Steps of force',
      unit: 'ticks, by N from one to the next',
      xName: 'step',
      xUnit: 'N',
      xLog: true,
      kind: 'log',
      floor: Plot.kNone,
      fixed: true,
      height: 240,
      series: both.map(
          ([key, colour]) => ({label: key, colour, points: Plot.outline(roughness[key].steps), width: 1.4}))
    });
    const spectra =
        both.map(([key, colour]) => ({label: key, colour, points: roughness[key].spectrum, width: 1.3}));
    byId('spectrum').hidden = !spectra[0].points.length;
    if (spectra[0].points.length)
      Plot.draw(byId('spectrum'), {
        title: 'Spectrum of force',
        unit: 'N²/Hz',
        xName: 'frequency',
        xUnit: 'Hz',
        xLog: true,
        kind: 'log',
        fixed: true,
        height: 240,
        series: spectra
      });
  }

  // ---- punctuality: histograms, each bin as wide as it is on its axis
  // -----------------------------------------------------
  const late = summary.lateness_histogram_us, ages = summary.result_age_histogram_ticks;
  byId('lateness').hidden = !late.length;
  byId('punctual-lead').textContent = late.length ?
      count(summary.missed_ticks) + ' of ' + count(summary.ticks) +
          ' ticks were missed. Both axes of the lateness are logarithmic, for one tick in a hundred thousand matters.' :
      'In virtual time no tick is late.';
  const histogram = (id, spec, bins) => bins.length && Plot.draw(byId(id), {
    kind: 'log',
    floor: Plot.kNone,
    fixed: true,
    height: 240,
    ...spec,
    series: [{label: 'ticks', colour: 'accent', points: Plot.outline(bins), width: 1.2, fill: true}]
  });
  histogram(
      'lateness', {
        title: 'How late a tick comes',
        unit: 'ticks, by µs after its time',
        xName: 'lateness',
        xUnit: 'µs',
        xLog: true
      },
      late.map(([low, high, n]) => [Math.max(low, 0.05), high, n]));
  histogram(
      'age', {
        title: 'Age of the collision result',
        unit: 'ticks of the loop, by age in ticks',
        xName: 'age',
        xUnit: '',
        xIntegers: true
      },
      ages.map(([low, high, n]) => [low - 0.5, high - 0.5, n]));

  // ---- contents
  // ------------------------------------------------------------------------------------------------------------
  for (const head of document.querySelectorAll('section:not([hidden]) h2[id]')) {
    const link = document.createElement('a');
    link.href = '#' + head.id;
    link.textContent = head.textContent;
    byId('contents').append(link);
  }
})();
