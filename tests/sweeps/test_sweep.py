"""Sweeps that nothing disturbs, or that are cut short and go on."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys

import numpy
import pytest

import palpate
from cluster import wait_for
from conftest import AXES, ENVIRONMENT
from palpate import PalpateError, Scene
from palpate.sweeps import Grid, sweep
from palpate.sweeps.drive import _CtrlC

BALL = {'radius': 0.7}
GRID = Grid(x=(-1, 1, 40), y=(-1, 1, 40), z=(-1, 1, 20), rx=(0, 90, 3))


def same_poses(start, n):
    return GRID.poses(start, n)


@pytest.fixture(scope='module')
def client():
    from distributed import Client, LocalCluster

    with LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, dashboard_address=':0'
    ) as cluster, Client(cluster) as one:
        yield one


@pytest.fixture
def swept(client, tmp_path):
    """Sweeps into a folder of this test's own, `out`."""

    def do(scene=BALL, poses=GRID, out='out.zarr', size=5000, **more):
        return sweep(scene, poses, out=tmp_path / out, size=size, client=client, quiet=True, **more)

    return do


def test_the_answers_are_those_of_the_scene_in_the_order_of_the_poses(swept):
    done = swept()
    assert done.poses == GRID.count and done.chunks == 20 and done.twice == 1 and done.earlier == 0
    assert (done.answers('touches')[:] == Scene(BALL).touches(GRID.poses(0, GRID.count))).all()


def test_clearance_keeps_a_column_an_array_and_not_who_answered(swept):
    done = swept(ask='clearance')
    poses = GRID.poses(0, GRID.count)
    assert (done.answers('distance')[:] == Scene(BALL).clearance(poses)['distance']).all()
    assert done.answers('on_static').shape == (GRID.count, 3)
    with pytest.raises(KeyError):
        done.answers('engine')


def test_workers_engine_and_where_poses_come_from_leave_the_hash_as_it_is(swept, tmp_path):
    one = swept(out='a.zarr').hash
    assert swept(out='b.zarr', poses=same_poses, count=GRID.count).hash == one
    assert swept(out='c.zarr', poses=GRID.poses(0, GRID.count)).hash == one
    assert swept(out='d.zarr', engine='ref').hash == one
    assert sweep(BALL, GRID, out=tmp_path / 'e.zarr', size=5000, workers=1, quiet=True).hash == one
    assert sweep(BALL, GRID, out=tmp_path / 'f.zarr', size=5000, workers=3, quiet=True).hash == one


def test_another_scene_pose_or_question_has_another_hash(swept):
    shifted = Grid(x=(-1, 1, 40), y=(-1, 1, 40), z=(-1, 1.0000000000000002, 20), rx=(0, 90, 3))
    hashes = {
        swept(out='a.zarr').hash,
        swept(out='b.zarr', scene={'radius': 0.6}).hash,
        swept(out='c.zarr', poses=shifted).hash,
        swept(out='d.zarr', ask='clearance').hash,
    }
    assert len(hashes) == 4


def test_what_was_asked_and_by_whom_stands_in_the_attributes(swept):
    done = swept()
    kept = json.loads((done.path / '.zattrs').read_text())
    assert (
        kept['question']['scene'] == Scene(BALL).hash and kept['question']['palpate'] == palpate.__version__
    )
    assert kept['question']['poses']['x'] == [-1, 1, 40] and kept['shape'] == [40, 40, 20, 3, 1, 1]
    assert kept['engine'] == 'cpu' and kept['engines'] == ['cpu'] and kept['again'] == ['ref']
    assert 'pytest' in kept['command'] and kept['hash'] == done.hash


def test_a_scene_is_made_once_a_worker_not_once_a_chunk_nor_a_sweep(swept, tmp_path):
    logged = {**BALL, 'log': str(tmp_path / 'log'), 'radius': 0.65}
    swept(scene=logged, out='a.zarr', share=0)
    swept(scene=logged, out='b.zarr', share=0)
    made = [line for line in (tmp_path / 'log').read_text().splitlines() if line.split()[1] == 'scene']
    assert len(made) == 3  # the worker's, and the caller's of each sweep
    from palpate.sweeps import worker  # the worker is in this process

    assert worker._jobs == {}


