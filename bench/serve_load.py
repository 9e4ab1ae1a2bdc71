#!/usr/bin/env python3
"""Load on `palpate serve`, loopback only, bounded: a session alone, beside batch clients at full rate and
viewers, and, to tell what the load costs from what a busy machine costs, beside a program that does nothing
but turn in a circle on each processor but the loop's; in rounds, every other one the other way round, since a
machine's own stalls come in bursts.

usage: serve_load.py PROGRAM FOLDER [--seconds 60] [--alone-seconds 60] [--rounds 2] [--batches 4] [--viewers 200] [--poses 500] [--backend gpu|cpu] [--ordinary] [--beside] [--out DIR]

FOLDER: what `palpate generate contacts` made. Its hand goes to and fro along its path for the whole time; the
batches ask poses along that path, a millimetre off at most. Prints, and leaves in DIR/load.json: missed
ticks, p50 and p99 of the results' age and of the lateness for the phases of each round, how late cyclictest
was meanwhile, which says what is the machine's own, and what the host of a virtual machine took of the loop's
processor (ms, as Linux was told); queries and poses a second and p99 of a query's time, memory of the server
over the time. The ratios are those of all rounds' ticks together, and of the medians of the rounds' p99 of
age. --ordinary: the server has no right to real-time priority, nor to lock memory (as root, by setpriv).
Python's standard library only.

The clients of a server are on other machines. These are on the server's, so that they give way (nice 19) and
leave the loop's processor, the last, alone: else their own work would be measured. --beside: they take what
they get, as programs on the hand's own machine would.
"""
import argparse
import http.client
import json
import os
import pathlib
import random
import re
import resource
import selectors
import shutil
import signal
import socket
import statistics
import struct
import subprocess
import tempfile
import threading
import time

parser = argparse.ArgumentParser()
parser.add_argument('program')
parser.add_argument('folder', type=pathlib.Path)
parser.add_argument('--seconds', type=float, default=60)
parser.add_argument(
    '--alone-seconds', type=float, help='of each of the other two phases; default as --seconds'
)
parser.add_argument(
    '--rounds', type=int, default=2, help='of all three phases, every other one from the last to the first'
)
parser.add_argument('--batches', type=int, default=4)
parser.add_argument('--viewers', type=int, default=200)
parser.add_argument('--poses', type=int, default=500, help='of a query: about what a planner asks at once')
parser.add_argument('--backend', default='cpu')
parser.add_argument('--ordinary', action='store_true')
parser.add_argument('--beside', action='store_true', help='clients like any other program of this machine')
parser.add_argument('--out', type=pathlib.Path)
options = parser.parse_args()
options.alone_seconds = options.alone_seconds or options.seconds
KEY = 'AAAAAAAAAAAAAAAAAAAAAA=='

root = tempfile.TemporaryDirectory()
shutil.copytree(options.folder, root.name, dirs_exist_ok=True)


def lengthen():
    """The path, to and fro until the session is over; its poses."""
    file = pathlib.Path(root.name) / 'path.csv'
    head, *rows = file.read_text().splitlines()
    if not head.startswith('time_s,x_m,y_m,z_m,qx,qy,qz,qw'):
        raise SystemExit(
            f'{file.name} of {options.folder} has no poses, which the batches are made of: take a scene whose'
            ' tool is free'
        )
    times, rest = zip(*((float(time), pose) for time, pose in (row.split(',', 1) for row in rows)))
    steps = list(zip([b - a for a, b in zip(times, times[1:])], rest[1:], rest))
    out, now = [f'0,{rest[0]}'], 0.0
    while now < max(options.seconds, options.alone_seconds):
        for step, there, _ in steps:
            now += step
            out.append(f'{now:.6f},{there}')
        for step, _, back in reversed(steps):
            now += step
            out.append(f'{now:.6f},{back}')
    file.write_text('\n'.join([head, *out]) + '\n')
    return [[float(x) for x in pose.split(',')[:7]] for pose in rest]


