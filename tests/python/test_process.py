"""Signals, threads, processes, pickles."""
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import CUBE, PLATE, at, random_poses

import palpate


def interrupted_after(seconds, work):
    """Ctrl-C after a while; returns how long the work went on afterwards."""
    pressed = []

    def press():
        pressed.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(seconds, press)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
        return time.monotonic() - pressed[0]
    finally:
        timer.cancel()


def test_ctrl_c_ends_a_batch(boxes):
    poses = np.repeat(at(0.009), 20_000_000, axis=0)  # minutes
    interrupted_after(0.5, lambda: boxes.query_batch(poses, ('contact',)))
    assert boxes.touches(at(0.009)).all()  # and the scene goes on


def test_ctrl_c_ends_an_opening():
    scene = {
        'tool': {'generate': {'name': 'disassembly', 'triangles': 1000}},
        'static': [{'generate': {'name': 'disassembly', 'triangles': 3_000_000}}],
    }
    interrupted_after(0.5, lambda: palpate.Scene(scene, engine='cpu', cache=False))


def test_progress_is_told_and_obeyed(boxes):
    told = []
    poses = np.repeat(at(0.05), 200_000, axis=0)
    boxes.touches(poses, progress=lambda done, count: told.append((done, count)))
    assert told[-1] == (200_000, 200_000) and told == sorted(told)
    with pytest.raises(palpate.PalpateError, match='cancelled') as raised:
        boxes.touches(poses, progress=lambda done, count: False)
    assert raised.value.code == 64
    with pytest.raises(ZeroDivisionError):
        palpate.Scene(tool=CUBE, static=PLATE, engine='cpu', progress=lambda what, done: 1 / 0)


def test_threads_ask_one_scene(clamp):
    scene = palpate.Scene(clamp, engine='cpu')
    poses = random_poses(scene, 200)
    expected = scene.query_batch(poses, ('force', 'contact'))
    faults = []

    def ask(at_once):
        for first in range(0, len(poses), at_once):
            mine = scene.query_batch(poses[first : first + at_once], ('force', 'contact'))
            if (mine.force != expected.force[first : first + at_once]).any() or (
                mine.contact != expected.contact[first : first + at_once]
            ).any():
                faults.append(first)

    threads = [threading.Thread(target=ask, args=(at_once,)) for at_once in (1, 7, 200)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not faults


def test_a_forked_child_is_refused(boxes):
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            boxes.touches(at(0.009))
            os.write(writer, b'answered')
        except palpate.PalpateError as error:
            os.write(writer, str(error).encode())
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    assert b'after fork() open the scene again' in os.read(reader, 4096)
    assert boxes.touches(at(0.009)).all()


def touched(scene):
    return scene.touches(at(0.009)).tolist(), scene.hash


@pytest.mark.parametrize('method', ['fork', 'spawn'])
def test_a_pickled_scene_opens_again_in_another_process(boxes, method):
    with multiprocessing.get_context(method).Pool(1) as pool:
        assert pool.apply(touched, (boxes,)) == ([True], boxes.hash)


def test_a_pickle_knows_when_its_file_has_changed(clamp, tmp_path):
    file = tmp_path / 'scene.json'
    scene = {
        'tool': {'generate': {'name': 'contacts', 'triangles': 1000}},
        'static': [{'generate': {'name': 'contacts', 'triangles': 1000}}],
    }
    file.write_text(repr(scene).replace("'", '"'))
    pickled = pickle.dumps(palpate.Scene(file, engine='cpu'))
    assert pickle.loads(pickled).file == str(file)
    file.write_text(repr({**scene, 'response': {'stiffness': 1000}}).replace("'", '"'))
    with pytest.raises(palpate.PalpateError, match='changed since it was pickled'):
        pickle.loads(pickled)


def test_errors_and_columns_can_be_pickled(boxes):
    error = pickle.loads(pickle.dumps(palpate.PalpateError(3, 'why')))
    assert error.code == 3 and str(error) == 'why'
    found = pickle.loads(pickle.dumps(boxes.query_batch(at(0.009))))
    assert found.contact.all() and found.force.shape == (1, 3)


def test_a_closed_scene_says_so():
    with palpate.Scene(tool=CUBE, static=PLATE, engine='cpu') as scene:
        assert scene.touches(at(0.009)).all()
    with pytest.raises(palpate.PalpateError, match='closed'):
        scene.touches(at(0.009))


def test_closing_while_a_thread_asks_waits_for_it():
    scene = palpate.Scene(tool=CUBE, static=PLATE, engine='cpu')
    poses, answers, begun = np.repeat(at(0.009), 300_000, axis=0), [], threading.Event()
    thread = threading.Thread(
        target=lambda: answers.append(scene.touches(poses, progress=lambda done, count: begun.set()).all())
    )
    thread.start()
    begun.wait()
    scene.close()
    thread.join()
    assert answers == [True]


def test_a_missing_library_is_named():
    done = subprocess.run(
        [sys.executable, '-c', 'import palpate'],
        env={**os.environ, 'PALPATE_LIBRARY': '/nowhere/lib.so'},
        capture_output=True,
        text=True,
    )
    assert done.returncode != 0 and '/nowhere/lib.so can\'t be loaded' in done.stderr
