"""`palpate query`: fields, answers that are known, both back ends, exported geometry."""
import signal
import subprocess

import re

from harness import *

FIELDS = [
    'number',
    'pose',
    'contact',
    'pairs',
    'cst',
    'bst',
    'cmt',
    'bmt',
    'imt',
    'est',
    'areas',
    'force',
    'torque',
    'flags',
    'tool',
    'evaluations',
    'truncated',
    'engine',
    'time_us',
]
AREA_FIELDS = ['id', 'zones', 'static', 'mobile', 'normal', 'depth', 'point', 'force', 'torque', 'flags']
SETS = ['cst', 'bst', 'cmt', 'bmt', 'imt', 'est']
HEADER = 'x,y,z,qx,qy,qz,qw\n'
PRESSED = '0 0 0.018 0 0 0 1'  # the ball of 20 mm, 2 mm deep in the block


def without_time(line):
    return {key: value for key, value in line.items() if key not in ('time_us', 'engine')}


def test_a_line_has_the_contracts_fields_in_its_order():
    folder = Folder()
    (line,) = lines_of(palpate('query', folder.save(), '--pose', PRESSED))
    expect(list(line) == FIELDS, list(line))
    expect(
        line['number'] == 0
        and len(line['pose']) == 7
        and line['contact'] is True
        and line['truncated'] is False,
        line,
    )
    (area,) = line['areas']
    expect(list(area) == AREA_FIELDS, list(area))
    expect(list(line['time_us'])[0] == 'total' and line['time_us']['total'] > 0, line['time_us'])
    for name in SETS:
        expect(line[name] == sorted(set(line[name])), f'{name} is not ascending')
    expect(area['static'] == sorted(area['static']) and area['id'] == area['static'][0], area)
    expect(sorted(i for zone in area['zones'] for i in zone) == area['static'], 'zones partition the area')


def test_a_ball_pressed_into_a_block_is_pushed_out_by_the_spring():
    folder = Folder()
    (line,) = lines_of(palpate('query', folder.save(), '--pose', PRESSED))
    (area,) = line['areas']
    h, r = 2e-3, 0.02
    a2 = 2 * r * h - h * h
    mean = (r * a2 - 2 / 3 * (r**3 - (r - h) ** 3)) / a2  # of the depth below the sphere, over the disc
    expect(
        abs(area['depth'] / mean - 1) < 0.10,
        f"d {area['depth']} m instead of {mean} m; 12 rows of facets and samples allow 10 %",
    )
    expect(area['normal'][2] > math.cos(math.radians(0.5)), area['normal'])
    expect(0 < line['force'][2] <= 2000 * h, line['force'])  # no stiffer than the spring
    expect(abs(line['force'][0]) + abs(line['force'][1]) < 0.01 * line['force'][2], line['force'])
    # The spring's own length, but for what the tool turned.
    expect(
        abs(2000 * line['tool'][2] - 2000 * 0.018 - line['force'][2]) < 0.02 * line['force'][2], line['tool']
    )


def test_free_near_and_far():
    folder = Folder()
    folder.write(
        'poses.csv', HEADER + '0,0,0.03,0,0,0,1\n1,0,0,0,0,0,1\n1e6,0,0,0,0,0,1\n-1e300,1e300,0,0.6,0,0,0.8\n'
    )
    lines = lines_of(palpate('query', folder.save(), '--poses', folder / 'poses.csv'))
    expect(len(lines) == 4, len(lines))
    for i, line in enumerate(lines):
        expect(line['number'] == i and line['contact'] is False and line['pairs'] == 0, line)
        expect(
            line['areas'] == []
            and line['force'] == [0, 0, 0]
            and line['torque'] == [0, 0, 0]
            and line['cst'] == [],
            line,
        )


def test_a_negative_number_may_come_first():
    folder = Folder()
    (line,) = lines_of(palpate('query', folder.save(), '--pose', '-0.01 0 0.018 0 0 0 1'))
    expect(line['contact'], line)


