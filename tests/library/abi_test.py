"""Holds palpate.h against service/library/palpate.abi, the interface as it was released last, and the library
against palpate.h.

usage: abi_test.py LIBRARY SOURCE CXX          fails where something was removed or changed; additions pass
       abi_test.py LIBRARY SOURCE CXX --store  writes palpate.abi anew, with a release that adds something

A stand-in with the header's functions and empty bodies is what abidw reads: the header alone decides what a
caller is compiled with, and the library itself is built without the types' descriptions.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

library, source, compiler = sys.argv[1:4]
header = pathlib.Path(source) / 'service/library/palpate.h'
baseline = header.with_suffix('.abi')
text = re.sub(r'/\*.*?\*/', '', header.read_text(), flags=re.S)
prototypes = re.findall(r'^PALPATE_API\s+([^;#]*?\b(palpate_\w+)\([^;#]*\));', text, re.M)
names = {name for _, name in prototypes}
assert len(prototypes) == len(names) > 25, 'the header is not read as it should be'


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


listed = subprocess.run(
    ['nm', '-D', '--defined-only', library], capture_output=True, text=True, check=True
).stdout.splitlines()
# But for the name of the version.
exported = {line.split()[-1].split('@')[0] for line in listed if ' A ' not in line}
if exported != names:
    sys.exit(
        f'the library exports {sorted(exported - names)} beside the header, and lacks'
        f' {sorted(names - exported)}'
    )

with tempfile.TemporaryDirectory() as folder:
    stand_in = pathlib.Path(folder) / 'stand_in.c'
    bodies = ''.join(
        f'{prototype} {{ {"" if prototype.startswith("void ") else "return 0;"} }}\n'
        for prototype, _ in prototypes
    )
    stand_in.write_text('#include "palpate.h"\n' + bodies)
    built = pathlib.Path(folder) / 'libpalpate.so.0'
    code, said = run(
        compiler,
        '-x',
        'c',
        '-std=c11',
        '-g',
        '-shared',
        '-fPIC',
        '-Wl,-soname,libpalpate.so.0',
        f'-I{header.parent}',
        str(stand_in),
        '-o',
        str(built),
    )
    if code:
        sys.exit(f'the stand-in can\'t be built:\n{said}')
    if sys.argv[4:] == ['--store']:
        code, said = run(
            'abidw',
            '--no-corpus-path',
            '--no-comp-dir-path',
            '--no-show-locs',
            '--out-file',
            str(baseline),
            str(built),
        )
        sys.exit(said if code else 0)
    code, said = run('abidiff', '--no-added-syms', str(baseline), str(built))
    if code:
        sys.exit(f'abidiff ends with {code}: palpate.h is not what {baseline} has\n{said}')
print(f'{len(names)} functions are as they were released')
