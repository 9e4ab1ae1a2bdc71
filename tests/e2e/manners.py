"""Manners of the command line: what a person at a terminal sees, what is checked before long work, what is
never lost without a word, help, completions, manual."""
import pty
import re
import select
import shlex
import shutil
import signal

from harness import *

CLI = (
    'run',
    'query',
    'path',
    'compare',
    'plan',
    'info',
    'generate',
    'devices',
    'serve',
    'tune',
    'bench',
    'completions',
    'man',
)


def at_terminal(*arguments, until=None, cwd=None, both=True, apart_s=()):
    """What the program writes to a terminal (standard output and error; without `both` error is kept apart),
    and its exit code. `until`: words after which it is sent SIGINT, and again after each of the times."""
    ours, its = pty.openpty()
    process = subprocess.Popen(
        [PROGRAM, *map(str, arguments)],
        stdin=subprocess.DEVNULL,
        stdout=its,
        stderr=its if both else subprocess.DEVNULL,
        cwd=cwd,
        env={**os.environ, 'TERM': 'xterm'},
    )
    os.close(its)
    said, end = b'', time.monotonic() + TIMEOUT_S
    while time.monotonic() < end:
        if not select.select([ours], [], [], 1)[0]:
            continue
        try:
            piece = os.read(ours, 65536)
        except OSError:  # the terminal's other end is closed
            break
        said += piece
        if until and until in said:
            process.send_signal(signal.SIGINT)
            for wait in apart_s:
                time.sleep(wait)
                process.send_signal(signal.SIGINT)
            until = None
    code = process.wait(TIMEOUT_S)
    os.close(ours)
    return code, said.decode()


def pressed(folder):
    """A scene whose tool is at z = 18 mm, 2 mm deep."""
    return folder.save(), '0 0 0.018 0 0 0 1'


def test_a_long_bench_of_a_force_ends_when_asked():
    folder = Folder()
    scene = folder.save()
    poses = folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n0,0,0.018,0,0,0,1\n0.002,0,0.018,0,0,0,1\n')
    asked = ('bench', 'force', scene, '--poses', poses, '--frames', '100000', '--out', folder / 'out')
    code, said = at_terminal(*asked, until=b'poses')
    expect(code == 1 and 'interrupted' in said and not (folder / 'out').exists(), said)


def test_signals_at_once_are_one():
    """As `timeout` sends them, to the program and to its group."""
    folder = Folder()
    scene = folder.save()
    poses = folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n0,0,0.018,0,0,0,1\n0.002,0,0.018,0,0,0,1\n')
    asked = ('bench', 'force', scene, '--poses', poses, '--frames', '100000', '--out', folder / 'out')
    code, said = at_terminal(*asked, until=b'poses', apart_s=5 * (0.001,))
    expect(code == 1 and 'interrupted' in said, f'exit {code}: {said}')


def test_verdicts_that_are_interrupted_print_what_they_say_was_answered():
    folder = Folder()
    scene = folder.save()
    rows = ''.join(f'0,0,{0.04 + 1e-8 * i},0,0,0,1\n' for i in range(1_000_000))
    poses = folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n' + rows)
    code, said = at_terminal('query', scene, '--poses', poses, '--clearance', until=b'"number"')
    answered = re.search(r'interrupted after (\d+) of 1000000 poses', said)
    expect(code == 1 and answered, said[-500:])
    expect(int(answered[1]) == said.count('"number"'), (answered[0], said.count('"number"')))


def test_a_bench_of_stability_ends_when_asked():
    folder = Folder()
    code, said = at_terminal('bench', 'stability', folder.save(), '--out', folder / 'out', until=b'formulas')
    expect(code == 1 and 'interrupted' in said and not (folder / 'out').exists(), said)


def test_a_query_at_a_terminal_is_for_people_and_elsewhere_for_programs():
    folder = Folder()
    scene, pose = pressed(folder)
    code, said = at_terminal('query', scene, '--pose', pose, '--names', both=False)
    expect(code == 0 and '{' not in said, said)
    for words in (
        'pairs of triangles, 1 area',
        'force',
        ' N in all',
        'felt by a hand at rest there',
        'mm deep, along',
        'mock-up    block',
        'tool       ball',
    ):
        expect(words in said, f'{words}: {said}')
    expect(max(map(len, said.splitlines())) < 200, said)
    (line,) = lines_of(palpate('query', scene, '--pose', pose))
    expect(f"{line['pairs']} pairs" in said and line['contact'], said)
    expect(float(re.search(r'([0-9.]+) N in all', said)[1]) > 0.9 * math.hypot(*line['force']), said)
    code, said = at_terminal('query', scene, '--pose', pose, '--json', both=False)
    expect(code == 0 and json.loads(said)['pairs'] == line['pairs'], said)


