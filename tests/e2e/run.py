"""`palpate run`: files, reproducible bytes, the chapter's stages and contacts, the report, interruption."""
import html.parser
import re
import signal

from harness import *

TRACE = ('time_s,x_m,y_m,z_m,qx,qy,qz,qw,force_x_N,force_y_N,force_z_N,torque_x_Nm,torque_y_Nm,torque_z_Nm,'
         'response_force_x_N,response_force_y_N,response_force_z_N,response_torque_x_Nm,response_torque_y_Nm,response_torque_z_Nm,'
         'result_age_ticks,contact,stage')
SUMMARY = ['static_triangles', 'tool_triangles', 'backend', 'device', 'profile', 'law', 'ticks', 'missed_ticks', 'lateness_us', 'result_age_ticks',
           'frame_us', 'stages_reached', 'areas_max', 'force_max_N', 'torque_max_Nm']


def run(scene, out, *arguments):
    outcome = palpate('run', scene, '--pace', 'asap', '--out', out, *arguments)
    expect(outcome.code == 0, outcome)
    return outcome


def frames(out):
    return [json.loads(line) for line in (out / 'frames.jsonl').read_text().splitlines()]


def without_time(line):
    return re.sub(r'"time_us":\{[^}]*\}', '', line)


def test_the_disassembly_twice_gives_the_same_bytes_and_reaches_all_stages():
    folder = Folder()
    scene = SOURCE / 'scenes' / 'disassembly.json'
    outcome = run(scene, folder / 'a')
    run(scene, folder / 'b')
    expect((folder / 'a' / 'trace.csv').read_bytes() == (folder / 'b' / 'trace.csv').read_bytes(), 'trace.csv differs')
    one, two = ((folder / d / 'frames.jsonl').read_text().splitlines() for d in 'ab')
    expect(len(one) == len(two) and all(without_time(x) == without_time(y) for x, y in zip(one, two)), 'frames.jsonl differs beyond times')

    trace = (folder / 'a' / 'trace.csv').read_text().splitlines()
    expect(trace[0].startswith(TRACE), trace[0])
    summary = json.loads((folder / 'a' / 'summary.json').read_text())
    expect(list(summary) == SUMMARY, list(summary))
    expect(list(summary['lateness_us']) == ['p50', 'p99', 'p999', 'max'], summary['lateness_us'])
    expect(list(summary['result_age_ticks']) == ['p50', 'max'] and list(summary['frame_us']) == ['p50', 'p99', 'max'], summary)
    expect(summary['stages_reached'] == [1, 2, 3, 4, 5, 6], summary['stages_reached'])
    expect(summary['ticks'] == len(trace) - 1 and summary['missed_ticks'] == 0, summary)
    expect(abs(summary['static_triangles'] / 100000 - 1) <= 0.02 and abs(summary['tool_triangles'] / 2000 - 1) <= 0.02, summary)
    expect(summary['result_age_ticks']['max'] <= 2 * 3, summary['result_age_ticks'])   # virtual_delay_ticks 3, renewed every 3
    expect(summary['force_max_N'] > 0 and summary['torque_max_Nm'] > 0, summary)
    expect('report' in outcome.out and str(folder / 'a' / 'report.html') in outcome.out, outcome)


def test_the_contacts_reach_one_two_and_four_areas_at_once():
    folder = Folder()
    run(SOURCE / 'scenes' / 'contacts.json', folder / 'a')
    seen = set()
    for frame in frames(folder / 'a'):
        seen.add(sum(any(area['force']) for area in frame['areas']))
        expect('tick' in frame and list(frame)[-1] == 'tick', list(frame))
    expect({1, 2, 4} <= seen, f'areas at once: {sorted(seen)}')
    summary = json.loads((folder / 'a' / 'summary.json').read_text())
    expect(summary['stages_reached'] == [1, 2, 3], summary['stages_reached'])


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.links, self.ids = [], set()

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ('src', 'href', 'action', 'data', 'srcset', 'poster'):
                self.links.append((tag, name, value))
            if name == 'id':
                self.ids.add(value)


