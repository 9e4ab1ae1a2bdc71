"""`palpate bench error`: every knob has its errors and times, against closed forms that this test works out
again, and they fall as they should."""
import csv
import math

from harness import *
import json

COLUMNS = [
    'scene',
    'method',
    'knob',
    'value',
    'quantity',
    'error_p50',
    'error_p99',
    'time_us_p50',
    'time_us_p99',
]
CASES = (
    'peg of 96 sides off centre askew, play 0.3 mm',
    'plate on to 4 pads',
    'plate on six waves',
    'plate of 2 mm pierced',
)
FORMS = ('sphere_plane', 'cylinder_plane', 'corner_plane', 'sphere_sphere')


def test_the_closed_forms_converge_and_paper_does_not():
    folder = Folder()
    out = folder / 'figures'
    done = palpate('bench', 'error', '--frames', '8', '--out', out, '--clock', 'cpu')
    expect(done.code == 0, done)
    with open(out / 'results.csv') as file:
        rows = list(csv.DictReader(file))
    expect(list(rows[0])[: len(COLUMNS)] == COLUMNS, rows[0])
    expect(
        set(row['scene'] for row in rows) == {*FORMS, *CASES, 'control'},
        'the four closed forms, fits and plates, and the force law',
    )
    engines = {row['engine'] for row in rows} - {''}
    expect('cpu' in engines and len(engines) == 2, engines)
    # The engines' errors are the same to the last digit; what is left is one engine's.
    for engine in engines - {'cpu'}:
        key = lambda row: tuple(row[name] for name in COLUMNS[:7])
        expect(
            {key(row) for row in rows if row['engine'] == 'cpu'}
            == {key(row) for row in rows if row['engine'] == engine and row['method'] == 'refined'},
            engine,
        )
    rows = [row for row in rows if row['engine'] in ('cpu', '') or row['method'] == 'paper']
    for row in rows:
        expect(
            0 <= float(row['error_p50']) <= float(row['error_p99'])
            and 0 <= float(row['time_us_p50']) <= float(row['time_us_p99']),
            row,
        )
        # What is no frame has no time.
        expect(float(row['time_us_p50']) > 0 or row['method'] in ('tessellation', 'fp32', 'fp64'), row)
    for form in FORMS:
        errors = sorted(
            (float(row['value']), float(row['error_p50']))
            for row in rows
            if (row['scene'], row['method'], row['knob'], row['quantity'])
            == (form, 'refined', 'sample_spacing', 'd_m')
        )
        expect(len(errors) == 9, errors)
        # Sixteen times closer samples: at least first order.
        expect(errors[0][1] < errors[-1][1] / 16, f'{form}: {errors}')
        paper = [
            float(row['error_p50'])
            for row in rows
            if (row['scene'], row['method'], row['quantity']) == (form, 'paper', 'd_m')
        ]
        expect(min(paper) > errors[0][1], f'{form}: {paper}')
        for method, knob in (
            ('refined', 'sample_spacing'),
            ('refined', 'voxel_size'),
            ('refined', 'contact_samples'),
            ('paper', 'voxel_size'),
            ('paper', 'triangles'),
        ):
            points = {
                row['value']
                for row in rows
                if (row['scene'], row['method'], row['knob']) == (form, method, knob)
            }
            expect(len(points) >= 6, f'{form}, {method}, {knob}: {points}')
        # One flat face gives the direction; two spheres give it but for their samples.
        for row in rows:
            if (row['scene'], row['method'], row['quantity']) == (
                form,
                'refined',
                'n_c_deg',
            ) and form != 'sphere_sphere':
                expect(float(row['error_p99']) < 1e-5, row)
    # Of fits and plates each method is judged against its own truth, and every curve has its points.
    for case in CASES:
        errors = sorted(
            (float(row['value']), float(row['error_p50']))
            for row in rows
            if (row['scene'], row['method'], row['knob'], row['quantity'])
            == (case, 'refined', 'sample_spacing', 'F_N')
        )
        expect(len(errors) == 7 and errors[0][1] < errors[-1][1], f'{case}: {errors}')
        for method, knob in (
            ('refined', 'voxel_size'),
            ('refined', 'contact_samples'),
            ('paper', 'voxel_size'),
            ('paper', 'triangles'),
        ):
            points = {
                row['value']
                for row in rows
                if (row['scene'], row['method'], row['knob']) == (case, method, knob)
            }
            expect(len(points) >= 6, f'{case}, {method}, {knob}: {points}')
    # What stands apart: the mesh's own error falls with its triangles, single precision is lost far from the
    # origin, the corrected law beats holding.
    alone = {(row['method'], row['knob'], float(row['value'])): float(row['error_p50']) for row in rows}
    expect(
        alone['tessellation', 'tool_triangles', 81920] < alone['tessellation', 'tool_triangles', 80] / 100,
        'tessellation',
    )
    steps = {
        method: [
            error for (m, knob, _), error in sorted(alone.items()) if (m, knob) == (method, 'lattice_step')
        ]
        for method in ('palpate', 'fp32')
    }
    expect(max(steps['palpate']) < 1e-4 and len(steps['palpate']) == 4 == len(steps['fp32']), steps)
    for age in (2, 5, 10, 20, 50):
        expect(alone['corrected', 'age', age] < alone['hold', 'age', age], f'age {age}')
    results = json.loads((out / 'results.json').read_text())
    for form in FORMS:
        expect(float(results[f'order of d, {form}'].split()[0]) >= 1, results[f'order of d, {form}'])
    for summary in results['findings'][:2]:
        expect(
            summary.startswith(('By one engine', 'Each by an engine of its own'))
            and all(form in summary for form in (*FORMS, *CASES)),
            summary,
        )
    expect(
        sum('times sooner' in one or 'gets no nearer' in one for one in results['findings'][2:]) == 8,
        results['findings'],
    )
    page = (out / 'report.html').read_text()
    expect(page.count('<h2 id="chapter-') == 9, 'a chapter a subject, and what stands apart')
    for sign in ('1 ms', 'Pareto front', 'order 2', 'engines, refined'):
        expect(sign in page, sign)
    expect(
        '<canvas' not in (out / 'report.html').read_text()
        and 'sphere_sphere' in (out / 'report.html').read_text(),
        'a report that draws itself',
    )


