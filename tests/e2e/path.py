"""Paths and verdicts: touch or not, how far, when; what is printed, what is left, and the exit codes."""
import csv

from harness import *

HEADER = 'x,y,z,qx,qy,qz,qw\n'


def ball_over_a_block(folder):
    """A ball of 10 mm radius; the block's top is z = 0."""
    folder = pathlib.Path(folder)
    (folder / 'block.stl').write_bytes(stl(box((0.1, 0.1, 0.02), (0, 0, -0.01))))
    (folder / 'ball.stl').write_bytes(stl(sphere(0.01)))
    scene = folder / 'scene.json'
    scene.write_text(
        json.dumps(
            {'static': [{'mesh': 'block.stl', 'units': 'm'}], 'tool': {'mesh': 'ball.stl', 'units': 'm'}}
        )
    )
    return scene


def poses(folder, *heights):
    path = pathlib.Path(folder) / 'path.csv'
    path.write_text(HEADER + ''.join(f'0.001,0.002,{z},0,0,0,1\n' for z in heights))
    return path


def test_a_clear_path_says_so_and_how_near_it_came():
    with tempfile.TemporaryDirectory() as folder:
        scene = ball_over_a_block(folder)
        done = palpate('path', scene, poses(folder, 0.02, 0.012, 0.02), '--out', folder + '/out')
        expect(done.code == 0, done)
        report = json.loads(done.out)
        expect(report['clear'] and report['first_contact'] is None and report['closest_pose'] == 1, report)
        expect(abs(report['least_clearance_m'] - 0.002) < 1e-7, report)
        expect(
            report['examined']['poses'] == 3
            and report['examined']['screws'] == 2
            and report['examined']['evaluations'] > 3,
            report,
        )
        rows = list(csv.DictReader(open(folder + '/out/path.csv')))
        expect(len(rows) == 3 and all(row['touches'] == '0' for row in rows) and rows[1]['tool_part'], rows)
        page = open(folder + '/out/path.html').read()
        expect(
            'The path is clear' in page and page.count('<svg') >= 3 and 'src=' not in page,
            'a self-contained page',
        )
        expect(len(json.load(open(folder + '/out/path.json'))['poses']) == 3, 'a pose each')


def test_a_path_through_the_block_is_not_clear_though_its_poses_are():
    with tempfile.TemporaryDirectory() as folder:
        scene = ball_over_a_block(folder)
        done = palpate('path', scene, poses(folder, 0.05, -0.05))  # from above to below
        expect(done.code == 5 and 'touches between pose 0 and pose 1' in done.err, done)
        report = json.loads(done.out)
        expect(not report['clear'] and abs(report['first_contact']['pose'] - 0.4) < 2e-5, report)
        expect(
            report['first_contact']['pose'] <= 0.4
            and report['first_contact']['tool_part']
            and report['worst_depth_m'] is None,
            report,
        )
        expect(
            report['least_clearance_m'] == 0
            and report['closest_pose'] == report['first_contact']['pose']
            and report['touching']['static'] == [report['first_contact']['static_part']]
            and report['touching']['tool'] == [report['first_contact']['tool_part']],
            report,
        )


def test_poses_are_read_from_a_pipe():
    with tempfile.TemporaryDirectory() as folder:
        scene, path = ball_over_a_block(folder), poses(folder, 0.02, 0.012)
        for question in (('path', scene), ('query', scene, '--any', '--poses')):
            piped = subprocess.run(
                ['sh', '-c', f'cat {path} | "$@" /dev/stdin', 'sh', PROGRAM, *map(str, question)],
                capture_output=True,
                timeout=TIMEOUT_S,
            )
            expect(piped.returncode == 0 and piped.stdout.decode() == palpate(*question, path).out, piped)
        path.write_text('time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,0,0,0.3,0,0,0,1\nnan,0,0,0.4,0,0,0,1\n')
        expect_refused(palpate('path', scene, path), 3, "line 3: it has time_s 'nan', which is not finite")


def test_poses_as_a_spreadsheet_saves_them_are_read():
    with tempfile.TemporaryDirectory() as folder:
        scene = ball_over_a_block(folder)
        path = poses(folder, 0.02, 0.012)
        plain = palpate('path', scene, path)
        path.write_bytes(b'\xef\xbb\xbf' + path.read_bytes().replace(b'\n', b'\r\n'))
        marked = palpate('path', scene, path)
        expect(marked.code == 0 and marked.out == plain.out, marked)
        done = palpate('path', scene, folder)
        expect(done.code == 3 and 'a folder is no poses file' in done.err, done)


