import numpy as np
import pytest

import palpate

FACES = np.array(
    [
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 6],
        [1, 6, 5],
        [2, 3, 7],
        [2, 7, 6],
        [3, 0, 4],
        [3, 4, 7],
    ]
)


def box(half, z=0.0):
    """Vertices and faces of a box with these half sides, its middle at a height, m."""
    corners = [[x, y, k] for k in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return np.array(corners, float) * half + [0, 0, z], FACES


def at(*heights):
    """The tool upright at these heights: poses (N, 7)."""
    poses = np.zeros((len(heights), 7))
    poses[:, 2], poses[:, 6] = heights, 1
    return poses


#: A cube of 20 mm over a plate whose top is at z = 0: at height z it is z - 10 mm off.
CUBE, PLATE = box([0.01, 0.01, 0.01]), box([0.1, 0.1, 0.01], -0.01)


@pytest.fixture(scope='session')
def boxes():
    return palpate.Scene(tool=CUBE, static=PLATE, engine='cpu')


@pytest.fixture(scope='session')
def clamp(tmp_path_factory):
    """The path of a scene file: a clamp on a pipe among solids."""
    return palpate.generate(
        'disassembly', tmp_path_factory.mktemp('clamp'), triangles=5000, tool_triangles=2000
    )


def random_poses(scene, count, seed=1):
    """Poses turned at random about where the tool starts, most of them in contact."""
    source = np.random.default_rng(seed)
    poses = np.empty((count, 7))
    poses[:, :3] = scene.start[:3] + source.normal(0, 0.03, (count, 3))
    turns = source.normal(0, 1, (count, 4))
    poses[:, 3:] = turns / np.linalg.norm(turns, axis=1, keepdims=True)
    return poses