def test_a_tool_equal_to_the_mock_up_is_answered():
    folder = Folder()
    path = folder.save(tool={'mesh': 'block.stl', 'units': 'm'})
    (line,) = lines_of(palpate('query', path, '--pose', '0 0 0 0 0 0 1'))
    expect(line['contact'] and not line['truncated'], line)
    # Every face lies on its twin.
    expect(line['cst'] == list(range(12)) and line['cmt'] == list(range(12)), line)
    expect(line['pairs'] >= 12, line['pairs'])
    expect(all(math.isfinite(v) for v in line['force'] + line['torque']), line['force'])


def test_a_small_contact_far_from_the_tools_middle_keeps_its_lever():
    folder = Folder()
    folder.write('cube.stl', stl(box((0.002, 0.002, 0.002), (0.201, 0.201, -0.001))))
    folder.write('plate.stl', stl(box((0.5, 0.5, 0.04))))
    path = folder.save(static=[{'mesh': 'cube.stl', 'units': 'm'}], tool={'mesh': 'plate.stl', 'units': 'm'})
    for engine in ('cpu', 'gpu', 'ref'):
        (line,) = lines_of(palpate('query', path, '--pose', '0 0 0.01998 0 0 0 1', '--backend', engine))
        (area,) = line['areas']
        # Under even pressure the middle of the cube's top carries the whole. Off by less than a lattice step of
        # about 2 nm and what single precision makes of the mesh, 15 nm.
        wanted = [0.201 * line['force'][2], -0.201 * line['force'][2], 0]
        expect(line['force'][2] > 0, line['force'])
        for a, b in zip(line['torque'], wanted, strict=True):
            expect(abs(a - b) <= 1e-6 * wanted[0], (engine, line['torque'], wanted))
        for a, b in zip(area['point'], (0.201, 0.201, 0), strict=True):
            expect(abs(a - b) <= 1e-6, (engine, area['point']))


def test_two_sheets_push_each_other_once_they_have_walls():
    folder = Folder()

    def square(side):
        h = side / 2
        a, b, c, d = (-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)
        return [(a, b, c), (a, c, d)]

    for name, side in (('floor', 0.2), ('plate', 0.04)):
        folder.write(f'{name}.stl', stl(square(side)))
        folder.write(f'{name}_box.stl', stl(box((side, side, 0.002))))

    def answer(mockup, tool, z, thickness=0.002):
        body = lambda name: {
            'mesh': name + '.stl',
            'units': 'm',
            **({} if name.endswith('box') else {'sheet_thickness': thickness}),
        }
        scene = folder.save(static=[body(mockup)], tool=body(tool), response={'voxel_size': 0.004})
        done = palpate('query', scene, '--pose', f'0.01 0 {z} 0 0 0 1')
        (line,) = lines_of(done)
        return line, done.err

    for z in (0.0015, -0.0015):
        line, told = answer('floor', 'plate', z)
        walls = '2 of 2 triangles lie in open pieces and are walls 2 mm thick now; it has 12'
        informed = json.loads(palpate('info', folder / 'scene.json', '--json').out)['scenes'][0]['warnings']
        for whose, name in (('tool', 'plate'), ('mock-up', 'floor')):
            expect(f'{whose} ' in told and f'{name}.stl: {walls}' in told, told)
            expect(any(w.startswith(whose) and walls in w for w in informed), informed)
        boxes, _ = answer('floor_box', 'plate_box', z)
        # The same boxes, but for the diagonals of their faces. Of single precision in the files of boxes, 0.002 is
        # off by 5e-11 m: of 0.5 mm 1e-7.
        expect(abs(boxes['force'][2]) > 0.1 and boxes['force'][2] * z > 0, boxes['force'])
        for a, b in zip(line['force'], boxes['force'], strict=True):
            expect(abs(a - b) <= 1e-6 * abs(boxes['force'][2]), (line['force'], boxes['force']))
    # A 64th of the tool.
    for z in (0.0004, -0.0004):
        line, told = answer('floor', 'plate', z, thickness='auto')
        expect('2 of 2 triangles lie in open pieces and are walls 0.625 mm thick now' in told, told)
        expect(line['force'][2] * z > 0, line['force'])
    line, told = answer('floor', 'plate', 0.0007, thickness='auto')
    expect(not line['contact'], line)
    line, told = answer('floor', 'plate', 0, thickness=0)
    expect(line['contact'] and 'no_direction' in line['flags'] and line['force'] == [0, 0, 0], line)
    expect(
        '"sheet_thickness": "auto" in the scene gives it walls' in told and 'open pieces' not in told, told
    )
    folder.save(static=[{'mesh': 'floor_box.stl', 'units': 'm', 'sheet_thickness': 0.001}])
    told = palpate('query', folder / 'scene.json', '--pose', PRESSED).err
    expect('no piece of it is open, so "sheet_thickness" changes nothing' in told, told)
    folder.save(static=[{'mesh': 'floor_box.stl', 'units': 'm', 'sheet_thickness': 'auto'}])
    told = palpate('query', folder / 'scene.json', '--pose', PRESSED).err
    expect('no piece of it is a sheet, so "sheet_thickness" changes nothing' in told, told)


