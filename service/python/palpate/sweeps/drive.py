# mypy: ignore-errors
"""Hands chunks to Dask and sees that each is done once, whatever falls over meanwhile.

Dask schedules: it moves a lost worker's tasks to the others. What it doesn't do is remember: after its
scheduler is gone nothing is known of the tasks. The markers are, so whatever has none is handed in again. """
import contextlib
import queue
import signal
import threading
import time

from distributed import KilledWorker

from .words import refuse
from .worker import Delivery, Undelivered, answer_chunk

# So many chunks are handed in for each thread of the workers: the next is there when one is done, and a
# scheduler that is asked for 10^10 poses need not know them all at once (chosen).
AHEAD = 3
PATIENCE_S = 120  # for a scheduler to come back, or a first worker to come (chosen)


class _CtrlC:
    """Ctrl-C as a flag that the loop asks for: raised wherever Python is at the moment it gets lost where
    exceptions are (a finalizer of Dask's, say), and the sweep goes on. The second one is raised at once. Where
    somebody else handles it, or outside the main thread, all stays as it is. `wake` is called with it."""

    def __init__(self, wake):
        self._wake, self._pressed, self._before = wake, False, None

    def __enter__(self):
        ours = signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if ours and threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._press)
        return self

    def __exit__(self, *_):
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)

    def _press(self, *_):
        if self._pressed:
            raise KeyboardInterrupt
        self._pressed = True
        self._wake()

    def look(self):
        if self._pressed:
            raise KeyboardInterrupt


class Driver:
    """Has `job` done by the workers of `client`. `connect`: gives a client anew when this one is closed, or
    None."""

    def __init__(self, client, job, progress, connect=None):
        self._client, self._job, self._progress, self._connect = client, job, progress, connect
        self._ended = queue.SimpleQueue()
        self._round, self._alone = 0, False
        self._ctrl_c = _CtrlC(lambda: self._ended.put((None, None)))  # such a queue may be put to anywhere

    def run(self, todo, twice):
        """Does the chunks `todo`, in their order; those also in `twice` are asked of two engines. Full,
        PalpateError, KeyboardInterrupt: it stopped; what is done stays done."""
        with self._ctrl_c:
            self._run(todo, twice)

    def _run(self, todo, twice):
        waiting, running = list(reversed(todo)), {}
        self._deliver()
        room, counted = self._room(), time.monotonic()
        try:
            while waiting or running:
                self._ctrl_c.look()
                while waiting and len(running) < room:
                    running[waiting[-1]] = self._submit(waiting[-1], waiting[-1] in twice)
                    waiting.pop()
                try:
                    number, future = self._ended.get(timeout=1)
                except queue.Empty:
                    number, future = None, None
                if future is not None and running.get(number) is future:
                    del running[number]
                    if self._is_done(number, future):
                        self._progress.advance(self._job.chunks.span(number)[1])
                    else:
                        waiting.append(number)
                if self._client.status != 'running':
                    waiting.extend(sorted(running, reverse=True))
                    running.clear()
                    self._come_back()
                    counted = 0
                if time.monotonic() - counted > 5:
                    room, counted = self._room(), time.monotonic()
        finally:
            with contextlib.suppress(Exception):  # of a connection that is gone
                for future in running.values():
                    future.cancel()
                self._client.unregister_worker_plugin(self._job.name)

    def _submit(self, number, twice):
        self._round += 1
        future = self._client.submit(
            answer_chunk,
            self._job.name,
            number,
            twice,
            pure=False,
            key=f'{self._job.name}-{number}-{self._round}',
        )
        future.add_done_callback(lambda ended: self._ended.put((number, ended)))
        return future

    def _is_done(self, number, future):
        """False: it has to be handed in again."""
        if future.status == 'finished':
            return True
        if future.status != 'error':  # cancelled, lost: its scheduler is gone
            return False
        error = future.exception()
        if isinstance(error, Undelivered):
            self._deliver()
            return False
        if isinstance(error, KilledWorker):
            refuse(f'chunk {number} ended every worker that took it: they crashed or had too little memory')
        raise error

    def _room(self):
        """How many chunks to keep handed in."""
        try:
            threads = sum(self._client.nthreads().values())
        except Exception:  # no connection at the moment
            threads = 0
        if threads == 0 and not self._alone:
            self._progress.note('no worker is there yet; waiting for one')
        self._alone = threads == 0
        return AHEAD * max(threads, 1)

    def _deliver(self):
        self._client.register_worker_plugin(Delivery(self._job), name=self._job.name)

    def _come_back(self):
        """Waits until there is a scheduler again, and tells it of the job."""
        self._progress.note('the connection to the scheduler is lost; waiting for it to come back')
        until = time.monotonic() + PATIENCE_S
        while time.monotonic() < until:
            self._ctrl_c.look()
            try:
                if self._client.status == 'closed' and self._connect:
                    self._client = self._connect()
                if self._client.status == 'running':
                    self._deliver()
                    self._progress.note('the scheduler is back')
                    return
            except Exception:  # whatever a connection that comes and goes throws: there is the time limit
                pass
            time.sleep(0.2)
        refuse(f'the scheduler did not come back within {PATIENCE_S} s')
