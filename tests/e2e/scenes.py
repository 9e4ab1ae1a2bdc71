"""The shipped scenes at full size, as scripts/demo runs them."""
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
    expect(
        abs(summary['static_triangles'] / 100000 - 1) <= 0.02
        and abs(summary['tool_triangles'] / 2000 - 1) <= 0.02,
        summary,
    )
    expect(summary['force_max_N'] > 0 and summary['torque_max_Nm'] > 0, summary)
    expect(str(folder / 'a' / 'report.html') in outcome.out, outcome)


def test_no_ray_of_the_letter_runs_through_the_clamp_to_its_other_arm():
    folder = Folder()
    run(SOURCE / 'scenes' / 'disassembly.json', folder / 'a', '--profile', 'paper')
    deepest = max(area['depth'] for frame in frames(folder / 'a') for area in frame['areas'])
    # The hand presses by millimetres; the arms are 54 mm apart.
    expect(0 < deepest < 10e-3, f'{deepest} m deep')


def test_the_contacts_reach_one_two_and_four_areas_at_once():
    folder = Folder()
    run(SOURCE / 'scenes' / 'contacts.json', folder / 'a')
    seen = set()
    for frame in frames(folder / 'a'):
        seen.add(sum(any(area['force']) for area in frame['areas']))
        expect(list(frame)[-1] == 'tick', list(frame))
    expect({1, 2, 4} <= seen, f'areas at once: {sorted(seen)}')
    expect(expect_contract(folder / 'a')['stages_reached'] == [1, 2, 3], 'stages')


def test_the_chapter_to_the_letter_reaches_all_contacts_and_feels_torques_alone():
    folder = Folder()
    run(SOURCE / 'scenes' / 'chapter.json', folder / 'a')
    summary = expect_contract(folder / 'a')
    expect(
        (summary['profile'], summary['law'], summary['stages_reached']) == ('paper', 'printed', [1, 2, 3]),
        summary,
    )
    seen = set()
    for frame in frames(folder / 'a'):
        seen.add(sum(any(area['force']) for area in frame['areas']))
        # Pressed by a millimetre and a half, and turned while pressed.
        expect(all(area['depth'] < 5e-3 for area in frame['areas']), frame)
    expect({1, 2, 4} <= seen, f'areas at once: {sorted(seen)}')
    expect(summary['force_max_N'] == 0, 'a force on a rig without one')
    lines = [line.split(',') for line in (folder / 'a' / 'trace.csv').read_text().splitlines()]
    for axis in ('torque_x_Nm', 'torque_y_Nm', 'torque_z_Nm'):
        column = lines[0].index(axis)
        most = max(abs(float(line[column])) for line in lines[1:])
        # An axis that no collision turned, or a torque that no longer settles.
        expect(1e-3 < most < 0.5, f'{axis}: {most} N·m at most')


main(globals())
