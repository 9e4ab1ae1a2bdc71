"""A sweep that everything befalls, against one that nothing does.

    sweep_faults.py [--poses 2e7] [--folder DIR] [--tmpfs]

Sweeps a generated scene (contacts, 5,000 and 1,000 triangles) three times: by one Dask worker, by two, each
on a processor of its own, and by two again while a worker is killed with -9 in mid-chunk, the scheduler is
killed with -9 and started again, and the disk is filled until the sweep stops, emptied, and the sweep called
again. Prints seconds and rates, and fails unless all three have the same hash, every chunk one marker, and
the answers the same bytes. A quiet machine gives the times; load does not change the hash. --tmpfs: DIR is a
small file system of its own, mounted here (needs the right to: unshare -rm), so that full is full; else a
limit on the workers' files stands for it. PYTHONPATH names palpate, as of a build tree: BUILD/python.
"""
import argparse
import hashlib
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / 'tests/sweeps'))
from cluster import Cluster, wait_for

import palpate


class Sweep:
    """A call of palpate-sweep and its folder."""

    def __init__(self, scene, axes, out, address):
        self.out = out
        self._words = [
            sys.executable,
            '-m',
            'palpate.sweeps',
            scene,
            '--out',
            str(out),
            '--scheduler',
            address,
            *axes,
        ]

    def start(self):
        return subprocess.Popen(self._words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def markers(self):
        folder = self.out / '.sweep'
        return len([file for file in folder.iterdir() if file.name.isdigit()]) if folder.is_dir() else 0

    def result(self, process):
        """Exit code, hash or None, what it said."""
        out, err = process.communicate()
        found = re.search(r'hash (\w{64})', out)
        return process.returncode, found and found.group(1), out + err

    def bytes(self):
        """A hash of all answers, by their numbers alone."""
        import zarr

        return hashlib.sha256(zarr.open_group(str(self.out), mode='r')['touches'][:].tobytes()).hexdigest()


def undisturbed(scene, axes, folder, workers, processors):
    """Seconds from a warm cluster's first chunk to the end, and the sweep."""
    with Cluster(folder / f'cluster-{workers}', workers, processors) as cluster:
        # The workers start and prepare the scene: one short sweep that isn't timed.
        warm = Sweep(
            scene,
            ['--x=0:0.01:64', '--size=1', '--share=0'],
            folder / f'warm-{workers}.zarr',
            cluster.address,
        )
        code, _, said = warm.result(warm.start())
        assert code == 0, said
        sweep = Sweep(scene, axes, folder / f'whole-{workers}.zarr', cluster.address)
        began, before = time.monotonic(), os.times()
        code, value, said = sweep.result(sweep.start())
        seconds = time.monotonic() - began
        assert code == 0, said
        print(
            f'{workers} worker(s): {seconds:.1f} s in all; {said.splitlines()[0].split("; ")[-1]}', flush=True
        )
        return sweep, value, float(re.search(r'([\d,]+) poses a second', said).group(1).replace(',', ''))


def fill(folder, cluster, whole):
    """No more room: a file takes it (tmpfs), or the workers' files may be no longer than a byte."""
    if whole:
        with open(folder / 'filler', 'wb', buffering=0) as file:
            try:
                while True:
                    file.write(bytes(4096))
            except OSError:
                return lambda: (folder / 'filler').unlink()
    pids = [cluster.pid(name) for name in ('worker-0', 'worker-1')]
    for pid in pids:
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (1, resource.RLIM_INFINITY))
    return lambda: [
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2) for pid in pids
    ]


def disturbed(scene, axes, folder, processors, chunks, tmpfs):
    with Cluster(folder / 'cluster-disturbed', 2, processors) as cluster:
        sweep = Sweep(scene, axes, folder / 'disturbed.zarr', cluster.address)
        process = sweep.start()
        wait_for('a tenth of the chunks', lambda: sweep.markers() >= max(1, chunks // 10), 3600)
        cluster.kill('worker-0')  # a worker is always in a chunk: writing one takes a hundredth of asking it
        print(f'a worker is killed after {sweep.markers()} chunks', flush=True)
        wait_for('a quarter', lambda: sweep.markers() >= chunks // 4, 3600)
        cluster.kill('scheduler')
        print(f'the scheduler is killed after {sweep.markers()} chunks', flush=True)
        wait_for('half', lambda: sweep.markers() >= chunks // 2, 3600)
        empty = fill(folder, cluster, tmpfs)
        print(f'the disk is filled after {sweep.markers()} chunks', flush=True)
        code, _, said = sweep.result(process)
        assert code == 3 and 'no room to write' in said.splitlines()[-1], said
        print(said.splitlines()[-1], flush=True)
        empty()
        code, value, said = sweep.result(sweep.start())
        assert code == 0, said
        print(said.splitlines()[0])
        return sweep, value


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('--poses', type=float, default=2e7)
    parser.add_argument('--folder')
    parser.add_argument('--tmpfs', action='store_true')
    parser.add_argument('--size', type=int, default=1 << 16)
    asked = parser.parse_args()
    folder = pathlib.Path(asked.folder or tempfile.mkdtemp(prefix='palpate-sweep-'))
    folder.mkdir(parents=True, exist_ok=True)
    if asked.tmpfs:
        subprocess.run(['mount', '-t', 'tmpfs', '-o', 'size=64m', 'tmpfs', str(folder)], check=True)
    scene = palpate.generate('contacts', folder / 'scene', triangles=5000, tool_triangles=1000)
    # Round where the tool starts, at the mock-up's surface: some touch, most of those that don't are near.
    start = palpate.Scene(scene).start
    side = round((asked.poses / 5) ** (1 / 3))
    axes = [f'--{name}={centre - 0.03}:{centre + 0.03}:{side}' for name, centre in zip('xyz', start)] + [
        '--rx=0:40:5',
        f'--size={asked.size}',
    ]
    count = 5 * side**3
    chunks = -(-count // asked.size)
    processors = sorted(os.sched_getaffinity(0))[:2]
    print(f'{count:,} poses in {chunks} chunks', flush=True)
    one, hash_one, rate_one = undisturbed(scene, axes, folder, 1, processors)
    two, hash_two, rate_two = undisturbed(scene, axes, folder, 2, processors)
    print(f'two workers: {rate_two / rate_one:.2f} times one')
    last, hash_last = disturbed(scene, axes, folder, processors, chunks, asked.tmpfs)
    share = float(json.loads((last.out / '.zattrs').read_text())['poses'])
    assert share == count and [sweep.markers() for sweep in (one, two, last)] == [chunks] * 3
    assert hash_one == hash_two == hash_last and one.bytes() == two.bytes() == last.bytes()
    print(f'hash of all three: {hash_one}')
    if asked.tmpfs:
        subprocess.run(['umount', str(folder)], check=True)
    if not asked.folder:
        shutil.rmtree(folder)


if __name__ == '__main__':
    main()
