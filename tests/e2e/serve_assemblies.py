"""`palpate serve`: mesh files that are uploaded, looked at, made a scene of and saved."""
from harness import *
from server import *


def glb(nodes):
    """A node for each (name, triangles, colour), without indices."""
    points, views, accessors, meshes, materials, parts = b'', [], [], [], [], []
    for i, (name, triangles, colour) in enumerate(nodes):
        flat = [p for t in triangles for p in t]
        data = b''.join(struct.pack('<3f', *p) for p in flat)
        views.append({'buffer': 0, 'byteOffset': len(points), 'byteLength': len(data)})
        accessors.append(
            {
                'bufferView': i,
                'componentType': 5126,
                'count': len(flat),
                'type': 'VEC3',
                'min': [min(p[k] for p in flat) for k in range(3)],
                'max': [max(p[k] for p in flat) for k in range(3)],
            }
        )
        materials.append({'pbrMetallicRoughness': {'baseColorFactor': [*colour, 1]}})
        meshes.append({'primitives': [{'attributes': {'POSITION': i}, 'material': i}]})
        parts.append({'mesh': i, 'name': name})
        points += data
    head = json.dumps(
        {
            'asset': {'version': '2.0'},
            'buffers': [{'byteLength': len(points)}],
            'bufferViews': views,
            'accessors': accessors,
            'materials': materials,
            'meshes': meshes,
            'nodes': parts,
            'scenes': [{'nodes': list(range(len(nodes)))}],
            'scene': 0,
        }
    ).encode()
    head += b' ' * (-len(head) % 4)
    return (
        struct.pack('<4sII', b'glTF', 2, 28 + len(head) + len(points))
        + struct.pack('<I4s', len(head), b'JSON')
        + head
        + struct.pack('<I4s', len(points), b'BIN\0')
        + points
    )


def pump():
    """A block with a ball on it that reaches 1 mm into it, and a lamp far away."""
    moved = [[(x, y, z + 0.019) for x, y, z in t] for t in sphere(0.02)]
    return glb(
        [
            ('block', box((0.2, 0.2, 0.04), (0, 0, -0.02)), (1, 0, 0)),
            ('ball', moved, (0, 0, 1)),
            ('lamp', box((0.01, 0.01, 0.01), (0, 0, 0.3)), (1, 1, 1)),
        ]
    )


def last(parts):
    """Names without what the importer puts above several roots."""
    return [p['path'].split('/')[-1] for p in parts]


def sent(server, *files):
    body, kind = form({'file': list(files)})
    return server.ask('POST', '/v1/assemblies', body, {'Content-Type': kind})


def read(server, *files):
    answer = sent(server, *files)
    expect(answer.status == 202, answer)
    name = answer.json()['id']
    return until(
        'the assembly is read',
        lambda: (lambda a: (a['state'] != 'reading', a))(server.ask('GET', f'/v1/assemblies/{name}').json()),
    )


TAKEN_OUT = {
    'static': [{'mesh': 'pump.glb', 'without': ['ball']}],
    'tool': {'mesh': 'pump.glb', 'part': 'ball'},
}


def test_parts_have_names_sizes_and_colours():
    with Server() as server:
        pumped = read(server, ('pump.glb', pump()), ('note.txt', b'company'))
        expect(pumped['state'] == 'ready' and [f['mesh'] for f in pumped['files']] == [True, False], pumped)
        expect(last(pumped['parts']) == ['block', 'ball', 'lamp'], pumped['parts'])
        expect([p['colour'] for p in pumped['parts']] == ['#ff0000', '#0000ff', '#ffffff'], pumped['parts'])
        expect(
            pumped['parts'][1]['first_triangle'] == 12 and pumped['parts'][0]['triangles'] == 12,
            pumped['parts'],
        )
        expect(
            all(abs(a - b) < 1e-6 for a, b in zip(pumped['parts'][0]['box']['min'], [-0.1, -0.1, -0.04])),
            pumped['parts'][0],
        )
        expect(not pumped['files'][0]['states_unit'] and pumped['files'][0]['in_metres'], pumped['files'])
        for most in ('', '?max_triangles=100'):
            geometry = server.ask('GET', f'/v1/assemblies/{pumped["id"]}/geometry{most}').body
            magic, version, bits, vertices, triangles, *tool = struct.unpack('<4s7I', geometry[:32])
            expect(
                magic == b'PGEO'
                and tool == [0, 0, 0]
                and len(geometry) == 32 + 12 * vertices + 16 * triangles,
                (vertices, triangles),
            )
            total = sum(p['triangles'] for p in pumped['parts'])
            expect(
                triangles == total and bits == 0 if not most else 0 < triangles <= 100 and bits == 1,
                (triangles, bits),
            )
            ids = struct.unpack(f'<{triangles}I', geometry[-4 * triangles :])
            expect(max(ids) < total and len(set(ids)) == triangles, 'each id once')
        expect(
            server.ask('GET', f'/v1/assemblies/{pumped["id"]}/geometry?max_triangles=9').status == 400,
            'too few',
        )
        expect(server.ask('DELETE', f'/v1/assemblies/{pumped["id"]}').status == 204, 'forgotten')
        expect(server.ask('GET', f'/v1/assemblies/{pumped["id"]}').status == 404, 'gone')


