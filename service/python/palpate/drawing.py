"""A contact as a picture, for notebooks."""
from __future__ import annotations

from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike

from ._library import PalpateError
from .poses import matrix_of_pose
from .scene import Scene

_STATIC, _TOOL, _STATIC_HIT, _TOOL_HIT = '#b8bcc2', '#8fa9c4', '#d1495b', '#2e86ab'


def draw(scene: Scene, pose: Optional[ArrayLike] = None, axes: Any = None, margin: float = 0.25) -> Any:
    """Draws the tool at a pose (7,), the start by default, and what of the mock-up is near it, triangles that
    touch in colour, the force as an arrow as long as the tool. Gives the matplotlib axes.

    axes: three-dimensional ones to draw on. margin: how far beyond the tool the mock-up is drawn, by the
    tool's longest side."""
    try:
        from matplotlib import pyplot  # type: ignore[import]
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import]
    except ImportError:
        raise PalpateError(
            2, 'drawing needs matplotlib, which is not installed (Debian: python3-matplotlib)'
        ) from None
    found = scene.query(scene.start if pose is None else pose)
    matrix = matrix_of_pose(found.pose)
    tool = scene.triangles('tool') @ matrix[:3, :3].T + matrix[:3, 3]
    low, high = tool.min((0, 1)), tool.max((0, 1))
    reach = margin * (high - low).max()
    mockup = scene.triangles('static')
    near = (mockup.max(1) >= low - reach).all(1) & (mockup.min(1) <= high + reach).all(1)

    if axes is None:
        axes = pyplot.figure().add_subplot(projection='3d')
    for corners, shown, hits, plain, coloured in (
        (mockup, near, np.union1d(found.cst, found.est), _STATIC, _STATIC_HIT),
        (tool, np.ones(len(tool), bool), np.union1d(found.cmt, found.imt), _TOOL, _TOOL_HIT),
    ):
        hit = np.zeros(len(corners), bool)
        hit[hits.astype(np.intp)] = True
        axes.add_collection3d(
            Poly3DCollection(corners[shown & ~hit], facecolor=plain, edgecolor='none', alpha=0.25)
        )
        axes.add_collection3d(Poly3DCollection(corners[hit], facecolor=coloured, edgecolor='none', alpha=0.9))
    strength = float(np.linalg.norm(found.force))
    middle = matrix[:3, :3] @ np.array(scene.description['centre_of_mass']) + matrix[:3, 3]
    if strength > 0:
        axes.quiver(*middle, *(found.force / strength * (high - low).max()), color=_STATIC_HIT)
    axes.set(
        xlabel='x, m',
        ylabel='y, m',
        zlabel='z, m',
        title=f'{found.pairs} pairs, {strength:.3g} N' if found.contact else 'no contact',
        xlim=(low[0] - reach, high[0] + reach),
        ylim=(low[1] - reach, high[1] + reach),
        zlim=(low[2] - reach, high[2] + reach),
    )
    axes.set_box_aspect(high - low + 2 * reach)
    return axes
