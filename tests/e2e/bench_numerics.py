"""`palpate bench numerics`: where single and double precision break, and that palpate holds or refuses
there."""
import csv
import json

from harness import *


def test_nothing_is_lost_silently():
    folder = Folder()
    done = palpate('bench', 'numerics', '--out', folder / 'figures')
    expect(done.code == 0, done)
    with open(folder / 'figures/results.csv') as file:
        rows = list(csv.DictReader(file))
    expect(list(rows[0])[:6] == ['case', 'parameter', 'value', 'precision', 'error', 'outcome'], rows[0])
    expect(
        set(row['case'] for row in rows)
        == {
            'stiffness',
            'scale',
            'offset',
            'aspect',
            'depth',
            'sample_spacing',
            'patch_aspect',
            'patches',
            'play_inside',
            'play_aside',
            'interference',
            'stiffness_ratio',
            'touching',
            'delay',
            'ticks',
        },
        'the fifteen cases',
    )
    broken = {(row['case'], row['precision']) for row in rows if row['outcome'] in ('lost', 'no contact')}
    for case in ('offset', 'scale', 'stiffness', 'touching'):
        expect((case, 'fp32') in broken, f'single precision breaks in {case}')
    for row in rows:
        expect(
            row['outcome'] in ('held', 'lost', 'no contact') or row['outcome'].startswith('refused: '), row
        )
        # Gaps below a lattice step, contacts shallower than samples are apart and results older than the
        # press are no matter of arithmetic.
        if row['precision'] == 'palpate' and row['case'] in (
            'stiffness',
            'scale',
            'offset',
            'aspect',
            'patch_aspect',
            'patches',
            'stiffness_ratio',
            'ticks',
        ):
            expect(row['outcome'] == 'held' or row['outcome'].startswith('refused: '), row)
    facts = json.loads((folder / 'figures/results.json').read_text())
    expect(sum(key.startswith('breaks, ') for key in facts) == 15, list(facts))
    # What fp64 holds and palpate loses, it says why, and there is nothing else.
    held = {
        (row['case'], row['value']) for row in rows if row['precision'] == 'fp64' and row['outcome'] == 'held'
    }
    lost = [
        row
        for row in rows
        if row['precision'] == 'palpate'
        and row['outcome'] in ('lost', 'no contact')
        and (row['case'], row['value']) in held
    ]
    refused = [
        row
        for row in rows
        if row['precision'] == 'palpate'
        and row['outcome'].startswith('refused')
        and (row['case'], row['value']) in held
    ]
    first = facts['findings'][0]
    expect(
        facts['lost without a reason'] == '0'
        and first.startswith(f'Of {len(held)} answers that fp64 holds palpate loses {len(lost)}, ')
        and first.endswith(f' and refuses {len(refused)}, in a sentence.'),
        facts['findings'],
    )
    expect(sum('steps of the lattice' in one for one in facts['findings']) == len(lost), facts['findings'])
    expect((folder / 'figures/chart_0.svg').read_text().startswith('<svg'), 'pictures by themselves')


main(globals())
