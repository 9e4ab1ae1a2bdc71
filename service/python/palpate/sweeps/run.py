# mypy: ignore-errors
"""palpate.sweep: asks a scene at very many poses, on many processors or machines, and can be cut short
anywhere."""
from __future__ import annotations

import contextlib
import dataclasses
import os
import pathlib
import shlex
import sys
import uuid

import numpy

from . import digest
from .asking import ASKS, ENGINES, answer, maker, second_engine
from .chunks import MOST_CHUNKS, MOST_OF_A_CHUNK, SIZE, Chunks
from .poses import ArrayPoses, source_of
from .progress import Progress
from .store import Full, Store
from .words import refuse


@dataclasses.dataclass(frozen=True)
class _Wanted:
    """What `sweep` is asked beside the scene and the poses, under its own names."""

    ask: str
    within: float | None
    again: str  # the second engine
    share: float
    again_poses: int
    workers: int | None
    quiet: bool
    command: str | None
    connect: object


@dataclasses.dataclass(frozen=True)
class Swept:
    """A sweep that is done.

    path : the Zarr group; `answers(column)` opens one of its arrays. hash : of the scene's hash, the
    question, all poses and all answers; the same for any workers, engines and cuts. poses, chunks : how many.
    earlier : chunks that were done before this run. twice : chunks that two engines answered. seconds, rate :
    of this run, in s and poses a second, after the workers were there."""

    path: pathlib.Path
    hash: str
    poses: int
    chunks: int
    earlier: int
    twice: int
    seconds: float
    rate: float

    def answers(self, column):
        """The Zarr array of a column: (poses, …), in the order of the poses."""
        import zarr

        return zarr.open_group(str(self.path), mode='r')[column]


def sweep(
    scene,
    poses,
    *,
    out,
    count=None,
    client=None,
    ask='touches',
    within=None,
    engine='auto',
    again='auto',
    share=0.01,
    again_poses=1024,
    workers=None,
    size=SIZE,
    quiet=False,
    command=None,
    connect=None,
):
    """Asks a scene at all of `poses` and keeps the answers in the Zarr group `out`.

    scene : a palpate.Scene, or what makes one: a file or a dict. poses : a Grid, a function (start, n) ->
    float64 (n, 7) with `count` of them in all, or an array (N, 7). client : a distributed.Client whose
    workers have palpate and see `out` and the scene's files under the same paths. None: `workers` processes
    here, which share the processors out (None: one each, at most 8).
    ask : 'touches' (bool), 'clearance' (distance and nearest points; `within` metres) or 'query' (contact,
    force, torque). engine : of a scene that is made here. again : the engine that answers `share` of the
    chunks a second time: 'auto' (ref beside cpu, cpu beside gpu), 'gpu', 'cpu' or 'ref'; at `again_poses`
    poses of each, evenly spread, for ref is slow.
    quiet : no progress on standard error. command : what to note as the command; connect : makes a lost
    client anew.

    Called again with the same question and `out`, it goes on where it was cut off. Raises PalpateError in one
    sentence: bad input, no room on the disk, two engines that differ (the chunk and the pose are named, and
    nothing of it is kept)."""
    import palpate

    if ask not in ASKS:
        refuse(f"ask is one of {', '.join(ASKS)}; it is {ask!r}")
    if within is not None and ask != 'clearance':
        refuse(f'within belongs to clearance; this asks {ask}')
    if within is not None and not _is_number(within):
        refuse(f'within is a distance in metres; it is {within!r}')
    if again not in ENGINES:
        refuse(f"again is one of {', '.join(ENGINES)}; it is {again!r}")
    if not _is_number(share) or not 0 <= share <= 1:
        refuse(f'share is a part of the chunks, from 0 to 1; it is {share!r}')
    for name, value, most in (('size', size, MOST_OF_A_CHUNK), ('again_poses', again_poses, None)):
        if not _is_count(value) or (most is not None and value > most):
            limits = '1 or more' if most is None else f'1 to {most}'
            refuse(f'{name} is a number of poses in a chunk, {limits}; it is {value!r}')
    if workers is not None and not _is_count(workers):
        refuse(f'workers is how many processes answer, 1 or more; it is {workers!r}')
    source = source_of(poses, count)
    if not isinstance(scene, palpate.Scene):
        scene = palpate.Scene(scene, engine=engine)
    store, chunks = Store(os.path.abspath(out)), Chunks(source.count, size)
    if chunks.count > MOST_CHUNKS:
        refuse(
            f'{source.count} poses in chunks of {size} are {chunks.count} chunks; at most {MOST_CHUNKS} can be'
            ' kept, so make size larger'
        )
    second = second_engine(scene.engine, again)
    wanted = _Wanted(ask, within, second, share, again_poses, workers, quiet, command, connect)
    try:
        with store.mine():
            return _sweep(scene, source, chunks, store, client, wanted)
    except Full as full:
        refuse(f'{full}; make room and give the same command again, which goes on from what is done')