def test_a_part_is_taken_out_and_the_contact_at_the_start_can_be_left_out():
    folder = Folder()
    with Server('--root', folder.path) as server:
        pumped = read(server, ('pump.glb', pump()))
        scene = server.ready(
            server.ask(
                'POST', f'/v1/assemblies/{pumped["id"]}/scene', {'scene': TAKEN_OUT, 'name': 'pump, ball'}
            )
        )
        told = server.ask('GET', f'/v1/scenes/{scene}').json()
        expect(told['name'] == 'pump, ball' and not told['ignores_initial'], told)
        parts = server.ask('GET', f'/v1/scenes/{scene}/parts').json()
        expect(last(parts['static']) == ['block', 'lamp'] and last(parts['tool']) == ['ball'], parts)
        touched = server.ask('POST', f'/v1/scenes/{scene}/query?names=1', {'pose': told['start']}).json()
        expect(
            touched['contact']
            and [path.split('/')[-1] for side in ('static', 'tool') for path in touched['parts'][side]]
            == ['block', 'ball'],
            touched.get('parts'),
        )
        saved = server.ask(
            'POST', f'/v1/assemblies/{pumped["id"]}/save', {'scene': TAKEN_OUT, 'folder': 'pump'}
        )
        expect(saved.status == 201 and saved.json()['path'] == 'pump/scene.json', saved)
        expect(json.loads((folder.path / 'pump/scene.json').read_text()) == TAKEN_OUT, 'as it was sent')
        expect((folder.path / 'pump/pump.glb').read_bytes() == pump(), 'and its mesh')
        again = server.ask(
            'POST', f'/v1/assemblies/{pumped["id"]}/save', {'scene': TAKEN_OUT, 'folder': 'pump'}
        )
        expect(again.status == 409, again)
        server.ask('DELETE', f'/v1/assemblies/{pumped["id"]}')
        as_written = server.ready(server.ask('POST', '/v1/scenes', {'path': 'pump/scene.json'}))
        without = server.ready(
            server.ask('POST', '/v1/scenes', {'path': 'pump/scene.json', 'start': 'ignore_initial'})
        )
        paper = {'path': 'pump/scene.json', 'start': 'ignore_initial', 'profile': 'paper'}
        expect(server.ask('POST', '/v1/scenes', paper).status == 400, 'in paper nothing is left out')
        expect(
            as_written != without and server.ask('GET', f'/v1/scenes/{without}').json()['ignores_initial'],
            'two scenes',
        )
        forces = {}
        for name in (as_written, without):
            with WebSocket(server, f'/v1/scenes/{name}/haptic') as loop:
                hello = loop.json()
                loop.send({'type': 'pose', 'seq': 1, 'time': 0, 'pose': hello['start']})
                forces[name] = math.hypot(*loop.json()['force'])
        expect(forces[as_written] > 0.5 and forces[without] == 0, forces)


def test_a_path_comes_with_the_scene():
    folder = Folder()
    path = 'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0.05,0,0,0,1,1\n1,0,0,0,0,0,0,1,1\n'
    with Server('--root', folder.path) as server:
        pumped = read(server, ('pump.glb', pump()))
        scene = {**TAKEN_OUT, 'device': {'driver': 'simulated', 'path': 'path.csv'}}
        made = server.ready(
            server.ask('POST', f'/v1/assemblies/{pumped["id"]}/scene', {'scene': scene, 'path': path})
        )
        expect(
            server.ask('GET', f'/v1/scenes/{made}').json()['start'][2] == 0.05,
            'it begins where the path does',
        )
        expect(
            server.ask(
                'POST', f'/v1/assemblies/{pumped["id"]}/save', {'scene': scene, 'path': path, 'folder': 'p'}
            ).status
            == 201,
            'saved',
        )
        expect((folder.path / 'p/path.csv').read_text() == path, 'the path, too')