def test_poses_at_a_terminal_are_a_table():
    folder = Folder()
    scene, _ = pressed(folder)
    folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n0,0,0.018,0,0,0,1\n0,0,9,0,0,0,1\n')
    code, said = at_terminal('query', scene, '--poses', folder / 'poses.csv', both=False)
    head, touching, free = said.replace('\r', '').splitlines()
    expect(code == 0 and head.split()[:2] == ['pose', 'pairs'], said)
    expect(touching.split()[0] == '0' and int(touching.split()[1]) > 0, said)
    expect(free.split()[:3] == ['1', '0', '0'], said)


def test_a_line_tells_number_and_pose_as_pose_takes_it():
    folder = Folder()
    scene, pose = pressed(folder)
    (line,) = lines_of(palpate('query', scene, '--pose', pose))
    expect(line['number'] == 0 and line['pose'] == [0, 0, 0.018, 0, 0, 0, 1], line)
    (again,) = lines_of(palpate('query', scene, '--pose', ' '.join(map(str, line['pose']))))
    expect(again['force'] == line['force'], again)


def test_a_run_replaces_no_other_without_being_told():
    folder = Folder()
    scene = folder.save()
    words = (
        'run',
        scene,
        '--pace',
        'asap',
        '--duration',
        '0.02',
        '--backend',
        'cpu',
        '--out',
        folder / 'out',
    )
    expect(palpate(*words).code == 0, 'the first')
    before = {file.name: file.read_bytes() for file in (folder / 'out').iterdir()}
    expect_refused(palpate(*words), 3, '--out', 'already', '--overwrite')
    # Before anything is read: a scene that does not exist gives the same sentence.
    expect_refused(palpate('run', folder / 'none.json', '--out', folder / 'out'), 3, '--overwrite')
    expect(
        {file.name: file.read_bytes() for file in (folder / 'out').iterdir()} == before, 'files were touched'
    )
    expect(palpate(*words, '--overwrite').code == 0, 'told')
    # A folder with other things in it is no run.
    folder.write('other/notes.txt', 'mine')
    expect(
        palpate(*words[:-1], folder / 'other').code == 0
        and (folder / 'other' / 'notes.txt').read_text() == 'mine',
        'another folder',
    )


def test_no_command_replaces_files_without_being_told():
    folder = Folder()
    scene, pose = pressed(folder)
    folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n0,0,9,0,0,0,1\n0,0,8,0,0,0,1\n')
    for name, words in (
        (
            'bench',
            (
                'bench',
                'latency',
                scene,
                '--poses',
                folder / 'poses.csv',
                '--frames',
                '2',
                '--rounds',
                '1',
                '--backend',
                'cpu',
            ),
        ),
        ('path', ('path', scene, folder / 'poses.csv', '--backend', 'cpu')),
        ('generate', ('generate', 'contacts', '--triangles', '2000', '--tool-triangles', '1000')),
    ):
        out = folder / name
        expect(palpate(*words, '--out', out).code == 0, name)
        before = {file.name: (file.read_bytes(), file.stat().st_mtime_ns) for file in out.iterdir()}
        expect_refused(
            palpate(*words, '--out', out),
            3,
            f'--out {out}: ',
            'are there already',
            'name another folder, or say --overwrite',
        )
        expect(
            {file.name: (file.read_bytes(), file.stat().st_mtime_ns) for file in out.iterdir()} == before,
            f'{name}: files were touched',
        )
        told = palpate(*words, '--out', out, '--overwrite')
        expect(
            told.code == 0 and any(file.stat().st_mtime_ns != before[file.name][1] for file in out.iterdir()),
            told,
        )
    # Nothing is read first: a scene that does not exist gives the same sentence.
    for words in (
        ('bench', 'latency', folder / 'none.json', '--out', folder / 'bench'),
        ('path', folder / 'none.json', folder / 'none.csv', '--out', folder / 'path'),
    ):
        expect_refused(palpate(*words), 3, '--overwrite')


