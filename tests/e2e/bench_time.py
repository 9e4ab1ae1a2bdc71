"""`palpate bench throughput` and `latency`: each engine has rows of its own, a batch or frame of the device is
one submission of few dispatches whatever its size, and --largest bounds the batches. `prepare`: stages add up to
what they are stages of. `jitter`: every tick that was due is counted."""
import csv

from harness import *

MOST_DISPATCHES = 10  # docs/ARCHITECTURE.md: of a frame, and of a batch of any size


def measured(folder, bench, *words):
    out = folder / bench
    done = palpate(
        'bench', bench, ball_on_block(folder), '--poses', folder / 'poses.csv', '--rounds', '3', '--out', out,
        '--backend', 'cpu', 'gpu', *words,
    )  # fmt: skip
    expect(done.code == 0, done)
    with open(out / 'results.csv') as file:
        return list(csv.DictReader(file))


def test_throughput_by_batch():
    rows = measured(Folder(), 'throughput', '--largest', '8')
    for engine in ('cpu', 'gpu'):
        for asked in ('frames', 'answers'):
            sizes = [r['batch'] for r in rows if (r['backend'], r['asked']) == (engine, asked)]
            expect(sizes == ['single', '1', '4', '8'], f'{engine}, {asked}: {sizes}')
    expect(all(float(r['poses_per_s']) > 0 for r in rows), rows)
    batches = [r for r in rows if (r['backend'], r['asked']) == ('gpu', 'frames') and r['batch'] != 'single']
    for row in batches:
        expect(float(row['submissions']) == 1 and float(row['dispatches']) <= MOST_DISPATCHES, row)
    expect(
        len({row['dispatches'] for row in batches}) == 1, f'as many dispatches whatever the size: {batches}'
    )
    # As much comes back as there are poses.
    expect(float(batches[-1]['bytes_down']) > 2 * float(batches[0]['bytes_down']), batches)


def test_the_largest_batch_is_bounded():
    folder = Folder()
    scene = ball_on_block(folder)
    for wrong in ('0', '65537', 'many'):
        expect_refused(
            palpate('bench', 'throughput', scene, '--largest', wrong, '--out', folder / 'none'),
            3,
            '--largest',
            wrong,
        )
    expect(not (folder / 'none').exists(), 'nothing is left behind')


def test_latency_by_engine():
    rows = measured(Folder(), 'latency', '--frames', '8')
    for engine in ('cpu', 'gpu'):
        total = [r for r in rows if (r['backend'], r['frames'], r['stage']) == (engine, 'contact', 'total')]
        expect(len(total) == 1 and float(total[0]['p50_us']) > 0, f'{engine}: {rows}')
        expect(total[0]['p999_us'] == '', 'no p99.9 of eight frames')
        if engine == 'gpu':
            expect(float(total[0]['submissions']) == 1, total)
            expect(float(total[0]['dispatches']) <= MOST_DISPATCHES, total)


def test_a_start_by_stage():
    folder = Folder()
    out = folder / 'prepare'
    done = palpate('bench', 'prepare', ball_on_block(folder), '--out', out)
    expect(done.code == 0, done)
    with open(out / 'results.csv') as file:
        rows = list(csv.DictReader(file))
    seconds = {row['stage']: float(row['seconds']) for row in rows if row['who'] == 'palpate, first start'}
    whole, parts = seconds['whole start'], seconds['meshes and lattice'] + seconds['preparation']
    expect(abs(whole - parts) <= 1e-3 * whole, f'but for the four digits printed: {seconds}')
    stages = {stage: s for stage, s in seconds.items() if stage.startswith('- ')}
    expect(stages and all(0 <= s <= whole for s in stages.values()), f'none takes longer than all: {seconds}')
    expect('first start' in (out / 'report.html').read_text(), 'the page')


def test_ticks_of_a_loop_under_load():
    folder = Folder()
    out = folder / 'jitter'
    done = palpate(
        'bench', 'jitter', ball_on_block(folder), '--seconds', '1', '--backend', 'cpu', '--out', out
    )
    expect(done.code == 0, done)
    with open(out / 'results.csv') as file:
        ours = next(row for row in csv.DictReader(file) if row['loop'] == 'palpate')
    ticks, missed = int(ours['ticks']), int(ours['missed'])
    expect(ticks <= 1000 <= ticks + missed, ours)
    late = [float(ours[f'late_{name}_us']) for name in ('p50', 'p99', 'p999', 'max')]
    expect(0 <= late[0] and late == sorted(late), ours)
    expect(
        'cyclictest' in (out / 'report.html').read_text(),
        'the page says what is beside it, or that nothing is',
    )


main(globals())
