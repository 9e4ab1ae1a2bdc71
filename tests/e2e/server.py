"""Starts `palpate serve` on a free loopback port and talks to it. Python's standard library only."""
import base64
import http.client
import json
import math
import os
import random
import re
import signal
import socket
import struct
import subprocess
import tempfile
import time

from harness import PROGRAM, Folder, expect

WAIT_S = 900  # a busy machine is slow, and its slowness is no failure; a hang is


def until(what, ask, every_s=0.1):
    """Asks until the answer, or the first of a tuple, is true, and gives the answer, or the rest of the
    tuple."""
    end = time.monotonic() + WAIT_S
    while True:
        answer = ask()
        truth, told = answer if isinstance(answer, tuple) else (answer, answer)
        if truth:
            return told
        expect(time.monotonic() < end, f'not within {WAIT_S} s: {what}; the last that was seen: {told}')
        time.sleep(every_s)


HEADER = 'x,y,z,qx,qy,qz,qw\n'


def poses(count, seed=7):
    """Near the block of a Folder, some touching; `seed` can be overridden to look for more."""
    chance = random.Random(seed)
    rows = []
    for _ in range(count):
        q = [chance.gauss(0, 1) for _ in range(4)]
        size = math.sqrt(sum(x * x for x in q))
        rows.append(
            [
                chance.uniform(-0.1, 0.1),
                chance.uniform(-0.1, 0.1),
                chance.uniform(0.01, 0.04),
                *(x / size for x in q),
            ]
        )
    return rows


def csv(rows):
    return HEADER + ''.join(','.join(map(repr, row)) + '\n' for row in rows)


def without_times(text):
    return re.sub(rb'"time_us":\{[^}]*\}', b'', text.encode() if isinstance(text, str) else text)


def rooted():
    """A folder with a scene below, and the server's arguments."""
    folder = Folder()
    folder.save()
    return folder, ('--root', folder.path)


def named(server, path='scene.json'):
    return server.ready(server.ask('POST', '/v1/scenes', {'path': path}))


class Answer:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    def json(self):
        return json.loads(self.body)

    def __str__(self):
        return f'{self.status} {self.body[:500]!r}'