def test_a_device_that_cannot_be_opened_leaves_no_folder():
    folder = Folder()
    scene = folder.save()
    no_usb = {'PATH': os.environ['PATH']}
    for words in ((), ('--out', folder / 'deep' / 'out')):
        outcome = palpate(
            'run', scene, '--device', 'spacemouse', '--backend', 'cpu', *words, cwd=folder.path, **no_usb
        )
        expect(outcome.code == 4, f'expected exit 4 for a device that is not here: {outcome}')
        made = sorted(p.name for p in folder.path.iterdir() if p.is_dir())
        expect(made == [], made)
    # One that was there stays, with what was in it.
    folder.write('mine/notes.txt', 'mine')
    expect(
        palpate('run', scene, '--device', 'spacemouse', '--backend', 'cpu', '--out', folder / 'mine').code
        == 4,
        'exit 4',
    )
    expect([p.name for p in (folder / 'mine').iterdir()] == ['notes.txt'], list((folder / 'mine').iterdir()))


def test_a_run_without_a_terminal_gives_signs_of_life():
    folder = Folder()
    # By the clock, a line every 10 s.
    outcome = palpate('run', folder.save(), '--backend', 'cpu', '--duration', '21', '--out', folder / 'out')
    expect(outcome.code == 0, outcome)
    signs = re.findall(r'^palpate: +([0-9.]+) s  .* N ', outcome.err, re.M)
    expect(len(signs) >= 1 and all(0 < float(s) <= 21.1 for s in signs), outcome.err)


def test_quiet_says_nothing_but_the_result_and_errors():
    folder = Folder()
    scene, pose = pressed(folder)
    loud, quiet = (palpate('query', scene, '--pose', pose, *words) for words in ((), ('--quiet',)))
    expect(loud.err != '' and quiet.err == '' and quiet.code == 0, quiet)
    expect(json.loads(loud.out)['force'] == json.loads(quiet.out)['force'], quiet)
    done = palpate(
        'run',
        scene,
        '-q',
        '--pace',
        'asap',
        '--duration',
        '0.02',
        '--backend',
        'cpu',
        '--out',
        folder / 'out',
    )
    expect(done.code == 0 and done.err == '' and 'report' in done.out, done)
    expect_refused(palpate('query', folder / 'none.json', '--pose', pose, '-q'), 3, 'none.json')


def test_info_tells_what_it_can_read_whatever_becomes_of_the_others():
    folder = Folder()
    for words in ((), ('--json',)):
        outcome = palpate(
            'info',
            folder / 'block.stl',
            folder / 'missing.stl',
            folder / 'ball.stl',
            folder / 'gone.stl',
            *words,
        )
        expect(outcome.code == 3, outcome)
        for name in ('block.stl', 'ball.stl'):
            expect(name in outcome.out, outcome)
        for name in ('missing.stl', 'gone.stl'):
            expect(name not in outcome.out and name in outcome.err, outcome)
        expect(len(outcome.err.splitlines()) == 2, outcome)
        if words:
            expect(
                [pathlib.Path(mesh['file']).name for mesh in json.loads(outcome.out)['meshes']]
                == ['block.stl', 'ball.stl'],
                outcome,
            )
    expect_refused(palpate('info', folder / 'missing.stl'), 3, 'missing.stl')


def test_bench_looks_at_its_folder_before_it_measures():
    folder = Folder()
    folder.write('file', 'no folder')
    # The scene does not exist, and yet the folder is what is told: nothing was read, nothing measured.
    for words in (
        ('latency', folder / 'none.json'),
        ('numerics',),
        ('stability',),
        ('plan',),
        ('scale',),
        ('error',),
        ('force',),
    ):
        expect_refused(palpate('bench', *words, '--out', folder / 'file' / 'deep'), 3, '--out', 'no folder')
    expect_refused(palpate('bench', 'latency', folder / 'none.json', '--out', folder / 'new'), 3, 'none.json')
    expect(not (folder / 'new').exists(), 'nothing is made before there is something to write')


def test_a_server_at_a_terminal_tells_its_address_in_words():
    folder = Folder()
    code, said = at_terminal(
        'serve', '--listen', '127.0.0.1:0', '--backend', 'cpu', '--root', folder.path, until=b'Ctrl-C ends'
    )
    expect(code == 0 and '{' not in said, said)
    expect(re.search(r'the viewer is at http://127\.0\.0\.1:[1-9]\d*/ for a browser', said), said)
    code, said = at_terminal(
        'serve', '--listen', '127.0.0.1:0', '--backend', 'cpu', '--log', 'json', until=b'listening'
    )
    for line in said.splitlines():
        if line.startswith('{'):
            expect('event' in json.loads(line), line)
    expect(code == 0 and re.search(r'"url":"http://127\.0\.0\.1:[1-9]\d*/"', said), said)