def test_a_batch_on_all_cores_prints_what_single_queries_do():
    folder = Folder()
    scene = generated(folder)
    folder.write(
        'poses.csv',
        HEADER + ''.join(f'{0.002 * (i % 100) - 0.1},{0.001 * (i % 13)},0,0,0,0,1\n' for i in range(200)),
    )
    for engine in ('cpu', 'gpu'):
        asked = ['query', scene, '--poses', folder / 'poses.csv', '--backend', engine]
        alone = lines_of(palpate(*asked))
        batch = lines_of(palpate(*asked, '--batch', '200'))
        expect(any(line['contact'] for line in alone), 'some touch')
        expect(any(line['evaluations'] > 2 for line in alone), 'some look for a balance')
        for a, b in zip(alone, batch, strict=True):
            expect(b.pop('batch') == 200, b)
            expect(without_time(a) == without_time(b), f"{engine}: pose {a['number']} differs")


def test_an_interrupt_ends_preparation():
    folder = Folder()
    made = palpate(
        'generate', 'contacts', '--triangles', '300000', '--tool-triangles', '1000', '--out', folder / 'large'
    )
    expect(made.code == 0, made)
    process = subprocess.Popen(
        [PROGRAM, 'query', folder / 'large' / 'scene.json', '--pose', '0 0 0 0 0 0 1'],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    said = b''
    while b'preparing the scene' not in said:
        line = process.stderr.readline()
        expect(line, f'ended before it prepared: {said}')
        said += line
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=TIMEOUT_S)
    expect(process.returncode == 1 and out == b'', f'exit {process.returncode}: {err}')
    expect(b'cancelled' in err.splitlines()[-1], err)


def test_batch_is_named_and_changes_only_times():
    folder = Folder()
    path = folder.save()
    folder.write('poses.csv', HEADER + ''.join(f'0,0,{0.015 + 0.001 * i},0,0,0,1\n' for i in range(7)))
    alone = lines_of(palpate('query', path, '--poses', folder / 'poses.csv'))
    batch = lines_of(palpate('query', path, '--poses', folder / 'poses.csv', '--batch', '3'))
    expect(all(line['batch'] == 3 for line in batch), batch[0])
    for a, b in zip(alone, batch, strict=True):
        b.pop('batch')
        expect(without_time(a) == without_time(b), f"pose {a['number']} differs")