def test_a_scene_is_judged_against_a_converged_run():
    folder = Folder()
    scene = ball_on_block(folder, side=0.08, poses=12, step=0.0001)
    done = palpate(
        'bench',
        'error',
        scene,
        '--poses',
        folder / 'poses.csv',
        '--scenes-only',
        '--quick',
        '--backend',
        'cpu',
        '--out',
        folder / 'figures',
    )
    expect(done.code == 0, done)
    with open(folder / 'figures/results.csv') as file:
        errors = {
            float(row['value']): float(row['error_p50'])
            for row in csv.DictReader(file)
            # One scene, called like its folder.
            if (row['knob'], row['quantity']) == ('sample_spacing', 'd_m')
        }
    expect(len(errors) == 7 and errors[min(errors)] < errors[max(errors)] / 4, errors)
    far = folder.write('far.csv', 'x,y,z,qx,qy,qz,qw\n5,5,5,0,0,0,1\n')
    refused = palpate(
        'bench', 'error', scene, '--poses', far, '--scenes-only', '--rounds', '1', '--out', folder / 'none'
    )
    expect(refused.code == 3, refused)
    expect(refused.err.count('none of the 1 poses has a contact that pushes') == 1, 'said once')
    nothing = palpate('bench', 'error', '--scenes-only', '--out', folder / 'none')
    expect(nothing.code == 2 and '--scenes-only goes with a scene' in nothing.err, nothing)
    expect(not (folder / 'none' / 'results.csv').exists(), 'a table of nothing')


main(globals())