def test_there_is_one_first_tour():
    tour = [
        re.split(r'  +', line.strip())[0]
        for line in palpate('--help')
        .out.split('A first quarter of an hour')[1]
        .split('\n\n')[0]
        .splitlines()[1:]
    ]
    text = (SOURCE / 'README.md').read_text().split('## Your own mock-up')[1]
    readme = [
        line.split('#')[0].strip() for line in re.search(r'```sh\n(.*?)```', text, re.S)[1].splitlines()
    ]
    expect(len(tour) == 6 and tour == readme, f'{tour}\n{readme}')


def test_the_demo_tells_how_to_call_the_program():
    demo = (SOURCE / 'scripts' / 'demo').read_text()
    told = demo.split('cat <<END')[1].split('END')[0]
    expect('export PATH="$PWD/build/demo/bin:\\$PATH"' in told and 'report.html' in told, told)
    # The command that it prints makes `palpate` a command.
    line = next(line for line in told.splitlines() if 'export PATH' in line)
    printed = subprocess.run(
        ['bash', '-c', f'cat <<END\n{line}\nEND'], cwd=SOURCE, capture_output=True, text=True
    ).stdout
    shown = subprocess.run(['bash', '-c', printed + '\necho "$PATH"'], capture_output=True, text=True).stdout
    expect(shown.startswith(f'{SOURCE}/build/demo/bin:'), shown)
    expect('export PATH="$PWD/build/demo/bin:$PATH"' in (SOURCE / 'README.md').read_text(), 'README')


def test_help_version_and_environment():
    for words in (('help',), ('--help',), ('-h',)):
        expect(palpate(*words).out == palpate('--help').out, words)
    for command in CLI:
        expect(palpate('help', command).out == palpate(command, '--help').out != '', command)
    latency = palpate('help', 'bench', 'latency').out
    expect('--frames' in latency and 'palpate bench latency' in latency, latency)
    expect_refused(palpate('help', 'qurey'), 2, "did you mean 'query'?")
    short, long = palpate('-V').out, palpate('--version').out
    expect(
        short == long
        and re.fullmatch(
            r'palpate \d+\.\d+\.\d+, commit (unknown|[0-9a-f]{12}(-dirty)?), engines gpu, cpu, ref\n', short
        ),
        short,
    )
    help_text = palpate('--help').out
    for name in ('PALPATE_CACHE', 'XDG_CACHE_HOME', 'LP_NUM_THREADS', 'TERM', 'TMPDIR'):
        expect(name in help_text, name)


def test_mistyped_options_are_told_what_was_meant():
    expect_refused(
        palpate('query', 'x.json', '--pse', '0 0 0 0 0 0 1'),
        2,
        "'--pse' is no option of palpate query",
        "did you mean '--pose'?",
        'palpate query --help',
    )
    expect_refused(palpate('run', 'x.json', '--bakcend=cpu'), 2, "'--bakcend'", "did you mean '--backend'?")
    expect_refused(palpate('run', 'x.json', '-device', 'falcon'), 2, "did you mean '--device'?")
    expect_refused(palpate('serve', '--max-conn', '3'), 2, "did you mean '--max-connections'?")
    expect_refused(
        palpate('bench', 'latency', 'x.json', '--out', 'o', '--round', '3'),
        2,
        "no option of palpate bench latency",
        "did you mean '--rounds'?",
    )
    unlike = palpate('query', 'x.json', '--frobnicate')
    expect_refused(unlike, 2, "'--frobnicate' is no option of palpate query")
    expect('did you mean' not in unlike.err, unlike)
    expect_refused(
        palpate('query', 'x.json', 'y.json', '--pose', '0 0 0 0 0 0 1'),
        2,
        "takes no further argument 'y.json'",
    )


def completed(*words):
    """What bash offers for the last of the words."""
    script = palpate('completions', 'bash').out
    expect(script != '', 'a script')
    line = ' '.join(shlex.quote(w) for w in words)
    done = subprocess.run(
        [
            'bash',
            '--norc',
            '-c',
            (
                f'{script}\nCOMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _palpate; printf "%s\\n"'
                ' "${COMPREPLY[@]}"'
            ),
        ],
        capture_output=True,
        text=True,
        cwd='/',
    )
    expect(done.returncode == 0 and done.stderr == '', done)
    return done.stdout.split()


def options_of(*command):
    """By the help's lines: "  -h,--help   …", "  --out DIR …"."""
    text = palpate(*command, '--help').out
    return set(
        re.findall(
            r'(?:^  |,)(--?[a-z][a-z-]*)',
            '\n'.join(
                line[:60]
                for line in text.split('Options:')[1].split('Subcommands:')[0].splitlines()
                if re.match(r'  -', line)
            ),
            re.M,
        )
    )


