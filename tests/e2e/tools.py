"""`palpate info`, `generate`, `devices` and `plan`."""
import re

from harness import *

STAGES = [
    'transform',
    'cull',
    'pairs',
    'imt',
    'bmt',
    'bst',
    'est',
    'areas',
    'zones',
    'rays',
    'contact_point',
    'torque',
    'telemetry',
]


def info(*meshes):
    outcome = palpate('info', *meshes, '--json')
    expect(outcome.code == 0, outcome)
    return json.loads(outcome.out)['meshes']


def test_info_tells_size_closedness_and_parts():
    folder = Folder()
    (block,) = info(folder / 'block.stl')
    expect(
        block['triangles'] == 12 and block['vertices'] == 8 and block['closed'] and block['open_edges'] == 0,
        block,
    )
    # Float32 in the file.
    expect(all(abs(a - b) < 1e-6 for a, b in zip(block['size'], (0.2, 0.2, 0.04))), block['size'])
    expect(
        len(block['parts']) == 1
        and block['parts'][0]['triangles'] == 12
        and block['parts'][0]['orientation'] == 'outward',
        block['parts'],
    )


def test_info_finds_what_is_open_turned_degenerate_and_double():
    folder = Folder()
    cube = box((1, 1, 1))
    folder.write('open.stl', stl(cube[:-1]))
    folder.write('turned.stl', stl([(a, c, b) for a, b, c in cube]))
    folder.write('double.stl', stl(cube + [cube[0]] + [(cube[0][0], cube[0][0], cube[0][1])]))
    opened, turned, double = info(folder / 'open.stl', folder / 'turned.stl', folder / 'double.stl')
    expect(not opened['closed'] and opened['open_edges'] == 3 and opened['largest_gap'] > 0.9, opened)
    expect(turned['closed'] and turned['parts'][0]['orientation'] == 'turned', turned)
    expect(double['degenerate'] == 1 and double['duplicate'] >= 1, double)


def test_info_for_people_says_the_same():
    folder = Folder()
    outcome = palpate('info', folder / 'block.stl', folder / 'ball.stl')
    expect(
        outcome.code == 0
        and 'block.stl' in outcome.out
        and 'ball.stl' in outcome.out
        and '12' in outcome.out,
        outcome,
    )


def test_info_of_a_scene_says_how_the_tool_starts():
    folder = Folder()
    plate = [[(-0.05, 0, 0), (0.05, 0, 0), (0, 0.05, 0)]]
    folder.write('sheet.stl', stl(plate))
    folder.write('upright.stl', stl([[(x, z + 0.01, y - 0.02) for x, y, z in plate[0]]]))

    def start_of(height, mockup='block.stl', tool='ball.stl', profile='refined'):
        scene = folder.save(
            static=[{'mesh': mockup, 'units': 'm', 'position': [0, 0, -height]}],
            tool={'mesh': tool, 'units': 'm'},
            response={'profile': profile},
        )
        outcome = palpate('info', scene, '--json')
        expect(outcome.code == 0, outcome)
        (told,) = json.loads(outcome.out)['scenes']
        printed = [
            line.removeprefix('  start').strip()
            for line in palpate('info', scene).out.splitlines()
            if line.startswith('  start')
        ]
        expect(
            printed == (['free: nothing touches the tool'] if told['free'] else told['start']),
            (printed, told),
        )
        return told

    expect(start_of(0.03)['free'], 'a ball of 20 mm, 30 mm above')
    expect(start_of(0.03, profile='paper')['free'], 'likewise')
    pressed = start_of(0.018)
    deep = re.match(
        r"the tool starts up to (\S+) mm deep in 'block', its part 'ball', about .* -0\.018 m$",
        pressed['start'][0],
    )
    # 2 mm at the ball's pole; the deepest sample lies beside it.
    expect(not pressed['free'] and deep and 1.9 < float(deep[1]) <= 2, pressed)
    (letter,) = start_of(0.018, profile='paper')['start']
    expect(letter.startswith("the tool starts in touch with 'block', its part 'ball' ("), letter)
    sheets = start_of(0, 'sheet.stl', 'upright.stl')
    expect(
        sheets['start']
        == [
            "the tool starts in touch with 'sheet', its part 'upright' (1 pair of triangles), "
            'but no sample of either lies in the other: nothing pushes it'
        ],
        sheets,
    )


