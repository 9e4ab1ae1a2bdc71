"""The yardstick's page: a figure in which palpate is the worst stands in its first table, with the best; what
nobody feels, and a method that fails, don't hide."""
import subprocess
import sys
import tempfile
from pathlib import Path

PAGE = Path(__file__).parents[2] / 'bench/haptic/page.py'
COLUMNS = (
    'direction_p50_deg direction_p95_deg magnitude_p50 magnitude_p95 torque_p50 torque_p95 step noise'
    ' loop_lost frame_p50_us frame_p99_us evaluation_p50_us unsettled memory_mib prepare_s'
).split()


def row(case, method, **figures):
    return f'"{case}",fit,{method},' + ','.join(str(figures.get(column, 0.5)) for column in COLUMNS) + '\n'


def page(figures, failures=''):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / 'raw').mkdir()
        (folder / 'facts.csv').write_text('clock,cores,poses\ncpu,1,2\n')
        (folder / 'methods.csv').write_text('method,name,version\npalpate,palpate,1\nvps,VPS,2\n')
        (folder / 'cases.csv').write_text(
            'case,group,fixed_triangles,tool_triangles,gyration_m,truth\n'
            '"peg, tilted",fit,12,12,0.01,"by hand"\n"<key>",fit,12,12,0.01,"by hand"\n'
        )
        (folder / 'failures.csv').write_text('case,method,sentence\n' + failures)
        (folder / 'figures.csv').write_text(f'case,group,method,{",".join(COLUMNS)}\n{figures}')
        for method in ('palpate', 'vps'):
            (folder / f'raw/peg__tilted.{method}.csv').write_text(
                'part,fx,fy,fz,tx,ty,tz,true_fx,true_fy,true_fz,true_tx,true_ty,true_tz\n'
                + 2 * 'path,0,0,1,0,0,0,0,0,1,0,0,0\n'
            )
        done = subprocess.run([sys.executable, PAGE, folder], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return (folder / 'index.html').read_text()


def first_table(text):
    return text[text.index('Where palpate is the worst') : text.index('Best and worst')]


def test_the_worst_stands_first():
    text = first_table(
        page(
            row('peg, tilted', 'palpate', torque_p95=0.84, direction_p95_deg=0.9, step=0.99)
            + row('peg, tilted', 'vps', torque_p95=0.47, direction_p95_deg=0.1, step=0)
            + row('<key>', 'palpate', frame_p99_us=20)
            + row('<key>', 'vps', frame_p99_us=19)
        )
    )
    assert '84 <span class="best">47</span>' in text and '20 <span class="best">19</span>' in text, text
    assert 'worst in 2 of 20 figures' in text, 'below a degree, and below a spring, nobody feels it'


def test_a_method_that_fails_is_told():
    text = page(
        row('peg, tilted', 'palpate') + row('peg, tilted', 'vps') + row('<key>', 'vps'),
        '"<key>",palpate,"ended by signal 11"\n',
    )
    assert (
        'gives no answer in 1 of 2 cases' in first_table(text) and text.count('ended by signal 11') == 2
    ), 'in failures and in the tables'
    assert '&lt;key&gt;' in text and '<key>' not in text


for name, test in list(globals().items()):
    if name.startswith('test_'):
        test()
        print('ok', name)
