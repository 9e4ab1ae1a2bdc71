#!/usr/bin/env python3
"""Draws OUT/index.html from what haptic_yardstick left in OUT: figures, samples, failures. Nothing is
measured here.

usage: page.py OUT"""
import csv
import html
import io
import math
import platform
import re
import subprocess
import sys
from pathlib import Path

import matplotlib

matplotlib.use('svg')
import matplotlib.pyplot as plt  # noqa: E402

JUDGED = 'palpate'  # whose worst rows come first
# column, head, unit factor, what a figure as good as nobody feels; none: every difference counts
MEASURES = [
    ('direction_p95_deg', 'direction, p95, °', 1, 1),
    ('magnitude_p95', 'magnitude, p95, %', 100, 1),
    ('torque_p95', 'torque, p95, %', 100, 1),
    ('step', 'largest step, ÷ K|Δx|', 1, 1),
    ('noise', 'noise at rest, ÷ K·rms', 1, 1),
    ('loop_lost', 'work lost round a loop, %', 100, 1),
    ('frame_p50_us', 'answer, p50, µs', 1, None),
    ('frame_p99_us', 'answer, p99, µs', 1, None),
    ('evaluation_p50_us', 'one evaluation, p50, µs', 1, None),
    ('memory_mib', 'memory, MiB', 1, None),
]
MORE = [
    ('direction_p50_deg', 'direction, p50, °', 1, 1),
    ('magnitude_p50', 'magnitude, p50, %', 100, 1),
    ('torque_p50', 'torque, p50, %', 100, 1),
    ('unsettled', 'balance not found, %', 100, 1),
    ('prepare_s', 'preparing, s', 1, None),
]
LOOKS = [('#0072b2', 'o'), ('#d55e00', 's'), ('#009e73', '^'), ('#cc79a7', 'D'), ('#56b4e9', 'v')]
CLOCKS = {'wall': 'the wall clock', 'cpu': 'processor time, of all threads together,'}
PARTS = {'closed form': 'Closed forms', 'fit': 'Fits', 'stiff': 'Stiff cases', 'part': 'Real parts'}


def rows_of(path):
    with open(path, newline='') as file:
        return list(csv.DictReader(file))


def number(text, factor=1):
    return float(text) * factor if text not in (None, '') else None


def shown(value):
    if value is None:
        return '–'
    if value == 0:
        return '0'
    if abs(value) >= 1000:
        return f'{value:,.0f}'
    if abs(value) < 0.01:
        return f'{value:.0e}'
    return f'{value:.3g}'


def table(head, rows):
    """`rows`: of texts that are HTML already; a cell may be (text, class)."""
    out = ['<div class="wide"><table><tr>' + ''.join(f'<th>{cell}</th>' for cell in head) + '</tr>']
    for row in rows:
        cells = [cell if isinstance(cell, tuple) else (cell, '') for cell in row]
        out.append(
            '<tr>'
            + ''.join(
                f'<td class="{kind}">{text}</td>' if kind else f'<td>{text}</td>' for text, kind in cells
            )
            + '</tr>'
        )
    return '\n'.join(out) + '</table></div>'


def svg(figure, label):
    text = io.StringIO()
    figure.savefig(text, format='svg', bbox_inches='tight', metadata={'Date': None})
    plt.close(figure)
    body = text.getvalue()
    body = body[body.index('<svg') :]
    body = re.sub(r'<svg ', f'<svg role="img" aria-label="{html.escape(label)}" ', body, count=1)
    return f'<div class="wide"><div class="chart">{body}</div></div>'


class Run:
    def __init__(self, folder):
        self.folder = Path(folder)
        self.cases = rows_of(self.folder / 'cases.csv')
        self.methods = rows_of(self.folder / 'methods.csv')
        self.facts = rows_of(self.folder / 'facts.csv')[0]
        self.failures = rows_of(self.folder / 'failures.csv')
        self.figures = {(row['case'], row['method']): row for row in rows_of(self.folder / 'figures.csv')}
        self.look = {m['method']: LOOKS[i % len(LOOKS)] for i, m in enumerate(self.methods)}
        self.name = {m['method']: m['name'] for m in self.methods}

    def figure(self, case, method, column, factor=1):
        row = self.figures.get((case, method))
        return number(row[column], factor) if row else None

    def samples(self, case, method):
        path = self.folder / 'raw' / f'{re.sub(r"[^A-Za-z0-9]", "_", self._bytes(case))}.{method}.csv'
        return [row for row in rows_of(path) if row['part'] == 'path'] if path.exists() else []

    @staticmethod
    def _bytes(name):
        return name.encode().decode('latin-1')  # a letter that is two bytes becomes two, as in the program


def rounded_up(value, floor):
    """What is as good as nobody feels is equally good: a silent method has no noise, and earns nothing by
    it."""
    return value if value is None or floor is None else max(value, floor)


