"""Scenes of extreme size through the program: the right answer or one clear refusal, with and without the
device."""
import os
import pathlib
import resource
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / 'e2e'))
from harness import *  # noqa: E402

BACKENDS = ('gpu', 'cpu')


def answer(scene, pose, backend=None):
    """The line of one query without its times and who answered, and what was said on standard error."""
    outcome = palpate('query', scene, '--pose', pose, *(('--backend', backend) if backend else ()))
    lines = lines_of(outcome)
    expect(len(lines) == 1, outcome)
    return {**lines[0], 'time_us': 0, 'engine': ''}, outcome.err


def answer_on_both(scene, pose):
    (gpu, said), (cpu, _) = (answer(scene, pose, backend) for backend in BACKENDS)
    # A device may lack room, or steps of one invocation; it says so, and pushes with nothing.
    refused = gpu['truncated'] and gpu['force'] == [0, 0, 0] and 'the most' in said
    expect(refused or gpu == cpu, f'gpu and cpu differ\n{str(gpu)[:2000]}\n{str(cpu)[:2000]}')
    expect(not cpu['truncated'], cpu)
    return cpu


def test_a_million_coincident_triangles_are_refused_with_the_limit():
    folder = Folder()
    folder.write('same.stl', stl([((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0))] * 1_000_000))
    scene = folder.save(static=[{'mesh': 'same.stl', 'units': 'm'}])
    for backend in BACKENDS:
        expect_refused(
            palpate('query', scene, '--pose', '0 0 0 0 0 0 1', '--backend', backend),
            3,
            'scene.json',
            '1000000 triangles',
            'limit is 4096',
        )


def test_a_million_triangles_in_one_voxel_are_answered_or_refused_by_shaders():
    # A ball of 1 m with a million triangles, in a scene of 10 km: the lists of the few voxels there hold all
    # of them.
    folder = Folder()
    folder.write(
        'crowd.stl', stl(sphere(0.5, 500) + [((1e4, 1e4, 1e4), (1e4 + 1, 1e4, 1e4), (1e4, 1e4 + 1, 1e4))])
    )
    folder.write('ball.stl', stl(sphere(0.05)))
    scene = folder.save(static=[{'mesh': 'crowd.stl', 'units': 'm'}], tool={'mesh': 'ball.stl', 'units': 'm'})
    pose = '0 0 0.52 0 0 0 1'
    cpu, _ = answer(scene, pose, 'cpu')
    expect(cpu['contact'] and cpu['pairs'] > 100 and not cpu['truncated'], 'the balls cross')
    default, _ = answer(scene, pose)
    expect(default == cpu, 'without --backend the answer is right, whoever gives it')
    refused = palpate('query', scene, '--pose', pose, '--backend', 'gpu')
    expect_refused(refused, 3, 'triangles of the mock-up share a voxel, at most 30000')


def test_a_sliver_across_ten_thousand_voxels_is_found_all_along():
    # 1 m long and 0.1 mm wide, diagonal, in voxels of 0.07 mm: 10,000 of them along x and along y.
    folder = Folder()
    folder.write('sliver.stl', stl([((0, 0, 0), (0.7, 0.7, 0), (0.0001, 0, 0))]))
    folder.write('ball.stl', stl(sphere(0.002)))
    scene = folder.save(
        static=[{'mesh': 'sliver.stl', 'units': 'm'}],
        tool={'mesh': 'ball.stl', 'units': 'm'},
        response={'voxel_size': 0.00007},
    )
    for t in (0.0001, 0.35, 0.6999):
        found = answer_on_both(scene, f'{t} {t} 0 0 0 0 1')
        expect(found['contact'] and found['cst'] == [0], f'at {t}: {found}')
    expect(not answer_on_both(scene, '0.35 0.36 0 0 0 0 1')['contact'], 'beside it')


def test_a_triangle_across_too_many_voxels_is_refused_with_the_limit():
    folder = Folder()
    folder.write('sheet.stl', stl([((0, 0, 0), (0.7, 0, 0), (0, 0.7, 0))]))
    folder.write('steep.stl', stl([((0, 0, 0), (0.7, 0.7, 0.7), (0.0001, 0, 0))]))
    for mesh, words in (
        ('sheet.stl', ('boundary voxels', 'limit is 8000000')),
        ('steep.stl', ('bricks', 'limit is')),
    ):
        scene = folder.save(static=[{'mesh': mesh, 'units': 'm'}], response={'voxel_size': 0.00007})
        expect_refused(
            palpate('query', scene, '--pose', '0 0 0 0 0 0 1'), 3, 'scene.json', 'voxel_size', *words
        )
        # Left to choose, it finds a size that fits.
        answer_on_both(folder.save(static=[{'mesh': mesh, 'units': 'm'}]), '0.1 0.1 0.1 0 0 0 1')


def test_ten_million_triangles_are_prepared_and_queried_within_six_gibibytes():
    folder = Folder()
    made = palpate(
        'generate', 'contacts', '--triangles', '10000000', '--tool-triangles', '2000', '--out', folder / 'big'
    )
    expect(made.code == 0, made)
    answer(folder / 'big' / 'scene.json', '0 0 0 0 0 0 1')
    most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    expect(most < 6 * 2**30, f'{most / 2**30:.2f} GiB')


main(globals())
