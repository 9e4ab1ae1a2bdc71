"""`palpate compare`: in what two runs differ, as text, JSON and a page."""
import shutil

from harness import *


def runs(folder):
    """The same run twice, and once with half the stiffness."""
    folder.write('block.stl', stl(box((0.06, 0.06, 0.03), (0, 0, -0.015))))
    folder.write('ball.stl', stl(sphere(0.01)))
    folder.write(
        'path.csv',
        'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0.012,0,0,0,1,1\n0.5,0.001,0,0.009,0,0,0,1,2\n1,0.002,0,0.012,0,0,0,1,3\n',
    )
    for name, stiffness in (('a', 2000), ('b', 2000), ('soft', 1000)):
        scene = folder.save(
            static=[{'mesh': 'block.stl', 'units': 'm'}],
            tool={'mesh': 'ball.stl', 'units': 'm'},
            response={'stiffness': stiffness},
            device={'driver': 'simulated', 'path': 'path.csv'},
        )
        done = palpate('run', scene, '--pace', 'asap', '--backend', 'cpu', '--out', folder / name)
        expect(done.code == 0, done)
    return [folder / name for name in ('a', 'b', 'soft')]


def test_like_runs_have_the_same_trace_and_others_say_where_they_part():
    folder = Folder()
    a, b, soft = runs(folder)
    summary = json.loads((a / 'summary.json').read_text())
    made = summary['provenance']
    expect({'version', 'commit', 'machine', 'engine', 'command', 'time', 'inputs', 'plan'} == set(made), made)
    expect(made['command'].startswith('palpate run ') and made['engine'].startswith('cpu on '), made)
    expect([len(one['sha256']) for one in made['inputs']] == [64] * 4, 'scene, two meshes, path')
    expect('pairs' in made['plan']['kept'], made)

    same = palpate('compare', a, b, '--json')
    told = json.loads(same.out)
    expect(same.code == 0 and told['same_trace'] and told['ticks']['only_first'] == 0, told)
    differ = {one['figure'] for one in told['differences']}
    # --out alone.
    expect('provenance command' in differ and not any('inputs' in name for name in differ), differ)

    other = palpate('compare', a, soft, '--json', '--out', folder / 'out')
    told = json.loads(other.out)
    expect(other.code == 0 and not told['same_trace'], told)
    force = next(one for one in told['quantities'] if one['quantity'] == 'sent force')
    expect(force['largest'] > 0.01 and 0 < force['first_at_s'] <= force['largest_at_s'] < 1, force)
    figures = {one['figure']: one for one in told['differences']}
    expect(
        figures['force max N']['second_over_first'] < 1 and 'provenance inputs scene' in figures,
        list(figures),
    )
    expect(json.loads((folder / 'out' / 'compare.json').read_text()) == told, 'the file is what is printed')
    page = (folder / 'out' / 'compare.html').read_text()
    expect('Two runs compared' in page and 'src=' not in page and 'http' not in page, 'a self-contained page')
    text = palpate('compare', a, soft)
    expect(
        text.code == 0
        and text.out.startswith('the traces differ')
        and 'sent force' in text.out
        and '× ' in text.out,
        text,
    )


def test_a_run_that_was_stopped_is_said_to_be():
    folder = Folder()
    a, b, _ = runs(folder)
    expect('stopped' not in palpate('compare', a, b).out, 'neither was')
    for run in (b, a):
        summary = json.loads((run / 'summary.json').read_text())
        (run / 'summary.json').write_text(json.dumps(summary | {'stopped': True}))
        told = json.loads(palpate('compare', a, b, '--json', '--out', folder / 'out', '--overwrite').out)
        expect(told['stopped'] == {'first': run == a, 'second': True}, told['stopped'])
        sentence = ('both runs were' if run == a else 'the second run was') + ' stopped before'
        expect(sentence in palpate('compare', a, b).out, sentence)
        expect(sentence in (folder / 'out' / 'compare.html').read_text(), 'and on the page')


def test_runs_without_a_common_tick_are_not_called_the_same():
    folder = Folder()
    a = runs(folder)[0]
    shutil.copytree(a, folder / 'empty')
    (folder / 'empty' / 'trace.csv').write_text((a / 'trace.csv').read_text().split('\n')[0] + '\n')
    told = json.loads(palpate('compare', a, folder / 'empty', '--json', '--out', folder / 'out').out)
    expect(not told['same_trace'] and told['ticks']['common'] == 0, told['ticks'])
    for one in told['quantities']:
        expect([one[key] for key in ('largest', 'largest_at_s', 'rms', 'first_at_s')] == [None] * 4, one)
    text = palpate('compare', a, folder / 'empty').out
    expect(text.count('nothing to compare') == 6 and 'the same' not in text, text)
    expect((folder / 'out' / 'compare.html').read_text().count('nothing to compare') == 6, 'and on the page')
    before = (folder / 'out' / 'compare.json').read_bytes()
    expect_refused(palpate('compare', a, a, '--out', folder / 'out'), 3, 'compare.json', '--overwrite')
    expect((folder / 'out' / 'compare.json').read_bytes() == before, 'a refusal changes nothing')


def test_what_is_no_run_is_refused_with_file_and_line():
    folder = Folder()
    a = runs(folder)[0]
    expect_refused(palpate('compare', a, folder / 'nothing'), 3, 'nothing', 'no run')
    for change, words in (
        (lambda text: text.replace('time_s', 'time', 1), ('time_s', 'is missing')),
        (lambda text: text.replace('\n0.001,', '\n0.001,abc,', 1), ('line 3', 'values instead of')),
        (lambda text: text[:-30] + '\n', ('values instead of',)),
    ):
        shutil.rmtree(folder / 'bad', ignore_errors=True)
        shutil.copytree(a, folder / 'bad')
        (folder / 'bad' / 'trace.csv').write_text(change((a / 'trace.csv').read_text()))
        expect_refused(palpate('compare', a, folder / 'bad'), 3, 'trace.csv', *words)
    (folder / 'bad' / 'summary.json').write_text('[1')
    expect_refused(palpate('compare', a, folder / 'bad'), 3, 'summary.json')
    expect(palpate('compare', a).code == 2, 'two runs are required')


main(globals())
