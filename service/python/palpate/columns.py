"""Answers as NumPy columns: arrays that the library writes into."""
from __future__ import annotations

import ctypes
import math
from typing import Any, Iterator, Mapping, Optional

import numpy as np
from numpy.typing import NDArray

from ._library import PalpateError, pointers

Specification = Mapping[str, 'tuple[np.dtype[Any], tuple[int, ...]]']


def _specification(**columns: Any) -> dict[str, tuple[np.dtype[Any], tuple[int, ...]]]:
    return {name: (np.dtype(kind), tail) for name, (kind, *rest) in columns.items() for tail in [tuple(rest)]}


#: Columns of `Scene.query_batch`: dtype, and the shape of a pose's entry.
COLUMNS = _specification(
    contact=(np.bool_,),
    pairs=(np.uint64,),
    cst=(np.uint32,),
    bst=(np.uint32,),
    cmt=(np.uint32,),
    bmt=(np.uint32,),
    imt=(np.uint32,),
    est=(np.uint32,),
    areas=(np.uint32,),
    depth=(np.float64,),
    deepest_static=(np.uint32,),
    deepest_mobile=(np.uint32,),
    force=(np.float64, 3),
    torque=(np.float64, 3),
    tool=(np.float64, 7),
    evaluations=(np.uint32,),
    flags=(np.uint32,),
    truncated=(np.bool_,),
    engine=(np.uint8,),
)
#: Columns of `Scene.clearance`.
DISTANCE_COLUMNS = _specification(
    distance=(np.float64,),
    static_id=(np.uint32,),
    mobile_id=(np.uint32,),
    on_static=(np.float64, 3),
    on_mobile=(np.float64, 3),
    engine=(np.uint8,),
)
#: Columns of `Scene.first_contact`.
MOTION_COLUMNS = _specification(
    kind=(np.uint8,),
    time=(np.float64,),
    pose=(np.float64, 7),
    distance=(np.float64,),
    static_id=(np.uint32,),
    mobile_id=(np.uint32,),
    evaluations=(np.uint64,),
    engine=(np.uint8,),
)
#: Names of the codes in a column `engine`.
ENGINES = ('', 'gpu', 'cpu', 'ref')
#: What stands in columns of triangles for none.
NO_TRIANGLE = 0xFFFFFFFF


class _Columns(Mapping[str, 'NDArray[Any]']):
    """Columns by name: attributes, and a mapping. Their leading shape is that of the poses: `(N,)` for poses
    `(N, 7)`, `()` for one."""

    _specification: Specification = {}
    _struct: type[ctypes.Structure]

    def __init__(
        self,
        shape: tuple[int, ...],
        names: Optional[Any] = None,
        out: Optional[Mapping[str, NDArray[Any]]] = None,
    ) -> None:
        wanted: Any = (names,) if isinstance(names, str) else names
        if wanted is None:
            wanted = self._specification if out is None else out
        chosen = tuple(wanted)
        self._arrays: dict[str, NDArray[Any]] = {}
        self.shape = shape
        for name in chosen:
            if name not in self._specification:
                raise PalpateError(
                    2, f'there is no column {name!r}; the columns are {", ".join(self._specification)}'
                )
            dtype, tail = self._specification[name]
            self._arrays[name] = (
                np.empty(shape + tail, dtype)
                if out is None
                else _fitting(name, out.get(name), shape + tail, dtype)
            )
        self._flat = {name: array.reshape(-1) for name, array in self._arrays.items()}

    def _at(self, first: int) -> ctypes.Structure:
        """The library's struct for the poses from `first` on."""
        made = self._struct()
        made.size = ctypes.sizeof(made)
        for name, array in self._flat.items():
            step = array.itemsize * math.prod(self._specification[name][1])
            setattr(made, name, array.ctypes.data + first * step)
        return made

    def __getattr__(self, name: str) -> NDArray[Any]:
        arrays: dict[str, NDArray[Any]] = self.__dict__.get('_arrays', {})
        if name in arrays:
            return arrays[name]
        if name in self._specification:
            raise AttributeError(f'the column {name} was not asked for')
        raise AttributeError(name)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._arrays]

    @property
    def nbytes(self) -> int:
        """Bytes of all columns together."""
        return sum(array.nbytes for array in self._arrays.values())

    def __repr__(self) -> str:
        return (
            f'<{type(self).__name__} of {int(np.prod(self.shape, dtype=int))} poses:'
            f' {", ".join(self._arrays)}>'
        )

    def __getstate__(self) -> Any:
        return self.shape, self._arrays

    def __setstate__(self, state: Any) -> None:
        self.shape, self._arrays = state
        self._flat = {name: array.reshape(-1) for name, array in self._arrays.items()}


def _fitting(name: str, array: Any, shape: tuple[int, ...], dtype: np.dtype[Any]) -> NDArray[Any]:
    if (
        not isinstance(array, np.ndarray)
        or array.dtype != dtype
        or array.shape != shape
        or not array.flags.c_contiguous
        or not array.flags.writeable
    ):
        raise PalpateError(
            2, f'the column {name} must be a writable C-contiguous array of shape {shape} and dtype {dtype}'
        )
    return array


class Columns(_Columns):
    """What `Scene.query_batch` finds, a row a pose.

    contact (bool): they touch, containment included. pairs (uint64): triangles that intersect. cst, bst, cmt,
    bmt, imt, est (uint32): lengths of the sets (docs/NOTATION.md). areas (uint32): of contact. depth
    (float64, m): of the deepest sample; 0: none is inside. deepest_static, deepest_mobile (uint32): its
    triangles. force (…, 3; N) and torque (…, 3; N·m, about the tool's centre of mass), on the tool, world
    axes. tool (…, 7): where the tool is while the hand is at the pose. evaluations (uint32): of the field.
    flags (uint32): bits of palpate.h. truncated (bool): a list was too small, and there is no force. engine
    (uint8): ENGINES[code] answered."""

    _specification = COLUMNS
    _struct = pointers('palpate_columns', tuple(COLUMNS))


class Distances(_Columns):
    """What `Scene.clearance` finds, a row a pose.

    distance (float64, m): 0: they touch; inf: further than `within`, or beyond the lattice's reach
    (Scene.description). static_id, mobile_id (uint32): the nearest pair of triangles, or NO_TRIANGLE.
    on_static, on_mobile (…, 3; m, world): its nearest points; nan where there are none. engine (uint8):
    ENGINES[code]."""

    _specification = DISTANCE_COLUMNS
    _struct = pointers('palpate_distances', tuple(DISTANCE_COLUMNS))


class Motions(_Columns):
    """What `Scene.first_contact` finds, a row a motion.

    kind (uint8): 0 clear, 1 contact, 2 undecided (so near for so long that the search was given up). time
    (float64, 0 to 1): clear until then for certain. pose (…, 7): there. distance (float64, m): between the
    two there. static_id, mobile_id (uint32): that come together, or NO_TRIANGLE. evaluations (uint64): poses
    that were asked about. engine (uint8): ENGINES[code]."""

    _specification = MOTION_COLUMNS
    _struct = pointers('palpate_motions', tuple(MOTION_COLUMNS))

    @property
    def clear(self) -> NDArray[np.bool_]:
        """Whether the tool stays clear all the way."""
        return np.asarray(self['kind'] == 0)