def _is_number(value):
    return isinstance(value, (int, float, numpy.integer, numpy.floating)) and not isinstance(value, bool)


def _is_count(value):
    return isinstance(value, (int, numpy.integer)) and not isinstance(value, bool) and value >= 1


def _sweep(scene, source, chunks, store, client, wanted):
    asked = _begin(scene, source, chunks, store, wanted)
    twice = chunks.asked_twice(wanted.share)
    done = store.done()
    earlier = len(done)
    progress = Progress(
        chunks.poses,
        sum(record['poses'] for record in done.values()),
        open(os.devnull, 'w') if wanted.quiet else None,
    )
    if earlier:
        progress.note(f'{earlier} of {chunks.count} chunks were done before')
    with contextlib.ExitStack() as stack:
        driver = None
        for _ in range(3):
            # Those that two engines answer take longest, so they begin first.
            todo = sorted(
                set(range(chunks.count)) - set(done), key=lambda number: (number not in twice, number)
            )
            if todo:
                if driver is None:
                    driver = _driver(scene, source, chunks, store, client, wanted, progress, stack)
                    progress.begin()
                try:
                    driver.run(todo, twice)
                except BaseException:
                    progress.end()
                    progress.note(f'{len(store.done())} of {chunks.count} chunks are done')
                    raise
                progress.end()
                done = store.done()
            # What counts is what the disk gives back.
            in_turn = sorted(done.values(), key=lambda record: record['chunk'])
            for number in store.faulty(in_turn, asked['columns']):
                progress.note(f'chunk {number} is not on the disk as it was written; asking again')
                del done[number]
            if len(done) == chunks.count:
                break
        else:
            refuse(f'{store.path}: the disk gives back other data than was written')
    return _finish(asked, [done[number] for number in range(chunks.count)], chunks, store, earlier, progress)


def _begin(scene, source, chunks, store, wanted):
    """Makes the store ready for this question, or finds it there. What is asked, for the digest."""
    import palpate

    first = answer(scene, wanted.ask, wanted.within, source.poses(0, 1))
    types = {
        name: [values.dtype.newbyteorder('<').str, list(values.shape[1:])]
        for name, values in sorted(first.items())
    }
    asked = {'scene': scene.hash, 'ask': wanted.ask, 'within': wanted.within, 'columns': types}
    question = {
        **asked,
        'poses': source.describe(),
        'count': source.count,
        'chunk': chunks.size,
        'palpate': palpate.__version__,
    }
    about = {
        'engine': scene.engine,
        'command': wanted.command or shlex.join(sys.orig_argv),
        'shape': list(getattr(source, 'shape', ())),
    }
    store.begin(question, about, first, chunks, source.rows if isinstance(source, ArrayPoses) else None)
    return asked


def _driver(scene, source, chunks, store, client, wanted, progress, stack):
    """Hands the job out: to `client`, or to processes of this machine, which end with `stack`."""
    import palpate

    from .cluster import local
    from .drive import Driver
    from .worker import Job

    shares = {}
    if client is None:
        client, shares = stack.enter_context(local(wanted.workers, scene.engine == 'gpu'))
    job = Job(
        f'palpate-sweep-{uuid.uuid4().hex}',
        palpate.__version__,
        scene.hash,
        maker(scene),
        scene.engine,
        wanted.again,
        wanted.again_poses,
        wanted.ask,
        wanted.within,
        None if isinstance(source, ArrayPoses) else source,
        str(store.path),
        chunks,
        shares,
    )
    return Driver(client, job, progress, wanted.connect)


def _finish(asked, records, chunks, store, earlier, progress):
    """Seals the store with the hash of all answers."""
    if [record['start'] for record in records] != [
        chunks.span(number)[0] for number in range(chunks.count)
    ] or sum(record['poses'] for record in records) != chunks.poses:
        refuse(f'{store.path}: its markers are not those of this sweep')
    value = digest.of_sweep(asked, records)
    store.finish(
        hash=value,
        poses=chunks.poses,
        engines=sorted({record['engine'] for record in records}),
        again=sorted({record['again'] for record in records if 'again' in record}),
    )
    return Swept(
        store.path,
        value,
        chunks.poses,
        chunks.count,
        earlier,
        sum('again' in record for record in records),
        progress.seconds,
        progress.rate,
    )
