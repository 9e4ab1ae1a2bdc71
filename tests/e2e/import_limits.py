"""A mesh file that makes its importer crash, hang or take all memory: one sentence, exit code 3, nothing left
running.

palpate runs here beside palpate-import-faulty, which does what the first word of a file says."""
import atexit
import shutil
import signal

from harness import *

BINARIES = pathlib.Path(PROGRAM).parent


def beside_a_faulty_importer():
    folder = pathlib.Path(tempfile.mkdtemp(prefix='faulty-', dir=BINARIES))
    atexit.register(shutil.rmtree, folder)
    for name, source in (('palpate', 'palpate'), ('palpate-import', 'palpate-import-faulty')):
        os.link(BINARIES / source, folder / name)
    return str(folder / 'palpate')


FAULTY = beside_a_faulty_importer()


def running(path):
    """Processes that name the file among their arguments."""
    found = []
    for process in pathlib.Path('/proc').glob('[0-9]*'):
        try:
            if str(path).encode() in (process / 'cmdline').read_bytes():
                found.append(process.name)
        except OSError:
            pass  # it is gone
    return found


def wait_for(count, mesh):
    """A killed process takes its time to go: 20 s at most, on a busy machine."""
    for _ in range(2000):
        if len(running(mesh)) == count:
            return
        time.sleep(0.01)
    expect(False, f'{len(running(mesh))} processes are running instead of {count}')


def faulty(*arguments):
    done = subprocess.run(
        [FAULTY, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, timeout=TIMEOUT_S
    )
    return Outcome(done.returncode, done.stdout.decode(), done.stderr.decode())


def expect_contained(word, *sentence, options=()):
    folder = Folder()
    mesh = folder.write(f'{word}.stl', word)
    expect_refused(faulty('info', mesh, *options), 3, f'{word}.stl', *sentence)
    wait_for(0, mesh)
    scene = folder.save(
        tool={'mesh': f'{word}.stl'}, static=[{'generate': {'name': 'contacts', 'triangles': 1000}}]
    )
    expect_refused(
        faulty('query', scene, '--pose', '0 0 0 0 0 0 1', '--backend', 'cpu', *options),
        3,
        f'{word}.stl',
        *sentence,
    )
    wait_for(0, mesh)


def test_an_import_that_crashes():
    expect_contained('crash', 'crashed', 'SIGSEGV')
    expect_contained('abort', 'crashed', 'SIGABRT', 'free(): invalid')
    expect_contained('fork', 'crashed')


def test_a_real_file_that_makes_the_library_abort():
    # A 3MF whose root names a model that is not in it: an assertion of assimp 5.2.5. Should it learn to
    # refuse it, so much the better.
    import zipfile

    folder = Folder()
    with zipfile.ZipFile(folder / 'no_root.3mf', 'w') as archive:
        archive.writestr(
            '_rels/.rels',
            (
                '<?xml version="1.0"?><Relationships'
                ' xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship'
                ' Target="/3D/gone.model" Id="rel0"'
                ' Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
            ),
        )
    expect_refused(palpate('info', folder / 'no_root.3mf'), 3, 'no_root.3mf', "can't be read")


def test_an_import_that_hangs():
    expect_contained('hang', 'more than the 1 s allowed', options=('--import-seconds', '1'))
    expect_contained('sleep', 'more than the 1 s allowed', options=('--import-seconds', '1'))


def test_an_import_that_takes_all_memory():
    expect_contained('greed', 'more than the 300 MiB of memory allowed', options=('--import-memory', '300'))


def test_an_import_that_finds_no_memory_for_the_file_itself():
    folder = Folder()
    outcome = palpate('info', folder / 'block.stl', '--import-memory', '1')
    expect_refused(outcome, 3, 'block.stl', 'more than the 1 MiB of memory allowed')


def test_an_import_that_ends_without_an_answer():
    expect_contained('silent', 'unsound')
    expect_contained('garbage', 'unsound')
    expect_contained('throw', 'unknown reason')


def test_an_importer_that_is_missing_is_named():
    folder = pathlib.Path(tempfile.mkdtemp(prefix='alone-', dir=BINARIES))
    atexit.register(shutil.rmtree, folder)
    os.link(PROGRAM, folder / 'palpate')
    mesh = Folder()
    done = subprocess.run(
        [folder / 'palpate', 'info', mesh / 'block.stl'], capture_output=True, timeout=TIMEOUT_S
    )
    expect_refused(
        Outcome(done.returncode, done.stdout.decode(), done.stderr.decode()), 1, 'palpate-import', 'missing'
    )


def test_a_build_without_a_reader_of_cad_files_says_what_is_missing():
    folder = pathlib.Path(tempfile.mkdtemp(prefix='alone-', dir=BINARIES))
    atexit.register(shutil.rmtree, folder)
    os.link(PROGRAM, folder / 'palpate')
    os.link(BINARIES / 'palpate-import', folder / 'palpate-import')
    for name in ('a.step', 'a.STP', 'a.iges', 'a.brep'):
        (folder / name).write_text('whatever')
        done = subprocess.run(
            [folder / 'palpate', 'info', folder / name], capture_output=True, timeout=TIMEOUT_S
        )
        expect_refused(
            Outcome(done.returncode, done.stdout.decode(), done.stderr.decode()),
            3,
            name,
            'palpate-import-cad',
            'OpenCASCADE',
            'libocct-data-exchange-dev',
        )


def test_killing_palpate_ends_its_importer():
    folder = Folder()
    mesh = folder.write('sleep.stl', 'sleep')
    process = subprocess.Popen([FAULTY, 'info', mesh], stderr=subprocess.DEVNULL)
    wait_for(2, mesh)
    process.send_signal(signal.SIGKILL)
    process.wait()
    wait_for(0, mesh)


def test_files_that_refer_to_others_are_read_from_another_folder():
    folder = Folder()
    data = b''.join(struct.pack('<3f', *p) for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0)))
    folder.write('parts/a b.bin', data)
    document = {
        'asset': {'version': '2.0'},
        'scenes': [{'nodes': [0]}],
        'scene': 0,
        'nodes': [{'mesh': 0, 'name': 'plate'}],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0}}]}],
        'accessors': [
            {
                'bufferView': 0,
                'componentType': 5126,
                'count': 3,
                'type': 'VEC3',
                'min': [0, 0, 0],
                'max': [1, 1, 0],
            }
        ],
        'bufferViews': [{'buffer': 0, 'byteLength': 36}],
        'buffers': [{'byteLength': 36, 'uri': 'a b.bin'}],
    }
    folder.write('parts/plate.gltf', json.dumps(document))
    folder.write('parts/colour.mtl', 'newmtl red\nKd 1 0 0\n')
    folder.write('parts/plate.obj', 'mtllib colour.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n')
    for name in ('plate.gltf', 'plate.obj'):
        outcome = palpate('info', f'parts/{name}', cwd=folder.path)
        expect(outcome.code == 0 and outcome.out.startswith(f'parts/{name}'), outcome)


def test_a_file_without_names_is_one_part_named_like_the_file():
    folder = Folder()
    outcome = palpate('info', folder / 'block.stl', '--json')
    expect(outcome.code == 0, outcome)
    expect([part['path'] for part in json.loads(outcome.out)['meshes'][0]['parts']] == ['block'], outcome)


def test_limits_that_are_none_are_refused():
    folder = Folder()
    for options in (
        ('--import-memory', '0'),
        ('--import-memory', '-1'),
        ('--import-seconds', '0'),
        ('--import-seconds', 'nan'),
    ):
        expect_refused(palpate('info', folder / 'block.stl', *options), 3, options[0])


main(globals())
