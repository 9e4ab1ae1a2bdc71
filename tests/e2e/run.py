"""`palpate run`: files, reproducible bytes, the chapter's stages and contacts, the report, interruption."""
import html.parser
import signal

from harness import *
from run_files import *


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
    expect(
        palpate(
            'generate',
            'contacts',
            '--triangles',
            '2000',
            '--tool-triangles',
            '1000',
            '--out',
            folder / 'scene',
            '--overwrite',
        ).code
        == 0,
        'generate',
    )
    return run(folder / 'scene' / 'scene.json', folder / 'out', *arguments)


def test_the_same_run_twice_leaves_the_same_bytes():
    folder = Folder()
    small_run(folder, '--duration', '3')
    (folder / 'out').rename(folder / 'first')
    small_run(folder, '--duration', '3')
    expect_same_files(folder / 'first', folder / 'out')
    expect_contract(folder / 'out')
    expect(any(frame['areas'] for frame in frames(folder / 'out')), 'three seconds reach the first contact')


def test_a_recorded_frame_asked_again_has_the_same_sets_and_areas():
    folder = Folder()
    small_run(folder, '--duration', '3', '--backend', 'cpu')
    recorded = [frame for frame in frames(folder / 'out') if frame['contact']]
    expect(len(recorded) > 50, f'three seconds reach the first contact: {len(recorded)}')
    rows = [','.join(map(repr, frame['pose'])) for frame in recorded]
    poses = folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n' + '\n'.join(rows) + '\n')
    done = palpate('query', folder / 'scene/scene.json', '--poses', poses, '--backend', 'cpu')
    asked = [json.loads(line) for line in done.out.splitlines()]
    expect(len(asked) == len(recorded), done)
    for frame, again in zip(recorded, asked):
        for key in ('pose', 'pairs', 'cst', 'bst', 'cmt', 'bmt', 'imt', 'est'):
            expect(frame[key] == again[key], f'{key} of the frame of tick {frame["tick"]}')
        same = lambda line: [(area['id'], area['normal'], area['depth']) for area in line['areas']]
        expect(same(frame) == same(again), f'areas of the frame of tick {frame["tick"]}')
    # What hangs on a spring is elsewhere than what it hangs on.
    trace = [line.split(',') for line in (folder / 'out/trace.csv').read_text().splitlines()[1:]]
    apart = [
        sum((a - float(b)) ** 2 for a, b in zip(frame['pose'][:3], trace[frame['tick']][1:4])) ** 0.5
        for frame in recorded
    ]
    expect(max(apart) > 1e-5, f'tool and device are at most {max(apart)} m apart')


def test_a_recorded_run_is_done_again_to_the_bit():
    folder = Folder()
    small_run(folder, '--duration', '0.3', '--backend', 'cpu')
    scene, trace = folder / 'scene' / 'scene.json', folder / 'out' / 'trace.csv'
    recorded = [line.split(',') for line in trace.read_text().splitlines()]
    expect(
        run(scene, folder / 'again', '--device', f'replay:{trace}', '--backend', 'cpu') is not None, 'replay'
    )
    again = [line.split(',') for line in (folder / 'again' / 'trace.csv').read_text().splitlines()]
    expect(len(again) == len(recorded), f'{len(again)} rows of {len(recorded)}')
    header = recorded[0]
    same = [
        i
        for i, name in enumerate(header)
        if name in ('time_s', 'contact', 'stage', 'result_age_ticks')
        or name[:2] in ('x_', 'y_', 'z_', 'qx', 'qy', 'qz', 'qw')
        or name.startswith('response_')
    ]
    for a, b in zip(recorded, again):
        expect([a[i] for i in same] == [b[i] for i in same], f'{a}\n{b}')
    # The scene may name it as well, and what is no trace is one sentence with its line.
    described = json.loads(scene.read_text())
    described['device'] = {'driver': 'replay', 'path': '../out/trace.csv'}
    (folder / 'scene' / 'replay.json').write_text(json.dumps(described))
    expect(
        palpate(
            'run',
            folder / 'scene' / 'replay.json',
            '--pace',
            'asap',
            '--duration',
            '0.01',
            '--backend',
            'cpu',
            '--out',
            folder / 'third',
        ).code
        == 0,
        'by the scene',
    )
    lines = trace.read_text().splitlines()
    lines[2] = ','.join(['abc' if i == 1 else cell for i, cell in enumerate(lines[2].split(','))])
    bad = folder.write('bad.csv', '\n'.join(lines))
    expect_refused(
        palpate('run', scene, '--device', f'replay:{bad}', '--pace', 'asap', '--backend', 'cpu'),
        3,
        'bad.csv, line 3',
        '"abc" is not a finite number',
    )
    expect_refused(
        palpate('run', scene, '--device', 'replay', '--pace', 'asap', '--backend', 'cpu'), 3, 'replay:FILE'
    )


