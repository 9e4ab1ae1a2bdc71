"""Runs every command of README.md, in its order, in one empty folder (all but the two scripts), and holds its
scene file against the program's reader."""
import re
import shlex
import shutil

from harness import *
from server import Server

TEXT = (SOURCE / 'README.md').read_text()
COMMANDS = [
    line.split('#')[0].strip()
    for block in re.findall(r'```sh\n(.*?)```', TEXT, re.S)
    for line in block.splitlines()
]


def test_every_command_of_the_readme_works():
    folder = tempfile.mkdtemp(prefix='palpate-readme-')
    here = os.getcwd()
    os.chdir(folder)
    server, scene, served = None, None, 0
    try:
        for command in COMMANDS:
            words = shlex.split(command)
            if command.endswith('&'):
                expect(words[:2] == ['palpate', 'serve'] and server is None, command)
                server = Server(*words[2:-1])  # on a free port in place of the usual one
            elif words[:1] == ['palpate']:
                outcome = palpate(*words[1:])
                expect(outcome.code == 0, f'{command}: {outcome}')
            elif words[:1] == ['curl']:
                # ID stands for what the upload answered.
                asked = [
                    word.replace('localhost:8090', f'localhost:{server.port}').replace('/ID/', f'/{scene}/')
                    for word in words[1:]
                ]
                done = subprocess.run(
                    ['curl', '-sS', '--fail', '--max-time', '300', *asked], capture_output=True, timeout=400
                )
                expect(done.returncode == 0, f'{command}: {done}')
                scene = scene or json.loads(done.stdout)['id']
                served += 1
        expect(b'"pairs":' in done.stdout and served == 3, done)
        expect((pathlib.Path(folder) / 'run' / 'report.html').is_file(), 'the report that the README names')
    finally:
        os.chdir(here)
        code = server.stop() if server else None
        shutil.rmtree(folder)
    expect(code == 0, f'the server ended with {code}')


def test_the_other_commands_are_scripts_that_exist():
    others = [c.split()[0] for c in COMMANDS if c and c.split()[0] not in ('palpate', 'curl')]
    expect(others == ['scripts/demo', 'scripts/test'], others)
    for script in others:
        expect(os.access(SOURCE / script, os.X_OK), script)


def test_scripts_tell_all_of_their_usage():
    for name in ('test', 'bench', 'bench-haptic', 'gpu-check'):
        script = SOURCE / 'scripts' / name
        head = script.read_text().split('\n', 1)[1].split('\nset -')[0].splitlines()
        told = subprocess.run([script, '--help'], capture_output=True, text=True, timeout=60)
        expect(told.returncode == 0 and 'usage: ' in told.stdout, told)
        expect(told.stdout.splitlines() == [line[2:] for line in head], told.stdout)
    refused = subprocess.run(
        [SOURCE / 'scripts/check-tidy', '-x'], capture_output=True, text=True, timeout=60
    )
    expect(refused.returncode == 2 and refused.stderr.startswith('usage: scripts/check-tidy'), refused)


def test_the_scene_file_of_the_readme_is_read():
    scene = re.search(r'```json\n(.*?)```', TEXT, re.S).group(1)
    folder = Folder()
    folder.write('pull.csv', 'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0,0,0,0,1,1\n')
    # Its mesh is the reader's own, so being asked for that file alone shows that all the rest was understood.
    expect_refused(palpate('plan', folder.write('scene.json', scene)), 3, 'engine.glb')


def test_the_links_of_the_readme_lead_somewhere():
    for target in re.findall(r'\]\(([^)#:]+)\)', TEXT):
        expect((SOURCE / target).exists(), target)


main(globals())