def test_a_scenes_own_path_is_taken_as_its_device_takes_it():
    with tempfile.TemporaryDirectory() as folder:
        scene = ball_over_a_block(folder)
        path, guide = pathlib.Path(folder) / 'own.csv', pathlib.Path(folder) / 'guide.csv'
        # The guide goes down along z, from 0.05 to -0.05; half of the way and less is travelled.
        guide.write_text(
            'travel_m,x_m,y_m,z_m,qx,qy,qz,qw\n0,0.001,0.002,0.05,0,0,0,1\n0.1,0.001,0.002,-0.05,0,0,0,1\n'
        )
        path.write_text('time_s,travel_m,rx_rad,ry_rad,rz_rad,stage\n0,0,0,0,0,1\n1,0.03,0,0,0,1\n')
        done = palpate('path', scene, path)
        expect(done.code == 3 and 'along a guide, and' in done.err and 'names none' in done.err, done)
        scene.write_text(
            json.dumps(
                {
                    **json.loads(scene.read_text()),
                    'device': {'driver': 'simulated', 'path': 'own.csv', 'guide': 'guide.csv'},
                }
            )
        )
        done = palpate('path', scene, path)
        expect(done.code == 0, done)
        expect(abs(json.loads(done.out)['least_clearance_m'] - 0.01) < 1e-7, done)
        free = pathlib.Path(folder) / 'free.csv'
        free.write_text(
            'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0.001,0.002,0.05,0,0,0,1,1\n1,0.001,0.002,0.02,0,0,0,1,1\n'
        )
        again = palpate('path', scene, free)
        expect(
            again.code == 0
            and json.loads(again.out)['least_clearance_m'] == json.loads(done.out)['least_clearance_m'],
            again,
        )


def test_a_scene_of_profile_paper_gets_the_same_verdicts():
    with tempfile.TemporaryDirectory() as folder:
        scene = ball_over_a_block(folder)
        path = poses(folder, 0.02, 0.0095)
        told = []
        for profile in ('refined', 'paper'):
            scene.write_text(json.dumps({**json.loads(scene.read_text()), 'response': {'profile': profile}}))
            done = palpate('path', scene, path, '--tolerance', '0.0001')
            expect(done.code == 5, done)
            told.append(json.loads(done.out))
            expect(('the profile is paper' in done.err) == (profile == 'paper'), done)
        expect(told[0] == told[1] and told[0]['worst_depth_m'] > 0.0004, told)


def test_a_tolerance_lets_shallow_contact_pass():
    with tempfile.TemporaryDirectory() as folder:
        scene = ball_over_a_block(folder)
        shallow = poses(folder, 0.02, 0.0098, 0.02)
        expect_refused(
            palpate('path', scene, shallow, '--tolerance', '1e-300'), 3, '1e-300', 'less than a step'
        )
        expect(palpate('path', scene, shallow).code == 5, 'without tolerance')
        tolerated = palpate('path', scene, shallow, '--tolerance', '0.001')
        expect(tolerated.code == 0, 'with more than it is deep')
        report = json.loads(tolerated.out)
        expect(report['least_clearance_m'] == 0 and report['closest_pose'] == 1, report)
        for backend in ('cpu', 'ref'):
            lines = lines_of(
                palpate(
                    'query', scene, '--poses', shallow, '--any', '--tolerance', '0.001', '--backend', backend
                )
            )
            expect([line['touches'] for line in lines] == [False, False, False], lines)


def test_verdicts_of_poses_are_the_same_of_both_engines():
    with tempfile.TemporaryDirectory() as folder:
        scene = ball_over_a_block(folder)
        asked = poses(folder, 0.015, 0.0099, -0.005, 0.0103, 9)
        told = {}
        for backend in ('cpu', 'ref'):
            any_lines = lines_of(palpate('query', scene, '--poses', asked, '--any', '--backend', backend))
            expect(
                [(line['number'], line['engine'], line['touches']) for line in any_lines]
                == [(i, backend, i in (1, 2)) for i in range(5)],
                any_lines,
            )
            told[backend] = lines_of(
                palpate('query', scene, '--poses', asked, '--clearance', '--backend', backend)
            )
            near = lines_of(
                palpate('query', scene, '--poses', asked, '--within', '0.001', '--backend', backend)
            )
            expect([line['number'] for line in near] == [1, 2, 3], near)
        expect(all(line.pop('engine') == backend for backend, lines in told.items() for line in lines), told)
        expect(told['cpu'] == told['ref'], told)
        lines = told['cpu']
        expect(
            abs(lines[0]['clearance'] - 0.005) < 1e-7
            and lines[1]['clearance'] == 0
            and 'static' not in lines[1]
            and lines[4]['clearance'] is None,
            lines,
        )
        gap = [a - b for a, b in zip(lines[0]['on_static'], lines[0]['on_mobile'])]
        expect(abs(math.hypot(*gap) - 0.005) < 1e-7 and lines[0]['parts']['static'], lines[0])