def by_method(run, case, column, factor, floor=None):
    values = {m: run.figure(case['case'], m, column, factor) for m in run.name}
    return {m: rounded_up(v, floor) for m, v in values.items() if v is not None}


def worst_section(run):
    """Of the judged method: the cells in which it is the worst of two or more, with the best."""
    if JUDGED not in run.name:
        return ''
    rows, worst, asked = [], 0, 0
    for case in run.cases:
        cells = []
        for column, _, factor, floor in MEASURES:
            values = by_method(run, case, column, factor, floor)
            asked += JUDGED in values and len(values) > 1
            if (
                JUDGED not in values
                or values[JUDGED] < max(values.values())
                or min(values.values()) == values[JUDGED]
            ):
                cells.append('')
                continue
            worst += 1
            cells.append(
                (f'{shown(values[JUDGED])} <span class="best">{shown(min(values.values()))}</span>', 'bad')
            )
        rows.append([(html.escape(case['case']), 'name')] + cells)
    failed = [f for f in run.failures if f['method'] == JUDGED]
    return f'''<h2>Where {JUDGED} is the worst</h2>
<p>{JUDGED} is the worst in {worst} of {asked} figures, and gives no answer in {len(failed)} of {len(run.cases)} cases. Red: its figure; grey: the best.
Errors below 1° or 1 % count as these, steps and noise below a spring's own as 1.</p>
{table(['case'] + [head for _, head, _, _ in MEASURES], rows)}'''


def counts(run):
    """How often each method is the best and the worst, by measure; equal ones all are."""
    rows = []
    for column, head, factor, floor in MEASURES:
        best, worst, asked = dict.fromkeys(run.name, 0), dict.fromkeys(run.name, 0), 0
        for case in run.cases:
            values = by_method(run, case, column, factor, floor)
            if len(values) < 2:
                continue
            asked += 1
            for method, value in values.items():
                best[method] += value == min(values.values())
                worst[method] += value == max(values.values()) > min(values.values())
        rows.append([head, str(asked)] + [f'{best[m]} / {worst[m]}' for m in run.name])
    return table(['measure', 'cases'] + [f'{html.escape(n)}: best / worst' for n in run.name.values()], rows)


def dots(run):
    """A panel a measure, a row a case, a mark a method; two panels a picture, which print keeps together."""
    return '\n'.join(dot_panels(run, MEASURES[i : i + 2]) for i in range(0, len(MEASURES), 2))


def dot_panels(run, measures):
    figure, axes = plt.subplots(1, 2, figsize=(11, 0.27 * len(run.cases) + 1.2), sharey=True)
    places = list(range(len(run.cases)))[::-1]
    for (column, head, factor, floor), ax in zip(measures, axes):
        found = [
            v
            for c in run.cases
            for m in run.name
            if (v := run.figure(c['case'], m, column, factor)) is not None and v > 0
        ]
        low = 10 ** math.floor(math.log10(max(min(found, default=1), (floor or 1e-9) * 1e-3)))
        for nudge, method in enumerate(run.name):
            colour, marker = run.look[method]
            points = [
                (max(v, low), y)
                for c, y in zip(run.cases, places)
                if (v := run.figure(c['case'], method, column, factor)) is not None
            ]
            ax.plot(
                [x for x, _ in points],
                [y + 0.16 * (1 - nudge) for _, y in points],
                linestyle='',
                marker=marker,
                color=colour,
                markersize=5,
                label=run.name[method],
                alpha=0.9,
            )
        if floor:
            ax.axvline(floor, color='#888', linewidth=0.8, linestyle=':')
        ax.set_xscale('log')
        ax.set_title(head + ('  (left edge: this or less)' if floor else ''), fontsize=9, loc='left')
        ax.set_yticks(places)
        ax.set_yticklabels([c['case'] for c in run.cases], fontsize=8)
        ax.tick_params(axis='x', labelsize=8)
        ax.grid(True, which='major', color='#ddd', linewidth=0.6)
        ax.set_axisbelow(True)
        for side in ('top', 'right'):
            ax.spines[side].set_visible(False)
    legend_above(figure, axes[0], 0.25 / figure.get_figheight())
    return svg(figure, ' and '.join(head for _, head, _, _ in measures) + ' of all methods on all cases')


def legend_above(figure, ax, share):
    handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc='upper center', ncol=max(1, len(labels)), frameon=False, fontsize=9)
    figure.tight_layout(rect=(0, 0, 1, 1 - share))


def felt(row, kind):
    return math.sqrt(sum(float(row[f'{kind}{axis}']) ** 2 for axis in 'xyz'))


def truth(row, kind):
    cells = [row[f'true_{kind}{axis}'] for axis in 'xyz']
    return math.sqrt(sum(float(c) ** 2 for c in cells)) if all(cells) else None


