# mypy: ignore-errors
"""Workers on this machine, for a sweep that was given none."""
import contextlib
import logging
import os
import tempfile

# Python's part of the work is done side by side by so many; a scene's memory is taken by each (chosen).
MOST_WORKERS = 8


def shares(workers, processors):
    """The processors of each worker, by its name in the cluster: all of them dealt out, none to two where
    there are enough."""
    processors = sorted(processors)
    if workers >= len(processors):
        return {number: {processors[number % len(processors)]} for number in range(workers)}
    return {number: set(processors[number::workers]) for number in range(workers)}


@contextlib.contextmanager
def local(workers, gpu):
    """A client of `workers` processes here, and their shares of the processors. None: one a processor, at
    most MOST_WORKERS; one alone where a GPU answers."""
    from distributed import Client, LocalCluster

    processors = os.sched_getaffinity(0)
    if workers is None:
        workers = 1 if gpu else min(len(processors), MOST_WORKERS)
    loggers = [logging.getLogger(name) for name in ('distributed', 'tornado', 'asyncio')]
    levels = [logger.level for logger in loggers]
    try:
        # One thread's batch has threads of its own; the other writes meanwhile.
        with tempfile.TemporaryDirectory(prefix='palpate-sweep-') as folder, LocalCluster(
            n_workers=workers,
            threads_per_worker=2,
            processes=True,
            dashboard_address=':0',
            local_directory=folder,
            silence_logs=logging.ERROR,
        ) as cluster, Client(cluster) as client:
            try:
                yield client, shares(workers, processors)
            finally:
                # A busy machine may be slow to take them down; by then all is written.
                for logger in loggers:
                    logger.setLevel(logging.CRITICAL)
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)
