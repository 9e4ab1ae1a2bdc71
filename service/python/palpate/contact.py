"""All that is known of one pose."""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


class Contact:
    """What touches at a pose. `cst`, `bst`, `cmt`, `bmt`, `imt`, `est`: triangles of the sets of
    docs/NOTATION.md, ascending (uint32)."""

    def __init__(self, line: dict[str, Any]) -> None:
        #: The line that `palpate query --names --json` prints, read.
        self.line = line
        self.pose: NDArray[np.float64] = np.array(line['pose'])
        #: They touch, containment included.
        self.contact: bool = line['contact']
        #: Pairs of triangles that intersect.
        self.pairs: int = line['pairs']
        self.cst, self.bst, self.cmt, self.bmt, self.imt, self.est = (
            np.array(line[name], np.uint32) for name in ('cst', 'bst', 'cmt', 'bmt', 'imt', 'est')
        )
        #: On the tool, world axes: N, and N·m about the tool's centre of mass.
        self.force: NDArray[np.float64] = np.array(line['force'])
        self.torque: NDArray[np.float64] = np.array(line['torque'] or [0.0, 0.0, 0.0])
        #: Paths of the parts that touch.
        self.static_parts: list[str] = line['parts']['static']
        self.tool_parts: list[str] = line['parts']['tool']
        #: Contact areas: id, zones, triangles, normal, depth, point, force, torque, flags.
        self.areas: list[dict[str, Any]] = line['areas']
        self.flags: list[str] = line['flags']
        self.truncated: bool = line['truncated']

    def __repr__(self) -> str:
        return (
            f'<palpate.Contact: {self.pairs} pairs, force {self.force} N>'
            if self.contact
            else '<palpate.Contact: none>'
        )