def scene_of(folder, tool, **statics):
    """A scene of triangles by name."""
    for name, triangles in {'tool': tool, **statics}.items():
        (pathlib.Path(folder) / f'{name}.stl').write_bytes(stl(triangles))
    scene = pathlib.Path(folder) / 'scene.json'
    meshes = [{'mesh': f'{name}.stl', 'units': 'm'} for name in statics]
    scene.write_text(json.dumps({'static': meshes, 'tool': {'mesh': 'tool.stl', 'units': 'm'}}))
    return scene


def test_with_a_tolerance_a_path_names_what_comes_together_first():
    with tempfile.TemporaryDirectory() as folder:
        scene = scene_of(
            folder,
            sphere(0.01),
            block=box((0.1, 0.1, 0.02), (0, 0, -0.01)),
            floor=box((0.1, 0.1, 0.02), (0, 0, -0.11)),
        )
        # The last pose is in the air, nearer to the floor.
        done = palpate('path', scene, poses(folder, 0.05, -0.08), '--tolerance', '0.001')
        report = json.loads(done.out)
        expect(done.code == 5 and abs(report['first_contact']['pose'] - 0.041 / 0.13) < 1e-3, done)
        expect('block' in report['first_contact']['static_part'], report)
        expect(report['touching']['static'] == [report['first_contact']['static_part']], report)
        expect(report['touching']['tool'] == [report['first_contact']['tool_part']], report)


def test_a_contact_without_a_depth_is_told_where_a_tolerance_leaves_it_out():
    with tempfile.TemporaryDirectory() as folder:
        plate = box((0.02, 0.02, 0.002))
        path = pathlib.Path(folder) / 'path.csv'
        path.write_text(HEADER + '0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n')
        done = palpate('path', scene_of(folder, plate, same=plate), path, '--tolerance', '5e-5')
        report = json.loads(done.out)
        expect(done.code == 0 and report['tolerated'] == {'poses': 2, 'without_depth': 2}, done)
        expect('at 2 of 2 poses' in done.err and 'no depth' in done.err, done)
        done = palpate(
            'path',
            scene_of(folder, sphere(0.01), block=box((0.1, 0.1, 0.02), (0, 0, -0.01))),
            poses(folder, 0.02, 0.0099),
            '--tolerance',
            '0.001',
        )
        report = json.loads(done.out)
        expect(done.code == 0 and report['tolerated'] == {'poses': 1, 'without_depth': 0}, done)
        expect('no depth' not in done.err, done)


def test_what_is_not_decided_is_not_called_a_touch():
    with tempfile.TemporaryDirectory() as folder:
        done = palpate('path', ball_over_a_block(folder), poses(folder, 1e9, -1e9))
        expect(done.code == 5 and 'is not decided' in done.err and 'touches between' in done.err, done)
        expect(json.loads(done.out)['first_contact']['undecided'] is True, done)


def test_parts_are_named_where_one_body_lies_wholly_in_the_other():
    with tempfile.TemporaryDirectory() as folder:
        large, small = box((0.06, 0.06, 0.06)), box((0.01, 0.01, 0.01))
        for tool, static in ((small, large), (large, small)):
            scene = scene_of(folder, tool, other=static)
            for backend in ('cpu', 'ref'):
                line = lines_of(
                    palpate(
                        'query',
                        scene,
                        '--pose',
                        '.004 .002 .001 0 0 0 1',
                        '--names',
                        '--json',
                        '--backend',
                        backend,
                    )
                )[0]
                expect(line['contact'] and line['pairs'] == 0, line)
                expect(len(line['parts']['static']) == 1 and len(line['parts']['tool']) == 1, line)


def test_a_guided_path_is_asked_of_as_a_list_of_poses_is():
    with tempfile.TemporaryDirectory() as folder:
        made = palpate(
            'generate',
            'disassembly',
            '--triangles',
            '20000',
            '--tool-triangles',
            '1000',
            '--out',
            folder + '/g',
        )
        expect(made.code == 0, made)
        scene, path = folder + '/g/scene.json', pathlib.Path(folder + '/g/path.csv')
        expect('travel_m' in path.read_text().splitlines()[0], path.read_text()[:80])
        told = lines_of(palpate('query', scene, '--poses', path, '--any'))
        expect(len(told) == len(path.read_text().splitlines()) - 1, len(told))
        expect({line['touches'] for line in told} == {True, False}, told[:3])


def test_what_examines_nothing_is_an_error_and_never_clear():
    with tempfile.TemporaryDirectory() as folder:
        scene = ball_over_a_block(folder)
        expect_refused(palpate('path', scene, poses(folder)), 3, 'path.csv', 'no pose')
        expect_refused(palpate('path', scene, poses(folder, 'nan')), 3, 'path.csv')
        expect_refused(palpate('path', scene, folder + '/none.csv'), 3, 'none.csv')
        expect_refused(palpate('path', scene, poses(folder, 0.05), '--tolerance', '-1'), 3, '--tolerance')
        expect_refused(
            palpate('query', scene, '--poses', poses(folder, 0.05), '--tolerance', '0.001'), 2, '--any'
        )


main(globals())
