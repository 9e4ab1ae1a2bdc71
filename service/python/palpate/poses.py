"""Poses as 4 × 4 matrices and back."""
from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._library import PalpateError


def pose_of_matrix(matrix: ArrayLike) -> NDArray[np.float64]:
    """Poses (…, 7), x y z qx qy qz qw, of homogeneous matrices (…, 4, 4) that turn and shift alone. Raises
    PalpateError."""
    given = np.asarray(matrix, np.float64)
    if given.shape[-2:] != (4, 4):
        raise PalpateError(2, f'matrices have the shape {given.shape}; (…, 4, 4) is wanted')
    turn = given[..., :3, :3]
    if (
        not np.allclose(turn @ np.swapaxes(turn, -1, -2), np.eye(3), atol=1e-6)
        or not (np.linalg.det(turn) > 0).all()
    ):
        raise PalpateError(3, 'a matrix scales, shears or mirrors; a pose turns and shifts alone')
    # The largest of the four squares keeps the root away from 0: 4 q² of w, x, y, z.
    diagonal = np.diagonal(turn, axis1=-2, axis2=-1)
    squares = np.stack(
        [1 + diagonal.sum(-1), *(1 + 2 * diagonal[..., k] - diagonal.sum(-1) for k in range(3))], -1
    )
    across = [turn[..., (k + 2) % 3, (k + 1) % 3] - turn[..., (k + 1) % 3, (k + 2) % 3] for k in range(3)]
    beside = [turn[..., (k + 2) % 3, (k + 1) % 3] + turn[..., (k + 1) % 3, (k + 2) % 3] for k in range(3)]
    rows = [
        [squares[..., 0], *across],
        [across[0], squares[..., 1], beside[2], beside[1]],
        [across[1], beside[2], squares[..., 2], beside[0]],
        [across[2], beside[1], beside[0], squares[..., 3]],
    ]
    # (…, 4, 4): rows w x y z, each up to a factor the quaternion.
    every = np.stack([np.stack(row, -1) for row in rows], -2)
    best = np.take_along_axis(every, squares.argmax(-1)[..., None, None], -2)[..., 0, :]
    best = best / np.linalg.norm(best, axis=-1, keepdims=True)
    return np.concatenate([given[..., :3, 3], best[..., 1:], best[..., :1]], -1)


def matrix_of_pose(pose: ArrayLike) -> NDArray[np.float64]:
    """Homogeneous matrices (…, 4, 4) of poses (…, 7)."""
    given = np.asarray(pose, np.float64)
    x, y, z, w = np.moveaxis(given[..., 3:] / np.linalg.norm(given[..., 3:], axis=-1, keepdims=True), -1, 0)
    out = np.zeros(given.shape[:-1] + (4, 4))
    out[..., 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], -1)
    out[..., 1, :3] = np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], -1)
    out[..., 2, :3] = np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1)
    out[..., :3, 3] = given[..., :3]
    out[..., 3, 3] = 1
    return out
