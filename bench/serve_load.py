"""Load on `palpate serve`, loopback only, bounded: a session alone, then beside batch clients at full rate and viewers.

usage: serve_load.py PROGRAM FOLDER [--seconds 60] [--batches 4] [--viewers 200] [--poses 500] [--backend gpu|cpu] [--ordinary] [--out DIR]

FOLDER: what `palpate generate` made. Its hand goes to and fro along its path for the whole time; the batches ask poses along that path, a millimetre off at most.
Prints, and leaves in DIR/load.json: missed ticks, p50 and p99 of the results' age and of the lateness for both phases, queries and poses a second and p99 of a
query's time, memory of the server over the time. --ordinary: the server has no right to real-time priority, nor to lock memory (as root, by setpriv). Python's
standard library only. The clients share the machine with the server, as they would in the worst case.
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
import struct
import subprocess
import tempfile
import threading
import time

parser = argparse.ArgumentParser()
parser.add_argument('program')
parser.add_argument('folder', type=pathlib.Path)
parser.add_argument('--seconds', type=float, default=60)
parser.add_argument('--batches', type=int, default=4)
parser.add_argument('--viewers', type=int, default=200)
parser.add_argument('--poses', type=int, default=500, help='of a query: about what a planner asks at once')
parser.add_argument('--backend', default='cpu')
parser.add_argument('--ordinary', action='store_true')
parser.add_argument('--out', type=pathlib.Path)
options = parser.parse_args()
KEY = 'AAAAAAAAAAAAAAAAAAAAAA=='

root = tempfile.TemporaryDirectory()
shutil.copytree(options.folder, root.name, dirs_exist_ok=True)


def lengthen():
    """The path, to and fro until the session is over; its poses."""
    file = pathlib.Path(root.name) / 'path.csv'
    head, *rows = file.read_text().splitlines()
    times, rest = zip(*((float(time), pose) for time, pose in (row.split(',', 1) for row in rows)))
    steps = list(zip([b - a for a, b in zip(times, times[1:])], rest[1:], rest))
    out, now = [f'0,{rest[0]}'], 0.0
    while now < options.seconds:
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
WITHOUT_RIGHTS = ['setpriv', '--bounding-set', '-sys_nice,-ipc_lock'] if os.geteuid() == 0 else []


def without_limits():
    resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
    resource.setrlimit(resource.RLIMIT_MEMLOCK, (65536, 65536))


server = subprocess.Popen([*(WITHOUT_RIGHTS if options.ordinary else []), options.program, 'serve', '--listen', '127.0.0.1:0', '--root', root.name, '--backend', options.backend], stderr=log,
                          preexec_fn=without_limits if options.ordinary else None)
while not (found := re.search(rb'"listening","address":"127.0.0.1:(\d+)"', os.pread(log.fileno(), 100_000, 0))):
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


def session(seconds, during=None):
    """A session of that length; its summary."""
    started = json.loads(ask('POST', '/v1/sessions', json.dumps({'scene': scene['id'], 'duration_s': seconds})))
    begun = time.monotonic()
    if during:
        during(started['id'])
    while (state := json.loads(ask('GET', f"/v1/sessions/{started['id']}")))['state'] == 'running':
        time.sleep(min(1, max(0.05, seconds - (time.monotonic() - begun))))
    return state


class Load:
    """Batch clients on threads, viewers on one more."""

    def __init__(self):
        self.stop = False
        self.times, self.poses = [], 0
        self.messages = self.bytes = 0
        self.lock = threading.Lock()
        self.threads = []
        self.memory = []   # KiB, once a second

    def weigh(self):
        while not self.stop:
            time.sleep(1)
            self.memory.append(memory_kib())

    def batch(self, seed):
        chance = random.Random(seed)
        poses = [chance.choice(path) for _ in range(options.poses)]
        body = b''.join(struct.pack('<7d', *(x + chance.uniform(-0.001, 0.001) for x in pose[:3]), *pose[3:]) for pose in poses)
        connection = http.client.HTTPConnection('127.0.0.1', port, timeout=600)
        while not self.stop:
            began = time.monotonic()
            connection.request('POST', f"/v1/scenes/{scene['id']}/query", body=body,
                               headers={'Content-Type': 'application/vnd.palpate.poses', 'Accept': 'application/vnd.palpate.wrenches'})
            data = connection.getresponse().read()
            with self.lock:
                self.times.append(time.monotonic() - began)
                self.poses += len(data) // 64

    def watch(self, session_id):
        poll = selectors.DefaultSelector()
        for i in range(options.viewers):
            link = socket.create_connection(('127.0.0.1', port))
            kind = '?format=binary' if i % 2 else ''
            link.sendall(f'GET /v1/sessions/{session_id}/stream{kind} HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {KEY}\r\nSec-WebSocket-Version: 13\r\n\r\n'.encode())
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
        jobs = [(self.weigh, ())] + [(self.batch, (i,)) for i in range(options.batches)] + ([(self.watch, (session_id,))] if options.viewers else [])
        self.threads = [threading.Thread(target=job, args=arguments, daemon=True) for job, arguments in jobs]
        for thread in self.threads:
            thread.start()
        self.begun = time.monotonic()

    def end(self):
        self.stop = True
        self.seconds = time.monotonic() - self.begun
        for thread in self.threads:
            thread.join(120)


try:
    scene = json.loads(ask('POST', '/v1/scenes', json.dumps({'path': 'scene.json'}), {'Content-Type': 'application/json'}))
    while scene['state'] not in ('ready', 'failed'):
        scene = json.loads(ask('GET', f"/v1/scenes/{scene['id']}?wait=30"))
    if scene['state'] == 'failed':
        raise SystemExit(scene['error']['detail'])
    alone = session(options.seconds)
    load = Load()
    loaded = session(options.seconds, load.start)
    load.end()
finally:
    server.send_signal(signal.SIGTERM)
    server.wait(60)

load.times.sort()


def figures(state):
    summary = state['summary']
    return {'ticks': summary['ticks'], 'missed_ticks': summary['missed_ticks'], 'result_age_ticks': state['result_age_ticks'], 'lateness_us': summary['lateness_us'], 'frame_us': summary['frame_us'],
            'notes': summary.get('notes', [])}


result = {'scene': options.folder.name, 'backend': scene['device'], 'seconds': options.seconds, 'batch_clients': options.batches, 'viewers': options.viewers, 'processors': os.cpu_count(),
          'load_average': os.getloadavg(), 'alone': figures(alone), 'loaded': figures(loaded), 'realtime': not options.ordinary, 'poses_per_s': load.poses / load.seconds, 'queries_per_s': len(load.times) / load.seconds,
          'query_s': {'p50': load.times[len(load.times) // 2], 'p99': load.times[int(0.99 * len(load.times))], 'poses': options.poses} if load.times else None,
          'viewer_reads': load.messages, 'viewer_bytes': load.bytes,
          'memory_kib': {'after_5_s': load.memory[min(4, len(load.memory) - 1)], 'half_way': load.memory[len(load.memory) // 2], 'end': load.memory[-1], 'max': max(load.memory)},
          'missed_ratio': loaded['summary']['missed_ticks'] / max(alone['summary']['missed_ticks'], 1),
          'age_p99_ratio': loaded['result_age_ticks']['p99'] / max(alone['result_age_ticks']['p99'], 1)}
print(json.dumps(result, indent=1))
if options.out:
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / 'load.json').write_text(json.dumps(result, indent=1) + '\n')
