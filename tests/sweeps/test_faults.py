"""Workers that are killed, a scheduler that goes, a disk that is full: a sweep ends with the hash of an
undisturbed one."""
import os
import resource
import signal

import pytest

import palpate
from cluster import Cluster, wait_for
from conftest import ENVIRONMENT
from palpate.sweeps import Grid, sweep

BALL = {'radius': 0.7}
GRID = Grid(x=(-1, 1, 40), y=(-1, 1, 40), z=(-1, 1, 20), rx=(0, 90, 3))


@pytest.fixture(scope='module')
def undisturbed(tmp_path_factory):
    """The hashes of sweeps that nothing disturbs, by what they ask."""
    folder = tmp_path_factory.mktemp('undisturbed')
    return {
        ask: sweep(BALL, GRID, ask=ask, out=folder / f'{ask}.zarr', size=5000, workers=1, quiet=True).hash
        for ask in ('touches', 'clearance')
    }


def at_work(log):
    """The process that began a batch last and is still at it, or None."""
    begun = {}
    for line in log.read_text().splitlines() if log.exists() else ():
        pid, what, _ = line.split()
        begun.pop(pid, None)
        if what == 'begin' and int(pid) != os.getpid() and os.path.exists(f'/proc/{pid}'):
            begun[pid] = True
    return int(list(begun)[-1]) if begun else None


def counted(command, out, undisturbed):
    """The sweep is whole, with every chunk once, and its hash is that of an undisturbed one."""
    assert command.markers() == list(range(20))
    assert '96,000 poses in 20 chunks' in out and f'hash {undisturbed}' in out


def test_a_worker_killed_in_mid_chunk_costs_that_chunk_alone(command, undisturbed, tmp_path):
    log = tmp_path / 'log'
    one = command({**BALL, 'pause_s': 0.3, 'log': str(log)}, '--workers', '2')
    process = one.start()
    wait_for('a few chunks', lambda: len(one.markers()) >= 4)
    wait_for('a worker in mid-chunk', lambda: at_work(log) not in (None, process.pid))
    os.kill(at_work(log), signal.SIGKILL)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    counted(one, out, undisturbed['touches'])
    batches = sum(line.split()[1] == 'begin' for line in log.read_text().splitlines())
    # The pose by itself, 20 chunks, one of them twice, and what the killed worker's two threads were at.
    assert 1 + 20 + 1 + 1 <= batches <= 1 + 20 + 1 + 3


def test_a_scheduler_that_is_killed_and_comes_back_loses_nothing(command, undisturbed, tmp_path):
    with Cluster(tmp_path / 'cluster', environment=ENVIRONMENT) as cluster:
        one = command({**BALL, 'pause_s': 0.3}, '--scheduler', cluster.address)
        process = one.start()
        wait_for('a few chunks', lambda: len(one.markers()) >= 3)
        cluster.kill('scheduler')
        out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    assert 'the scheduler is back' in err
    counted(one, out, undisturbed['touches'])


def test_workers_that_come_late_and_are_killed_are_made_good(command, undisturbed, tmp_path):
    with Cluster(tmp_path / 'cluster', workers=0) as cluster:
        one = command({**BALL, 'pause_s': 0.2}, '--scheduler', cluster.address)
        process = one.start()
        wait_for('the folder', lambda: (one.out / '.zattrs').exists())
        cluster.add_worker(ENVIRONMENT)
        wait_for('a few chunks', lambda: len(one.markers()) >= 3)
        cluster.kill('worker-0')
        out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    counted(one, out, undisturbed['touches'])


def test_a_chunk_that_ends_its_workers_ends_the_sweep_in_a_sentence(command, monkeypatch):
    # Dask gives up at the fourth worker; for speed here at the first.
    monkeypatch.setitem(ENVIRONMENT, 'DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES', '0')
    code, out, err = command(
        {**BALL, 'crash': -1.0}, '--workers', '1', '--share', '0', '--rz=1', '--size=96000'
    ).run()
    # Dask's dying processes may print tracebacks of theirs; none goes through the sweep.
    assert (
        code == 3
        and 'palpate-sweep: chunk 0 ended every worker that took it' in err
        and 'palpate/sweeps/' not in err
    ), err


def test_a_full_disk_is_said_in_a_sentence_and_the_same_command_goes_on(command, undisturbed):
    # A limit on a file's length stands for the disk's: what is asked fits, a chunk's 20 kB of distances
    # don't.
    one = command(BALL, '--workers', '2', '--ask', 'clearance')
    code, out, err = one.run(
        preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_FSIZE, (8000, resource.getrlimit(resource.RLIMIT_FSIZE)[1])
        )
    )
    assert code == 3 and out == '' and one.markers() == []
    assert (
        'out.zarr: no room to write (File too large); make room and give the same command again'
        in err.splitlines()[-1]
    ), err
    assert 'Traceback' not in err
    code, out, err = one.run()
    assert code == 0, err
    counted(one, out, undisturbed['clearance'])
