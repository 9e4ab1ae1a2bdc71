"""Judges a list of software (SPDX 2.3 JSON) that scripts/sbom made: its form, and that it names all that went
into the programs.

usage: sbom_judge.py FILE.json SOURCE_DIRECTORY PROGRAM...
"""
import base64
import json
import pathlib
import re
import subprocess
import sys
import urllib.parse

FILE, SOURCE, PROGRAMS = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
PACKAGE_KEYS = {
    'SPDXID',
    'name',
    'versionInfo',
    'supplier',
    'downloadLocation',
    'filesAnalyzed',
    'licenseConcluded',
    'licenseDeclared',
    'copyrightText',
    'externalRefs',
    'checksums',
    'primaryPackagePurpose',
}
RELATIONS = {'DESCRIBES', 'CONTAINS', 'DYNAMIC_LINK', 'BUILD_DEPENDENCY_OF', 'OPTIONAL_DEPENDENCY_OF'}


def expect(condition, message):
    if not condition:
        sys.exit(f'{FILE}: {message}')


document = json.loads(FILE.read_text())
expect(
    set(document)
    == {
        'spdxVersion',
        'dataLicense',
        'SPDXID',
        'name',
        'documentNamespace',
        'creationInfo',
        'packages',
        'relationships',
    },
    sorted(document),
)
expect(
    (document['spdxVersion'], document['dataLicense'], document['SPDXID'])
    == ('SPDX-2.3', 'CC0-1.0', 'SPDXRef-DOCUMENT'),
    'head',
)
expect(
    re.fullmatch(r'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ', document['creationInfo']['created'])
    and document['creationInfo']['creators'],
    document['creationInfo'],
)
expect(re.fullmatch(r'[a-z]+:[^\s#]+', document['documentNamespace']), document['documentNamespace'])

packages = {package['SPDXID']: package for package in document['packages']}
expect(len(packages) == len(document['packages']), 'an identifier is there twice')
by_name = {package['name']: package for package in document['packages']}
for name, package in packages.items():
    expect(re.fullmatch(r'SPDXRef-[A-Za-z0-9.-]+', name), f'{name} is no identifier')
    expect(
        {'name', 'versionInfo', 'downloadLocation'} <= set(package) <= PACKAGE_KEYS,
        f'{name}: {sorted(package)}',
    )
    expect(package['versionInfo'] != 'NOASSERTION', f'{name} has no version: it is not installed here')
related = {}
for relation in document['relationships']:
    ends = relation['spdxElementId'], relation['relatedSpdxElement']
    expect(
        set(relation) == {'spdxElementId', 'relationshipType', 'relatedSpdxElement'}
        and relation['relationshipType'] in RELATIONS,
        relation,
    )
    expect(
        all(end in packages or end == 'SPDXRef-DOCUMENT' for end in ends) and 'SPDXRef-palpate' in ends,
        relation,
    )
    related.setdefault(relation['relationshipType'], set()).update(
        set(ends) - {'SPDXRef-palpate', 'SPDXRef-DOCUMENT'}
    )
expect(
    set().union(*related.values()) == set(packages) - {'SPDXRef-palpate'}, 'a package stands beside palpate'
)

# Versions are dpkg's and npm's.
for package in document['packages']:
    if package['SPDXID'].startswith('SPDXRef-deb-'):
        version = subprocess.run(
            ['dpkg-query', '-W', '-f', '${Version}\n', package['name']], capture_output=True, text=True
        ).stdout.splitlines()[0]
        (reference,) = package['externalRefs']
        expect(
            package['versionInfo'] == version, f"{package['name']}: {package['versionInfo']} is not {version}"
        )
        expect(
            reference['referenceLocator'].startswith(f"pkg:deb/debian/{urllib.parse.quote(package['name'])}@")
            and '+' not in reference['referenceLocator'],
            reference,
        )
lock = json.loads((SOURCE / 'service/viewer/package-lock.json').read_text())['packages']
three, locked = by_name['three'], lock['node_modules/three']
expect((three['versionInfo'], three['licenseDeclared']) == (locked['version'], 'MIT'), three)
expect(
    base64.b64encode(bytes.fromhex(three['checksums'][0]['checksumValue'])).decode()
    == locked['integrity'].removeprefix('sha512-'),
    three,
)
expect(
    {name for name, package in lock.items() if name and not package.get('dev')} == {'node_modules/three'},
    'the viewer contains more than three',
)

# What is compiled or embedded is in the list as such, and in the notices.
notices = (SOURCE / 'THIRD_PARTY_NOTICES.md').read_text()
inside = {
    'libcli11-dev': 'CLI11',
    'libglm-dev': 'GLM',
    'nlohmann-json3-dev': 'JSON for Modern C++',
    'libboost-dev': 'Boost',
    'libxxhash-dev': 'xxHash',
    'three': 'three.js',
}
expect({packages[name]['name'] for name in related['CONTAINS']} == set(inside), sorted(related['CONTAINS']))
for name, words in inside.items():
    expect(words in notices, f'THIRD_PARTY_NOTICES.md lacks {words} ({name})')

# Each library that a program names itself is in the list by its package, and in the notices.
linked = {packages[name]['name'] for name in related['DYNAMIC_LINK']}
named = {
    'libassimp': 'assimp',
    'lib3MF': 'lib3mf',
    'libembree': 'Embree',
    'libtbb': 'oneTBB',
    'libfmt': '{fmt}',
    'libvulkan': 'Vulkan loader',
    'libusb': 'libusb',
    'libssl': 'OpenSSL',
    'libcrypto': 'OpenSSL',
    'libTK': 'OpenCASCADE',
    'libz.': 'zlib',
}
for program in PROGRAMS:
    needed = re.findall(
        r'\(NEEDED\).*\[(.*)\]',
        subprocess.run(['readelf', '-d', program], capture_output=True, text=True, check=True).stdout,
    )
    expect(needed, f'{program} needs no library')
    for library in needed:
        if re.match(r'lib(c|m|stdc\+\+|gcc_s|a?san|ubsan|tsan|gomp)\.|ld-linux', library):
            continue
        owners = subprocess.run(
            ['dpkg-query', '--search', f'*/{library}'], capture_output=True, text=True
        ).stdout
        expect(
            {line.split(':')[0] for line in owners.splitlines()} & linked,
            f'{program} needs {library}, whose package is not in the list',
        )
        known = [words for beginning, words in named.items() if library.startswith(beginning)]
        expect(
            known and all(words in notices for words in known),
            f'THIRD_PARTY_NOTICES.md lacks {library}, which {program} needs',
        )
print(f'{FILE}: {len(packages)} packages, {len(linked)} of them linked')
