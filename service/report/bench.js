'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const byId = (id) => document.getElementById(id);
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
  const number = (value) => Math.abs(value) >= 1e7 ? Number(value).toExponential(0) : Math.abs(value) >= 10000 ? Math.round(value).toLocaleString('en') : String(Number(Number(value).toPrecision(3)));

  document.title = 'palpate bench ' + data.facts.bench;
  byId('title').textContent = 'palpate bench ' + data.facts.bench;
  byId('subtitle').textContent = data.facts.device;
  const row = (table, cells, tag = 'td') => {
    const tr = table.insertRow();
    for (const cell of cells) {
      const td = document.createElement(tag);
      td.textContent = cell;
      tr.append(td);
    }
  };
  row(byId('table'), data.columns.map((name) => name.replaceAll('_', ' ')), 'th');
  for (const cells of data.rows) row(byId('table'), cells);
  for (const [name, value] of Object.entries(data.facts)) row(byId('facts'), [name.replaceAll('_', ' '), value]);

  const palette = ['t0', 't5', 't2', 't6', 't8', 't4', 't1', 't7', 't3', 't9'];
  const charts = [];
  const draw = () => {
    for (const chart of charts) chart.destroy();
    charts.length = 0;
    for (const [index, spec] of data.charts.entries()) {
      if (spec.picture) continue;
      const bars = spec.labels.length > 0;
      const datasets = spec.series.map((s, i) => {
        const ink = colour(palette[(s.expected ? i - 1 : i) % palette.length]);   // what theory expects goes in the ink of what it is of
        return { label: s.label, data: bars ? s.y : s.x.map((x, k) => ({ x, y: s.y[k] })), backgroundColor: ink, borderColor: ink,
                 borderWidth: bars ? 0 : 2, borderDash: s.expected ? [6, 4] : [], pointRadius: bars || s.expected || s.x.length > 40 ? 0 : 3, borderRadius: 2, maxBarThickness: 34 };
      });
      const axis = (title, log) => ({
        type: log ? 'logarithmic' : 'linear', title: { display: Boolean(title), text: title, color: colour('soft') },
        grid: { color: colour('grid') }, border: { display: false }, beginAtZero: !log,
        ticks: { color: colour('soft'), callback: (value) => !log || /^[125]/.test(String(value).replace(/^0\.0*/, '')) ? number(value) : '' } });
      const x = bars ? { grid: { display: false }, ticks: { color: colour('ink') } } : axis(spec.x_title, spec.log_x);
      const y = axis('', spec.log_y);
      x.stacked = y.stacked = spec.stacked;
      charts.push(new Chart(byId('chart' + index), {
        type: bars ? 'bar' : 'line', data: { labels: spec.labels, datasets },
        options: { animation: false, responsive: true, maintainAspectRatio: false, scales: { x, y },
                   plugins: { legend: { position: 'bottom', labels: { color: colour('ink'), boxWidth: 12, boxHeight: 12 } },
                              tooltip: { callbacks: { label: (item) => item.dataset.label + ': ' + number(item.parsed.y) } } } } }));
    }
  };
  for (const [index, spec] of data.charts.entries()) {
    const figure = document.createElement('figure');
    figure.className = 'bench';
    const caption = document.createElement('figcaption');
    caption.append(spec.title + ' ');
    const unit = document.createElement('span');
    unit.textContent = spec.unit;
    caption.append(unit);
    const frame = document.createElement('div');
    if (spec.picture) {
      frame.innerHTML = spec.picture;
      frame.className = 'picture';
      figure.append(frame);   // it has its title in it
      byId('charts').append(figure);
      continue;
    }
    const canvas = document.createElement('canvas');
    canvas.id = 'chart' + index;
    frame.append(canvas);
    figure.append(caption, frame);
    byId('charts').append(figure);
  }
  draw();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);
})();
