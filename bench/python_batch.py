#!/usr/bin/python3
"""What the Python package costs beside one call of the C interface for the whole batch, and what two threads
are worth.

usage: PYTHONPATH=build/release/python bench/python_batch.py SCENE.json [--poses N] [--reach M] [--rounds R]

What two processors are worth to a batch: once as it is, once under `taskset -c 0`.

Prints, as the median of R rounds in turns: poses a second of palpate_query in one call and of
Scene.query_batch, by the wall clock and by processor time; the memory that a batch adds at its peak, beside
its columns; poses a second of lone questions by one and by two threads.
"""
import argparse
import ctypes
import statistics
import threading
import time

import numpy as np

import palpate
from palpate._library import call


def peak_kib(reset=False):
    if reset:
        open('/proc/self/clear_refs', 'w').write('5')
    return int(next(line for line in open('/proc/self/status') if line.startswith('VmHWM')).split()[1])


def resident_kib():
    return int(next(line for line in open('/proc/self/status') if line.startswith('VmRSS')).split()[1])


def timed(work):
    wall, processor = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - wall, time.process_time() - processor


arguments = argparse.ArgumentParser()
arguments.add_argument('scene')
arguments.add_argument('--poses', type=int, default=1_000_000)
arguments.add_argument('--reach', type=float, default=0.02, help='of the poses from the start, m')
arguments.add_argument('--rounds', type=int, default=3)
options = arguments.parse_args()

scene = palpate.Scene(options.scene, engine='cpu')
source = np.random.default_rng(1)
poses = np.empty((options.poses, 7))
poses[:, :3] = scene.start[:3] + source.uniform(-options.reach, options.reach, (options.poses, 3))
poses[:, 3:] = scene.start[3:]
names = ('contact', 'depth', 'force', 'torque')
print(scene, scene.description['device'])


def whole():
    found = palpate.Columns((options.poses,), names)
    call('query', scene._handle.pointer, poses.ctypes.data, options.poses, ctypes.byref(found._at(0)), None)
    return found


scene.query_batch(poses[:2000], names)  # threads and lists are there
before = resident_kib()
peak_kib(reset=True)
found = scene.query_batch(poses, names)
print(
    f'memory: {(peak_kib() - before) / 1024:.1f} MiB at the peak, of which the columns are'
    f' {found.nbytes / 2**20:.1f} MiB'
)

one, other = [], []
for _ in range(options.rounds):
    one.append(timed(whole))
    other.append(timed(lambda: scene.query_batch(poses, names)))
for what, times in (('one call of palpate_query', one), ('Scene.query_batch', other)):
    wall, processor = (statistics.median(column) for column in zip(*times))
    print(
        f'{what}: {options.poses / wall:.0f} poses/s by the clock, {1e6 * processor / options.poses:.2f} us'
        ' of processor time a pose'
    )
assert all((whole()[name] == scene.query_batch(poses, names)[name]).all() for name in names)

lone = poses[:20_000]
for question in (lambda pose: scene.touches(pose), lambda pose: scene.query_batch(pose, names)):
    rates = []
    for threads in (1, 2):
        workers = [
            threading.Thread(target=lambda part: [question(pose) for pose in part], args=(lone[k::threads],))
            for k in range(threads)
        ]
        taken = timed(
            lambda: ([worker.start() for worker in workers], [worker.join() for worker in workers])
        )[0]
        rates.append(len(lone) / taken)
    print(
        f'lone poses: {rates[0]:.0f}/s by one thread, {rates[1]:.0f}/s by two:'
        f' {rates[1] / rates[0]:.2f} times'
    )