def test_where_an_open_body_leaves_its_inside_in_doubt_it_is_said():
    # A ball that lacks a cap: at its mouth half of all directions leave it. A block beside it is closed.
    folder = Folder()
    at, radius = 0.1, 0.03
    cup = [t for t in sphere(radius, 24, (0, 0, at)) if sum(p[2] for p in t) / 3 < at + 0.7 * radius]
    folder.write('parts.stl', stl(box((0.2, 0.2, 0.04), (0, 0, -0.02)) + cup))
    folder.write('plate.stl', stl(box((0.05, 0.05, 0.001))))
    scene = folder.save(
        static=[{'mesh': 'parts.stl', 'units': 'm'}], tool={'mesh': 'plate.stl', 'units': 'm'}
    )
    told = {}
    for place, z in (('mouth', at + 0.7 * radius), ('block', -0.0002), ('nowhere', 0.06)):
        done = palpate('query', scene, '--pose', f'0 0 {z} 0 0 0 1', '--json')
        expect(done.code == 0, done)
        told[place] = re.search(
            r'is a vote .*?(?:; (none|\d+) of (\d+) triangles of the tool|$)', done.err, re.M
        )
        expect(told[place], done)
    expect(int(told['mouth'][1]) >= 2, told)  # a face of the plate, right above the mouth
    expect(told['block'][1] == 'none' and int(told['block'][2]) >= 4, told)
    expect(told['nowhere'][1] is None, told)


def test_an_open_mockup_without_a_voxel_inside_is_said_to_be():
    folder = Folder()
    lidless = [t for t in box((0.1, 0.1, 0.1)) if any(abs(p[2] - 0.05) > 1e-9 for p in t)]
    folder.write('lidless.stl', stl(lidless))
    folder.write('cube.stl', stl(box((0.1, 0.1, 0.1))))
    scene = folder.save(
        static=[{'mesh': 'lidless.stl', 'units': 'm'}], tool={'mesh': 'cube.stl', 'units': 'm'}
    )
    told = palpate('query', scene, '--pose', '0.02 0.03 0.03 0 0 0 1').err
    expect('no voxel of it is wholly inside' in told and '"sheet_thickness"' in told, told)
    (informed,) = json.loads(palpate('info', scene, '--json').out)['scenes'][0]['bodies']
    expect('no voxel of it is wholly inside' in informed and 'is a vote' in informed, informed)


def test_a_body_that_is_there_twice_pushes_once():
    folder = Folder()
    folder.write('floor.stl', stl(box((0.1, 0.1, 0.02))))
    folder.write('ball.stl', stl(sphere(0.006, 24)))
    tool = {'mesh': 'ball.stl', 'units': 'm'}
    force = []
    for copies in (1, 2):
        scene = folder.save(static=[{'mesh': 'floor.stl', 'units': 'm'}] * copies, tool=tool)
        (answer,) = lines_of(palpate('query', scene, '--pose', '0.013 0.012 0.0145 0 0 0 1'))
        force.append(answer['force'][2])
    # Twice as many samples are inside, so either body's may be taken at another level: that moves it by
    # 0.0003 N here. Counted twice, the block pushes with 2.36 N.
    expect(force[0] > 1 and abs(force[1] / force[0] - 1) < 0.01, force)


def test_in_the_mouth_of_an_open_body_its_wall_alone_pushes():
    # A ball that lacks a cap. A plate lies in its mouth, free, and with two corners through the wall: that
    # pushes it back in, whatever the voxels.
    folder = Folder()
    cup = [t for t in sphere(0.03, 24) if sum(p[2] for p in t) / 3 < 0.021]
    folder.write('cup.stl', stl(cup))
    folder.write('plate.stl', stl(box((0.03, 0.03, 0.001))))
    poses = folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n0,0,0.018,0,0,0,1\n0.0065,0,0.018,0,0,0,1\n')
    forces = []
    for voxel_size in (0.002, 0.004, 0.006, 0.008):
        scene = folder.save(
            static=[{'mesh': 'cup.stl', 'units': 'm'}],
            tool={'mesh': 'plate.stl', 'units': 'm'},
            response={'voxel_size': voxel_size},
        )
        free, line = lines_of(palpate('query', scene, '--poses', poses, '--json'))
        expect(free['pairs'] == 0 and free['force'] == [0, 0, 0], (voxel_size, free['force']))
        forces.append(line['force'])
        expect(line['pairs'] > 0 and line['force'][0] < -0.01 and line['force'][2] < -0.01, forces)
        expect(abs(line['force'][1]) < -0.1 * line['force'][0], forces)
    # The grid's margin moves the lattice, by steps of nanometres.
    expect(all(abs(a - b) < 1e-6 for force in forces for a, b in zip(force, forces[0])), forces)


