"""The manager beside answers known beforehand, and poses as matrices."""
import numpy as np
import pytest
from conftest import CUBE, box

import palpate


def shift(x=0.0, y=0.0, z=0.0):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


@pytest.fixture(scope='module')
def manager():
    made = palpate.CollisionManager(engine='cpu')
    made.add_object('left', CUBE, shift(x=-0.05))
    made.add_object('right', CUBE, shift(x=0.05))
    return made


def test_names_of_what_touches(manager):
    assert manager.in_collision_single(CUBE) is False
    assert manager.in_collision_single(CUBE, shift(x=0.035), return_names=True) == (True, {'right'})
    long = box([0.06, 0.005, 0.005])
    hit, names, contact = manager.in_collision_single(long, return_names=True, return_data=True)
    assert hit and names == {'left', 'right'} and contact.pairs > 0
    assert manager.in_collision_single(box([0.002, 0.002, 0.002]), shift(x=-0.05))  # wholly inside


def test_distance_and_the_nearest(manager):
    distance, name = manager.min_distance_single(CUBE, shift(x=0.01), return_name=True)
    assert name == 'right' and abs(distance - 0.02) < 1e-6
    assert manager.min_distance_single(CUBE, shift(x=0.05)) == 0
    assert manager.min_distance_single(CUBE, shift(x=0.05), return_name=True) == (0, 'right')
    assert manager.min_distance_single(CUBE, shift(x=100), return_name=True) == (float('inf'), None)


def test_a_group_against_a_group(manager):
    other = palpate.CollisionManager(engine='cpu')
    other.add_object('a', CUBE, shift(x=0.06))
    other.add_object('b', CUBE, shift(z=0.1))
    assert manager.in_collision_other(other, return_names=True) == (True, {('right', 'a')})
    other.set_transform('a', shift(x=0.08))
    assert not manager.in_collision_other(other)
    assert abs(manager.min_distance_other(other) - 0.01) < 1e-6


def test_arrays_belong_to_their_maker_again():
    vertices, faces = box([0.01, 0.01, 0.01])
    vertices, faces = np.array(vertices, float), np.array(faces, np.uint32)
    made = palpate.CollisionManager(engine='cpu')
    made.add_object('here', (vertices, faces))
    vertices += [0.1, 0, 0]
    made.add_object('there', (vertices, faces))
    vertices += [0.1, 0, 0]
    faces[:] = 0
    small = box([0.002, 0.002, 0.002])
    assert made.in_collision_single(small, return_names=True) == (True, {'here'})
    assert made.in_collision_single(small, shift(x=0.1), return_names=True) == (True, {'there'})


def test_moved_and_removed_objects_count_as_they_are():
    made = palpate.CollisionManager(engine='cpu')
    made.add_object('only', CUBE)
    assert made.in_collision_single(CUBE)
    made.set_transform('only', shift(x=1))
    assert not made.in_collision_single(CUBE)
    made.remove_object('only')
    with pytest.raises(palpate.PalpateError, match='without objects'):
        made.in_collision_single(CUBE)
    with pytest.raises(palpate.PalpateError, match="no object 'only'"):
        made.remove_object('only')


def test_matrices_and_poses_are_the_same():
    source = np.random.default_rng(3)
    poses = np.concatenate([source.normal(0, 1, (200, 3)), source.normal(0, 1, (200, 4))], 1)
    poses[:4, 3:] = np.eye(4)  # half turns about the axes, and none
    poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1, keepdims=True)
    back = palpate.pose_of_matrix(palpate.matrix_of_pose(poses))
    same = np.sign((back[:, 3:] * poses[:, 3:]).sum(1))[:, None]  # q and -q are one turn
    np.testing.assert_allclose(back[:, 3:] * same, poses[:, 3:], atol=1e-12)
    np.testing.assert_array_equal(back[:, :3], poses[:, :3])
    matrix = palpate.matrix_of_pose([0, 0, 0, 0, 0, np.sqrt(0.5), np.sqrt(0.5)])  # a quarter turn about z
    np.testing.assert_allclose(matrix[:3, :3] @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    with pytest.raises(palpate.PalpateError, match='mirrors'):
        palpate.pose_of_matrix(np.diag([1.0, 1, -1, 1]))