def test_the_report_is_one_self_contained_page():
    folder = Folder()
    small_run(folder, '--duration', '3')
    text = (folder / 'out' / 'report.html').read_text()
    page = Page()
    page.feed(text)
    expect(not page.links, f'the page reaches outside: {page.links}')
    for sign in ('http://', 'https://', '@import', 'url('):
        expect(sign not in text, f'the page holds {sign}')
    for figure in (
        'torque',
        'force',
        'depth',
        'triangles',
        'areas',
        'time',
        'energy',
        'law-torque',
        'law-force',
        'steps',
        'spectrum',
    ):
        expect(figure in page.ids, f'no figure {figure}')
    for place in ('@CSS@', '@DATA@', '@SCRIPT@', '@PLOT_JS@'):
        expect(place not in text, f'{place} was not filled')
    data = json.loads(
        re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S).group(1)
    )
    expect(
        {'summary', 'curves', 'highlight', 'roughness', 'provenance', 'stages', 'stage_figures'} <= set(data),
        list(data),
    )
    expect(data['chapter'] == '', 'figure numbers are the chapter\'s scenes\' alone')
    steps = data['roughness']['with']
    expect(
        steps['still'] + sum(n for _, _, n in steps['steps']) == 2999, 'a step between any two of 3,000 ticks'
    )
    expect(
        len(steps['spectrum']) == 512 and max(d for _, d in data['curves']['depth']) > 0, 'spectrum and depth'
    )
    # A hand that presses does work, and a contact that only pushes back gives none.
    energy = [e for _, e in data['curves']['energy']]
    expect(min(energy) < 0 and max(energy) < 0.05 * -min(energy), f'{min(energy)} to {max(energy)} J')
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
    small_run(folder, '--duration', '2.4', '--backend', 'gpu')  # touches from 1.8 s on
    gpu = (folder / 'out' / 'trace.csv').read_bytes()
    small_run(folder, '--duration', '2.4', '--backend', 'cpu')
    expect((folder / 'out' / 'trace.csv').read_bytes() == gpu, 'traces differ')
    summary = json.loads((folder / 'out' / 'summary.json').read_text())
    expect(summary['backend'] == 'cpu' and summary['force_max_N'] > 0, summary)