def test_units_are_a_guess_that_is_told_and_a_choice_that_is_made():
    folder = Folder()
    folder.write('saw.stl', stl(box((191, 40, 2))))
    (saw,) = info(folder / 'saw.stl')
    expect(
        saw['unit'] == 'file'
        and '191 m long, if in metres' in saw['unit_guess']
        and '191 mm, if in millimetres (--units mm)' in saw['unit_guess'],
        saw,
    )
    expect(abs(saw['size'][0] - 191) < 1e-4, 'nothing is applied silently')
    outcome = palpate('info', folder / 'saw.stl', '--units', 'mm', '--json')
    (saw,) = json.loads(outcome.out)['meshes']
    expect(saw['unit'] == 'm' and saw['unit_guess'] is None and abs(saw['size'][0] - 0.191) < 1e-6, saw)
    folder.write('engine.gltf', gltf(ENGINE, box((500, 1, 1))))
    (engine,) = info(folder / 'engine.gltf')
    expect(engine['unit'] == 'm' and 'metres by its format: 504 m long' in engine['unit_guess'], engine)
    expect_refused(palpate('info', folder / 'saw.stl', '--units', 'ell'), 3, '--units')


def test_units_of_a_scene_that_states_none():
    folder = Folder()
    folder.write('block.stl', stl(box((200, 200, 40), (0, 0, -20))))
    folder.write('ball.stl', stl(sphere(20)))
    stated, free = folder.save(), folder.save(
        'free.json', static=[{'mesh': 'block.stl'}], tool={'mesh': 'ball.stl'}
    )
    pose = ('--pose', '0 0 0.019 0 0 0 1')
    (line,) = lines_of(palpate('query', free, *pose, '--units', 'mm'))
    expect(line['contact'] and 0 < line['force'][2] < 2.5, line['force'])
    (line,) = lines_of(palpate('query', stated, *pose, '--units', 'mm'))
    expect(
        line['force'] == lines_of(palpate('query', stated, *pose))[0]['force'], 'what the scene states stands'
    )


def test_closed_beside_edges_of_one_triangle_says_why():
    folder = Folder()
    cube = [t for t in box((1, 1, 1)) if not all(p[2] == 0.5 for p in t)]
    # The lid's edge a b has a point more than the wall's.
    a, b, c, d, m = (-0.5, -0.5, 0.5), (0.5, -0.5, 0.5), (0.5, 0.5, 0.5), (-0.5, 0.5, 0.5), (0, -0.5, 0.5)
    folder.write('junction.stl', stl(cube + [(m, b, c), (m, c, d), (m, d, a)]))
    (junction,) = info(folder / 'junction.stl')
    expect(
        junction['closed']
        and junction['open_edges'] == 3
        and any('T-junctions' in note for note in junction['notes']),
        junction,
    )


ENGINE = [
    {'name': 'engine', 'children': [1, 2]},
    {'name': 'block', 'mesh': 0},
    {'name': 'lid', 'children': [3, 4], 'translation': [0, 0, 3]},
    {'name': 'bolt', 'mesh': 0, 'translation': [2, 0, 0]},
    {'name': 'bolt', 'mesh': 0, 'translation': [-2, 0, 0]},
]


