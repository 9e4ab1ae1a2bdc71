"""Bad values in files and arguments: one sentence that names file and value, exit code 3, nothing on standard
output."""
from harness import *

POSE = ('--pose', '0 0 0.1 0 0 0 1')


def refuse_scene(folder, *words, **changes):
    expect_refused(palpate('query', folder.save(**changes), *POSE), 3, *words)


def test_a_missing_scene_file():
    expect_refused(palpate('query', 'nowhere.json', *POSE), 3, 'nowhere.json')
    expect_refused(palpate('run', 'nowhere.json'), 3, 'nowhere.json')
    expect_refused(palpate('plan', 'nowhere.json'), 3, 'nowhere.json')


def test_a_missing_mesh_file():
    folder = Folder()
    refuse_scene(folder, 'gone.stl', tool={'mesh': 'gone.stl'})
    expect_refused(palpate('info', folder / 'gone.stl'), 3, 'gone.stl')


def test_an_empty_mesh():
    folder = Folder()
    folder.write('empty.stl', stl([]))
    refuse_scene(folder, 'empty.stl', tool={'mesh': 'empty.stl'})
    folder.write('nothing.stl', b'')
    refuse_scene(folder, 'nothing.stl', tool={'mesh': 'nothing.stl'})
    folder.write('points.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\n')
    refuse_scene(folder, 'points.obj', tool={'mesh': 'points.obj'})


def test_a_coordinate_that_is_not_a_number():
    folder = Folder()
    triangles = box((0.1, 0.1, 0.1))
    triangles[5] = (triangles[5][0], (0.1, float('nan'), 0), triangles[5][2])
    folder.write('nan.stl', stl(triangles))
    refuse_scene(folder, 'nan.stl', tool={'mesh': 'nan.stl'})
    triangles[5] = (triangles[5][0], (0.1, float('inf'), 0), triangles[5][2])
    folder.write('inf.stl', stl(triangles))
    refuse_scene(folder, 'inf.stl', static=[{'mesh': 'inf.stl'}])


def test_a_truncated_stl():
    folder = Folder()
    folder.write('cut.stl', stl(box((0.1, 0.1, 0.1)))[:-60])
    refuse_scene(folder, 'cut.stl', static=[{'mesh': 'cut.stl'}])
    expect_refused(palpate('info', folder / 'cut.stl'), 3, 'cut.stl')


def test_a_mesh_that_is_flat_after_snapping():
    folder = Folder()
    point = (0.0, 0.0, 0.0)
    folder.write('point.stl', stl([(point, point, point)]))
    refuse_scene(folder, tool={'mesh': 'point.stl'})
    expect_refused(palpate('info', folder / 'point.stl'), 3, 'point.stl')


def test_text_that_is_no_json():
    folder = Folder()
    expect_refused(palpate('query', folder.write('broken.json', '{"static": ['), *POSE), 3, 'broken.json')
    expect_refused(palpate('query', folder.write('list.json', '[]'), *POSE), 3, 'list.json')
    expect_refused(palpate('query', folder.write('binary.json', bytes(range(256))), *POSE), 3, 'binary.json')


def test_a_wrong_json_type():
    folder = Folder()
    refuse_scene(folder, 'stiffness', response={'stiffness': 'hard'})
    refuse_scene(folder, 'static', static='block.stl')
    refuse_scene(folder, 'mesh', tool={'mesh': 7})
    refuse_scene(folder, 'position', static=[{'mesh': 'block.stl', 'position': [0, 0]}])


def test_a_number_out_of_range():
    folder = Folder()
    refuse_scene(folder, 'stiffness', '-5', response={'stiffness': -5})
    refuse_scene(folder, 'smooth_angle_deg', '120', response={'smooth_angle_deg': 120})
    for thickness in (-0.001, 1e-9, 2, '1 mm', 'Auto', None):
        tool = {'mesh': 'ball.stl', 'units': 'm', 'sheet_thickness': thickness}
        refuse_scene(folder, 'sheet_thickness', str(thickness).replace('None', 'null'), tool=tool)
    refuse_scene(folder, 'rotation', static=[{'mesh': 'block.stl', 'rotation': [0, 0, 0, 2]}])


def test_an_unknown_key_is_told_the_nearest_known_one():
    folder = Folder()
    refuse_scene(folder, 'stifness', 'stiffness', response={'stifness': 2000})
    refuse_scene(folder, 'tol', 'tool', tol={})


def test_an_unknown_part_is_told_what_there_is():
    folder = Folder()
    refuse_scene(folder, 'Piston_1', tool={'mesh': 'ball.stl', 'part': 'Piston_1'})


def test_a_pose_that_is_not_finite():
    scene = Folder()
    path = scene.save()
    for word in ('nan', 'inf', '-inf', '1e999'):
        expect_refused(palpate('query', path, '--pose', f'0 {word} 0 0 0 0 1'), 3, '--pose')


