"""Runs the palpate program as a person or a script would, and says what was seen. Python's standard library
only.

usage of a test script: SCRIPT.py PROGRAM SOURCE_DIRECTORY [PART_OF_A_CASE'S_NAME]
"""
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time
import traceback

PROGRAM = os.path.abspath(sys.argv[1])
SOURCE = pathlib.Path(sys.argv[2]).resolve()
os.environ.setdefault('PALPATE_CACHE', 'off')  # what is tested is worked out here and now
TIMEOUT_S = 900  # a hang is a failure, not a wait; a whole scene on a busy machine takes minutes


class Outcome:
    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err

    def __str__(self):
        return f'exit {self.code}\n--- stdout\n{self.out[:2000]}\n--- stderr\n{self.err[:2000]}'


def palpate(*arguments, cwd=None, **environment):
    done = subprocess.run(
        [PROGRAM, *map(str, arguments)],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=TIMEOUT_S,
        cwd=cwd,
        env={**os.environ, **environment},
    )
    return Outcome(done.returncode, done.stdout.decode(), done.stderr.decode())


def expect(condition, message):
    if not condition:
        raise AssertionError(str(message))


def expect_refused(outcome, code, *words):
    """One sentence on standard error that holds all `words`, nothing on standard output, and this exit
    code."""
    expect(outcome.code == code, f'expected exit {code}: {outcome}')
    expect(outcome.out == '', f'standard output should be empty: {outcome}')
    lines = outcome.err.strip().split('\n')
    # A machine without a Vulkan device says first that the CPU answers; progress is plain lines of `palpate:
    # <step>`.
    expect(lines[-1].startswith('palpate: '), f'no sentence: {outcome}')
    for word in words:
        expect(word in lines[-1], f"the sentence lacks '{word}': {lines[-1]}")
    for sign in ('what():', 'terminate', 'Aborted', 'Segmentation', 'exception'):
        expect(sign not in outcome.err, outcome)


def lines_of(outcome):
    expect(outcome.code == 0, outcome)
    return [json.loads(line) for line in outcome.out.splitlines()]


# ---- small meshes ---------------------------------------------------------------------------------------------------
def box(size, centre=(0, 0, 0)):
    """Twelve triangles, outward."""
    c = [[centre[i] + size[i] * (b >> i & 1) - size[i] / 2 for i in range(3)] for b in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return [(c[a], c[b], c[d]) for q in quads for a, b, d in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]


def sphere(radius, rows=12, centre=(0, 0, 0)):
    def point(i, j):
        t, p = math.pi * i / rows, math.pi * j / rows
        if i in (0, rows):  # one point, to the bit, at the poles
            return (centre[0], centre[1], centre[2] + (radius if i == 0 else -radius))
        j %= 2 * rows
        p = math.pi * j / rows
        return (
            centre[0] + radius * math.sin(t) * math.cos(p),
            centre[1] + radius * math.sin(t) * math.sin(p),
            centre[2] + radius * math.cos(t),
        )

    faces = []
    for i in range(rows):
        for j in range(2 * rows):
            a, b, c, d = point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)
            if i < rows - 1:
                faces.append((a, b, c))
            if i > 0:
                faces.append((a, c, d))
    return faces


def stl(triangles):
    body = b''.join(struct.pack('<12fH', 0, 0, 0, *a, *b, *c, 0) for a, b, c in triangles)
    return b'made by a test'.ljust(80) + struct.pack('<I', len(triangles)) + body


def gltf(nodes, triangles):
    """One mesh of `triangles`, named 'solid', for all nodes (dictionaries) that say "mesh": 0; the first node
    is the root."""
    import base64

    points = [point for triangle in triangles for point in triangle]
    data = b''.join(struct.pack('<3f', *point) for point in points)
    return json.dumps(
        {
            'asset': {'version': '2.0'},
            'scene': 0,
            'scenes': [{'nodes': [0]}],
            'nodes': nodes,
            'meshes': [{'name': 'solid', 'primitives': [{'attributes': {'POSITION': 0}}]}],
            'accessors': [
                {
                    'bufferView': 0,
                    'componentType': 5126,
                    'count': len(points),
                    'type': 'VEC3',
                    'min': [min(p[k] for p in points) for k in range(3)],
                    'max': [max(p[k] for p in points) for k in range(3)],
                }
            ],
            'bufferViews': [{'buffer': 0, 'byteLength': len(data)}],
            'buffers': [
                {
                    'byteLength': len(data),
                    'uri': 'data:application/octet-stream;base64,' + base64.b64encode(data).decode(),
                }
            ],
        }
    )


class Folder:
    """A scene's folder: a block of 200 × 200 × 40 mm below z = 0 as mock-up, a sphere of 20 mm as tool,
    unless told otherwise."""

    def __init__(self):
        self._folder = tempfile.TemporaryDirectory(prefix='palpate-test-')
        self.path = pathlib.Path(self._folder.name)
        self.write('block.stl', stl(box((0.2, 0.2, 0.04), (0, 0, -0.02))))
        self.write('ball.stl', stl(sphere(0.02)))
        self.scene = {
            'static': [{'mesh': 'block.stl', 'units': 'm'}],
            'tool': {'mesh': 'ball.stl', 'units': 'm'},
            'response': {'stiffness': 2000},
        }

    def write(self, name, content):
        path = self.path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def save(self, name='scene.json', **changes):
        return self.write(name, json.dumps({**self.scene, **changes}))

    def __truediv__(self, name):
        return self.path / name


def ball_on_block(folder, side=0.06, poses=8, step=0.0002):
    """A scene of a ball of 10 mm pressed by `step` m a pose, from 1 mm on, into a block of `side` m, with
    poses.csv beside it."""
    folder.write('block.stl', stl(box((side, side, side / 2), (0, 0, -side / 4))))
    folder.write('ball.stl', stl(sphere(0.01)))
    folder.write(
        'poses.csv',
        'x,y,z,qx,qy,qz,qw\n'
        + ''.join(f'{0.001 * i},{0.0007 * i},{0.009 - step * i},0,0,0,1\n' for i in range(poses)),
    )
    return folder.save()


def main(cases):
    wanted = sys.argv[3] if len(sys.argv) > 3 else ''
    passed = failed = 0
    for name, case in list(cases.items()):
        if not name.startswith('test_') or wanted not in name:
            continue
        start = time.monotonic()
        try:
            case()
            passed += 1
            print(f'ok      {name[5:]}  ({time.monotonic() - start:.1f} s)', flush=True)
        except Exception as error:
            failed += 1
            place = traceback.extract_tb(error.__traceback__)[1]
            print(f'FAILED  {name[5:]}, line {place.lineno}: {type(error).__name__}: {error}', flush=True)
    print(f'{passed} passed, {failed} failed')
    sys.exit(1 if failed or not passed else 0)
