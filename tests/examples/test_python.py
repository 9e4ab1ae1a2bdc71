"""docs/examples in Python do what they say."""
import os
import re
import subprocess
import sys

from shapes import EXAMPLES, write_boxes


def run(*words, cwd):
    done = subprocess.run(
        [sys.executable, *map(str, words)], cwd=cwd, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_cube_of_a_simulator_of_ones_own_comes_to_rest_on_the_plate(tmp_path):
    text = (EXAMPLES / 'own_simulator/loop.py').read_text()
    last = run(EXAMPLES / 'own_simulator/loop.py', cwd=tmp_path).splitlines()[-1]
    height, speed, force = (
        float(value)
        for value in re.search(r'height +([\d.]+) mm  speed ([\d.]+) m/s  force ([\d.]+) N', last).groups()
    )
    # It bears its weight, 0.981 N, which presses a spring of 2000 N/m by 0.49 mm; printed to 0.01 mm, and a
    # thousandth of its weight off while it settles.
    assert abs(height - (20 - 0.4905)) < 0.02 and speed < 0.001 and abs(force - 0.981) < 0.002
    assert len(text.splitlines()) < 40


def test_the_accessibility_map_is_dark_in_the_body_and_bright_away_from_it(tmp_path):
    write_boxes(tmp_path / 'block.off', [((-0.1, -0.1, 0), (0.1, 0.1, 0.2))])
    said = run(
        EXAMPLES / 'accessibility/accessibility.py',
        'block.off',
        '--poses',
        '60000',
        '--workers',
        '1',
        cwd=tmp_path,
    )
    assert re.search(r'hash \w{64}', said)
    import zarr

    group = zarr.open_group(str(tmp_path / 'map.zarr'), mode='r')
    across, _, up, tilts, _, turns = group.attrs['shape']
    free = ~group['touches'][:].reshape(across, up, tilts, turns)
    middle, corner = free[across // 2, up // 2], free[0, -1]
    # Inside the block no direction is free; 150 mm above its edge and beside it, only those down and across
    # it are not.
    assert not middle.any() and corner.mean() > 0.9
    # On its flank, 75 mm off, the half of directions away from it is free: x runs first, so turns of the rod
    # by 270° point to −x … +x.
    assert 0.4 < free[across // 6, up // 2].mean() < 0.95
    assert (tmp_path / 'map.png').stat().st_size > 10000 and os.listdir(tmp_path)
