"""What CGAL's exact kernels say about the geometry that palpate judged: pairs, one by one, and the class of
voxels.

usage: second_opinion.py PROGRAM JUDGE SOURCE_DIRECTORY quick|full [SEED [FAMILY]]

Everything goes through the program: a scene file and poses in; out of it, by `query --export-geometry`, the
integers that were judged and the pairs that were found. The judge, a program of its own, decides each pair
and each voxel again. A line is printed for every family of scenes; any difference is an error. Soups have
small whole coordinates, in which triangles meet in corners, along edges and in planes.
"""
import csv
import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

PROGRAM, JUDGE, SOURCE = (pathlib.Path(p).resolve() for p in sys.argv[1:4])
FULL = sys.argv[4] == 'full'
SEED = int(sys.argv[5]) if len(sys.argv) > 5 else 2012
ONLY = sys.argv[6] if len(sys.argv) > 6 else ''  # of the families' names
POSE_HEADER = 'x,y,z,qx,qy,qz,qw\n'
COUNTS = (
    'poses',
    'touching',
    'pairs',
    'cross',
    'overlap',
    'touch',
    'missing',
    'extra',
    'boundary',
    'boundary_missing',
    'boundary_extra',
    'centres',
    'inside',
    'wrong',
)
# The sets are the same in both profiles; the refined one's balance of an open tool takes lavapipe some
# minutes a scene.
PROFILE = 'refined' if FULL else 'paper'
# The printed share of poses with pairs, and of pairs that only touch, must not be that of a comparison of
# nothing.
LEAST_TOUCHING = 0.5