class Server:
    """`with Server('--root', folder) as server:` — stopped by SIGTERM at the end, which must give exit 0.
    `before`: a command that becomes the program."""

    def __init__(self, *arguments, environment=None, preexec=None, before=()):
        self.log = tempfile.TemporaryFile()
        self.process = subprocess.Popen(
            [*before, PROGRAM, 'serve', '--listen', '127.0.0.1:0', '--backend', 'cpu', *map(str, arguments)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=self.log,
            env={**os.environ, **(environment or {})},
            preexec_fn=preexec,
        )
        self.port = None
        end = time.monotonic() + WAIT_S
        while self.port is None:
            expect(
                self.process.poll() is None and time.monotonic() < end,
                f'the server did not start: {self.log_text()}',
            )
            found = re.search(r'"event":"listening","address":"127.0.0.1:(\d+)"', self.log_text())
            self.port = int(found[1]) if found else time.sleep(0.02)

    def log_text(self):
        return os.pread(self.log.fileno(), 10_000_000, 0).decode(errors='replace')

    def __enter__(self):
        return self

    def __exit__(self, kind, *ignored):
        code = self.stop()
        if kind is None:
            expect(code == 0, f'exit {code} after SIGTERM: {self.log_text()[-2000:]}')

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(WAIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            return 'a hang'

    def connect(self):
        return socket.create_connection(('127.0.0.1', self.port), timeout=WAIT_S)

    def ask(self, method, path, body=None, headers=None):
        connection = http.client.HTTPConnection('127.0.0.1', self.port, timeout=WAIT_S)
        try:
            if isinstance(body, (dict, list)):
                body, headers = json.dumps(body), {'Content-Type': 'application/json', **(headers or {})}
            connection.request(method, path, body=body, headers=headers or {})
            got = connection.getresponse()
            return Answer(got.status, dict(got.getheaders()), got.read())
        finally:
            connection.close()

    def raw(self, data):
        """Sends bytes as they are and gives what comes back until the server closes."""
        with self.connect() as link:
            try:
                link.sendall(data)
                got = b''
                while piece := link.recv(65536):
                    got += piece
            except ConnectionError:
                pass
            return got

    def upload(self, **parts):
        body, kind = form(parts)
        return self.ask('POST', '/v1/scenes', body, {'Content-Type': kind})

    def ready(self, answer):
        """Waits for the scene of a POST's answer and gives its id."""
        expect(answer.status in (200, 202), answer)
        scene = self.settled(answer.json()['id'])
        expect(scene['state'] == 'ready', scene)
        return scene['id']

    def settled(self, name, headers=None):
        """The scene, once it is ready or failed."""

        def ended():
            scene = self.ask('GET', f'/v1/scenes/{name}?wait=20', headers=headers).json()
            return scene['state'] in ('ready', 'failed'), scene

        return until(f'scene {name} is ready or failed', ended, every_s=0)

    def metric(self, name):
        found = re.search(rf'^{re.escape(name)} (\S+)$', self.ask('GET', '/metrics').body.decode(), re.M)
        return float(found[1])


def form(parts):
    """multipart/form-data. A value is bytes or text, or (filename, bytes), or a list of such."""
    boundary = 'test-boundary-7'
    body = b''
    for name, values in parts.items():
        for value in values if isinstance(values, list) else [values]:
            filename, content = value if isinstance(value, tuple) else (None, value)
            content = content.encode() if isinstance(content, str) else content
            field = f'form-data; name="{name}"' + (f'; filename="{filename}"' if filename else '')
            body += f'--{boundary}\r\nContent-Disposition: {field}\r\n\r\n'.encode() + content + b'\r\n'
    return body + f'--{boundary}--\r\n'.encode(), f'multipart/form-data; boundary={boundary}'


class WebSocket:
    """A client's end, as RFC 6455 has it; `refused` is the HTTP answer where there is no WebSocket."""

    def __init__(self, server, path, headers=''):
        self.link = server.connect()
        key = base64.b64encode(os.urandom(16)).decode()
        self.link.sendall(
            f'GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nUpgrade: websocket\r\nConnection:'
            f' Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n{headers}\r\n'.encode()
        )
        self.buffer = b''
        while b'\r\n\r\n' not in self.buffer:
            piece = self.link.recv(65536)
            expect(piece, 'the server closed before its answer')
            self.buffer += piece
        head, self.buffer = self.buffer.split(b'\r\n\r\n', 1)
        self.status = int(head.split()[1])
        self.head = head.decode()
        self.closed_with = None

    def __enter__(self):
        return self

    def __exit__(self, *ignored):
        self.link.close()

    def _take(self, count):
        while len(self.buffer) < count:
            piece = self.link.recv(65536)
            if not piece:
                raise EOFError
            self.buffer += piece
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def send(self, data):
        """Text as a text message, bytes as a binary one, anything else as JSON."""
        if not isinstance(data, (str, bytes)):
            data = json.dumps(data)
        self._frame(1 if isinstance(data, str) else 2, data.encode() if isinstance(data, str) else data)

    def _frame(self, code, payload):
        length = len(payload)
        head = bytes([0x80 | code]) + (
            bytes([0x80 | length])
            if length < 126
            else bytes([0x80 | 126]) + struct.pack('>H', length)
            if length < 65536
            else bytes([0x80 | 127]) + struct.pack('>Q', length)
        )
        mask = os.urandom(4)
        self.link.sendall(head + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(payload)))

    def receive(self):
        """The next message, text or bytes; None once the server has closed (`closed_with` is its code)."""
        whole, kind = b'', None
        while True:
            try:
                first, second = self._take(2)
                length = second & 127
                if length == 126:
                    (length,) = struct.unpack('>H', self._take(2))
                elif length == 127:
                    (length,) = struct.unpack('>Q', self._take(8))
                payload = self._take(length)
            except (EOFError, ConnectionError):
                return None
            code = first & 15
            if code == 9:
                self._frame(10, payload)
            elif code == 8:
                self.closed_with = struct.unpack('>H', payload[:2])[0] if len(payload) >= 2 else 1005
                try:
                    self._frame(8, payload)
                except ConnectionError:  # gone already
                    pass
                return None
            elif code in (0, 1, 2):
                kind = kind or code
                whole += payload
                if first & 0x80:
                    return whole.decode() if kind == 1 else whole

    def json(self):
        message = self.receive()
        return json.loads(message) if isinstance(message, str) else message