def small_run(folder, *arguments):
    expect(palpate('generate', 'contacts', '--triangles', '2000', '--tool-triangles', '1000', '--out', folder / 'scene').code == 0, 'generate')
    return run(folder / 'scene' / 'scene.json', folder / 'out', *arguments)


def test_the_report_is_one_self_contained_page():
    folder = Folder()
    small_run(folder)
    text = (folder / 'out' / 'report.html').read_text()
    page = Page()
    page.feed(text)
    expect(not page.links, f'the page reaches outside: {page.links}')
    for sign in ('http://', 'https://', '@import', 'url('):
        expect(sign not in text, f'the page holds {sign}')
    for canvas in ('torque', 'force', 'triangles', 'areas', 'time', 'law-torque', 'law-force'):
        expect(canvas in page.ids, f'no figure {canvas}')
    for place in ('@CSS@', '@DATA@', '@SCRIPT@', '@CHART_JS@'):
        expect(place not in text, f'{place} was not filled')
    data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S).group(1))
    expect({'summary', 'curves', 'highlight', 'stages', 'stage_figures'} <= set(data), list(data))
    expect(len(data['highlight']) > 0 and len(data['curves']['cst']) > 10, 'curves')
    expect(len(text) < 3_000_000, f'{len(text)} bytes')


def test_a_duration_ends_a_run_and_a_default_directory_is_fresh():
    folder = Folder()
    scene = folder.save()
    first = palpate('run', scene, '--pace', 'asap', '--duration', '0.05', cwd=folder.path)
    second = palpate('run', scene, '--pace', 'asap', '--duration', '0.05', cwd=folder.path)
    expect(first.code == 0 and second.code == 0, f'{first}\n{second}')
    made = sorted(p.name for p in folder.path.iterdir() if p.name.startswith('palpate-run-'))
    expect(len(made) == 2 and made[0] in first.out and made[1] in second.out, f'{made}\n{first}')
    trace = (folder.path / made[0] / 'trace.csv').read_text().splitlines()
    expect(len(trace) - 1 == 50, f'{len(trace) - 1} ticks instead of 50')


def test_profile_and_plan_reach_the_run():
    folder = Folder()
    small_run(folder, '--profile', 'paper', '--plan', 'full', '--duration', '0.3')
    summary = json.loads((folder / 'out' / 'summary.json').read_text())
    expect(summary['profile'] == 'paper' and summary['law'] == 'printed', summary)


def test_the_cpu_can_run_and_gives_the_same_trace():
    folder = Folder()
    small_run(folder, '--duration', '0.6', '--backend', 'gpu')
    gpu = (folder / 'out' / 'trace.csv').read_bytes()
    small_run(folder, '--duration', '0.6', '--backend', 'cpu')
    expect((folder / 'out' / 'trace.csv').read_bytes() == gpu, 'traces differ')
    expect(json.loads((folder / 'out' / 'summary.json').read_text())['backend'] == 'cpu', 'backend')


def test_an_interrupt_ends_a_real_time_run_with_whole_files():
    folder = Folder()
    scene = folder.save()
    for number in (signal.SIGINT, signal.SIGTERM):
        out = folder / f'out{number}'
        process = subprocess.Popen([PROGRAM, 'run', str(scene), '--out', str(out)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        deadline = time.monotonic() + 60
        # Without a path the run ends only when it is told to; wait until it has recorded something.
        while time.monotonic() < deadline and not ((out / 'trace.csv').exists() and (out / 'trace.csv').stat().st_size > 0):
            expect(process.poll() is None, 'the run ended by itself')
            time.sleep(0.05)
        time.sleep(0.3)
        process.send_signal(number)
        stdout, stderr = process.communicate(timeout=60)
        outcome = Outcome(process.returncode, stdout.decode(), stderr.decode())
        expect(outcome.code == 0, outcome)
        rows = (out / 'trace.csv').read_text()
        expect(rows.endswith('\n') and rows.count('\n') > 100, 'whole rows')
        expect(json.loads((out / 'summary.json').read_text())['ticks'] == rows.count('\n') - 1, 'summary')
        expect((out / 'report.html').read_text().rstrip().endswith('</html>'), 'report')


main(globals())