def test_an_interrupt_ends_a_real_time_run_with_whole_files():
    folder = Folder()
    scene = folder.save()
    for number in (signal.SIGINT, signal.SIGTERM):
        out = folder / f'out{number}'
        process = subprocess.Popen(
            [PROGRAM, 'run', str(scene), '--out', str(out)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        deadline = time.monotonic() + 60
        # Without a path the run ends only when it is told to; wait until it has recorded something.
        while time.monotonic() < deadline and not (
            (out / 'trace.csv').exists() and (out / 'trace.csv').stat().st_size > 0
        ):
            expect(process.poll() is None, 'the run ended by itself')
            time.sleep(0.05)
        time.sleep(0.3)
        process.send_signal(number)
        stdout, stderr = process.communicate(timeout=60)
        outcome = Outcome(process.returncode, stdout.decode(), stderr.decode())
        expect(outcome.code == 0, outcome)
        rows = (out / 'trace.csv').read_text()
        expect(rows.endswith('\n') and rows.count('\n') > 100, 'whole rows')
        summary = json.loads((out / 'summary.json').read_text())
        expect(summary['ticks'] == rows.count('\n') - 1, 'summary')
        expect(summary['stopped'] and any('was stopped after' in note for note in summary['notes']), summary)
        expect('was stopped after' in (out / 'report.html').read_text(), 'nobody takes it for a whole run')
        expect((out / 'report.html').read_text().rstrip().endswith('</html>'), 'report')


def test_a_run_goes_over_to_another_profile_and_back():
    folder = Folder()
    folder.write('block.stl', stl(box((0.08, 0.08, 0.04), (0, 0, -0.02))))
    folder.write('ball.stl', stl(sphere(0.01)))
    folder.write(
        'path.csv',
        'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0.012,0,0,0,1,0\n0.3,0,0,0.004,0,0,0,1,0\n1,0,0,0.004,0,0,0,1,0\n',
    )
    scene = folder.save(
        static=[{'mesh': 'block.stl', 'units': 'm'}],
        tool={'mesh': 'ball.stl', 'units': 'm'},
        device={'driver': 'simulated', 'path': 'path.csv'},
    )
    done = palpate(
        'run',
        scene,
        '--pace',
        'asap',
        '--switch',
        '0.5:paper',
        '--switch',
        '0.8:refined',
        '--out',
        folder / 'out',
    )
    expect(done.code == 0, done)
    summary = json.loads((folder / 'out/summary.json').read_text())
    expect(summary['ticks'] == 1001 and summary['missed_ticks'] == 0, summary)
    expect(any('2 times' in note for note in summary['notes']), summary['notes'])
    expect(not summary['stopped'], summary)
    expect(
        [(change['profile'], change['law']) for change in summary['profile_changes']]
        == [('paper', 'printed'), ('refined', 'corrected')],
        summary['profile_changes'],
    )
    expect('; from tick' in done.out, done.out)
    frames = [json.loads(line) for line in open(folder / 'out/frames.jsonl')]
    pushes = lambda first, last: [
        frame['tick'] for frame in frames if first <= frame['tick'] < last and frame['force'][2] > 0
    ]
    expect(pushes(0, 501) and pushes(801, 1001), 'refined pushes, before and after')
    expect(
        pushes(501, 801) == [],
        f'in paper the rays from the block\'s twelve centroids all miss: {pushes(501, 801)}',
    )
    expect(any(frame['contact'] for frame in frames if 501 <= frame['tick'] < 801), 'though there is contact')
    short = palpate(
        'run',
        scene,
        '--pace',
        'asap',
        '--duration',
        '0.4',
        '--switch',
        '0.5:paper',
        '--out',
        folder / 'short',
    )
    expect(short.code == 0 and '--switch 0.5:paper: the run ended before it' in short.err, short)
    expect_refused(
        palpate('run', scene, '--pace', 'asap', '--switch', 'soon:paper', '--out', folder / 'none'),
        3,
        'soon:paper',
    )
    expect_refused(
        palpate('run', scene, '--pace', 'asap', '--switch', '0.5:blue', '--out', folder / 'none'),
        3,
        '0.5:blue',
    )


def test_a_signal_while_a_scene_is_read_or_prepared_ends_the_program_at_once():
    folder = Folder()
    for number in (signal.SIGINT, signal.SIGTERM):
        for step in ('reading the meshes', 'preparing the scene'):
            # A million triangles take seconds, and nothing of them is kept from before.
            scene = folder.save(
                static=[{'generate': {'name': 'disassembly', 'body': 'mockup', 'triangles': 1000000}}]
            )
            process = subprocess.Popen(
                [PROGRAM, 'run', str(scene), '--backend', 'cpu', '--out', str(folder / 'never')],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env={**os.environ, 'PALPATE_CACHE': str(folder / f'cache{number}{step[:4]}')},
            )
            for line in process.stderr:
                if step.encode() in line:
                    break
            process.send_signal(number)
            stdout, stderr = process.communicate(timeout=60)
            expect(
                process.returncode == -number, Outcome(process.returncode, stdout.decode(), stderr.decode())
            )
            expect(not (folder / 'never').exists(), 'no device was opened, so there is no run')


main(globals())
