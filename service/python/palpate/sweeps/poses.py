# mypy: ignore-errors
"""Where a sweep's poses come from: a grid, a function or an array. Any run of them can be made by itself, on
any machine, from its first number alone, and is the same bits there.

A pose is x y z qx qy qz qw: metres, a unit quaternion, world from tool, as everywhere in palpate.
"""
import hashlib
import math

import numpy

from .words import refuse

# A table of an angle's sines and cosines travels to every worker; 10^6 of them are 16 MB (chosen).
MOST_ANGLES = 10**6
MOST_POSES = 2**63 - 1  # numpy's


class Grid:
    """All combinations of six axes, each a number, a range `(first, last, count)` that holds both ends, or a
    list of values.

    x, y, z : position of the tool's frame, metres, world frame. rx, ry, rz : turns about the world's x, y and
    z axis through the tool's origin, degrees, done in this order.

    Nothing is kept but the axes: 10^8 poses take no memory. The last axis runs fastest; `shape` has the six
    counts, so that `answers.reshape(grid.shape)` has an axis each. Sines are worked out here, once, and
    travel with the grid: numpy's differ in the last bit from processor to processor."""

    NAMES = ('x', 'y', 'z', 'rx', 'ry', 'rz')

    def __init__(self, x=0.0, y=0.0, z=0.0, rx=0.0, ry=0.0, rz=0.0):
        self._axes = [_axis(name, axis) for name, axis in zip(self.NAMES, (x, y, z, rx, ry, rz))]
        self.shape = tuple(len(axis) for axis in self._axes)
        self.count = math.prod(self.shape)
        if self.count > MOST_POSES:
            refuse(f'a grid of {self.count} poses is too large; at most {MOST_POSES} can be numbered')
        for name, axis in zip(self.NAMES[3:], self._axes[3:]):
            if len(axis) > MOST_ANGLES:
                refuse(f'{name} has {len(axis)} angles; at most {MOST_ANGLES} can be tabled')
        self._halves = [_half_angles(axis) for axis in self._axes[3:]]

    def axis(self, name):
        """The values of axis `name`: float64 (count,), metres or degrees."""
        axis = self._axes[self.NAMES.index(name)]
        return axis.at(numpy.arange(len(axis)))

    def describe(self):
        return {'kind': 'grid', **{name: axis.describe() for name, axis in zip(self.NAMES, self._axes)}}

    def poses(self, start, n):
        """Poses start … start + n − 1: float64 (n, 7)."""
        digits = numpy.unravel_index(numpy.arange(start, start + n, dtype=numpy.int64), self.shape)
        out = numpy.empty((n, 7))
        for column in range(3):
            out[:, column] = self._axes[column].at(digits[column])
        (sx, cx), (sy, cy), (sz, cz) = (half[:, digit] for half, digit in zip(self._halves, digits[3:]))
        # q = q_z q_y q_x, by products and sums alone: these are the same on every processor.
        out[:, 3] = cz * cy * sx - sz * sy * cx
        out[:, 4] = cz * sy * cx + sz * cy * sx
        out[:, 5] = sz * cy * cx - cz * sy * sx
        out[:, 6] = cz * cy * cx + sz * sy * sx
        return out


