# mypy: ignore-errors
"""What a Dask worker does for a sweep: it gets a scene once, by its content, and answers chunks by their
numbers."""
import dataclasses
import functools
import os
import threading

import numpy
from distributed import WorkerPlugin, get_worker

from . import digest
from .asking import answer, first_difference
from .chunks import Chunks
from .poses import ArrayPoses
from .store import Store
from .words import refuse


@dataclasses.dataclass(frozen=True)
class Job:
    """A sweep, as its workers know it; the same for all its chunks, so it travels once."""

    name: str
    version: str
    scene: str  # content hash
    make: object  # make(engine=…) gives the scene
    engine: str
    again: str  # the second engine
    again_poses: int  # of a chunk that it is asked of
    ask: str
    within: object
    source: object  # of poses; None: the store keeps them
    store: str
    chunks: Chunks
    shares: dict  # {worker's name: processors that it may use}; of a cluster of the sweep's own


class Delivery(WorkerPlugin):
    """Brings a job to each worker once, and to each one that comes later before its first task."""

    def __init__(self, job):
        self.job = job
        self.name = job.name

    def setup(self, worker):
        if worker.name in self.job.shares:
            _stay_on(self.job.shares[worker.name])
        with _lock:
            _jobs[self.job.name] = _Work(self.job)

    def teardown(self, worker):
        with _lock:
            _jobs.pop(self.job.name, None)


class _Work:
    def __init__(self, job):
        self.job = job
        self.store = Store(job.store)

    @functools.cached_property
    def source(self):
        return self.job.source or ArrayPoses(self.store.group['poses'])


_lock = threading.Lock()  # of _jobs
_jobs = {}  # by name
_scenes = {}  # by content hash and engine
# A batch takes all of the worker's processors, so a second one at once gains nothing; while one is answered,
# a worker of two threads makes the next one's poses and writes the last one's answers.
_answering = threading.Lock()  # of _scenes and whoever asks them


class Undelivered(Exception):
    """A worker knows no such job: the scheduler that would have told it is gone. The driver delivers
    again."""


def answer_chunk(name, number, twice):
    """Answers chunk `number` of job `name` and puts it on the disk. Gives nothing: the marker says that it is
    done, and a result that Dask kept could be lost with its worker. Full, PalpateError, Undelivered."""
    from palpate import PalpateError

    with _lock:
        work = _jobs.get(name)
    if work is None:
        raise Undelivered(name)
    try:
        _answer(work, number, twice)
    except PalpateError as error:
        refuse(f'chunk {number}: {error}')


def _answer(work, number, twice):
    job = work.job
    start, n = job.chunks.span(number)
    poses = work.source.poses(start, n)
    with _answering:
        scene = _scene(job, job.engine)
        columns = answer(scene, job.ask, job.within, poses)
    record = {
        'chunk': number,
        'start': start,
        'poses': n,
        'posed': digest.of_array(poses),
        'answers': digest.of_columns(columns),
        'engine': scene.engine,
    }
    if twice:
        # Evenly spread; all of a small chunk.
        asked = numpy.unique(numpy.arange(job.again_poses) * n // job.again_poses)
        with _answering:
            second = _scene(job, job.again)
            others = answer(second, job.ask, job.within, poses[asked])
        differs = first_difference({name: values[asked] for name, values in columns.items()}, others)
        if differs:
            row, column = differs
            place = asked[row]
            refuse(
                f'pose {start + place} ({" ".join(repr(float(x)) for x in poses[place])}): {column} is'
                f' {columns[column][place]} by {scene.engine} and {others[column][row]} by {second.engine}'
            )
        record['again'] = second.engine
    work.store.write(record, columns)


def _scene(job, engine):
    """The job's scene by `engine`; kept for the next chunk and the next sweep."""
    key = (job.scene, engine)
    if key not in _scenes:
        import palpate

        with _lock:
            wanted = {work.job.scene for work in _jobs.values()}
        for other in [other for other in _scenes if other[0] not in wanted]:
            del _scenes[other]
        if palpate.__version__ != job.version:
            refuse(
                f'worker {get_worker().name} has palpate {palpate.__version__}, the sweep is of {job.version}'
            )
        _scenes[key] = job.make(engine=engine)
    return _scenes[key]


def _stay_on(processors):
    """This process, its threads and those to come use these processors alone."""
    for thread in os.listdir('/proc/self/task'):
        os.sched_setaffinity(int(thread), processors)
