"""Answers known beforehand from boxes, and the command line's for a scene of thousands of triangles."""
import json
import os
import subprocess

import numpy as np
import pytest
from conftest import CUBE, PLATE, at, random_poses

import palpate


def test_the_version_is_the_projects():
    line = subprocess.run(
        [os.environ['PALPATE_PROGRAM'], '--version'], capture_output=True, text=True, check=True
    ).stdout
    assert palpate.__version__ in line


def test_touches_tells_containment_from_free(boxes):
    assert boxes.touches(at(0.02, 0.009, -0.01, -0.05)).tolist() == [False, True, True, False]
    assert boxes.touches(at(0.009)[0]).shape == ()  # one pose, one answer
    assert boxes.touches(np.empty((0, 7))).shape == (0,)


def test_clearance_is_the_gap(boxes):
    found = boxes.clearance(at(0.03, 0.009, 0.5), within=0.1)
    np.testing.assert_allclose(found.distance, [0.02, 0, np.inf], atol=1e-6)
    np.testing.assert_allclose(found.on_static[0, 2], 0, atol=1e-6)
    assert found.static_id[1] == palpate.NO_TRIANGLE and np.isnan(found.on_mobile[2]).all()
    assert palpate.ENGINES[found.engine[0]] == 'cpu'


def test_clearance_reaches_as_far_as_the_description_says(boxes):
    reach, origin = boxes.description['reach'], boxes.description['origin']
    inside, outside = origin[2] + reach - 0.02, origin[2] + reach + 0.02
    found = boxes.clearance(at(inside, outside)).distance
    np.testing.assert_allclose(found, [inside - 0.01, np.inf], atol=1e-6)


def test_first_contact_is_never_late(boxes):
    found = boxes.first_contact(at(0.11), at(-0.09, 0.06))
    assert found.clear.tolist() == [False, True]
    assert 0.5 - 1e-5 < found.time[0] <= 0.5
    one = boxes.first_contact(at(0.11)[0], at(0.06)[0])
    assert one.clear and one.time == 1


def test_force_pushes_out_of_the_plate(boxes):
    force, torque = boxes.wrench(at(0.009)[0])
    assert force.shape == (3,) and force[2] > 0.1
    # Samples lie on a grid, not about the middle.
    np.testing.assert_allclose(np.append(force[:2], torque), 0, atol=1e-4 * force[2])


def test_only_the_columns_asked_for_are_made(boxes):
    found = boxes.query_batch(at(0.02, 0.009), ('contact', 'cst'))
    assert list(found) == ['contact', 'cst'] and found.contact.dtype == bool and found.nbytes == 2 * 5
    with pytest.raises(AttributeError, match='force was not asked for'):
        found.force
    whole = boxes.query_batch(at(0.02, 0.009))
    assert {name: (array.dtype, array.shape[1:]) for name, array in whole.items()} == palpate.COLUMNS


def test_columns_are_written_in_place(boxes):
    mine = {'depth': np.zeros(2), 'force': np.zeros((2, 3))}
    found = boxes.query_batch(at(0.02, 0.009), out=mine)
    assert found.depth is mine['depth'] and mine['depth'][1] > 0 and mine['force'][1, 2] > 0
    with pytest.raises(palpate.PalpateError, match=r'shape \(2, 3\) and dtype float64'):
        boxes.query_batch(at(0.02, 0.009), out={'force': np.zeros((3, 2))})
    with pytest.raises(palpate.PalpateError, match='the column depth'):
        boxes.query_batch(at(0.02, 0.009), ('depth',), out={'force': np.zeros((2, 3))})


def test_lists_are_the_triangles_that_meet(boxes):
    found = boxes.query(at(0.009)[0])
    assert (
        found.contact
        and found.cst.tolist() == [2, 3]
        and found.static_parts == ['static 0']
        and found.tool_parts == ['tool']
    )


def test_a_scene_in_millimetres_is_the_same():
    scaled = [(1000 * vertices, faces) for vertices, faces in (CUBE, PLATE)]
    scene = palpate.Scene(
        {'tool': {'mesh': scaled[0], 'units': 'mm'}, 'static': [{'mesh': scaled[1], 'scale': 0.001}]},
        engine='cpu',
    )
    np.testing.assert_allclose(scene.clearance(at(0.03)).distance, 0.02, atol=1e-6)


def test_engines_give_equal_bits(clamp):
    scenes = [palpate.Scene(clamp, engine=engine) for engine in ('cpu', 'ref')]
    poses = random_poses(scenes[0], 12)
    one, other = (scene.query_batch(poses) for scene in scenes)
    assert scenes[0].hash == scenes[1].hash and len(scenes[0].hash) == 32
    assert one.contact.any() and (one.engine == 2).any()
    for name in one:
        if name != 'engine':
            np.testing.assert_array_equal(one[name], other[name], name)