def test_a_pose_that_is_not_a_unit_rotation():
    path = (folder := Folder()).save()
    for rotation in ('0 0 0 2', '0 0 0 0', '1 1 1 1'):
        expect_refused(palpate('query', path, '--pose', f'0 0 0 {rotation}'), 3, '--pose')


def test_a_pose_that_is_not_seven_numbers():
    path = (folder := Folder()).save()
    expect_refused(palpate('query', path, '--pose', '0 0 0 0 0 1'), 3, '6 values')
    expect_refused(palpate('query', path, '--pose', '0 0 zero 0 0 0 1'), 3, 'zero')
    expect_refused(palpate('query', path, '--pose', '0 0 0x1 0 0 0 1'), 3, '0x1')


def test_a_bad_line_of_a_poses_file_is_named_by_its_number():
    folder = Folder()
    path = folder.save()
    good = '0,0,0.1,0,0,0,1'

    def refuse(text, *words):
        expect_refused(
            palpate('query', path, '--poses', folder.write('poses.csv', text)), 3, 'poses.csv', *words
        )

    header = 'x,y,z,qx,qy,qz,qw'
    refuse(f'{header}\n{good}\n0,0,nan,0,0,0,1\n', 'line 3')
    refuse(f'{header}\n{good}\n\n{good},4\n', 'line 4', '8 values')
    refuse(f'{header}\n{good}\n0,0,a,0,0,0,1\n0,0,0,0,0,0,3\n', 'line 3', "'a'", '2 lines are bad')
    refuse(f'{good}\n', 'line 1', header)
    refuse(f'y,x,z,qx,qy,qz,qw\n{good}\n', 'line 1', header)
    refuse(f'{header}\n', 'no pose')
    refuse('', 'line 1')
    timed = 'time_s,x_m,y_m,z_m,qx,qy,qz,qw'
    refuse(f'{timed},stage\n0,{good},1\n0.1,{good}\n', 'line 3', "8 values instead of the header's 9")
    refuse(f'{timed}more\n0,{good}\n', 'line 1', timed)
    refuse(f'{timed},stage\n', 'no pose')
    expect_refused(palpate('query', path, '--poses', folder / 'gone.csv'), 3, 'gone.csv')


def test_generate_refuses_unknown_names_and_counts():
    folder = Folder()
    expect_refused(
        palpate('generate', 'teapot', '--out', folder / 'g'), 3, 'teapot', 'contacts', 'disassembly'
    )
    expect_refused(palpate('generate', 'contacts', '--triangles', '12', '--out', folder / 'g'), 3, '12')
    expect_refused(palpate('generate', 'contacts', '--triangles', 'many', '--out', folder / 'g'), 3, 'many')
    expect_refused(palpate('generate', 'contacts'), 2, '--out')


def test_a_part_that_is_named_as_another_is_numbered():
    folder = Folder()
    corner = 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1\n'
    folder.write('numbers.obj', 'o Piston\n' + corner + 'o #1\n' + corner)
    folder.write('bolts.obj', 'o Bolt 1\n' + corner + 'o Bolt 2\n' + corner)
    tool = {'mesh': 'bolts.obj', 'units': 'mm', 'part': 'Bolt 1', 'without': ['Bolt 2']}
    for number, part in (('#1', None), ('#2', '#1')):  # the second part is named as the first is numbered
        scene = folder.save(tool={'mesh': 'numbers.obj', 'units': 'cm', 'part': number})
        done = palpate('info', scene)
        if part:
            expect(done.code == 0 and f"part 'numbers.obj/{part}'" in done.out + done.err, done)
        else:
            expect_refused(done, 3, "a node named '#1' beside its part of that number")
    refuse_scene(folder, '"without", in part \'Bolt 1\' alone', "no node named 'Bolt 2'", tool=tool)


def test_a_directory_that_cannot_be_made():
    folder = Folder()
    folder.write('file', 'x')
    expect_refused(
        palpate(
            'run', folder.save(), '--pace', 'asap', '--duration', '0.01', '--out', folder / 'file' / 'out'
        ),
        3,
        'file',
    )


def test_an_unknown_haptic_device():
    folder = Folder()
    expect_refused(palpate('run', folder.save(), '--device', 'wand'), 3, 'wand', 'simulated')
    expect_refused(palpate('run', folder.save(), '--device', 'falcon'), 4, 'falcon')
    expect_refused(palpate('run', folder.save(), '--device', 'falcon', '--pace', 'asap'), 2, 'falcon')
    expect_refused(
        palpate('run', folder.save(), '--device', 'nodev', '--pace', 'asap'), 3, 'nodev', 'simulated'
    )


main(globals())
