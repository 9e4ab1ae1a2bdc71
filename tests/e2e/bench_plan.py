"""`palpate bench plan`: what a scene lacks is left out, gone from times and memory, and changes no bit of the
rest (the bench itself refuses if it does)."""
import csv
import json

from harness import *

LEFT_OUT = {
    'everything': '',
    'no_inside': 'imt',
    'all_smooth': 'zones',
    'sheet': 'imt zones',
    'no_torque': 'contact_point torque',
    'nobody_watching': 'telemetry',
    'one_triangle': 'imt zones',
    'swallowed': 'contact_point torque',
    'large_sheet': 'imt zones contact_point torque',
    'paper_thin': 'imt est',
    'large_contact': 'zones contact_point torque',
    'paper': 'est contact_point torque',
    'paper_smooth': 'est zones telemetry',
    'nothing': 'imt zones contact_point torque telemetry',
}


def rows_of(backend, folder):
    out = folder / f'figures_{backend}'
    done = palpate('bench', 'plan', '--backend', backend, '--rounds', '1', '--out', out)
    expect(done.code == 0, done)
    with open(out / 'results.csv') as file:
        return list(csv.DictReader(file)), json.loads((out / 'results.json').read_text())


def test_what_is_left_out_is_gone_and_the_rest_is_the_same():
    rows, facts = rows_of('gpu', Folder())
    expect(len(set(row['scene'] for row in rows)) >= 16, 'sixteen scenes at least')
    for scene in set(row['scene'] for row in rows):
        lean = {row['stage']: row for row in rows if (row['scene'], row['plan']) == (scene, 'lean')}
        whole = {row['stage']: row for row in rows if (row['scene'], row['plan']) == (scene, 'whole')}
        left_out = lean['total']['left_out'].split()
        if scene in LEFT_OUT:
            expect(left_out == LEFT_OUT[scene].split(), f'{scene}: {left_out}')
        expect('the same bits' in facts[scene], facts[scene])
        asked_device = any(whole.get(stage, {}).get('time_us_p50') for stage in ('reset', 'bst'))
        if 'imt' in left_out:  # its dispatch decides BMT alone, and no tool can be swallowed
            expect('imt' not in lean and 'swallowed' not in lean, lean)
            expect(
                not asked_device or ('bmt' in lean and 'imt' in whole),
                f'{scene}: {list(lean)}, {list(whole)}',
            )
        if scene in ('paper', 'paper_thin', 'paper_smooth', 'large_contact', 'large_sheet'):
            expect(asked_device, f'{scene}: too much for the host alone, or none of its business')
        if scene.startswith('paper'):  # the field has no zones to join
            memory = [int(plan['zones']['memory_bytes']) if 'zones' in plan else 0 for plan in (whole, lean)]
            expect(memory[0] > 0 or scene == 'one_triangle', f'{scene}: zones are joined in {memory}')
            if 'zones' in left_out:
                expect(
                    memory[1] == 0
                    and (
                        int(lean['total']['memory_bytes']) < int(whole['total']['memory_bytes'])
                        or scene == 'one_triangle'
                    ),
                    f'{scene}: {memory}',
                )
            else:
                expect(memory[1] == memory[0], f'{scene}: {memory}')
        if scene == 'far_tool':
            expect('cull' in lean, f'the search is on the device: {list(lean)}')


def test_the_other_engines_leave_out_the_same():
    for engine in ('cpu', 'ref'):
        rows, facts = rows_of(engine, Folder())
        expect(all('the same bits' in facts[row['scene']] for row in rows), facts)


def test_plan_tells_what_each_decision_spares():
    folder = Folder()
    folder.write('ball.stl', stl(sphere(0.03)))
    folder.write('tool.stl', stl(sphere(0.01)))
    folder.write(
        'path.csv', 'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0.045,0,0,0,1,0\n1,0,0,0.036,0,0,0,1,0\n'
    )
    scene = folder.save(
        static=[{'mesh': 'ball.stl', 'units': 'm'}],
        tool={'mesh': 'tool.stl', 'units': 'm'},
        device={'driver': 'simulated', 'path': 'path.csv', 'actuated': ['fx', 'fy', 'fz']},
    )
    done = palpate('plan', scene, '--json')
    expect(done.code == 0, done)
    stages = {stage['stage']: stage for stage in json.loads(done.out)['stages']}
    expect(len(stages) == 13, stages)
    for name in ('contact_point', 'torque', 'telemetry'):
        expect(not stages[name]['kept'] and stages[name]['saved_us'] is not None, stages[name])
    expect(stages['pairs']['kept'] and stages['pairs']['saved_us'] is None, stages['pairs'])


main(globals())