def test_a_thin_plate_without_an_end_pushes_as_a_whole_one_does():
    # Its walks along it leave it at that end, more than eight voxels away.
    folder = Folder()
    folder.write('ball.stl', stl(sphere(0.01)))
    plate = box((0.06, 0.06, 0.003))
    forces = []
    for name, triangles in (
        ('whole', plate),
        ('without', [t for t in plate if any(abs(p[0] - 0.03) > 1e-9 for p in t)]),
    ):
        folder.write(f'{name}.stl', stl(triangles))
        scene = folder.save(
            static=[{'mesh': f'{name}.stl', 'units': 'm'}],
            tool={'mesh': 'ball.stl', 'units': 'm'},
            response={'voxel_size': 0.002, 'stiffness': 2000},
        )
        (line,) = lines_of(palpate('query', scene, '--pose', '0 0 0.0112 0 0 0 1', '--json'))
        forces.append(line['force'])
    expect(forces[0][2] > 0.15 and forces[0] == forces[1], forces)


def test_profile_paper_has_no_est():
    folder = Folder()
    (line,) = lines_of(palpate('query', folder.save(), '--pose', PRESSED, '--profile', 'paper'))
    expect(line['est'] == [] and line['contact'], line)


def test_names_tell_which_parts_touch():
    folder = Folder()
    folder.write(
        'engine.gltf',
        gltf(
            [
                {'name': 'engine', 'children': [1, 2]},
                {'name': 'left', 'mesh': 0, 'translation': [-1, 0, 0]},
                {'name': 'right', 'mesh': 0, 'translation': [1, 0, 0]},
            ],
            box((0.5, 0.5, 0.04), (0, 0, -0.02)),
        ),
    )
    scene = folder.save(static=[{'mesh': 'engine.gltf'}])
    folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n1,0,0.019,0,0,0,1\n-1,0,0.019,0,0,0,1\n0,0,0.019,0,0,0,1\n')
    right, left, free = lines_of(palpate('query', scene, '--poses', folder / 'poses.csv', '--names'))
    expect(right['parts'] == {'static': ['engine/right'], 'tool': ['ball']}, right['parts'])
    expect(left['parts'] == {'static': ['engine/left'], 'tool': ['ball']}, left['parts'])
    expect(free['parts'] == {'static': [], 'tool': []}, free['parts'])


def test_bodies_of_one_mesh_are_told_apart():
    folder = Folder()
    folder.write('block.stl', stl(box((0.5, 0.5, 0.04), (0, 0, -0.02))))
    body = {'mesh': 'block.stl', 'units': 'm'}
    scene = folder.save(static=[body, {**body, 'position': [1, 0, 0]}, {**body, 'position': [2, 0, 0]}])
    poses = ''.join(f'{x},0,0.019,0,0,0,1\n' for x in range(3))
    folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n' + poses)
    lines = lines_of(palpate('query', scene, '--poses', folder / 'poses.csv', '--names'))
    names = [line['parts']['static'] for line in lines]
    expect(names == [['block'], ['block#2'], ['block#3']], names)