def command(*arguments, codes=(0,)):
    done = subprocess.run([*map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode not in codes:
        raise SystemExit(
            f'{" ".join(map(str, arguments))}: exit'
            f' {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}'
        )
    return done


def words(path, letter):
    data = path.read_bytes()
    return struct.unpack(f'<{len(data) // 4}{letter}', data)


def judged(scene, poses, folder, stride, backends=('gpu', 'cpu')):
    """The judge's counts for one scene. Pose 0 is put in front: the tool without rotation, far from anything
    or not."""
    (folder / 'poses.csv').write_text(
        POSE_HEADER + ''.join(','.join(map(repr, p)) + '\n' for p in [(0, 0, 0, 0, 0, 0, 1), *poses])
    )
    exports = []
    for backend in backends:
        out = folder / backend
        lines = command(
            PROGRAM,
            'query',
            scene,
            '--poses',
            folder / 'poses.csv',
            '--backend',
            backend,
            '--export-geometry',
            out,
        ).stdout.splitlines()
        if len(lines) != 1 + len(poses):
            raise SystemExit(f'{scene}: {len(lines)} answers to {1 + len(poses)} poses')
        # What the answer says of pairs is what the list of pairs says.
        for i, line in enumerate(map(json.loads, lines)):
            pairs = words(out / f'pairs_{i}.u32', 'I')
            said = (line['pairs'], line['cst'], line['cmt'])
            if line['truncated'] or said != (
                len(pairs) // 2,
                sorted(set(pairs[0::2])),
                sorted(set(pairs[1::2])),
            ):
                raise SystemExit(
                    f'{scene}, {backend}, pose {i}: pairs, cst and cmt are not those of the list of pairs (or'
                    ' the answer is truncated)'
                )
        exports.append(out)
    for name in sorted(p.name for p in exports[0].iterdir()):
        if any((other / name).read_bytes() != (exports[0] / name).read_bytes() for other in exports[1:]):
            raise SystemExit(f'{scene}: {name} differs between {" and ".join(backends)}')
    verdict = command(JUDGE, exports[0], stride, codes=(0, 1))
    counts = json.loads(verdict.stdout)
    if verdict.returncode != 0:
        print(f'{scene}: {verdict.stderr.strip()}', flush=True)
    return counts


def test_the_judge():
    """A judge that sees nothing wrong must be able to see it: a pair taken out, one put in, a voxel of every
    class changed."""
    rng = random.Random(f'{SEED} judge')
    with tempfile.TemporaryDirectory(prefix='palpate-second-opinion-') as temporary:
        folder = pathlib.Path(temporary)
        write_scene(folder, box((-5, -5, -5), (5, 5, 5)), box((-2, -2, -2), (2, 2, 2)), 1)
        judged(
            folder / 'scene.json',
            [(5, 0.25, 0.5, 0, 0, 0, 1), (5, 5, 5, *any_turn(rng))],
            folder,
            stride=1,
            backends=('cpu',),
        )
        pairs, voxels = folder / 'cpu' / 'pairs_1.u32', folder / 'cpu' / 'voxels.u8'
        known = words(pairs, 'I')
        free = next(
            (s, m) for s in range(12) for m in range(12) if (s, m) not in zip(known[0::2], known[1::2])
        )
        pairs.write_bytes(
            struct.pack(
                f'<{len(known)}I',
                *(w for pair in sorted([free, *zip(known[2::2], known[3::2])]) for w in pair),
            )
        )
        classes = bytearray(voxels.read_bytes())
        changed = [classes.index(0), classes.index(1), classes.index(2)]
        for place, said in zip(changed, (2, 0, 1)):
            classes[place] = said
        voxels.write_bytes(classes)
        verdict = command(JUDGE, folder / 'cpu', 1, codes=(1,))
        counts = json.loads(verdict.stdout)
        seen = {
            key: counts[key] for key in ('missing', 'extra', 'boundary_missing', 'boundary_extra', 'wrong')
        }
        if seen != {'missing': 1, 'extra': 1, 'boundary_missing': 1, 'boundary_extra': 1, 'wrong': 2}:
            raise SystemExit(f'the judge is blind: {seen}\n{verdict.stderr}')


# ---- soups ----------------------------------------------------------------------------------------------------------
def off(triangles):
    points = [p for t in triangles for p in t]
    return (
        f'OFF\n{len(points)} {len(triangles)} 0\n'
        + ''.join(f'{x!r} {y!r} {z!r}\n' for x, y, z in points)
        + ''.join(f'3 {3 * i} {3 * i + 1} {3 * i + 2}\n' for i in range(len(triangles)))
    )


def small_soup(rng, count):
    """Corners on a grid of 7 points a side: corners, edges and planes coincide by the dozen; some triangles
    have no area."""
    return [tuple(tuple(rng.randint(-3, 3) for _ in range(3)) for _ in range(3)) for _ in range(count)]


def flat_soup(rng, count):
    """All triangles in two planes and on a wall between: coplanar overlaps, corners on faces."""

    def corner(plane):
        u, v = rng.randint(-4, 4), rng.randint(-4, 4)
        return ((u, v, 0), (u, v, 1), (u, 0, v))[plane]

    return [tuple(corner(plane) for _ in range(3)) for plane in (rng.randrange(3) for _ in range(count))]


def fan_soup(rng, count):
    """Needles and caps round common points, with corners that lie on other triangles' edges."""
    hub = tuple(rng.randint(-2, 2) for _ in range(3))
    soup = []
    while len(soup) < count:
        a, b = (tuple(rng.randint(-4, 4) for _ in range(3)) for _ in range(2))
        # Hub on an edge.
        soup.append((hub, a, b) if rng.random() < 0.6 else (a, tuple(2 * m - e for m, e in zip(hub, a)), b))
    return soup


def general_soup(rng, count):
    """Nothing coincides but by the rounding to the lattice."""

    def triangle():
        c = [rng.uniform(-3, 3) for _ in range(3)]
        return tuple(tuple(x + rng.gauss(0, 1.5) for x in c) for _ in range(3))

    return [triangle() for _ in range(count)]


def box(low, high):
    c = [[(low, high)[b >> i & 1][i] for i in range(3)] for b in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return [tuple(tuple(c[k]) for k in t) for q in quads for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]


def octahedron(centre, r):
    def at(axis, s):
        return tuple(c + (s * r if k == axis else 0) for k, c in enumerate(centre))

    return [
        (at(0, x), at(1, y), at(2, z)) if x * y * z > 0 else (at(0, x), at(2, z), at(1, y))
        for x in (1, -1)
        for y in (1, -1)
        for z in (1, -1)
    ]


def solids(rng, count):
    """Closed bodies with whole corners: apart, nested, overlapping, back to back, some inside out."""
    bodies = []
    while len(bodies) < count:
        centre = tuple(rng.randint(-6, 6) for _ in range(3))
        body = (
            octahedron(centre, rng.randint(1, 5))
            if rng.random() < 0.4
            else box(centre, tuple(c + rng.randint(1, 6) for c in centre))
        )
        bodies += [(a, c, b) for a, b, c in body] if rng.random() < 0.2 else body
    return bodies


HALF = math.sqrt(0.5)
QUARTER_TURNS = [
    (0, 0, 0, 1),
    (HALF, 0, 0, HALF),
    (0, HALF, 0, HALF),
    (0, 0, HALF, HALF),
    (1, 0, 0, 0),
    (0, 1, 0, 0),
    (0.5, 0.5, 0.5, 0.5),
    (-0.5, 0.5, 0.5, 0.5),
]


def any_turn(rng):
    q = [rng.gauss(0, 1) for _ in range(4)]
    length = math.sqrt(sum(c * c for c in q))
    return tuple(c / length for c in q)


def soup_poses(rng, count, whole):
    """Mostly quarter turns and whole shifts, so that coincidences stay; shifts by halves; some of any
    kind."""
    poses = []
    for _ in range(count):
        if rng.random() < whole:
            unit = rng.choice((1, 1, 1, 0.5))
            poses.append((*(unit * rng.randint(-2, 2) for _ in range(3)), *rng.choice(QUARTER_TURNS)))
        else:
            poses.append((*(rng.uniform(-2, 2) for _ in range(3)), *any_turn(rng)))
    return poses


FAMILIES = {  # name: static bodies, tool, share of poses with quarter turns
    'small soups': (lambda rng: small_soup(rng, 60), lambda rng: small_soup(rng, 40), 0.8),
    'flat soups': (lambda rng: flat_soup(rng, 60), lambda rng: flat_soup(rng, 40), 0.8),
    'fans': (lambda rng: fan_soup(rng, 60), lambda rng: fan_soup(rng, 40), 0.8),
    'general soups': (lambda rng: general_soup(rng, 60), lambda rng: general_soup(rng, 40), 0),
    'solids': (lambda rng: solids(rng, 60), lambda rng: solids(rng, 24), 0.6),
}


def write_scene(folder, static, tool, voxel_size):
    (folder / 'static.off').write_text(off(static))
    (folder / 'tool.off').write_text(off(tool))
    (folder / 'scene.json').write_text(
        json.dumps(
            {
                'static': [{'mesh': 'static.off', 'units': 'm'}],
                'tool': {'mesh': 'tool.off', 'units': 'm'},
                'response': {'profile': PROFILE, 'voxel_size': voxel_size},
            }
        )
    )


def soups(name, scenes, poses):
    static, tool, whole = FAMILIES[name]
    for i in range(scenes):
        rng = random.Random(f'{SEED} {name} {i}')
        with tempfile.TemporaryDirectory(prefix='palpate-second-opinion-') as temporary:
            folder = pathlib.Path(temporary)
            # A voxel of one or a half puts corners and faces on the cubes' own.
            write_scene(folder, static(rng), tool(rng), rng.choice((1, 0.5, 0.7)))
            yield judged(folder / 'scene.json', soup_poses(rng, poses, whole), folder, stride=1)


# ---- the chapter's scenes -------------------------------------------------------------------------------------------
def quaternion_product(a, b):
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def chapter_scene(name, poses, stride):
    """A third of the poses as the scene's own run had them in contact, a third round them, a third anywhere
    near with any rotation."""
    rng = random.Random(f'{SEED} {name}')
    scene = SOURCE / 'scenes' / f'{name}.json'
    with tempfile.TemporaryDirectory(prefix='palpate-second-opinion-') as temporary:
        folder = pathlib.Path(temporary)
        command(
            PROGRAM,
            'run',
            scene,
            '--pace',
            'asap',
            '--out',
            folder / 'run',
            *([] if FULL else ['--duration', '4']),
        )
        with open(folder / 'run' / 'trace.csv') as trace:
            rows = list(csv.DictReader(trace))
        path = [
            tuple(float(r[k]) for k in ('x_m', 'y_m', 'z_m', 'qx', 'qy', 'qz', 'qw'))
            for r in rows
            if r['contact'] == '1'
        ]
        if len(path) < 100:
            raise SystemExit(f'{name}: its run touches in {len(path)} ticks only')
        chosen = [path[len(path) * i // (poses // 3)] for i in range(poses // 3)]
        while len(chosen) < poses:
            p = rng.choice(path)
            near = len(chosen) < 2 * poses // 3
            q = (
                quaternion_product((*(rng.uniform(-0.05, 0.05) for _ in range(3)), 1.0), p[3:])
                if near
                else any_turn(rng)
            )
            length = math.sqrt(sum(c * c for c in q))
            chosen.append(
                (*(c + rng.gauss(0, 0.002 if near else 0.01) for c in p[:3]), *(c / length for c in q))
            )
        yield judged(scene, chosen, folder, stride)


def report(name, verdicts):
    total = dict.fromkeys(COUNTS, 0)
    scenes = 0
    for counts in verdicts:
        scenes += 1
        for key in COUNTS:
            total[key] += counts[key]
    print(
        (
            f"{name}: {scenes} scenes, {total['poses']} poses, {total['touching']} with pairs;"
            f" {total['pairs']} pairs ({total['cross']} cross, {total['overlap']} overlap in a plane,"
            f" {total['touch']} only touch), {total['missing']} missing, {total['extra']} extra;"
            f" {total['boundary']} boundary voxels, {total['boundary_missing']} missing,"
            f" {total['boundary_extra']} extra; {total['centres']} other voxels' centres"
            f" ({total['inside']} inside), {total['wrong']} wrong"
        ),
        flush=True,
    )
    if total['touching'] < LEAST_TOUCHING * total['poses']:
        raise SystemExit(f'{name}: too few poses touch for a comparison')
    return total


def main():
    test_the_judge()
    scenes, poses = (6, 40) if FULL else (1, 16)
    families = {name: lambda name=name: soups(name, scenes, poses) for name in FAMILIES}
    families['contacts'] = lambda: chapter_scene('contacts', 60 if FULL else 12, stride=5 if FULL else 50)
    if FULL:
        families['disassembly'] = lambda: chapter_scene('disassembly', 60, stride=5)
    totals = [report(name, verdicts()) for name, verdicts in families.items() if ONLY in name]
    everything = {key: sum(t[key] for t in totals) for key in COUNTS}
    if not ONLY and (everything['touch'] < everything['pairs'] / 20 or everything['inside'] == 0):
        raise SystemExit('hardly any pair only touches, or no voxel is inside: this compared nothing hard')
    wrong = sum(everything[k] for k in ('missing', 'extra', 'boundary_missing', 'boundary_extra', 'wrong'))
    print(
        f"all: {everything['poses']} poses, {everything['pairs']} pairs of which {everything['touch']} only"
        f" touch, {everything['missing']} missing, {everything['extra']} extra;"
        f" {everything['centres']} centres, {wrong} differences (seed {SEED})"
    )
    sys.exit(1 if wrong or not totals else 0)


main()
