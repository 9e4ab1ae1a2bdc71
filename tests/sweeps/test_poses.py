"""Where poses come from, and how they are cut into chunks."""
import tracemalloc

import numpy
import pytest

from palpate import PalpateError
from palpate.sweeps.chunks import Chunks
from palpate.sweeps.poses import FunctionPoses, Grid, source_of


def turned(quaternion, point):
    """The point turned by a quaternion x y z w, by the textbook's matrix."""
    x, y, z, w = quaternion
    return (
        numpy.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        @ point
    )


def test_a_grid_has_every_combination_once_with_the_last_axis_fastest():
    grid = Grid(x=(0, 1, 3), y=[5.0, 7.0], rz=(0, 90, 2))
    assert grid.shape == (3, 2, 1, 1, 1, 2) and grid.count == 12
    poses = grid.poses(0, 12)
    assert poses[:, :3].tolist() == [[x, y, 0] for x in (0, 0.5, 1) for y in (5, 7) for _ in range(2)]
    assert poses[0, 3:].tolist() == [0, 0, 0, 1]
    assert numpy.allclose(
        poses[1, 3:], [0, 0, 0.5**0.5, 0.5**0.5], rtol=0, atol=1e-15
    )  # a rounding or two


def test_a_grid_turns_about_the_worlds_x_then_y_then_z():
    grid = Grid(rx=[30.0], ry=[50.0], rz=[70.0])
    point = numpy.array([0.3, -0.2, 0.9])
    for axis, angle in ((0, 30), (1, 50), (2, 70)):
        half = numpy.radians(angle) / 2
        point = turned([*(numpy.sin(half) * numpy.eye(3)[axis]), numpy.cos(half)], point)
    # Four products and sums of roundings each.
    assert numpy.allclose(
        turned(grid.poses(0, 1)[0, 3:], numpy.array([0.3, -0.2, 0.9])), point, rtol=0, atol=1e-15
    )


def test_a_part_of_a_grid_is_the_same_bits_as_in_the_whole():
    grid = Grid(x=(-1, 1, 7), z=(0, 0.3, 11), rx=(0, 350, 36), rz=(-5, 5, 3))
    whole = grid.poses(0, grid.count)
    for start, n in ((0, 1), (17, 100), (grid.count - 3, 3)):
        assert grid.poses(start, n).tobytes() == whole[start : start + n].tobytes()


def test_a_grid_of_a_hundred_million_poses_takes_the_memory_of_a_chunk():
    tracemalloc.start()
    grid = Grid(x=(0, 1, 1000), y=(0, 1, 1000), rz=(0, 99, 100))
    assert grid.count == 10**8
    last = grid.poses(grid.count - 65536, 65536)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert last[-1, :2].tolist() == [1, 1]
    assert peak < 30 * 65536 * 8  # seven columns, six digits and what is between


@pytest.mark.parametrize(
    'axes, words',
    [
        ({'x': (0, 1, 0)}, 'axis x'),
        ({'x': (0, 1, 1)}, 'axis x'),
        ({'y': (0, 1, 2.5)}, 'axis y'),
        ({'z': float('nan')}, 'finite'),
        ({'rx': (0.0, float('nan'), 3)}, 'finite'),
        ({'rx': 'a'}, 'axis rx'),
        ({'ry': []}, 'axis ry'),
        ({'rz': (0, 1, 10**6 + 1)}, '1000001 angles'),
    ],
)
def test_an_axis_that_is_none_is_refused_by_its_name(axes, words):
    with pytest.raises(PalpateError, match=words):
        Grid(**axes)


@pytest.mark.parametrize(
    'poses, count, words',
    [
        (numpy.zeros((3, 6)), None, r'\(3, 6\)'),
        (numpy.zeros((0, 7)), None, r'\(0, 7\)'),
        (lambda start, n: None, None, 'count'),
        (lambda start, n: None, 0, '0'),
    ],
)
def test_poses_that_are_none_are_refused(poses, count, words):
    with pytest.raises(PalpateError, match=words):
        source_of(poses, count)


def _boom(start, n):
    raise ValueError('boom')


def test_a_function_that_gives_another_number_of_poses_is_refused():
    with pytest.raises(PalpateError, match=r'asked for 5 from 10 on, gave shape \(4, 7\)'):
        FunctionPoses(lambda start, n: numpy.zeros((n - 1, 7)), 100).poses(10, 5)
    with pytest.raises(PalpateError, match='asked for 5 from 10 on, failed: ValueError: boom'):
        FunctionPoses(_boom, 100).poses(10, 5)
    with pytest.raises(PalpateError, match='they are complex'):
        source_of(numpy.zeros((3, 7), complex)).poses(0, 3)
    rows = numpy.zeros((100, 7))
    rows[42, 3] = numpy.nan
    with pytest.raises(
        PalpateError, match='rows 40 to 49 of the poses gave a number that is not finite, in row 42'
    ):
        source_of(rows).poses(40, 10)
    with pytest.raises(PalpateError, match='not finite'):
        FunctionPoses(lambda start, n: numpy.full((n, 7), numpy.inf), 100).poses(10, 5)


def test_chunks_hold_every_pose_once():
    for poses, size in ((1, 10), (10, 10), (11, 10), (65537, 65536)):
        chunks = Chunks(poses, size)
        numbers = [
            pose
            for number in range(chunks.count)
            for pose in range(chunks.span(number)[0], sum(chunks.span(number)))
        ]
        assert numbers == list(range(poses))


def test_one_chunk_in_a_hundred_is_asked_twice_and_always_the_same():
    assert [len(Chunks(n, 1).asked_twice(0.01)) for n in (1, 100, 101, 1526)] == [1, 1, 2, 16]
    assert Chunks(1000, 1).asked_twice(0.01) == Chunks(10000, 10).asked_twice(0.01)
    assert not Chunks(1000, 1).asked_twice(0) and len(Chunks(7, 1).asked_twice(1)) == 7