path = lengthen()
log = tempfile.TemporaryFile()
PROCESSORS = sorted(os.sched_getaffinity(0))
WITHOUT_RIGHTS = ['setpriv', '--bounding-set', '-sys_nice,-ipc_lock'] if os.geteuid() == 0 else []


def without_limits():
    resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
    resource.setrlimit(resource.RLIMIT_MEMLOCK, (65536, 65536))


server = subprocess.Popen(
    [
        *(WITHOUT_RIGHTS if options.ordinary else []),
        options.program,
        'serve',
        '--listen',
        '127.0.0.1:0',
        '--root',
        root.name,
        '--backend',
        options.backend,
    ],
    stderr=log,
    preexec_fn=without_limits if options.ordinary else None,
)
while not (
    found := re.search(rb'"listening","address":"127.0.0.1:(\d+)"', os.pread(log.fileno(), 100_000, 0))
):
    time.sleep(0.05)
port = int(found[1])


def ask(method, path, body=None, headers=None):
    connection = http.client.HTTPConnection('127.0.0.1', port, timeout=600)
    connection.request(method, path, body=body, headers=headers or {})
    answer = connection.getresponse()
    data = answer.read()
    connection.close()
    if answer.status >= 300:
        raise RuntimeError(f'{method} {path}: {answer.status} {data[:300]}')
    return data


def memory_kib():
    return int(re.search(r'VmRSS:\s+(\d+)', pathlib.Path(f'/proc/{server.pid}/status').read_text())[1])