class FunctionPoses:
    """`function(start, n)` gives poses start … start + n − 1 of `count`, float64 (n, 7). It must give the
    same whenever and wherever it is called, and be something that cloudpickle can send."""

    def __init__(self, function, count):
        if isinstance(count, bool) or not isinstance(count, (int, numpy.integer)) or count < 1:
            refuse(f'a function of poses needs their count, a whole number from 1 on; it is {count!r}')
        self.function, self.count = function, int(count)

    def describe(self):
        # A function's code has no name that lasts, so what it gives stands for it.
        ends = hashlib.sha256()
        for start in sorted({0, self.count // 2, self.count - 1}):
            ends.update(self.poses(start, min(16, self.count - start)).tobytes())
        return {
            'kind': 'function',
            'name': getattr(self.function, '__qualname__', 'function'),
            'count': self.count,
            'sample': ends.hexdigest(),
        }

    def poses(self, start, n):
        whose = f'the function of poses, asked for {n} from {start} on,'
        try:
            rows = self.function(start, n)
        except Exception as error:  # whatever a caller's function raises
            refuse(f'{whose} failed: {type(error).__name__}: {error}')
        return checked(rows, n, whose)


class ArrayPoses:
    """Rows of an array of poses (N, 7); the store keeps them, so that workers read theirs there."""

    def __init__(self, rows):
        self.rows = rows
        self.count = len(rows)

    def describe(self):
        digest = hashlib.sha256()
        for start in range(0, self.count, 1 << 16):
            digest.update(self.poses(start, min(1 << 16, self.count - start)).tobytes())
        return {'kind': 'array', 'count': self.count, 'sha256': digest.hexdigest()}

    def poses(self, start, n):
        return checked(
            self.rows[start : start + n], n, f'rows {start} to {start + n - 1} of the poses', first=start
        )


def source_of(poses, count=None):
    """The source of what a caller gave as `poses`."""
    if isinstance(poses, (Grid, FunctionPoses, ArrayPoses)):
        return poses
    if callable(poses):
        return FunctionPoses(poses, count)
    rows = numpy.asanyarray(poses)  # keeps a file that is mapped into memory as it is
    if rows.ndim != 2 or rows.shape[1] != 7 or len(rows) == 0:
        refuse(f'poses are rows of seven numbers, shape (N, 7); these have shape {rows.shape}')
    return ArrayPoses(rows)


def checked(poses, n, whose, first=0):
    """Poses as float64 (n, 7); `first`: the number of the first row, for sentences."""
    try:
        if numpy.iscomplexobj(poses):
            raise TypeError('they are complex')
        rows = numpy.ascontiguousarray(poses, dtype=numpy.float64)
    except (TypeError, ValueError) as error:
        refuse(f'{whose} gave no numbers: {error}')
    if rows.shape != (n, 7):
        refuse(f'{whose} gave shape {rows.shape}, not ({n}, 7)')
    finite = numpy.isfinite(rows).all(axis=1)
    if not finite.all():
        refuse(f'{whose} gave a number that is not finite, in row {first + int(finite.argmin())}')
    return rows


class _Values:
    def __init__(self, values):
        self._values = values

    def __len__(self):
        return len(self._values)

    def at(self, numbers):
        return self._values[numbers]

    def describe(self):
        if len(self) <= 16:
            return self._values.tolist()
        return {'count': len(self), 'sha256': hashlib.sha256(self._values.tobytes()).hexdigest()}


class _Range:
    def __init__(self, first, last, count):
        self._first, self._last, self._count = first, last, count
        if not math.isfinite(last - first):
            raise OverflowError
        self._step = (last - first) / (count - 1) if count > 1 else 0.0

    def __len__(self):
        return self._count

    def at(self, numbers):
        # The last one is said, not summed up, so that it is the number that was asked for.
        return numpy.where(numbers == self._count - 1, self._last, self._first + numbers * self._step)

    def describe(self):
        return [self._first, self._last, self._count]


def _axis(name, axis):
    try:
        if isinstance(axis, tuple):
            first, last, count = axis
            if not numpy.isfinite((float(first), float(last), float(count))).all():
                refuse(f'axis {name}: every value is finite; it is {axis!r}')
            made, numbers = _Range(float(first), float(last), int(count)), (first, last)
            if count != int(count) or count < 1 or (count == 1 and first != last):
                refuse(
                    f'axis {name}: a range is (first, last, count) with a whole count from 1 on, and from 2'
                    f' on if its ends differ; it is {axis}'
                )
        else:
            numbers = numpy.atleast_1d(numpy.asarray(axis, dtype=numpy.float64))
            if numbers.ndim != 1 or len(numbers) == 0:
                refuse(f'axis {name}: values are a list of numbers; these have shape {numbers.shape}')
            made = _Values(numbers.copy())
    except (TypeError, ValueError, OverflowError):
        refuse(f'axis {name}: a number, a range (first, last, count) or a list of values; it is {axis!r}')
    if not numpy.isfinite(numbers).all():
        refuse(f'axis {name}: every value is finite; it is {axis!r}')
    return made


def _half_angles(axis):
    halves = [math.radians(angle) / 2 for angle in axis.at(numpy.arange(len(axis)))]
    return numpy.array([[math.sin(half) for half in halves], [math.cos(half) for half in halves]])
