"""Load on `palpate serve`, loopback only, bounded: a session alone, then beside batch clients at full rate and viewers.

usage: serve_load.py PROGRAM SCENE.json [--seconds 60] [--batches 4] [--viewers 200] [--backend gpu] [--out DIR]

Prints, and leaves in DIR/load.json: missed ticks, p50 and p99 of the results' age and of the lateness for both phases, poses a second and p99 of a query's time,
memory of the server before and after. Python's standard library only; the clients share the machine with the server, as they would in the worst case.
"""
import argparse
import http.client
import json
import os
import pathlib
import random
import re
import selectors
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time

parser = argparse.ArgumentParser()
parser.add_argument('program')
parser.add_argument('scene', type=pathlib.Path)
parser.add_argument('--seconds', type=float, default=60)
parser.add_argument('--batches', type=int, default=4)
parser.add_argument('--viewers', type=int, default=200)
parser.add_argument('--backend', default='cpu')
parser.add_argument('--out', type=pathlib.Path)
options = parser.parse_args()
POSES = 500   # of a query: about what a planner asks at once
KEY = 'AAAAAAAAAAAAAAAAAAAAAA=='

log = tempfile.TemporaryFile()
server = subprocess.Popen([options.program, 'serve', '--listen', '127.0.0.1:0', '--root', options.scene.resolve().parent, '--backend', options.backend], stderr=log)
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

    def batch(self, seed):
        chance = random.Random(seed)
        start = scene['start']
        body = b''.join(struct.pack('<7d', *(start[k] + chance.uniform(-0.02, 0.02) for k in range(3)), *start[3:]) for _ in range(POSES))
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
        jobs = [(self.batch, (i,)) for i in range(options.batches)] + ([(self.watch, (session_id,))] if options.viewers else [])
        self.threads = [threading.Thread(target=job, args=arguments, daemon=True) for job, arguments in jobs]
        for thread in self.threads:
            thread.start()
        time.sleep(5)
        self.memory_begin = memory_kib()

    def end(self):
        self.memory_end = memory_kib()
        self.stop = True
        for thread in self.threads:
            thread.join(120)


try:
    scene = json.loads(ask('POST', '/v1/scenes', json.dumps({'path': options.scene.name}), {'Content-Type': 'application/json'}))
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


result = {'scene': str(options.scene), 'backend': scene['device'], 'seconds': options.seconds, 'batch_clients': options.batches, 'viewers': options.viewers, 'processors': os.cpu_count(),
          'load_average': os.getloadavg(), 'alone': figures(alone), 'loaded': figures(loaded), 'poses_per_s': load.poses / options.seconds,
          'query_s': {'p50': load.times[len(load.times) // 2], 'p99': load.times[int(0.99 * len(load.times))], 'poses': POSES} if load.times else None,
          'viewer_reads': load.messages, 'viewer_bytes': load.bytes, 'memory_kib': [load.memory_begin, load.memory_end]}
print(json.dumps(result, indent=1))
if options.out:
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / 'load.json').write_text(json.dumps(result, indent=1) + '\n')
