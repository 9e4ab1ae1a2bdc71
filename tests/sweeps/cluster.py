"""A Dask cluster of processes on this machine, whose parts can be killed: what a test does to a sweep."""
import contextlib
import os
import pathlib
import signal
import socket
import subprocess
import sys
import threading
import time


def free_port():
    with socket.socket() as one:
        one.bind(('127.0.0.1', 0))
        return one.getsockname()[1]


class Cluster:
    """A scheduler and `workers` workers, each started again when it ends, as a batch system's or systemd's
    are.

    `processors`: worker i stays on processors[i], where given. What they print goes to `folder`."""

    def __init__(self, folder, workers=2, processors=(), environment=None):
        self._folder = pathlib.Path(folder)
        self._folder.mkdir(parents=True, exist_ok=True)
        port = free_port()
        self.address = f'tcp://127.0.0.1:{port}'
        self._end = threading.Event()
        self._lock = threading.Lock()
        self._processes, self._threads = {}, {}
        self._start(
            'scheduler',
            [
                sys.executable,
                '-m',
                'distributed.cli.dask_scheduler',
                '--host',
                '127.0.0.1',
                '--port',
                str(port),
                '--dashboard-address',
                ':0',
            ],
            environment,
        )
        for i in range(workers):
            self.add_worker(environment, processors[i] if processors else None)

    def add_worker(self, environment=None, processor=None):
        name = f'worker-{len(self._threads) - 1}'
        self._start(
            name,
            [
                *(['taskset', '-c', str(processor)] if processor is not None else []),
                sys.executable,
                '-m',
                'distributed.cli.dask_worker',
                self.address,
                '--nthreads',
                '2',
                '--no-nanny',
                '--dashboard-address',
                ':0',
                '--name',
                name,
                '--local-directory',
                str(self._folder),
            ],
            environment,
        )

    def _start(self, name, command, environment):
        thread = self._threads[name] = threading.Thread(
            target=self._keep, args=(name, command, {**os.environ, **(environment or {})})
        )
        thread.start()

    def _keep(self, name, command, environment):
        while not self._end.is_set():
            with self._lock:
                if self._end.is_set():
                    return
                with open(self._folder / f'{name}.log', 'a') as log:
                    self._processes[name] = process = subprocess.Popen(
                        command, stdout=log, stderr=log, env=environment
                    )
            process.wait()
            self._end.wait(0.2)

    def pid(self, name):
        return self._processes[name].pid

    def kill(self, name):
        """Ends 'scheduler' or 'worker-0', … at once; another one comes."""
        os.kill(self.pid(name), signal.SIGKILL)

    def close(self):
        self._end.set()
        with self._lock:
            for process in self._processes.values():
                with contextlib.suppress(ProcessLookupError):
                    process.kill()
        for thread in self._threads.values():
            thread.join()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def wait_for(what, condition, seconds=120):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until, f'{what} did not come about within {seconds} s'
        time.sleep(0.02)
