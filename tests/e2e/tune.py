"""`palpate tune`: what it chooses is within the budget, no less accurate than the scene's own settings where those are, and nothing measured beats it."""
import json

from harness import *


def scene_in(folder):
    folder.write('block.stl', stl(box((0.06, 0.06, 0.03), (0, 0, -0.015))))
    folder.write('ball.stl', stl(sphere(0.01)))
    folder.write('poses.csv', 'x,y,z,qx,qy,qz,qw\n' + ''.join(f'{0.001 * i},{0.0007 * i},{0.009 - 0.0002 * i},0,0,0,1\n' for i in range(8)))
    return folder.save(static=[{'mesh': 'block.stl', 'units': 'm'}], tool={'mesh': 'ball.stl', 'units': 'm'})


def tuned(scene, folder, budget):
    done = palpate('tune', scene, '--budget-us', repr(budget), '--poses', folder / 'poses.csv', '--rounds', '2', '--json')
    if done.code == 3 and 'the fastest takes' in done.err:   # the machine has become slower than the budget, and it says so
        return None
    expect(done.code == 0, done)
    told = json.loads(done.out)
    chosen, measured = told['chosen'], told['measured']
    expect(chosen['time_us']['p95'] <= budget, chosen)
    own = next(one for one in measured if one['defaults'])
    if budget >= max(one['time_us']['p95'] for one in measured if one['defaults']):
        expect(chosen['error_F_N']['p50'] <= own['error_F_N']['p50'], f'{chosen} against {own}')
    for one in measured:
        better = one['error_F_N']['p50'] < chosen['error_F_N']['p50'] and one['error_F_N']['p99'] <= chosen['error_F_N']['p99'] and one['time_us']['p95'] <= chosen['time_us']['p95']
        expect(not better, f'{one} beats {chosen}')
    return told


def test_three_budgets():
    folder = Folder()
    scene = scene_in(folder)
    ample = tuned(scene, folder, 1e7)
    expect(len(ample['measured']) >= 8, ample['measured'])
    expect(ample['chosen']['error_F_N']['p50'] == min(one['error_F_N']['p50'] for one in ample['measured']), 'with all the time there is, the most accurate')
    own = max(one['time_us']['p95'] for one in ample['measured'] if one['defaults'])
    tuned(scene, folder, 3 * own)
    least = min(one['time_us']['p95'] for one in ample['measured'])
    tuned(scene, folder, 3 * least)


def test_a_budget_that_nothing_keeps_is_refused_with_the_fastest():
    folder = Folder()
    scene = scene_in(folder)
    expect_refused(palpate('tune', scene, '--budget-us', '0.01', '--poses', folder / 'poses.csv', '--rounds', '1', '--backend', 'cpu'), 3, '--budget-us 0.01', 'the fastest takes')
    expect(palpate('tune', scene).code == 2, 'a budget is required')


main(globals())