def test_what_is_refused():
    folder = Folder()
    with Server('--root', folder.path) as server:
        for name in ('../up.stl', 'a/b.stl', '.hidden.stl', 'scene.json', 'path.csv', 'über.stl'):
            answer = sent(server, (name, b'x'))
            expect(answer.status == 400, (name, answer))
        expect(sent(server, ('readme.txt', b'x')).status == 400, 'no mesh')
        expect(sent(server, ('a.stl', b'x'), ('a.stl', b'x')).status == 400, 'twice')
        body, kind = form({'mesh': [('a.stl', b'x')]})
        expect(
            server.ask('POST', '/v1/assemblies', body, {'Content-Type': kind}).status == 400,
            'an unknown part',
        )
        expect(server.ask('POST', '/v1/assemblies', {}).status == 415, 'no form')
        expect(read(server, ('bad.stl', b'no mesh'))['state'] == 'failed', 'a bad file alone')
        half = read(server, ('bad.stl', b'no mesh'), ('ball.stl', (folder.path / 'ball.stl').read_bytes()))
        expect(
            half['state'] == 'ready' and half['files'][0]['error'] and not half['files'][1]['error'],
            half['files'],
        )
        expect('/' not in half['files'][0]['error'], half['files'][0]['error'])
        pumped = read(server, ('pump.glb', pump()))
        outside = {'static': [{'mesh': '../block.stl'}], 'tool': {'mesh': 'pump.glb'}}
        for order, word in (
            ({'scene': outside, 'folder': 'x'}, 'block.stl'),
            ({'scene': TAKEN_OUT, 'folder': '../x'}, 'folder'),
            ({'scene': TAKEN_OUT, 'folder': ''}, 'folder'),
            ({'scene': [], 'folder': 'x'}, 'scene'),
            ({'scene': {'tool': {'mesh': 'pump.glb'}}, 'folder': 'x'}, 'static'),
            (
                {
                    'scene': {**TAKEN_OUT, 'device': {'driver': 'simulated', 'path': '/etc/passwd'}},
                    'folder': 'x',
                },
                'path',
            ),
            (
                {
                    'scene': {
                        **TAKEN_OUT,
                        'device': {'driver': 'simulated', 'path': 'path.csv', 'guide': 'g.csv'},
                    },
                    'path': 'x',
                    'folder': 'x',
                },
                'guide',
            ),
            ({'scene': TAKEN_OUT, 'folder': 'x', 'more': 1}, 'more'),
            (
                {
                    'scene': {**TAKEN_OUT, 'static': [{'mesh': 'pump.glb', 'units': 'mm', 'scale': 3}]},
                    'folder': 'x',
                },
                'stands beside "scale"',
            ),
            ({'scene': {**TAKEN_OUT, 'response': {'stiffness': -5}}, 'folder': 'x'}, 'from 0'),
            (
                {
                    'scene': {**TAKEN_OUT, 'device': {'driver': 'simulated', 'path': 'path.csv'}},
                    'path': 'x',
                    'folder': 'x',
                },
                'path.csv, line 1',
            ),
        ):
            answer = server.ask('POST', f'/v1/assemblies/{pumped["id"]}/save', order)
            expect(answer.status == 400 and word in answer.json()['detail'], (order, answer))
            expect(str(folder.path) not in answer.json()['detail'], answer)
            expect(not (folder.path / 'x').exists(), 'nothing is left behind')
        bad = server.ask(
            'POST',
            f'/v1/assemblies/{pumped["id"]}/scene',
            {'scene': {**TAKEN_OUT, 'response': {'stiffnes': 1}}},
        )
        expect(
            bad.status == 400 and bad.json()['field'] == 'scene' and 'stiffness' in bad.json()['detail'], bad
        )
        expect(
            server.ask('POST', '/v1/scenes', {'path': 'scene.json', 'start': 'maybe'}).status == 400, 'start'
        )
    with Server() as server:
        pumped = read(server, ('pump.glb', pump()))
        expect(
            server.ask(
                'POST', f'/v1/assemblies/{pumped["id"]}/save', {'scene': TAKEN_OUT, 'folder': 'x'}
            ).status
            == 404,
            'no root',
        )


def test_the_oldest_goes():
    ball = stl(sphere(0.02))
    with Server() as server:
        names = [sent(server, ('ball.stl', ball)).json()['id'] for _ in range(9)]
        expect(server.ask('GET', f'/v1/assemblies/{names[0]}').status == 404, 'the first')
        expect(
            all(server.ask('GET', f'/v1/assemblies/{name}').status == 200 for name in names[1:]),
            'the others stay',
        )


main(globals())