def curves(run):
    """Force or, where there is none, torque along each path, beside the truth."""
    columns = 3
    lines = math.ceil(len(run.cases) / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(11, 2.5 * lines), squeeze=False)
    for case, ax in zip(run.cases, axes.flat):
        kind, unit, scale = 'f', '|F|, N', 1
        drawn = False
        for method in run.name:
            rows = run.samples(case['case'], method)
            if not rows:
                continue
            if not drawn:
                right = [truth(row, 'f') for row in rows]
                if all(v is not None and v == 0 for v in right):
                    kind, unit, scale = 't', '|T|, N·mm', 1000
                right = [truth(row, kind) for row in rows]
                if all(v is not None for v in right):
                    ax.plot(
                        [i / (len(rows) - 1) for i in range(len(rows))],
                        [v * scale for v in right],
                        color='black',
                        linewidth=2.4,
                        alpha=0.35,
                        label='rigid truth',
                    )
                drawn = True
            ax.plot(
                [i / (len(rows) - 1) for i in range(len(rows))],
                [felt(row, kind) * scale for row in rows],
                color=run.look[method][0],
                linewidth=1,
                label=run.name[method],
            )
        ax.set_title(case['case'], fontsize=9, loc='left')
        ax.set_ylabel(unit, fontsize=8)
        ax.tick_params(labelsize=8)
        ax.grid(True, color='#e4e4e4', linewidth=0.6)
        for side in ('top', 'right'):
            ax.spines[side].set_visible(False)
    for ax in list(axes.flat)[len(run.cases) :]:
        ax.set_visible(False)
    legend_above(figure, axes.flat[0], 0.3 / figure.get_figheight())
    return svg(figure, 'Force along the path of each case')


def everything(run):
    out = []
    columns = MEASURES + MORE
    for group, title in PARTS.items():
        cases = [c for c in run.cases if c['group'] == group]
        if not cases:
            continue
        rows = []
        for case in cases:
            for i, method in enumerate(run.name):
                first = (html.escape(case['case']), 'name') if i == 0 else ''
                if (case['case'], method) not in run.figures:
                    why = next(
                        (
                            f['sentence']
                            for f in run.failures
                            if f['case'] == case['case'] and f['method'] == method
                        ),
                        'not asked',
                    )
                    rows.append(
                        [first, html.escape(run.name[method]), html.escape(why)] + [''] * (len(columns) - 1)
                    )
                    continue
                cells = [first, html.escape(run.name[method])]
                for column, _, factor, floor in columns:
                    values = by_method(run, case, column, factor, floor)
                    worst = method in values and values[method] == max(values.values()) > min(values.values())
                    cells.append(
                        (shown(run.figure(case['case'], method, column, factor)), 'bad' if worst else '')
                    )
                rows.append(cells)
        out.append(f'<h3>{title}</h3>' + table(['case', 'method'] + [h for _, h, _, _ in columns], rows))
    return '\n'.join(out)


def machine(facts):
    try:
        text = Path('/proc/cpuinfo').read_text()
        model = re.search(r'model name\s*:\s*(.*)', text).group(1)
    except (OSError, AttributeError):
        model = platform.machine()
    cores = int(facts['cores'])
    return f'{cores} core{"s" if cores > 1 else ""} of {model}'


def commit():
    try:
        return subprocess.run(
            ['git', 'describe', '--always', '--dirty'],
            cwd=Path(__file__).parent,
            text=True,
            capture_output=True,
            check=True,
        ).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return 'unknown'