def test_bash_completes_commands_options_and_their_words():
    expect(set(CLI) == set(completed('palpate', '')), completed('palpate', ''))
    expect(completed('palpate', 'qu') == ['query'], completed('palpate', 'qu'))
    for command in (('run',), ('query',), ('serve',), ('bench', 'latency')):
        expect(
            set(completed('palpate', *command, '-')) == options_of(*command),
            f"{command}: {set(completed('palpate', *command, '-')) ^ options_of(*command)}",
        )
    expect(
        completed('palpate', 'run', 'scene.json', '--backend', '') == ['auto', 'gpu', 'cpu', 'ref'], 'words'
    )
    expect(completed('palpate', 'run', '--pace', 'as') == ['asap'], 'words')
    expect(completed('palpate', 'generate', '') == ['contacts', 'disassembly'], 'words of an argument')
    expect(completed('palpate', 'completions', 'z') == ['zsh'], 'words of an argument')
    expect(completed('palpate', 'man', '') == [], 'an argument that is neither words nor a file')
    expect(
        'latency' in completed('palpate', 'bench', '')
        and completed('palpate', 'bench', 'latency', '--clock', 'c') == ['cpu'],
        'bench',
    )
    # `plan` is a command, and one of bench's.
    expect(
        '--json' in completed('palpate', 'plan', '--')
        and '--rounds' in completed('palpate', 'bench', 'plan', '--'),
        'plan',
    )
    expect(
        'usr' in completed('palpate', 'run', '--out', 'us') and 'usr' in completed('palpate', 'run', 'us'),
        'files',
    )


def test_zsh_and_fish_take_their_scripts():
    for shell in ('zsh', 'fish'):
        expect(shutil.which(shell), f'{shell} is missing (scripts/packages.txt has it in the group test)')
    folder = Folder()
    script = folder.write('_palpate', palpate('completions', 'zsh').out)
    done = subprocess.run(
        [
            'zsh',
            '-f',
            '-c',
            (
                f'autoload -Uz compinit; compinit -u -d {folder / "dump"}; source {script}; whence -w'
                ' _palpate _palpate_run _palpate_bench_latency'
            ),
        ],
        capture_output=True,
        text=True,
    )
    expect(done.returncode == 0 and done.stderr == '' and done.stdout.count('function') == 3, done)
    script = folder.write('palpate.fish', palpate('completions', 'fish').out)

    def fish(line):
        done = subprocess.run(
            ['fish', '--no-config', '-c', f'source {script}; complete --do-complete {shlex.quote(line)}'],
            capture_output=True,
            text=True,
            env={**os.environ, 'HOME': str(folder.path)},
        )
        expect(done.returncode == 0 and done.stderr == '', done)
        return [answer.split('\t')[0] for answer in done.stdout.splitlines()]

    expect(set(CLI) <= set(fish('palpate ')), fish('palpate '))
    expect(
        '--backend' in fish('palpate run --')
        and fish('palpate run --backend ') == ['auto', 'cpu', 'gpu', 'ref'],
        fish('palpate run --'),
    )
    expect(
        '--json' in fish('palpate plan --')
        and '--json' not in fish('palpate bench plan --')
        and '--rounds' in fish('palpate bench plan --'),
        fish('palpate bench plan --'),
    )


def test_manual_pages_are_of_the_same_options():
    folder = Folder()
    expect(palpate('man', '--out', folder / 'man').code == 0, 'man --out')
    pages = {path.name: path.read_text() for path in (folder / 'man').iterdir()}
    expect(set(pages) == {'palpate.1'} | {f'palpate-{command}.1' for command in CLI}, sorted(pages))
    for command in CLI:
        page = pages[f'palpate-{command}.1']
        expect(palpate('man', command).out == page, command)
        for option in options_of(command):
            expect(option.replace('-', '\\-') in page, f'{command}: {option}')
    expect(
        'PALPATE_CACHE' in pages['palpate.1'] and 'Exit codes' in pages['palpate.1'],
        'environment and exit codes',
    )
    for name in pages:  # what man would warn of
        shown = subprocess.run(
            ['groff', '-K', 'utf8', '-man', '-ww', '-Tutf8', '-P-cbou', str(folder / 'man' / name)],
            capture_output=True,
            text=True,
        )
        expect(
            shown.returncode == 0 and shown.stderr == '' and 'NAME' in shown.stdout, f'{name}: {shown.stderr}'
        )
    expect_refused(palpate('man', 'qurey'), 2, "'qurey'")


main(globals())
