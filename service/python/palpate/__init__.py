"""palpate: exact contact, force and distance between a tool and a large mock-up. docs/PYTHON.md is the
guide."""
from __future__ import annotations

import os
from typing import Any, Union

from ._library import PalpateError, call, text
from .columns import (
    COLUMNS,
    DISTANCE_COLUMNS,
    ENGINES,
    MOTION_COLUMNS,
    NO_TRIANGLE,
    Columns,
    Distances,
    Motions,
)
from .contact import Contact
from .drawing import draw
from .manager import CollisionManager
from .poses import matrix_of_pose, pose_of_matrix
from .run import Run
from .scene import Scene

__version__: str = text('version')
__all__ = [
    'COLUMNS',
    'CollisionManager',
    'Columns',
    'Contact',
    'DISTANCE_COLUMNS',
    'Distances',
    'ENGINES',
    'MOTION_COLUMNS',
    'Motions',
    'NO_TRIANGLE',
    'PalpateError',
    'Run',
    'Scene',
    'draw',
    'generate',
    'matrix_of_pose',
    'pose_of_matrix',
]


def generate(
    name: str, folder: Union[str, os.PathLike[str]], triangles: int = 0, tool_triangles: int = 0
) -> str:
    """Writes a generated scene, 'contacts' or 'disassembly', to a folder; gives the path of its scene.json.
    0: the usual counts."""
    call('generate', name.encode(), triangles, tool_triangles, os.fsencode(folder))
    return os.path.join(folder, 'scene.json')


def __getattr__(name: str) -> Any:
    """`sweep` and its `Grid` of poses (docs/SWEEPS.md), loaded when they are wanted: Dask and Zarr take a
    second."""
    if name in ('Grid', 'sweep'):
        from . import sweeps

        return getattr(sweeps, name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