def test_a_path_and_a_trace_are_poses():
    folder = Folder()
    scene = folder.save()
    rows = [f'{x},0,0.0{z},0,0,0,1' for x, z in ((0, 3), (0.001, 19), (0.002, 18))]
    asked = {}
    for name, header, line in (
        ('poses', HEADER.strip(), '{}'),
        ('path', 'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage', '0.5,{},2'),
        ('trace', 'time_s,x_m,y_m,z_m,qx,qy,qz,qw,force_x_N,contact,stage', '7,{},0.1,0,1'),
    ):
        text = '\n'.join([header, *(line.format(row) for row in rows)]) + '\n'
        lines = lines_of(palpate('query', scene, '--poses', folder.write(f'{name}.csv', text)))
        asked[name] = [(one['pose'], one['force'], one['pairs']) for one in lines]
    expect(len(asked['poses']) == 3 and asked['path'] == asked['trace'] == asked['poses'], asked)


def generated(folder):
    outcome = palpate(
        'generate',
        'contacts',
        '--triangles',
        '2000',
        '--tool-triangles',
        '1000',
        '--out',
        folder / 'contacts',
    )
    expect(outcome.code == 0, outcome)
    return folder / 'contacts' / 'scene.json'


def test_both_back_ends_and_both_plans_answer_alike_to_the_bit():
    folder = Folder()
    folder.write(
        'poses.csv',
        HEADER
        + ''.join(
            f'{0.001 * i},0.0007,{0.0205 - 0.0011 * i},{0.6 * (i % 2)},0,0,{1 - 0.2 * (i % 2)}\n'
            for i in range(12)
        ),
    )
    scene = folder.save()
    for profile in ('refined', 'paper'):
        answers = {}
        for backend in ('ref', 'cpu', 'gpu'):
            for plan in ('auto', 'full'):
                outcome = palpate(
                    'query',
                    scene,
                    '--poses',
                    folder / 'poses.csv',
                    '--backend',
                    backend,
                    '--plan',
                    plan,
                    '--profile',
                    profile,
                )
                if backend == 'gpu' and outcome.code == 4:
                    raise AssertionError(
                        'no Vulkan device: install mesa-vulkan-drivers (scripts/packages.txt)'
                    )
                answers[backend, plan] = [without_time(line) for line in lines_of(outcome)]
        expect(any(line['contact'] for line in answers['ref', 'full']), 'the poses should touch')
        for key, lines in answers.items():
            for reference, line in zip(answers['ref', 'full'], lines, strict=True):
                for field in reference:
                    expect(
                        line[field] == reference[field],
                        (
                            f"{profile} {key}, pose {line['number']}, {field}: {line[field]} instead of"
                            f" {reference[field]}"
                        ),
                    )


