"""Runs every `palpate` command of README.md, in its order, in one empty folder, and holds its scene file against the program's reader."""
import re
import shlex

from harness import *

TEXT = (SOURCE / 'README.md').read_text()
COMMANDS = [line.split('#')[0].strip() for block in re.findall(r'```sh\n(.*?)```', TEXT, re.S) for line in block.splitlines()]


def test_every_palpate_command_of_the_readme_works():
    folder = tempfile.mkdtemp(prefix='palpate-readme-')
    ours = [c for c in COMMANDS if c.startswith('palpate ')]
    expect(len(ours) >= 5, COMMANDS)
    for command in ours:
        outcome = palpate(*shlex.split(command)[1:], cwd=folder)
        expect(outcome.code == 0, f'{command}: {outcome}')
    expect((pathlib.Path(folder) / 'run' / 'report.html').is_file(), 'the report that the README names')


def test_the_other_commands_are_scripts_that_exist():
    others = [c.split()[0] for c in COMMANDS if c and not c.startswith('palpate ')]
    expect(others == ['scripts/demo', 'scripts/test'], others)
    for script in others:
        expect(os.access(SOURCE / script, os.X_OK), script)


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
