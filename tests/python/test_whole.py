"""Runs, pictures, and the package as it is installed."""
import os
import pathlib
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from conftest import at

import palpate
from palpate._library import library

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def test_a_run_gives_what_it_left(clamp, tmp_path):
    done = palpate.Scene(clamp, engine='cpu').run(tmp_path / 'out', duration=0.2)
    assert len(done.trace) > 100 and done.summary and (done.folder / 'report.html').is_file()
    for device, words, code in (
        ('abacus', "unknown haptic device 'abacus'", 3),
        ('falcon', "device 'falcon' can't keep", 2),
    ):
        with pytest.raises(palpate.PalpateError, match=words) as raised:
            palpate.Scene(clamp, engine='cpu').run(tmp_path / 'other', device=device)
        assert raised.value.code == code


def test_a_run_needs_a_file(boxes, tmp_path):
    with pytest.raises(palpate.PalpateError, match='scene of a file'):
        boxes.run(tmp_path)


def test_a_contact_is_drawn(boxes, tmp_path):
    import matplotlib

    matplotlib.use('Agg')
    axes = palpate.draw(boxes, at(0.009)[0])
    assert '12 pairs' in axes.get_title()
    # Triangles: the plate's near the tool and in contact, the tool's.
    lots = [part._vec.shape[1] // 3 for part in axes.collections[:4]]
    assert lots == [0, 2, 2, 10] and len(axes.collections) == 5  # and the arrow
    axes.figure.savefig(tmp_path / 'contact.png')
    assert (tmp_path / 'contact.png').stat().st_size > 5000


def test_the_wheel_works_alone(tmp_path):
    build = pathlib.Path(library._name).resolve().parent.parent
    done = subprocess.run([SOURCE / 'scripts/wheel', build, tmp_path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    wheel = pathlib.Path(done.stdout.strip())
    with zipfile.ZipFile(wheel) as archive:
        for entry in archive.infolist():
            target = archive.extract(entry, tmp_path / 'site')
            os.chmod(target, entry.external_attr >> 16)
    script = '''
import palpate
from palpate._library import library
open("cube.off", "w").write("OFF\\n4 4 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n3 0 2 1\\n3 0 1 3\\n3 0 3 2\\n3 1 2 3\\n")
scene = palpate.Scene({"tool": {"mesh": "cube.off"}, "static": [{"mesh": "cube.off"}]}, engine="cpu")
loaded = open("/proc/self/maps").read()
for name in ("libembree3", "libtbb", "libfmt", "libvulkan"):
    assert f"site/palpate/libs/{name}" in loaded, f"{name} is not the wheel's own"
print(palpate.__file__, scene.touches(scene.start), library._name)
'''
    plain = {name: value for name, value in os.environ.items() if not name.startswith('PALPATE_')}
    found = subprocess.run(
        [sys.executable, '-c', script],
        cwd=tmp_path,
        env={**plain, 'PYTHONPATH': str(tmp_path / 'site'), 'PALPATE_CACHE': 'off'},
        capture_output=True,
        text=True,
    )
    assert found.returncode == 0, found.stderr
    where, touches, loaded = found.stdout.split()
    assert touches == 'True' and where.startswith(str(tmp_path)) and loaded.startswith(str(tmp_path))


def test_names_of_the_interface_are_those_of_the_header():
    header = (SOURCE / 'service/library/palpate.h').read_text()
    for name, columns in (
        ('palpate_columns', palpate.COLUMNS),
        ('palpate_distances', palpate.DISTANCE_COLUMNS),
        ('palpate_motions', palpate.MOTION_COLUMNS),
    ):
        body = header.split(f'typedef struct {name} {{')[1].split('}')[0]
        members = [
            word.strip(' *;,')
            for line in body.splitlines()
            for word in line.split('/*')[0].replace(',', ' ').split()[1:]
            if word.strip(' *;,')
        ]
        assert members == ['size', *columns], name


def test_docstrings_tell_shapes():
    for method in ('query_batch', 'touches', 'clearance', 'first_contact'):
        assert '7)' in getattr(palpate.Scene, method).__doc__, method
    assert np.dtype(palpate.COLUMNS['force'][0]) == np.float64