class Background:
    """cyclictest beside what is measured: a thread of the loop's priority on the loop's processor (whatever
    the server's rights) that only sleeps, as late as the machine alone makes it; nothing where there is none,
    nor where it is refused."""

    def __init__(self, seconds):
        self.file = tempfile.TemporaryFile('w+')
        try:
            self.process = subprocess.Popen(
                [
                    'cyclictest',
                    '--quiet',
                    '--threads=1',
                    '--interval=1000',
                    f'--loops={int(seconds * 1000)}',
                    '--histogram=200000',
                    '--mlockall',
                    '--policy=fifo',
                    '--priority=80',
                    f'--affinity={PROCESSORS[-1]}',
                ],
                stdout=self.file,
                stderr=subprocess.DEVNULL,
            )
        except OSError:
            self.process = None

    def end(self):
        if not self.process or self.process.wait(60) != 0:
            return None
        self.file.seek(0)
        text = self.file.read()
        counts = [
            (int(us), int(count)) for us, count in re.findall(r'^(\d+) (\d+)$', text, re.M) if int(count)
        ]
        total, seen, percentiles = sum(count for _, count in counts), 0, {}
        for us, count in counts:
            seen += count
            for share in (0.5, 0.99, 0.999):
                if seen >= share * total:
                    percentiles.setdefault(
                        f'p{str(100 * share).rstrip("0").rstrip(".").replace(".", "")}', us
                    )
        return {
            'ticks': total,
            'missed_ticks': sum(count * (us // 1000) for us, count in counts),
            **percentiles,
            'max': int(re.search(r'# Max Latencies: (\d+)', text)[1]),
        }


def stolen_ms():
    """Time that the loop's processor wanted and its machine's host gave to others."""
    line = re.search(rf'^cpu{PROCESSORS[-1]} (.*)$', pathlib.Path('/proc/stat').read_text(), re.M)[1]
    return int(line.split()[7]) * 1000 // os.sysconf('SC_CLK_TCK')


def session(seconds, during=None):
    """A session of that length; its summary."""
    background, stolen = Background(seconds), stolen_ms()
    started = json.loads(
        ask('POST', '/v1/sessions', json.dumps({'scene': scene['id'], 'duration_s': seconds}))
    )
    begun = time.monotonic()
    if during:
        during(started['id'])
    while (state := json.loads(ask('GET', f"/v1/sessions/{started['id']}")))['state'] == 'running':
        time.sleep(min(1, max(0.05, seconds - (time.monotonic() - begun))))
    state['stolen_ms'] = stolen_ms() - stolen
    state['cyclictest_us'] = background.end()
    return state


class Busy:
    """The processors that are not the loop's, kept busy by programs of no memory and no system call, which
    know nothing of the server."""

    def __enter__(self):
        self.processes = [
            subprocess.Popen(
                ['nice', '-n', '19', 'sh', '-c', 'while :; do :; done'],
                preexec_fn=lambda cpu=cpu: os.sched_setaffinity(0, {cpu}),
            )
            for cpu in PROCESSORS[:-1]
        ]

    def __exit__(self, *ignored):
        for process in self.processes:
            process.kill()
            process.wait()


class Load:
    """Batch clients on threads, viewers on one more."""

    def __init__(self):
        self.stop = False
        self.times, self.poses = [], 0
        self.messages = self.bytes = 0
        self.lock = threading.Lock()
        self.threads = []
        self.memory = []  # KiB, once a second

    def on_another_machine(self, job, arguments):
        if not options.beside:
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 19)
            os.sched_setaffinity(threading.get_native_id(), PROCESSORS[:-1] or PROCESSORS)
        job(*arguments)

    def weigh(self):
        while not self.stop:
            time.sleep(1)
            self.memory.append(memory_kib())

    def batch(self, seed):
        chance = random.Random(seed)
        poses = [chance.choice(path) for _ in range(options.poses)]
        body = b''.join(
            struct.pack('<7d', *(x + chance.uniform(-0.001, 0.001) for x in pose[:3]), *pose[3:])
            for pose in poses
        )
        connection = http.client.HTTPConnection('127.0.0.1', port, timeout=600)
        while not self.stop:
            began = time.monotonic()
            connection.request(
                'POST',
                f"/v1/scenes/{scene['id']}/query",
                body=body,
                headers={
                    'Content-Type': 'application/vnd.palpate.poses',
                    'Accept': 'application/vnd.palpate.wrenches',
                },
            )
            data = connection.getresponse().read()
            with self.lock:
                self.times.append(time.monotonic() - began)
                self.poses += len(data) // 64

    def watch(self, session_id):
        poll = selectors.DefaultSelector()
        for i in range(options.viewers):
            link = socket.create_connection(('127.0.0.1', port))
            kind = '?format=binary' if i % 2 else ''
            link.sendall(
                f'GET /v1/sessions/{session_id}/stream{kind} HTTP/1.1\r\nHost: localhost\r\nUpgrade:'
                f' websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {KEY}\r\nSec-WebSocket-Version:'
                ' 13\r\n\r\n'.encode()
            )
            link.setblocking(False)
            poll.register(link, selectors.EVENT_READ)
        while not self.stop:
            for key, _ in poll.select(0.2):
                data = key.fileobj.recv(1 << 20)
                self.messages += 1
                self.bytes += len(data)
        for key in list(poll.get_map().values()):
            key.fileobj.close()

    def start(self, session_id):
        jobs = (
            [(self.weigh, ())]
            + [(self.batch, (i,)) for i in range(options.batches)]
            + ([(self.watch, (session_id,))] if options.viewers else [])
        )
        self.threads = [
            threading.Thread(target=self.on_another_machine, args=job, daemon=True) for job in jobs
        ]
        for thread in self.threads:
            thread.start()
        self.begun = time.monotonic()

    def end(self):
        self.stop = True
        self.seconds = time.monotonic() - self.begun
        for thread in self.threads:
            thread.join(120)


PHASES = ['alone', 'busy', 'loaded']


def run_round(states, loads, turned):
    """All phases once, from the last to the first if turned; adds each session's summary to its phase's, and
    the load to the loads."""
    for phase in reversed(PHASES) if turned else PHASES:
        if phase == 'loaded':
            load = Load()
            state = session(options.seconds, load.start)
            load.end()
            loads.append(load)
        elif phase == 'busy':
            with Busy():
                state = session(options.alone_seconds)
        else:
            state = session(options.alone_seconds)
        states[phase].append(state)


states, loads = {phase: [] for phase in PHASES}, []
try:
    scene = json.loads(
        ask('POST', '/v1/scenes', json.dumps({'path': 'scene.json'}), {'Content-Type': 'application/json'})
    )
    while scene['state'] not in ('ready', 'failed'):
        scene = json.loads(ask('GET', f"/v1/scenes/{scene['id']}?wait=30"))
    if scene['state'] == 'failed':
        raise SystemExit(scene['error']['detail'])
    for i in range(options.rounds):
        run_round(states, loads, i % 2 == 1)
    metrics = ask('GET', '/metrics').decode()
finally:
    server.send_signal(signal.SIGTERM)
    server.wait(60)


def figures(state):
    summary = state['summary']
    return {
        'ticks': summary['ticks'],
        'missed_ticks': summary['missed_ticks'],
        'stolen_ms': state['stolen_ms'],
        'result_age_ticks': state['result_age_ticks'],
        'lateness_us': summary['lateness_us'],
        'frame_us': summary['frame_us'],
        'cyclictest_us': state['cyclictest_us'],
        'notes': summary.get('notes', []),
    }


def metric(name):
    return int(float(re.search(rf'^{name} (\S+)$', metrics, re.M)[1]))


def missed_share(phase):
    """Of all rounds' ticks; where none was missed, as if one had been."""
    return max(1, sum(state['summary']['missed_ticks'] for state in states[phase])) / sum(
        state['summary']['ticks'] for state in states[phase]
    )


def missed_to_machine(phase):
    """Against cyclictest's in the same time; None without it."""
    machine = [state['cyclictest_us'] for state in states[phase]]
    return (
        sum(state['summary']['missed_ticks'] for state in states[phase])
        / max(1, sum(one['missed_ticks'] for one in machine))
        if all(machine)
        else None
    )


def age_p99(phase):
    return statistics.median(state['result_age_ticks']['p99'] for state in states[phase])


def of_load(load):
    times = sorted(load.times)
    return {
        'poses_per_s': load.poses / load.seconds,
        'queries_per_s': len(times) / load.seconds,
        'query_s': {
            'p50': times[len(times) // 2],
            'p99': times[int(0.99 * len(times))],
            'poses': options.poses,
        }
        if times
        else None,
        'viewer_reads': load.messages,
        'viewer_bytes': load.bytes,
        'memory_kib': {
            'after_5_s': load.memory[min(4, len(load.memory) - 1)],
            'half_way': load.memory[len(load.memory) // 2],
            'end': load.memory[-1],
            'max': max(load.memory),
        },
    }


result = {
    'scene': options.folder.name,
    'backend': scene['device'],
    'seconds': options.seconds,
    'alone_seconds': options.alone_seconds,
    'batch_clients': options.batches,
    'viewers': options.viewers,
    'processors': os.cpu_count(),
    'load_average': os.getloadavg(),
    'realtime': not options.ordinary,
    'clients_beside': options.beside,
    'rounds': [
        {phase: figures(states[phase][i]) for phase in PHASES} | {'load': of_load(loads[i])}
        for i in range(options.rounds)
    ],
    'telemetry_sent': metric('palpate_telemetry_sent_total'),
    'telemetry_dropped': metric('palpate_telemetry_dropped_total'),
    'missed_ticks': {
        phase: [sum(state['summary'][key] for state in states[phase]) for key in ('missed_ticks', 'ticks')]
        for phase in PHASES
    },
    'missed_ratio': missed_share('loaded') / missed_share('alone'),
    'missed_ratio_to_busy': missed_share('loaded') / missed_share('busy'),
    'missed_to_machine': {phase: missed_to_machine(phase) for phase in PHASES},
    'age_p99_ratio': age_p99('loaded') / max(age_p99('alone'), 1),
}
print(json.dumps(result, indent=1))
if options.out:
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / 'load.json').write_text(json.dumps(result, indent=1) + '\n')