def test_info_prints_the_hierarchy():
    folder = Folder()
    folder.write('engine.gltf', gltf(ENGINE, box((1, 1, 1))))
    outcome = palpate('info', folder / 'engine.gltf', '--tree')
    expect(outcome.code == 0, outcome)
    table = [line.split() for line in outcome.out.splitlines()]
    rows = table[[row[:1] == ['#'] for row in table].index(True) + 1 :]
    expect(
        [row[:2] for row in rows]
        == [['engine', '36'], ['#1', 'block'], ['lid', '24'], ['#2', 'bolt'], ['#3', 'bolt#2']],
        rows,
    )
    expect(all(row[-1] == 'outward' for row in rows if row[0][0] == '#'), rows)
    outcome = palpate('info', folder / 'engine.gltf', '--tree', '--json')
    ((engine,),) = [mesh['tree'] for mesh in json.loads(outcome.out)['meshes']]
    block, lid = engine['below']
    expect(
        (engine['name'], engine['triangles'], engine['closed'], 'number' in engine)
        == ('engine', 36, True, False),
        engine,
    )
    expect(
        (block['name'], block['number'], block['also'], block['size']) == ('block', 1, 'solid', [1, 1, 1]),
        block,
    )
    expect(lid['size'] == [5, 1, 1] and [bolt['name'] for bolt in lid['below']] == ['bolt', 'bolt#2'], lid)
    (flat,) = info(folder / 'engine.gltf')
    expect(
        [(part['number'], part['path']) for part in flat['parts']]
        == [(1, 'engine/block'), (2, 'engine/lid/bolt'), (3, 'engine/lid/bolt#2')],
        flat,
    )
    expect(all(abs(part['volume'] - 1) < 1e-9 for part in flat['parts']) and 'tree' not in flat, flat)


def test_generate_makes_scenes_that_load():
    folder = Folder()
    for name in ('contacts', 'disassembly'):
        outcome = palpate(
            'generate', name, '--triangles', '4000', '--tool-triangles', '1000', '--out', folder / name
        )
        expect(outcome.code == 0 and 'scene.json' in outcome.out, outcome)
        plan = palpate('plan', folder / name / 'scene.json', '--json')
        expect(plan.code == 0, plan)


def test_generate_makes_the_same_bytes_twice():
    folder = Folder()
    for out in ('a', 'b'):
        expect(palpate('generate', 'contacts', '--triangles', '3000', '--out', folder / out).code == 0, out)
    names = sorted(p.name for p in (folder / 'a').iterdir())
    expect(names == sorted(p.name for p in (folder / 'b').iterdir()) and names, names)
    for name in names:
        expect((folder / 'a' / name).read_bytes() == (folder / 'b' / name).read_bytes(), name)


def test_devices_lists_both_kinds_with_reasons():
    outcome = palpate('devices')
    expect(outcome.code == 0 and outcome.err == '', outcome)
    for word in ('Vulkan devices', 'Haptic devices', 'simulated', 'falcon', 'inverse3', 'not usable'):
        expect(word in outcome.out, f"no '{word}' in\n{outcome.out}")


NO_DRIVER = {'VK_ICD_FILENAMES': '/nowhere/driver.json', 'VK_DRIVER_FILES': '/nowhere/driver.json'}


def test_without_a_vulkan_device_the_cpu_answers_and_says_so():
    folder = Folder()
    query = ('query', folder.save(), '--pose', '0 0 0.018 0 0 0 1')
    expect_refused(palpate(*query, '--backend', 'gpu', **NO_DRIVER), 4, 'no usable Vulkan device')
    outcome = palpate(*query, **NO_DRIVER)
    expect(outcome.code == 0 and outcome.err.count('the engine cpu answers') == 1, outcome)
    expect(lines_of(outcome)[0]['engine'] == 'cpu', outcome)
    in_paper = palpate(*query, '--profile', 'paper', **NO_DRIVER)
    expect(
        in_paper.code == 0
        and in_paper.err.count('the engine ref answers') == 1
        and lines_of(in_paper)[0]['engine'] == 'ref',
        in_paper,
    )
    with_driver = palpate(*query)
    for a, b in zip(lines_of(outcome), lines_of(with_driver), strict=True):
        expect({**a, 'time_us': 0} == {**b, 'time_us': 0}, 'the same answer')
    expect('Vulkan driver' in palpate('devices', **NO_DRIVER).out, 'devices says why')