def test_an_engine_that_answers_otherwise_is_told_of_with_chunk_and_pose(swept, tmp_path):
    # x = −1 is 40 · 20 · 3 poses at the beginning: chunk 0, pose 0.
    with pytest.raises(
        PalpateError,
        match=r'chunk 0: pose 0 \(-1.0 -1.0 -1.0 0.0 0.0 0.0 1.0\): touches is False by cpu and True by ref',
    ):
        swept(scene={**BALL, 'wrong': -1.0}, share=1)
    assert not (tmp_path / 'out.zarr/.sweep/0').exists()
    # Asked at their first poses alone, no chunk notices that poses 2400 to 4799 are wrong.
    assert (
        swept(scene={**BALL, 'wrong': GRID.axis('x')[1]}, out='b.zarr', share=1, again_poses=1).chunks == 20
    )


def test_an_engine_beside_itself_is_refused(swept):
    with pytest.raises(PalpateError, match='compare it with itself'):
        swept(again='cpu')


def test_a_folder_of_another_question_is_left_alone(swept):
    done = swept()
    with pytest.raises(
        PalpateError, match="holds another sweep: its ask is \"touches\", this one's is \"clearance\""
    ):
        swept(ask='clearance')
    with pytest.raises(PalpateError, match='its scene is'):
        swept(scene={'radius': 0.6})
    assert swept().earlier == done.chunks


def test_a_folder_of_something_else_is_left_alone(swept, tmp_path):
    (tmp_path / 'out.zarr').mkdir()
    (tmp_path / 'out.zarr/mine').write_text('mine')
    with pytest.raises(PalpateError, match='is no sweep'):
        swept()
    assert os.listdir(tmp_path / 'out.zarr') == ['mine']


def test_a_chunk_without_a_marker_and_one_that_was_spoilt_are_asked_again(swept, tmp_path):
    done = swept()
    before = done.answers('touches')[:]
    (done.path / '.sweep/7').unlink()
    (done.path / 'touches/7').write_bytes(b'half')
    (done.path / 'touches/7.0123.partial').write_bytes(b'h')
    shutil.copy(done.path / 'touches/3', done.path / 'touches/12')  # marked, and another's answers
    (done.path / 'touches/13').unlink()  # marked, and gone
    again = swept()
    assert again.hash == done.hash and (again.answers('touches')[:] == before).all()
    assert not list(done.path.rglob('*.partial'))


def test_a_driver_that_is_killed_goes_on_from_what_is_done(command, tmp_path):
    source = {**BALL, 'pause_s': 0.1, 'log': str(tmp_path / 'log')}
    one = command(source, '--workers', '2', '--share', '0')
    process = one.start()
    wait_for('a few chunks', lambda: len(one.markers()) >= 4)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    # Its workers end when they miss it, with the chunk that they were at.
    wait_for(
        'the end of its workers',
        lambda: not any(
            os.path.exists(f'/proc/{line.split()[0]}') for line in (tmp_path / 'log').read_text().splitlines()
        ),
    )
    before = len(one.markers())
    assert before < 20
    code, out, err = one.run()
    assert code == 0 and f'{before} of 20 chunks were done before' in err, err
    assert f'hash {sweep(BALL, GRID, out=tmp_path / "b.zarr", size=5000, workers=2, quiet=True).hash}' in out