def test_both_back_ends_agree_along_a_generated_scenes_path():
    folder = Folder()
    scene = generated(folder)
    # Reaches the first contacts.
    run = palpate('run', scene, '--pace', 'asap', '--duration', '4', '--out', folder / 'run')
    expect(run.code == 0, run)
    rows = [row.split(',') for row in (folder / 'run' / 'trace.csv').read_text().splitlines()]
    touching = [row for row in rows[1:] if row[rows[0].index('contact')] not in ('0', 'false')]
    expect(len(touching) > 20, 'the path should touch')
    chosen = touching[:: max(1, len(touching) // 8)]
    folder.write('poses.csv', HEADER + ''.join(','.join(row[1:8]) + '\n' for row in chosen))
    cpu = lines_of(palpate('query', scene, '--poses', folder / 'poses.csv', '--backend', 'cpu'))
    gpu = lines_of(palpate('query', scene, '--poses', folder / 'poses.csv', '--backend', 'gpu'))
    expect(any(line['areas'] for line in cpu), 'some pose should have an area')
    for a, b in zip(cpu, gpu, strict=True):
        for field in a:
            expect(
                field in ('time_us', 'engine') or a[field] == b[field],
                f"pose {a['number']}, {field}: cpu {a[field]}, gpu {b[field]}",
            )


def test_exported_geometry_is_what_was_judged():
    folder = Folder()
    folder.write('poses.csv', HEADER + '0,0,0.018,0,0,0,1\n0.01,0,0.019,0.6,0,0,0.8\n1e9,0,0,0,0,0,1\n')
    outcome = palpate(
        'query', folder.save(), '--poses', folder / 'poses.csv', '--export-geometry', folder / 'judged'
    )
    expect(outcome.code == 0, outcome)
    judged = folder / 'judged'
    # Another export's files are not replaced unless somebody says so; then none of them is left.
    again = ('query', folder / 'scene.json', '--pose', '0 0 0.018 0 0 0 1', '--export-geometry', judged)
    before = (judged / 'tool_1.i32').read_bytes()
    refused = palpate(*again)
    expect(
        refused.code == 3
        and 'lattice.json' in refused.err
        and '--overwrite' in refused.err
        and not refused.out,
        refused,
    )
    expect((judged / 'tool_1.i32').read_bytes() == before, 'a refusal changes nothing')
    other = folder / 'other'
    expect(
        palpate(*again[:-1], other).code == 0
        and palpate(
            'query',
            folder / 'scene.json',
            '--poses',
            folder / 'poses.csv',
            '--export-geometry',
            other,
            '--overwrite',
        ).code
        == 0,
        'told to overwrite',
    )
    expect(palpate(*again[:-1], other, '--overwrite').code == 0, 'told to overwrite')
    expect(
        sorted(p.name for p in other.iterdir())
        == ['lattice.json', 'pairs_0.u32', 'static.i32', 'tool_0.i32', 'voxels.json', 'voxels.u8'],
        'of one pose',
    )
    lattice = json.loads((judged / 'lattice.json').read_text())
    expect(list(lattice) == ['step_m', 'origin_m'], lattice)
    expect(math.frexp(lattice['step_m'])[0] == 0.5, 'the step is a power of two of a metre')

    def metres(name):
        words = (judged / name).read_bytes()
        values = struct.unpack(f'<{len(words) // 4}i', words)
        return [
            tuple(lattice['origin_m'][i % 3] + lattice['step_m'] * v for i, v in enumerate(values[k : k + 3]))
            for k in range(0, len(values), 3)
        ]

    block, ball = box((0.2, 0.2, 0.04), (0, 0, -0.02)), sphere(0.02)
    # Corners: half a step of snapping an axis, once more for a pose, and float32 in the file (6e-9 of 0.1 m).
    for name, triangles, shift in (('static.i32', block, (0, 0, 0)), ('tool_0.i32', ball, (0, 0, 0.018))):
        seen = metres(name)
        expect(len(seen) == 3 * len(triangles), f'{name}: {len(seen)} corners')
        for corner, given in zip(seen, (c for t in triangles for c in t), strict=True):
            expect(
                all(abs(corner[i] - given[i] - shift[i]) < 2 * lattice['step_m'] + 2e-8 for i in range(3)),
                f'{name}: {corner} {given}',
            )
    expect((judged / 'tool_1.i32').stat().st_size == 36 * len(ball), 'one file a pose')
    expect(
        not (judged / 'tool_2.i32').exists() and 'pose 2' in outcome.err,
        'a pose beyond the lattice has no coordinates',
    )

    voxels = json.loads((judged / 'voxels.json').read_text())
    expect(list(voxels) == ['size', 'origin', 'counts'], voxels)
    classes = (judged / 'voxels.u8').read_bytes()
    nx, ny, nz = voxels['counts']
    expect(len(classes) == nx * ny * nz and set(classes) == {0, 1, 2}, 'a block has all three classes')

    def class_at(point):
        i, j, k = (
            math.floor(
                ((point[a] - lattice['origin_m'][a]) / lattice['step_m'] - voxels['origin'][a])
                / voxels['size']
            )
            for a in range(3)
        )
        return classes[i + nx * (j + ny * k)]

    expect(class_at((0.01, 0.02, -0.02)) == 2, 'the middle of the block is inside')
    expect(class_at((0.0123, 0.0077, -1e-9)) == 1, 'its top is boundary')
    expect(classes[0] == 0 and classes[-1] == 0, 'the corners of the grid are outside')


main(globals())