def test_answers_are_those_of_the_command_line_bit_by_bit(clamp, tmp_path):
    scene = palpate.Scene(clamp, engine='cpu')
    poses = random_poses(scene, int(os.environ.get('PALPATE_TEST_POSES', 60)))
    file = tmp_path / 'poses.csv'
    np.savetxt(file, poses, '%.17g', ',', header='x,y,z,qx,qy,qz,qw', comments='')
    done = subprocess.run(
        [os.environ['PALPATE_PROGRAM'], 'query', clamp, '--poses', file, '--json', '--backend', 'cpu'],
        capture_output=True,
        text=True,
        check=True,
    )
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    found = scene.query_batch(poses)
    assert len(lines) == len(poses) and found.contact.sum() > len(poses) // 4
    for name in ('contact', 'pairs', 'truncated', 'force', 'torque'):
        np.testing.assert_array_equal(found[name], [line[name] for line in lines], name)
    for name in ('cst', 'bst', 'cmt', 'bmt', 'imt', 'est', 'areas'):
        np.testing.assert_array_equal(found[name], [len(line[name]) for line in lines], name)
    touching = np.flatnonzero(found.contact)
    np.testing.assert_array_equal(found.tool[touching], [lines[i]['tool'] for i in touching])
    np.testing.assert_array_equal(scene.touches(poses), found.contact)


@pytest.mark.parametrize(
    'arguments, sentence',
    [
        (((), {}), 'a scene is a file, a dict, or tool and static'),
        ((('/nowhere.json',), {}), '/nowhere.json does not exist'),
        ((('/nowhere.json',), {'tool': CUBE}), 'in place of a source'),
        ((('/nowhere.json',), {'units': 'mm'}), 'in place of a source'),
        (((), {'tool': CUBE, 'static': []}), 'static is an empty list'),
        (((), {'tool': CUBE, 'static': PLATE, 'engine': 'abacus'}), 'abacus'),
        (((), {'tool': (CUBE[0], CUBE[1] + 1), 'static': PLATE}), 'index 8'),
        (((), {'tool': (CUBE[0][:, :2], CUBE[1]), 'static': PLATE}), r'shape \(8, 2\)'),
        (((), {'tool': (CUBE[0] * np.nan, CUBE[1]), 'static': PLATE}), 'vertex 0'),
        (((), {'tool': CUBE, 'static': {'plate': PLATE}}), 'this one is a dict'),
        ((({'tool': {'mesh': CUBE}, 'static': [{'mesh': PLATE}], 'responce': {}},), {}), 'responce'),
    ],
)
def test_what_is_wrong_with_a_scene_is_said(arguments, sentence):
    with pytest.raises(palpate.PalpateError, match=sentence) as raised:
        palpate.Scene(*arguments[0], **arguments[1])
    assert raised.value.code in (2, 3)


@pytest.mark.parametrize(
    'poses, sentence',
    [
        (np.zeros((3, 6)), r'shape \(3, 6\)'),
        (np.zeros(7), 'pose 0 is no pose'),
        (at(np.nan), 'pose 0'),
    ],
)
def test_what_is_wrong_with_poses_is_said(boxes, poses, sentence):
    with pytest.raises(palpate.PalpateError, match=sentence):
        boxes.touches(poses)


def test_motions_want_as_many_starts_as_goals(boxes):
    assert boxes.first_contact(at(0.11)[0], at(0.09, 0.06)).shape == (2,)
    with pytest.raises(palpate.PalpateError, match=r'\(3,\) and goals of the shape \(2,\)'):
        boxes.first_contact(at(0.11, 0.1, 0.09), at(0.09, 0.06))


def test_sheets_in_memory_have_walls_where_the_scene_says():
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * 0.1

    def answer(thickness):
        halves = np.array([[0, 1, 2], [0, 2, 3]])
        scene = palpate.Scene(
            {
                'static': [{'mesh': (square, halves), 'sheet_thickness': thickness}],
                'tool': {'mesh': (square * 0.2, halves), 'sheet_thickness': thickness},
            },
            engine='cpu',
        )
        return scene.query([0, 0, 0.0015, 0, 0, 0, 1])

    assert not answer(0).contact
    walls = answer(0.002)  # 0.5 mm in each other
    assert walls.contact and walls.force[2] > 0.1 > 1e6 * abs(walls.force[:2]).max()