def test_every_engine_gives_the_same_answer_and_its_name():
    folder = Folder()
    query = ['query', folder.save(), '--pose', '0 0 0.019 0 0 0 1']
    first = None
    for engine in ('gpu', 'cpu', 'ref'):
        (line,) = lines_of(palpate(*query, '--backend', engine))
        expect(line['contact'] and line['engine'] == engine, line)
        first = first or line
        expect({**line, 'time_us': 0, 'engine': 0} == {**first, 'time_us': 0, 'engine': 0}, 'the same answer')
    by_default = palpate(*query, '--backend', 'auto')
    expect(
        {**lines_of(by_default)[0], 'time_us': 0, 'engine': 0} == {**first, 'time_us': 0, 'engine': 0},
        'the same answer',
    )
    expect(
        lines_of(palpate(*query, '--profile', 'paper'))[0]['engine'] == 'gpu',
        'shaders answer in paper wherever they can',
    )
    in_paper = palpate(*query, '--backend', 'cpu', '--profile', 'paper')
    expect(
        lines_of(in_paper)[0]['engine'] == 'ref'
        and in_paper.err.count('the engine ref answers instead') == 1,
        in_paper,
    )


def test_plan_gives_a_reason_for_each_of_the_thirteen_stages():
    folder = Folder()
    outcome = palpate('plan', folder.save(), '--json')
    expect(outcome.code == 0, outcome)
    stages = json.loads(outcome.out)['stages']
    expect([s['stage'] for s in stages] == STAGES, stages)
    for s in stages:
        expect(
            list(s) == ['stage', 'kept', 'reason', 'memory_bytes', 'saved_bytes', 'saved_us']
            and s['reason']
            and isinstance(s['kept'], bool),
            s,
        )
        expect(
            s['memory_bytes'] >= 0 and (s['kept'] or s['memory_bytes'] == 0),
            f'a stage left out costs nothing: {s}',
        )
    engines = json.loads(outcome.out)['engines']
    expect([e['engine'] for e in engines] == ['cpu', 'gpu'], engines)
    expect(
        all(
            (e['frame_us'] is None) == bool(e['missing'])
            and (e['missing'] or e['frame_us'] > 0 and e['device'])
            for e in engines
        )
        and not engines[0]['missing'],
        engines,
    )
    kept = {s['stage']: s['kept'] for s in stages}
    expect(kept['imt'], 'a block is solid')
    expect(kept['zones'], 'a block has sharp edges')
    expect(not kept['telemetry'], 'nobody listens')


def test_plan_leaves_out_what_the_scene_does_not_need():
    folder = Folder()
    # A smooth ball as mock-up has no sharp edge; an open sheet has no inside.
    stages = json.loads(palpate('plan', folder.save(static=[{'mesh': 'ball.stl'}]), '--json').out)['stages']
    expect(not {s['stage']: s['kept'] for s in stages}['zones'], stages)
    folder.write('sheet.stl', stl(box((0.2, 0.2, 0.2))[:2]))
    stages = json.loads(palpate('plan', folder.save(static=[{'mesh': 'sheet.stl'}]), '--json').out)['stages']
    line = next(s for s in stages if s['stage'] == 'imt')
    expect(not line['kept'] and 'V_int' in line['reason'], line)
    stages = json.loads(palpate('plan', folder.save(response={'profile': 'paper'}), '--json').out)['stages']
    line = next(s for s in stages if s['stage'] == 'est')
    expect(not line['kept'] and line['memory_bytes'] == 0, line)


