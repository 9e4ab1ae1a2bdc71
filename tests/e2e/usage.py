"""Help, version and wrong usage (exit code 2)."""
import subprocess

from harness import *


def test_help_lists_every_command_and_the_exit_codes():
    outcome = palpate('--help')
    expect(outcome.code == 0 and outcome.err == '', outcome)
    for word in (
        'run',
        'query',
        'path',
        'compare',
        'plan',
        'info',
        'generate',
        'devices',
        'tune',
        'serve',
        'bench',
        'Exit codes',
        'metres',
        'unit quaternion',
    ):
        expect(word in outcome.out, f"help lacks '{word}'")


def test_every_command_has_help_of_its_own():
    for command in (
        'run',
        'query',
        'path',
        'compare',
        'plan',
        'info',
        'generate',
        'devices',
        'tune',
        'serve',
        'bench',
    ):
        outcome = palpate(command, '--help')
        expect(outcome.code == 0 and outcome.err == '' and command in outcome.out, outcome)


def test_version():
    outcome = palpate('--version')
    expect(outcome.code == 0 and outcome.out.startswith('palpate ') and outcome.out.count('\n') == 1, outcome)


def test_no_command_is_wrong_usage():
    outcome = palpate()
    expect(outcome.code == 2 and outcome.out == '' and 'query' in outcome.err, outcome)


def test_an_unknown_command_is_told_which_there_are():
    expect_refused(
        palpate('qurey', 'x.json'),
        2,
        "'qurey'",
        'run, query, path, compare, plan, info, generate, devices',
        "did you mean 'query'?",
    )
    expect_refused(palpate('tuen'), 2, "did you mean 'tune'?")


def test_an_unknown_flag_is_wrong_usage():
    expect_refused(palpate('query', 'x.json', '--frobnicate'), 2, '--frobnicate')
    expect_refused(palpate('--frobnicate'), 2, '--frobnicate')


def test_a_missing_scene_argument_is_wrong_usage():
    for command in ('run', 'query', 'plan'):
        expect_refused(palpate(command), 2, 'scene')


def test_query_needs_exactly_one_source_of_poses():
    expect_refused(palpate('query', 'x.json'), 2, '--pose')
    expect_refused(palpate('query', 'x.json', '--pose', '0 0 0 0 0 0 1', '--poses', 'p.csv'), 2, '--pose')


def test_what_a_verdict_has_no_place_for_is_wrong_usage():
    pose = ('--pose', '0 0 0 0 0 0 1')
    for verdict in (('--any',), ('--clearance',), ('--within', '0.01')):
        for other in (('--names',), ('--batch', '4'), ('--export-geometry', 'none')):
            expect_refused(palpate('query', 'x.json', *pose, *verdict, *other), 2, other[0])
    expect_refused(palpate('query', 'x.json', *pose, '--any', '--within', '0.01'), 2, '--within')
    expect_refused(palpate('query', 'x.json', *pose, '--overwrite'), 2, '--export-geometry')


def test_a_full_disk_is_told_by_whatever_is_printed():
    for words in (('completions', 'bash'), ('man', 'run'), ('man',)):
        with open('/dev/full', 'w') as full:
            done = subprocess.run([PROGRAM, *words], stdout=full, stderr=subprocess.PIPE, text=True)
        expect(done.returncode == 1 and "standard output can't be written" in done.stderr, done)


def test_a_path_whose_answer_cannot_be_printed_is_told():
    folder = Folder()
    folder.write('path.csv', 'x,y,z,qx,qy,qz,qw\n0,0,0.03,0,0,0,1\n0,0,0.01,0,0,0,1\n')
    words = ('path', folder.save(), folder / 'path.csv', '--backend', 'cpu', '-q')
    with open('/dev/full', 'w') as full:
        done = subprocess.run([PROGRAM, *words], stdout=full, stderr=subprocess.PIPE, text=True)
    expect(done.returncode == 1 and "standard output can't be written" in done.stderr, done)
    # What was examined is told before a file that can't be written.
    folder.write('taken/path.csv/none', '')
    done = palpate(*words, '--out', folder / 'taken', '--overwrite')
    expect(done.code == 3 and 'path.csv' in done.err and json.loads(done.out)['clear'] is False, done)


def test_a_flag_without_its_value_is_wrong_usage():
    expect_refused(palpate('query', 'x.json', '--pose'), 2, '--pose')


def test_a_bad_word_for_a_flag_is_a_bad_value():
    expect_refused(palpate('query', 'x.json', '--pose', '0 0 0 0 0 0 1', '--backend', 'abacus'), 3, 'abacus')
    expect_refused(palpate('query', 'x.json', '--pose', '0 0 0 0 0 0 1', '--profile', 'coarse'), 3, 'coarse')
    expect_refused(palpate('run', 'x.json', '--pace', 'slow'), 3, 'slow')
    expect_refused(palpate('run', 'x.json', '--duration', '-1'), 3, '-1')
    expect_refused(palpate('run', 'x.json', '--duration', 'nan'), 3, 'nan')
    expect_refused(palpate('tune', 'x.json', '--budget-us', 'nan'), 3, '--budget-us', 'nan')
    expect_refused(palpate('bench', 'questions', 'x.json', '--out', 'none', '--reach', 'nan'), 3, 'nan')
    for limit in ('--max-poses', '--max-triangles', '--max-connections'):
        for count in ('0', '-3', '99999999999999999999', 'many'):
            expect_refused(palpate('serve', limit, count), 3, limit)
    expect_refused(palpate('query', 'x.json', '--pose', '0 0 0 0 0 0 1', '--batch', '0'), 3, '--batch')


main(globals())
