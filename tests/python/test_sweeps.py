"""Sweeps over a real scene. tests/sweeps has what may befall one."""
import json
import subprocess
import sys

import numpy as np

import palpate
from conftest import CUBE, PLATE

# 30 poses: the reference takes a tenth of a second for a force.
GRID = dict(x=(-0.05, 0.105, 3), z=(-0.005, 0.015, 5), rx=(0, 40, 2))


def test_every_question_is_answered_as_the_scene_itself_does_and_by_two_engines(boxes, tmp_path):
    from distributed import Client, LocalCluster

    grid = palpate.Grid(**GRID)
    poses = grid.poses(0, grid.count)
    with LocalCluster(
        n_workers=1, threads_per_worker=2, processes=True, dashboard_address=':0'
    ) as cluster, Client(cluster) as client:
        for ask, answers in (
            ('touches', {'touches': boxes.touches(poses)}),
            ('clearance', boxes.clearance(poses)),
            ('query', boxes.query_batch(poses)),
        ):
            done = palpate.sweep(
                boxes, grid, ask=ask, out=tmp_path / ask, size=10, share=0.5, client=client, quiet=True
            )
            assert (done.poses, done.chunks, done.twice) == (30, 3, 2)
            for name, values in answers.items():
                if name != 'engine':
                    assert np.array_equal(done.answers(name)[:], values, equal_nan=True), name
        assert not done.answers('truncated')[:].any() and done.answers('contact')[:].any()


def test_a_scene_file_is_swept_by_the_command(tmp_path):
    scene = palpate.generate('contacts', tmp_path, triangles=2000, tool_triangles=1000)
    words = [
        sys.executable,
        '-m',
        'palpate.sweeps',
        scene,
        '--out',
        str(tmp_path / 'out.zarr'),
        '--x=-0.05:0.05:5',
        '--y=-0.1:0:5',
        '--z=0.1:0.2:4',
        '--size',
        '40',
        '--workers',
        '1',
    ]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    attributes = json.loads((tmp_path / 'out.zarr/.zattrs').read_text())
    assert attributes['hash'] in done.stdout and attributes['again'] == ['ref']
    assert attributes['question']['scene'] == palpate.Scene(scene).hash