def test_the_command_that_is_installed_sweeps(tmp_path):
    """Its workers are spawned: they read the script that began them, and must not begin a sweep of their own."""
    script = pathlib.Path(__file__).resolve().parents[2] / 'scripts/debian/palpate-sweep'
    scene = tmp_path / 'scene.json'
    scene.write_text(json.dumps(BALL))
    words = [sys.executable, script, scene, '--out', tmp_path / 'out.zarr', *AXES, '--workers', '2']
    done = subprocess.run(words, env=ENVIRONMENT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and 'hash ' in done.stdout, done.stderr[-2000:]


def test_ctrl_c_leaves_what_is_done_and_says_so(command):
    one = command({**BALL, 'pause_s': 0.1}, '--workers', '2')
    process = one.start()
    wait_for('a few chunks', lambda: len(one.markers()) >= 4)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130 and err.splitlines()[-1].startswith('palpate-sweep: stopped'), err
    assert 'Traceback' not in err
    code, out, err = one.run()
    assert code == 0 and 'chunks were done before' in err


def test_ctrl_c_is_not_lost_where_exceptions_are():
    class Ended:
        def __del__(self):
            os.kill(os.getpid(), signal.SIGINT)

    woken = []
    with _CtrlC(lambda: woken.append(True)) as ctrl_c:
        ended = Ended()
        ctrl_c.look()
        del ended  # what it raises nobody hears
        assert woken == [True]
        with pytest.raises(KeyboardInterrupt):
            ctrl_c.look()
        with pytest.raises(KeyboardInterrupt):  # the second one is not waited for
            os.kill(os.getpid(), signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_two_sweeps_do_not_write_to_one_folder_at_once(command):
    one = command({**BALL, 'pause_s': 0.2}, '--workers', '1')
    process = one.start()
    wait_for('a chunk', one.markers)
    code, _, err = one.run()
    assert code == 3 and 'another sweep is writing here' in err
    process.kill()
    process.communicate()


@pytest.mark.parametrize(
    'words, code, said',
    [
        (['--poses', 'none.npy'], 2, 'say which poses'),
        (['--ask', 'force'], 2, "'force'"),
        (['--x', '1:2'], 2, "'1:2'"),
        (['--share', '2'], 3, 'share'),
        (['--size', '0'], 3, 'size'),
        (['--within', '0.1'], 3, 'clearance'),
        (['--engine', 'gpu'], 4, 'no GPU'),
        (['--workers', '0'], 3, 'it is 0'),
        (['--size', '16777217'], 3, '1 to 16777216'),
        (['--x=-1e308:1e308:3'], 3, 'axis x'),
        (['--x', '0:1:3000000', '--y', '0:1:3000000', '--z', '0:1:3000000'], 3, 'too large'),
        (['--x', '0:1:100000', '--y', '0:1:100000', '--size', '1'], 3, 'make size larger'),
        (['--out', '/proc/none.zarr'], 3, "can't write there"),
    ],
)
def test_the_command_refuses_bad_input_in_one_sentence(command, words, code, said):
    asked = command(BALL, *words)
    got, out, err = asked.run()
    assert got == code and said in err.splitlines()[-1] and out == '' and 'Traceback' not in err, err
    assert not asked.out.exists(), 'what was refused has claimed the folder'


def test_a_question_that_differs_in_one_axis_is_refused_by_its_name(swept):
    swept()
    with pytest.raises(
        PalpateError, match=r"its poses z is \[-1.0, 1.0, 20\], this one's is \[-1.0, 1.0, 21\]"
    ):
        swept(poses=Grid(x=(-1, 1, 40), y=(-1, 1, 40), z=(-1, 1, 21), rx=(0, 90, 3)))


def test_a_scheduler_whose_file_never_comes_is_told_in_a_sentence(tmp_path, monkeypatch, capsys):
    from palpate.sweeps import cli, drive

    monkeypatch.setattr(drive, 'PATIENCE_S', 0.5)
    file = str(tmp_path / 'none.json')
    words = ['scene.json', '--out', str(tmp_path / 'out.zarr'), '--x', '0', '--scheduler-file', file]
    assert cli.main(words) == 3
    err = capsys.readouterr().err.splitlines()
    assert err == [
        f'palpate-sweep: waiting for {file}',
        f'palpate-sweep: no scheduler at {file}: there is no such file',
    ]


@pytest.mark.parametrize(
    'wrong',
    [{'size': 8.5}, {'size': '8'}, {'workers': 1.5}, {'share': 'a'}, {'again_poses': 2.5}, {'again': 'xyz'}],
)
def test_a_setting_of_another_type_is_refused_before_anything_is_made(wrong, tmp_path):
    with pytest.raises(PalpateError, match=next(iter(wrong))):
        sweep(Scene(BALL), Grid(x=0), out=tmp_path / 'out.zarr', **wrong)
    assert not (tmp_path / 'out.zarr').exists()
