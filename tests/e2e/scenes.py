"""The chapter's two scenes at full size, as scripts/demo runs them."""
from harness import *
from run_files import *


def test_the_disassembly_twice_gives_the_same_bytes_and_reaches_all_stages():
    folder = Folder()
    scene = SOURCE / 'scenes' / 'disassembly.json'
    outcome = run(scene, folder / 'a')
    run(scene, folder / 'b')
    expect_same_files(folder / 'a', folder / 'b')
    summary = expect_contract(folder / 'a')
    expect(summary['stages_reached'] == [1, 2, 3, 4, 5, 6], summary['stages_reached'])
    expect(abs(summary['static_triangles'] / 100000 - 1) <= 0.02 and abs(summary['tool_triangles'] / 2000 - 1) <= 0.02, summary)
    expect(summary['force_max_N'] > 0 and summary['torque_max_Nm'] > 0, summary)
    expect(str(folder / 'a' / 'report.html') in outcome.out, outcome)


def test_the_contacts_reach_one_two_and_four_areas_at_once():
    folder = Folder()
    run(SOURCE / 'scenes' / 'contacts.json', folder / 'a')
    seen = set()
    for frame in frames(folder / 'a'):
        seen.add(sum(any(area['force']) for area in frame['areas']))
        expect(list(frame)[-1] == 'tick', list(frame))
    expect({1, 2, 4} <= seen, f'areas at once: {sorted(seen)}')
    expect(expect_contract(folder / 'a')['stages_reached'] == [1, 2, 3], 'stages')


main(globals())
