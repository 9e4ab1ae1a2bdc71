import json
import os
import pathlib
import subprocess
import sys

import pytest

HERE = pathlib.Path(__file__).resolve().parent
FAKE = HERE / 'fake'
sys.path[:0] = [str(FAKE), str(HERE)]
ENVIRONMENT = {**os.environ, 'PYTHONPATH': str(FAKE)}  # of workers and commands
os.environ['PYTHONPATH'] = str(FAKE)

# 40 x 40 x 20 x 3 poses in 20 chunks, as arguments and as a Grid.
AXES = ['--x=-1:1:40', '--y=-1:1:40', '--z=-1:1:20', '--rx', '0:90:3', '--size', '5000']


class Command:
    """palpate-sweep on the scene `source`; its chunks are counted by their markers."""

    def __init__(self, folder, source, *more):
        self.out = folder / 'out.zarr'
        scene = folder / 'scene.json'
        scene.write_text(json.dumps(source))
        self._words = [
            sys.executable,
            '-m',
            'palpate.sweeps',
            str(scene),
            '--out',
            str(self.out),
            *AXES,
            *more,
        ]

    def start(self, **how):
        return subprocess.Popen(
            self._words, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how
        )

    def run(self, **how):
        process = self.start(**how)
        out, err = process.communicate(timeout=300)
        return process.returncode, out, err

    def markers(self):
        folder = self.out / '.sweep'
        return (
            sorted(int(file.name) for file in folder.iterdir() if file.name.isdigit())
            if folder.is_dir()
            else []
        )


@pytest.fixture
def command(tmp_path):
    return lambda source, *more: Command(tmp_path, source, *more)
