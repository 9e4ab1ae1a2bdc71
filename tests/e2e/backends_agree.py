"""Both back ends answer 500 poses of each of the chapter's scenes alike, through the command line.

Half of the poses are those of the run in contact, the others lie round them (up to 3 mm and 5 degrees away)
and elsewhere on the path. The sets, areas and zones must be equal; so must d, n_c, cp, F and T: one function
makes them from equal integers, so the bound is 0.
"""
import csv
import random

from harness import *

POSES = 500
SEED = 20120127  # the chapter's day


def poses_of(scene, folder):
    """250 poses in contact, 50 free ones, 200 near those in contact, taken from the scene's own run."""
    expect(palpate('run', scene, '--pace', 'asap', '--out', folder / 'run').code == 0, 'the run')
    with open(folder / 'run' / 'trace.csv') as trace:
        rows = list(csv.DictReader(trace))
    rng = random.Random(SEED)
    pose = lambda row: [float(row[k]) for k in ('x_m', 'y_m', 'z_m', 'qx', 'qy', 'qz', 'qw')]
    touching = [pose(r) for r in rows if r['contact'] == '1']
    free = [pose(r) for r in rows if r['contact'] == '0']
    expect(len(touching) > 100 and len(free) > 100, f'{len(touching)} ticks in contact, {len(free)} free')
    chosen = rng.choices(touching, k=POSES // 2) + rng.choices(free, k=POSES // 10)
    while len(chosen) < POSES:
        p = rng.choice(touching)
        turn = [rng.uniform(-1, 1) * math.radians(2.5) for _ in range(3)]  # half-angles
        q = quaternion_product((*turn, 1.0), p[3:])
        length = math.sqrt(sum(c * c for c in q))
        chosen.append([c + rng.uniform(-0.003, 0.003) for c in p[:3]] + [c / length for c in q])
    return chosen


def quaternion_product(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def compare(scene, profile):
    folder = Folder()
    poses = poses_of(scene, folder)
    folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n' + ''.join(','.join(map(repr, p)) + '\n' for p in poses))
    answers = {
        b: lines_of(
            palpate('query', scene, '--poses', folder / 'poses.csv', '--backend', b, '--profile', profile)
        )
        for b in ('gpu', 'cpu', 'ref')
    }
    contacts = areas = 0
    for i, (ref, *others) in enumerate(zip(answers['ref'], answers['gpu'], answers['cpu'], strict=True)):
        for other in others:
            for key in ref.keys() - {'time_us', 'engine'}:
                expect(
                    other[key] == ref[key],
                    (
                        f'{scene.name}, {profile}: {key} of {other["engine"]} differs, palpate query'
                        f' {scene} --pose "{" ".join(map(repr, poses[i]))}"'
                    ),
                )
        contacts += ref['contact']
        areas += len(ref['areas'])
    expect(
        len(answers['ref']) == POSES and contacts >= POSES // 4,
        f'only {contacts} of {len(answers["ref"])} poses touch',
    )
    print(
        f'        {scene.name}, {profile}: {POSES} poses equal in every bit, {contacts} in contact,'
        f' {areas} areas'
    )


def test_the_contacts_in_both_profiles():
    for profile in ('refined', 'paper'):
        compare(SOURCE / 'scenes' / 'contacts.json', profile)


def test_the_disassembly_in_both_profiles():
    for profile in ('refined', 'paper'):
        compare(SOURCE / 'scenes' / 'disassembly.json', profile)


main(globals())