STYLE = '''
:root { --page: #fff; --ink: #111; --faint: #555; --line: #eee; --rule: #999; --bad: #b00020; --link: #00557f; }
@media screen and (prefers-color-scheme: dark) {
  :root { color-scheme: dark; --page: #14171a; --ink: #e6e8ea; --faint: #a8adb2; --line: #2a2f34; --rule: #6b7278;
    --bad: #ff7a8a; --link: #6cb8d6; }
  .chart svg { filter: invert(0.92) hue-rotate(180deg); }
}
body { font: 15px/1.45 system-ui, sans-serif; max-width: 1080px; margin: 24px auto; padding: 0 16px;
  background: var(--page); color: var(--ink); }
a { color: var(--link); } nav a { margin-right: 14px; }
h1 { font-size: 24px; margin: 0 0 4px; }
h2 { font-size: 19px; margin: 32px 0 6px; }
h3 { font-size: 16px; margin: 20px 0 4px; }
.wide { overflow-x: auto; }
.chart { min-width: 760px; break-inside: avoid; } .chart svg { width: 100%; height: auto; }
table { border-collapse: collapse; font-size: 12.5px; margin: 6px 0; }
th { text-align: left; vertical-align: bottom; font-weight: 600; border-bottom: 1px solid var(--rule);
  padding: 2px 10px 2px 0; }
td { padding: 2px 10px 2px 0; border-bottom: 1px solid var(--line); font-variant-numeric: tabular-nums; }
.bad { color: var(--bad); font-weight: 600; white-space: nowrap; } .best { color: var(--faint); font-weight: 400; }
.name { white-space: nowrap; } .small { font-size: 13px; color: var(--faint); }
@media print {
  .wide { overflow: visible; } .chart { min-width: 0; } table { font-size: 9px; }
  h2, h3 { break-after: avoid; } tr { break-inside: avoid; }
}
'''


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    plt.rcParams['svg.hashsalt'] = 'yardstick'
    run = Run(sys.argv[1])
    methods = table(
        ['method', 'version and settings'],
        [[html.escape(m['name']), html.escape(m['version'])] for m in run.methods],
    )
    cases = table(
        ['case', 'triangles, fixed × tool', 'ρ, mm', 'truth'],
        [
            [
                html.escape(c['case']),
                f'{int(c["fixed_triangles"]):,} × {int(c["tool_triangles"]):,}',
                f'{float(c["gyration_m"]) * 1000:.1f}',
                html.escape(c['truth']),
            ]
            for c in run.cases
        ],
    )
    failures = (
        table(
            ['case', 'method', 'what happened'],
            [
                [
                    html.escape(f['case']),
                    html.escape(run.name.get(f['method'], f['method'])),
                    html.escape(f['sentence']),
                ]
                for f in run.failures
            ],
        )
        if run.failures
        else '<p>None.</p>'
    )
    page = f'''<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Haptic yardstick</title><style>{STYLE}</style>
<h1>Haptic yardstick</h1>
<p>What a hand is told, and how soon, by {len(run.name)} methods on {len(run.cases)} cases. Each hangs the tool on the hand by the same spring, K and Kρ²;
truth is a rigid tool on that spring that does not penetrate. <span class="small">{html.escape(machine(run.facts))}; {platform.system()} {platform.release()}; commit {html.escape(commit())}; {run.facts['poses']} poses a path; times by {CLOCKS[run.facts['clock']].strip(',')}.</span></p>
<nav><a href="#figures">All figures</a><a href="#curves">Forces</a><a href="#tables">Tables</a><a href="#meaning">What the measures mean</a><a href="#cases">Cases</a></nav>
{worst_section(run)}
<h2>Best and worst, by measure</h2>
{counts(run)}
{methods}
<h2>Failures</h2>
{failures}
<h2 id="figures">All figures</h2>
<p class="small">Left is better. Dotted: the limit below which an error is not counted above; for steps and noise what a spring of K does.</p>
{dots(run)}
<h2 id="curves">Force along each path</h2>
<p class="small">From just before touch (0) to the deepest pose (1); torque where the truth has no net force. Real parts: along the way out.</p>
{curves(run)}
<h2 id="tables">Tables</h2>
<p class="small">Red: the worst of its case, as above. Raw samples of every pose: raw/CASE.METHOD.csv; this table: figures.csv.</p>
{everything(run)}
<h2 id="meaning">What the measures mean</h2>
<p>Errors are of the poses whose true force is a tenth of the path's largest or more; p50 and p95 are over them. F*, T*: truth.</p>
<ul><li><b>Direction</b>: angle between F and F*; 90° where a method is silent.</li>
<li><b>Magnitude</b>: ||F| − |F*|| / |F*|. Where there is no net force, over |T*|/ρ; in the press fit, over K times the overlap.</li>
<li><b>Torque</b>: |T − T*| / (ρ |F*|), or over |T*| where there is no net force. About the tool's centre of volume.</li>
<li><b>Step</b>: largest |ΔF| / (K |Δx|) between neighbours on the path; |Δx| is the way plus the turn times the tool's farthest point. A spring of K: at most 1.</li>
<li><b>Noise</b>: the hand trembles by 1 µm rms along each axis; rms of F about its mean, over K times the tremble's rms in space. A spring: at most 1.</li>
<li><b>Work lost</b>: |∮ dW| / ∮ |dW| round a closed loop of poses, dW = F·dx + T·dθ by the trapezoid rule. A conservative force: 0, but for that rule.</li>
<li><b>Answer</b>: {CLOCKS[run.facts['clock']]} of one pose, the balance with the spring included, on the path's second walk. <b>Evaluation</b>: that over the number of times that the contact was worked out: about what a frame of a loop takes, where the balance is followed tick by tick.</li>
<li><b>Memory</b>: of a process that holds this case and method alone, after preparing and one walk.</li></ul>
<h2 id="cases">Cases</h2>
{cases}
</html>
'''
    (run.folder / 'index.html').write_text(page)
    print(run.folder / 'index.html')
    return 0


if __name__ == '__main__':
    sys.exit(main())