def test_bench_scale_refines_a_scene_of_ones_own():
    folder = Folder()
    folder.write('block.stl', stl(box((0.06, 0.06, 0.03), (0, 0, -0.015))))
    folder.write('ball.stl', stl(sphere(0.01)))
    folder.write(
        'poses.csv',
        'x,y,z,qx,qy,qz,qw\n' + ''.join(f'{0.001 * i},{0.0007 * i},0.009,0,0,0,1\n' for i in range(8)),
    )
    scene = folder.save(static=[{'mesh': 'block.stl', 'units': 'm'}], tool={'mesh': 'ball.stl', 'units': 'm'})
    engines = ('--backend', 'cpu', 'gpu')
    few = ('--poses', folder / 'poses.csv', '--rounds', '1')
    done = palpate('bench', 'scale', scene, *few, *engines, '--out', folder / 'out')
    expect(done.code == 0, done)
    rows = [
        row
        for row in json.loads((folder / 'out' / 'results.json').read_text())['rows']
        if row['frames'] == 'contact'
    ]
    balls = len(sphere(0.01))
    expect(
        [(row['backend'], row['static_triangles'], row['tool_triangles']) for row in rows]
        == [(engine, 12 * n, balls * n) for n in (1, 4, 16) for engine in ('cpu', 'gpu')],
        rows,
    )
    expect(all(row['count'] == 8 and row['p50_us'] > 0 for row in rows), 'the same poses meet in all three')
    # What a frame asks of a device: one submission of the device's engine, nothing of the native one.
    asked = [(row['backend'], row['submissions'] or 0, row['dispatches'] or 0) for row in rows]
    expect(all(s == (e == 'gpu') and (d > 0) == (e == 'gpu') for e, s, d in asked), asked)
    expect_refused(palpate('bench', 'scale', scene, '--out', folder / 'none'), 2, '--poses')
    # p99.9 of fewer than a thousand frames would be the longest by another name.
    done = palpate(
        'bench',
        'latency',
        scene,
        '--poses',
        folder / 'poses.csv',
        '--rounds',
        '1',
        '--out',
        folder / 'latency',
    )
    expect(done.code == 0, done)
    rows = json.loads((folder / 'latency' / 'results.json').read_text())['rows']
    expect(rows and all(row['p999_us'] is None for row in rows), rows)
    expect('cull' in (folder / 'latency' / 'report.html').read_text(), 'the chart shows every stage')


def test_bench_questions_times_all_that_a_planner_asks():
    folder = Folder()
    folder.write('block.stl', stl(box((0.06, 0.06, 0.03), (0, 0, -0.015))))
    folder.write('ball.stl', stl(sphere(0.01)))
    folder.write(
        'poses.csv', 'x,y,z,qx,qy,qz,qw\n' + ''.join(f'0,0,{0.004 + 0.002 * i},0,0,0,1\n' for i in range(8))
    )
    scene = folder.save(static=[{'mesh': 'block.stl', 'units': 'm'}], tool={'mesh': 'ball.stl', 'units': 'm'})
    asked = (
        'bench',
        'questions',
        scene,
        '--poses',
        folder / 'poses.csv',
        '--rounds',
        '1',
        '--backend',
        'cpu',
    )
    done = palpate(*asked, '--reach', '0', '--out', folder / 'out')
    expect(done.code == 0, done)
    rows = json.loads((folder / 'out' / 'results.json').read_text())['rows']
    ours = {(row['question'], row['frames']): row for row in rows if row['library'] == 'palpate cpu'}
    # A ball of 10 mm over a block's face: at 4, 6 and 8 mm it meets the block, at 10 mm its lowest corner
    # just does, and five are free.
    touching = ours['any', 'contact']['count']
    expect(touching in (3, 4) and ours['any', 'all']['count'] == 8, ours['any', 'all'])
    expect(
        {question for question, kind in ours if kind == 'all'}
        == {'any', 'distance', 'first contact', 'frame'},
        ours,
    )
    expect(
        ours['first contact', 'all']['count'] == 7 and all(row['p50_us'] > 0 for row in ours.values()),
        'a motion from each pose to the next',
    )
    moved = palpate(*asked, '--reach', '50', '--out', folder / 'moved')
    expect(moved.code == 0, moved)
    rows = json.loads((folder / 'moved' / 'results.json').read_text())['rows']
    expect(
        sum(row['count'] for row in rows if row['question'] == 'any' and row['frames'] in ('free', 'apart'))
        > 0,
        rows,
    )
    expect_refused(palpate(*asked, '--reach', '-1', '--out', folder / 'none'), 3, '--reach')
    # An engine that measures no distances is asked what it knows, and the page says what it is not.
    shaders = palpate(*asked[:-1], 'gpu', '--reach', '0', '--out', folder / 'gpu')
    expect(shaders.code == 0, shaders)
    rows = json.loads((folder / 'gpu' / 'results.json').read_text())['rows']
    expect(
        {(row['library'], row['question']) for row in rows}
        == {('palpate gpu', 'any'), ('palpate gpu', 'frame')},
        rows,
    )
    expect('measures no distances' in (folder / 'gpu' / 'report.html').read_text(), 'what is left out')


main(globals())
