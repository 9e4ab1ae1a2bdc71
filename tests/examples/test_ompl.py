"""The example for OMPL builds against the installed library and finds a way that `palpate path` finds
clear."""
import os
import subprocess

import pytest
from shapes import EXAMPLES, write_scene

BUILD, PROGRAM = os.environ['PALPATE_BUILD'], os.environ['PALPATE_PROGRAM']


def must(*words, **environment):
    done = subprocess.run(
        [str(word) for word in words],
        capture_output=True,
        text=True,
        timeout=900,
        env={**os.environ, **environment},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope='module')
def way_out(tmp_path_factory):
    folder = tmp_path_factory.mktemp('ompl')
    must('cmake', '--install', BUILD, '--component', 'library', '--prefix', folder / 'prefix')
    found = [str(path.parent) for path in (folder / 'prefix').rglob('palpate.pc')]
    assert len(found) == 1
    must(
        'cmake',
        '-S',
        EXAMPLES / 'ompl',
        '-B',
        folder / 'build',
        '-G',
        'Ninja',
        '-DCMAKE_BUILD_TYPE=Release',
        PKG_CONFIG_PATH=found[0],
    )
    must('cmake', '--build', folder / 'build')
    return folder / 'build/way_out'


def test_a_bar_turns_to_get_through_a_window(way_out, tmp_path):
    # A bar of 60 mm lies across a window that is 24 mm wide and 100 mm high in a wall of 4 mm: straight ahead
    # it can't pass.
    near, far = 0.058, 0.062
    wall = [
        ((near, -0.3, -0.3), (far, -0.012, 0.3)),
        ((near, 0.012, -0.3), (far, 0.3, 0.3)),
        ((near, -0.012, 0.05), (far, 0.012, 0.3)),
        ((near, -0.012, -0.3), (far, 0.012, -0.05)),
    ]
    scene = write_scene(tmp_path, wall, [((-0.005, -0.03, -0.005), (0.005, 0.03, 0.005))])
    (tmp_path / 'straight.csv').write_text('x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,1\n0.12,0,0,0,0,0,1\n')
    assert (
        subprocess.run([PROGRAM, 'path', scene, tmp_path / 'straight.csv'], capture_output=True).returncode
        == 5
    )
    way = must(way_out, scene, 0.12, 0, 0, 300)
    rows = [[float(value) for value in line.split(',')] for line in way.splitlines()[1:]]
    assert len(rows) >= 3 and all(len(row) == 7 for row in rows)
    assert (
        max(abs(a - b) for a, b in zip(rows[0], [0, 0, 0, 0, 0, 0, 1])) < 1e-12
        and max(abs(a - b) for a, b in zip(rows[-1][:3], [0.12, 0, 0])) < 1e-12
    )
    (tmp_path / 'way.csv').write_text(way)
    must(PROGRAM, 'path', scene, tmp_path / 'way.csv')


def test_a_part_that_is_shut_in_has_no_way_out(way_out, tmp_path):
    outer, inner = 0.05, 0.04
    room = []
    for axis in range(3):
        for side in (-1, 1):
            low, high = [-outer] * 3, [outer] * 3
            low[axis], high[axis] = (inner, outer) if side > 0 else (-outer, -inner)
            room.append((low, high))
    scene = write_scene(tmp_path, room, [((-0.005, -0.005, -0.005), (0.005, 0.005, 0.005))])
    done = subprocess.run([way_out, scene, '0.2', '0', '0', '5'], capture_output=True, text=True)
    assert done.returncode == 5 and done.stdout == '' and 'no way within 5 s' in done.stderr
