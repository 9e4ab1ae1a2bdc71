"""`palpate serve`: what a client sees when all goes well."""
import base64
import shutil
import subprocess

from harness import *
from server import *

STATES = ('queued', 'preparing', 'ready')


def glb(triangles):
    """One mesh, one node, without indices."""
    points = b''.join(struct.pack('<3f', *p) for t in triangles for p in t)
    flat = [p for t in triangles for p in t]
    low, high = [min(p[i] for p in flat) for i in range(3)], [max(p[i] for p in flat) for i in range(3)]
    head = json.dumps(
        {
            'asset': {'version': '2.0'},
            'buffers': [{'byteLength': len(points)}],
            'bufferViews': [{'buffer': 0, 'byteLength': len(points)}],
            'accessors': [
                {
                    'bufferView': 0,
                    'componentType': 5126,
                    'count': len(flat),
                    'type': 'VEC3',
                    'min': low,
                    'max': high,
                }
            ],
            'meshes': [{'primitives': [{'attributes': {'POSITION': 0}}]}],
            'nodes': [{'mesh': 0}],
            'scenes': [{'nodes': [0]}],
            'scene': 0,
        }
    ).encode()
    head += b' ' * (-len(head) % 4)
    points += b'\0' * (-len(points) % 4)
    return (
        struct.pack('<4sII', b'glTF', 2, 28 + len(head) + len(points))
        + struct.pack('<I4s', len(head), b'JSON')
        + head
        + struct.pack('<I4s', len(points), b'BIN\0')
        + points
    )


def simulated(folder):
    """A hand that presses the ball 2 mm into the block and stays."""
    folder.write(
        'path.csv',
        'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0.03,0,0,0,1,1\n0.3,0,0,0.018,0,0,0,1,1\n60,0,0,0.018,0,0,0,1,1\n',
    )
    return folder.save(device={'driver': 'simulated', 'path': 'path.csv'})


def test_a_recorded_trace_is_a_device_of_any_number_of_sessions():
    folder, arguments = rooted()
    scene = simulated(folder)
    done = palpate('run', scene, '--pace', 'asap', '--duration', '0.2', '--out', folder / 'out')
    expect(done.code == 0, done)
    folder.save('replay.json', device={'driver': 'replay', 'path': 'out/trace.csv'})
    with Server(*arguments) as server:
        name = named(server, 'replay.json')
        for _ in range(2):
            started = server.ask('POST', '/v1/sessions', {'scene': name})
            expect(started.status == 201, started)
        for wrong, word in (('replay:out/trace.csv', 'device.path'), ('nonsense', 'unknown haptic device')):
            refused = server.ask('POST', '/v1/sessions', {'scene': name, 'device': wrong})
            expect(refused.status == 400 and word in refused.json()['detail'], refused)


def test_a_session_whose_device_is_not_there_never_began():
    folder, arguments = rooted()
    simulated(folder)
    with Server(*arguments) as server:
        refused = server.ask('POST', '/v1/sessions', {'scene': named(server), 'device': 'inverse3'})
        expect(
            refused.status == 409 and server.ask('GET', '/v1/sessions').json() == {'sessions': []}, refused
        )
        log = server.log_text()
        expect('session_started' not in log and 'session_over' not in log, log)


def test_curl_alone_uploads_waits_and_queries_a_thousand_poses():
    curl = shutil.which('curl')
    expect(curl, 'curl is missing (scripts/packages.txt)')
    folder = Folder()
    folder.write('ball.glb', glb(sphere(0.02)))
    folder.write('poses.csv', csv(poses(1000)))
    scene = folder.save('local.json', tool={'mesh': 'ball.glb', 'units': 'm'}, response={})

    def run(*arguments):
        done = subprocess.run(
            [curl, '-sS', '--max-time', str(WAIT_S), *map(str, arguments)],
            capture_output=True,
            timeout=WAIT_S,
        )
        expect(done.returncode == 0, done.stderr.decode())
        return done.stdout

    with Server() as server:
        base = f'http://127.0.0.1:{server.port}'
        upload = json.loads(
            run(
                '-F',
                f'tool=@{folder / "ball.glb"}',
                '-F',
                f'static=@{folder / "block.stl"}',
                f'{base}/v1/scenes',
            )
        )
        expect(upload['state'] in STATES, upload)
        events = run('-N', f'{base}/v1/scenes/{upload["id"]}/events').decode()
        expect(events.rstrip().split('event: ')[-1].startswith('ready'), events)
        answers = run(
            '-H',
            'Content-Type: text/csv',
            '--data-binary',
            f'@{folder / "poses.csv"}',
            f'{base}/v1/scenes/{upload["id"]}/query',
        )
    told = palpate('query', scene, '--poses', folder / 'poses.csv', '--backend', 'cpu')
    expect(told.code == 0, told)
    lines = without_times(answers).split(b'\n')
    expect(
        len(lines) == 1001 and sum(b'"contact":true' in line for line in lines) > 100, f'{len(lines)} lines'
    )
    for mine, his in zip(lines, without_times(told.out).split(b'\n'), strict=True):
        expect(mine == his, f'{mine[:300]} instead of {his[:300]}')


def test_a_named_scene_answers_csv_json_and_bytes_alike():
    folder, arguments = rooted()
    rows = poses(40)
    with Server(*arguments) as server:
        expect(server.ask('GET', '/v1/scenes').json()['available'] == ['scene.json'], 'available')
        name = named(server)
        expect(
            server.ask('POST', '/v1/scenes', {'path': 'scene.json'}).status == 200,
            'a ready scene is told at once',
        )
        query = f'/v1/scenes/{name}/query'
        by_csv = server.ask('POST', query, csv(rows), {'Content-Type': 'text/csv'})
        by_json = server.ask('POST', query, {'poses': rows})
        packed = b''.join(struct.pack('<7d', *row) for row in rows)
        by_bytes = server.ask('POST', query, packed, {'Content-Type': 'application/vnd.palpate.poses'})
        expect(
            without_times(by_csv.body) == without_times(by_json.body) == without_times(by_bytes.body),
            'three forms, three answers',
        )
        lone = server.ask('POST', query, {'pose': rows[0]})
        expect(without_times(lone.body) == without_times(by_csv.body.split(b'\n')[0] + b'\n'), lone)
        verdicts = [
            json.loads(line)
            for line in server.ask('POST', query + '?any=1', {'poses': rows}).body.splitlines()
        ]
        expect(
            [(v['number'], v['touches']) for v in verdicts]
            == [(i, json.loads(line)['contact']) for i, line in enumerate(by_json.body.splitlines())]
            and all(v['engine'] for v in verdicts),
            verdicts,
        )
        brief = server.ask('POST', query + '?sets=0', {'poses': rows})
        wrenches = server.ask(
            'POST',
            query,
            packed,
            {'Content-Type': 'application/vnd.palpate.poses', 'Accept': 'application/vnd.palpate.wrenches'},
        ).body
        expect(len(wrenches) == 64 * len(rows), len(wrenches))
        for i, (long, short) in enumerate(
            zip(by_csv.body.splitlines(), brief.body.splitlines(), strict=True)
        ):
            long, short = json.loads(long), json.loads(short)
            expect(
                'cst' not in short and short['force'] == long['force'] and short['pairs'] == long['pairs'],
                short,
            )
            *wrench, pairs, flags, areas, bits = struct.unpack_from('<6d4I', wrenches, 64 * i)
            expect(
                wrench == long['force'] + long['torque']
                and pairs == long['pairs']
                and areas == len(long['areas'])
                and bits & 1 == long['contact'],
                (wrench, long),
            )


def test_media_types_are_read_in_any_case_and_a_weight_counts():
    folder, arguments = rooted()
    wrenches, lines = 'application/vnd.palpate.wrenches', 'application/x-ndjson'
    body = json.dumps({'pose': [0, 0, 0.018, 0, 0, 0, 1]})
    with Server(*arguments) as server:
        as_json = {'Content-Type': 'Application/JSON; charset=utf-8'}
        name = server.ready(server.ask('POST', '/v1/scenes', '{"path":"scene.json"}', as_json))
        form_body, kind = form(
            {
                part: (file, (folder / file).read_bytes())
                for part, file in (('static', 'block.stl'), ('tool', 'ball.stl'))
            }
        )
        upload = server.ask(
            'POST', '/v1/scenes', form_body, {'Content-Type': kind.replace('multipart', 'Multipart')}
        )
        expect(upload.status == 202, upload)
        for accept, told in (
            (wrenches, wrenches),
            (wrenches.upper(), wrenches),
            (f'{lines}, {wrenches}', wrenches),
            (f'{wrenches};q=0, {lines}', lines),
            (f'{wrenches};q=0.5, {lines}', lines),
            (f'{lines};q=0.2, {wrenches}; q=0.5', wrenches),
            (f'{wrenches};q=0.5, */*', lines),
            ('*/*', lines),
            ('', lines),
        ):
            answer = server.ask('POST', f'/v1/scenes/{name}/query', body, {**as_json, 'Accept': accept})
            expect(answer.status == 200 and answer.headers['Content-Type'] == told, (accept, answer.headers))


def test_uploaded_files_and_parts_keep_their_names():
    folder = Folder()
    block, ball = ((folder / name).read_bytes() for name in ('block.stl', 'ball.stl'))
    with Server() as server:

        def parts(**files):
            name = server.ready(server.upload(**files))
            told = server.ask('GET', f'/v1/scenes/{name}/parts').json()
            return {body: [part['path'] for part in told[body]] for body in told}, name

        told, name = parts(static=[('block.stl', block)], tool=('ball.stl', ball))
        expect(told == {'static': ['block'], 'tool': ['ball']}, told)
        scene = folder.save()
        (line,) = lines_of(
            palpate('query', scene, '--pose', '0 0 0.018 0 0 0 1', '--names', '--backend', 'cpu')
        )
        (mine,) = (
            json.loads(text)
            for text in server.ask(
                'POST', f'/v1/scenes/{name}/query?names=1', {'pose': [0, 0, 0.018, 0, 0, 0, 1]}
            ).body.splitlines()
        )
        expect(mine['parts'] == line['parts'], (mine['parts'], line['parts']))
        expect(server.ask('GET', f'/v1/scenes/{name}').json()['name'] == 'ball.stl on block.stl', 'name')
        told, _ = parts(static=[('a.stl', block), ('a.stl', block)], tool=('a.stl', ball))
        expect(told == {'static': ['a', 'static1_a'], 'tool': ['tool_a']}, told)
        failed = server.settled(
            server.upload(static=('block.stl', block), tool=('nan.stl', b'x')).json()['id']
        )
        detail = failed['error']['detail']
        expect('nan.stl' in detail and 'tool_' not in detail and '/' not in detail, failed)


def test_the_same_content_has_the_same_id_and_a_scene_can_be_deleted():
    folder, arguments = rooted()
    with Server(*arguments) as server:
        files = {
            'static': ('block.stl', (folder / 'block.stl').read_bytes()),
            'tool': ('ball.stl', (folder / 'ball.stl').read_bytes()),
        }
        first = server.upload(**files)
        name = server.ready(first)
        expect(first.headers['Location'] == f'/v1/scenes/{name}', first.headers)
        expect(server.upload(**files).json()['id'] == name, 'the same upload')
        expect(
            server.upload(**files, stiffness='1500').json()['id'] != name,
            'another stiffness is another scene',
        )
        expect(server.ask('DELETE', f'/v1/scenes/{name}').status == 204, 'delete')
        expect(server.ask('GET', f'/v1/scenes/{name}').status == 404, 'gone')
        expect(
            server.ask('POST', f'/v1/scenes/{name}/query', {'pose': [0, 0, 0, 0, 0, 0, 1]}).status == 404,
            'gone',
        )


def test_what_a_mesh_draws_on_is_part_of_the_id():
    def parts(folder, size):
        """A ball of that radius as a glTF whose points lie in a file of their own."""
        flat = [p for t in sphere(size) for p in t]
        points = b''.join(struct.pack('<3f', *p) for p in flat)
        told = json.dumps(
            {
                'asset': {'version': '2.0'},
                'buffers': [{'byteLength': len(points), 'uri': 'ball.bin'}],
                'bufferViews': [{'buffer': 0, 'byteLength': len(points)}],
                'accessors': [
                    {
                        'bufferView': 0,
                        'componentType': 5126,
                        'count': len(flat),
                        'type': 'VEC3',
                        'min': [-1] * 3,
                        'max': [1] * 3,
                    }
                ],
                'meshes': [{'primitives': [{'attributes': {'POSITION': 0}}]}],
                'nodes': [{'mesh': 0}],
                'scenes': [{'nodes': [0]}],
                'scene': 0,
            }
        )
        folder.write('ball.gltf', told)
        folder.write('ball.bin', points)
        return [(name, (folder / name).read_bytes()) for name in ('block.stl', 'ball.gltf', 'ball.bin')]

    folder = Folder()
    scene = folder.save(tool={'mesh': 'ball.gltf', 'units': 'm'})
    with Server('--root', folder.path) as server:
        ids, radii = [], []
        for size in (0.02, 0.01):  # as many triangles, as many bytes
            files = parts(folder, size)
            for answer in (
                server.upload(scene=scene.read_text(), file=files),
                server.ask('POST', '/v1/scenes', {'path': 'scene.json'}),
            ):
                ids.append(server.ready(answer))
                radii.append(server.ask('GET', f'/v1/scenes/{ids[-1]}').json()['tool_radius'])
        expect(
            len(set(ids)) == 4 and radii[0] == radii[1] > 1.5 * radii[2] and radii[2] == radii[3],
            (ids, radii),
        )


def test_a_file_that_states_its_unit_is_uploaded_beside_one_that_does_not():
    if not pathlib.Path(PROGRAM).with_name('palpate-import-cad').exists():
        return print('skipped: this build has no OpenCASCADE, so it reads no STEP file')
    _, arguments = rooted()
    step = (SOURCE / 'tests/fuzz/corpus/cad/cylinder.step').read_bytes()  # 10 mm wide, 20 mm high, on z = 0
    block = stl(box((200, 200, 40), (0, 0, -20)))
    with Server(*arguments) as server:
        name = server.ready(server.upload(tool=('pin.step', step), static=('block.stl', block), units='mm'))
        (touching,) = [
            json.loads(line)
            for line in server.ask(
                'POST', f'/v1/scenes/{name}/query?names=1', {'poses': [[0, 0, -0.001, 0, 0, 0, 1]]}
            ).body.splitlines()
        ]
        expect(
            touching['contact'] and len(touching['parts']['static']) == len(touching['parts']['tool']) == 1,
            touching,
        )
        (free,) = [
            json.loads(line)
            for line in server.ask(
                'POST', f'/v1/scenes/{name}/query', {'poses': [[0, 0, 0.001, 0, 0, 0, 1]]}
            ).body.splitlines()
        ]
        expect(not free['contact'] and 'parts' not in free, free)
        answer = server.upload(tool=('pin.step', step), static=('block.stl', block), tool_units='mm')
        expect(answer.status == 400 and answer.json()['field'] == 'tool_units', answer)
        expect('states its unit' in answer.json()['detail'], answer)


def test_a_scene_file_is_uploaded_with_what_it_names():
    folder = Folder()
    folder.write(
        'path.csv', 'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0.03,0,0,0,1,1\n1,0,0,0.018,0,0,0,1,1\n'
    )
    scene = {**folder.scene, 'device': {'driver': 'simulated', 'path': 'path.csv'}}
    files = [(name, (folder / name).read_bytes()) for name in ('block.stl', 'ball.stl', 'path.csv')]
    with Server() as server:
        name = server.ready(server.upload(scene=json.dumps(scene), file=files))
        told = server.ask('GET', f'/v1/scenes/{name}').json()
        expect(
            told['static_triangles'] == 12 and told['driver'] == 'simulated' and told['start'][2] == 0.03,
            told,
        )


def test_geometry_triangles_and_voxels_are_what_was_uploaded():
    folder, arguments = rooted()
    with Server(*arguments) as server:
        name = named(server)
        body = server.ask('GET', f'/v1/scenes/{name}/geometry').body
        magic, version, bits, sv, st, tv, tt, zero = struct.unpack_from('<4s7I', body)
        expect(
            (magic, version, bits, zero) == (b'PGEO', 1, 0, 0) and st == 12 and tt == len(sphere(0.02)),
            (magic, version, bits, st, tt),
        )
        expect(len(body) == 32 + 12 * (sv + tv) + 16 * (st + tt), len(body))
        vertices = struct.unpack_from(f'<{3 * sv}f', body, 32)
        corners = struct.unpack_from(f'<{3 * st}I', body, 32 + 12 * sv)
        one = server.ask('GET', f'/v1/scenes/{name}/triangles?ids=0,3-4').body
        expect(len(one) == 3 * 36, len(one))
        drawn = [vertices[3 * corners[i] + k] for i in (9, 10, 11) for k in range(3)]
        expect(list(struct.unpack_from('<9f', one, 36)) == drawn, 'triangle 3')
        few = server.ask('GET', f'/v1/scenes/{name}/geometry?max_triangles=100').body
        bits, _, st, _, tt = struct.unpack_from('<5I', few, 8)
        expect(bits == 1 and st == 12 and 20 < tt <= 100, (bits, st, tt))
        alone = server.ask('GET', f'/v1/scenes/{name}/geometry?max_triangles=100&body=tool').body
        bits, sv, st, tv, tt = struct.unpack_from('<5I', alone, 8)
        expect(bits == 1 and (sv, st) == (0, 0) and alone[32:] == few[-(12 * tv + 16 * tt) :], (bits, sv, st))
        expect(server.ask('GET', f'/v1/scenes/{name}/geometry?body=both').status == 400, 'body=both')
        voxels = server.ask('GET', f'/v1/scenes/{name}/voxels?class=internal').body
        kind = struct.unpack_from('<4s3I', voxels)
        (size,) = struct.unpack_from('<d', voxels, 40)
        counts = struct.unpack_from('<3I', voxels, 48)
        (n,) = struct.unpack_from('<Q', voxels, 64)
        expect(kind == (b'PVOX', 1, 2, 0) and len(voxels) == 72 + 4 * n and n > 0, (kind, n))
        expect(
            0.5 < n * size**3 / (0.2 * 0.2 * 0.04) < 1,
            'the inside of a block is most of it, less the boundary',
        )
        ids = struct.unpack_from(f'<{n}I', voxels, 72)
        expect(max(ids) < counts[0] * counts[1] * counts[2], counts)


def test_a_session_runs_is_watched_paused_recorded_and_stopped():
    folder, arguments = rooted()
    simulated(folder)
    with Server(*arguments) as server:
        name = named(server)
        started = server.ask('POST', '/v1/sessions', {'scene': name, 'record': 'first'})
        expect(started.status == 201 and started.json()['state'] == 'running', started)
        session = f"/v1/sessions/{started.json()['id']}"
        with WebSocket(server, session + '/stream') as viewer, WebSocket(
            server, session + '/stream?format=binary'
        ) as other:
            hello = viewer.json()
            expect(
                hello['type'] == 'hello' and hello['scene'] == name and other.json()['type'] == 'hello', hello
            )
            pressed = None
            end = time.monotonic() + WAIT_S
            while time.monotonic() < end:
                message = viewer.json()
                expect(
                    message['type'] == 'telemetry'
                    and len(message['pose']) == 7
                    and math.isfinite(message['lateness_us']),
                    message,
                )
                if message['frame'] and message['frame']['contact'] and message['force'][2] > 0.1:
                    pressed = message
                    break
            expect(pressed, 'the ball never touched the block')
            area = pressed['frame']['areas'][0]
            expect(
                area['rays'] > 0
                and area['max_depth'] >= area['depth'] > 0
                and len(pressed['frame_pose']) == 7,
                area,
            )
            while time.monotonic() < end:
                data = other.receive()
                magic, version, bits = struct.unpack_from('<4sHH', data)
                expect(magic == b'PTEL' and version == 1, data[:8])
                # The tick's contact is newer than the frame.
                if bits & 2 and struct.unpack_from('<I', data, 232)[0] > 0:
                    break
            lengths, areas = struct.unpack_from('<6I', data, 208), struct.unpack_from('<I', data, 232)[0]
            at = 240 + 4 * sum(lengths) + 56
            for _ in range(areas):
                _, _, zones, statics, mobiles, _ = struct.unpack_from('<6I', data, at)
                at += 24 + 8 * 14 + 4 * (zones + statics + mobiles)
            expect(at == len(data) and areas > 0 and lengths[0] > 0, (at, len(data)))
            expect(server.ask('DELETE', f'/v1/scenes/{name}').status == 409, 'a scene in use is kept')
            expect(server.ask('POST', session + '/pause').json()['state'] == 'paused', 'pause')
            while not message['paused']:
                message = viewer.json()
            still = viewer.json()['pose']
            expect(viewer.json()['pose'] == still, 'a paused simulation stands still')
            expect(server.ask('POST', session + '/resume').json()['state'] == 'running', 'resume')
            stopped = server.ask('DELETE', session).json()
            expect(
                stopped['state'] == 'ended'
                and stopped['summary']['ticks'] > 0
                and stopped['summary']['areas_max'] >= 1
                and stopped['tick'] == stopped['summary']['ticks'] - 1,
                stopped,
            )
            last = message
            while message is not None:
                last, message = message, viewer.json()
            expect(last['type'] == 'bye' and viewer.closed_with == 1000, last)
        (run,) = server.ask('GET', '/v1/runs').json()['runs']
        expect(
            run['name'] == 'first'
            and run['static_triangles'] == 12
            and set(run['files']) == {'frames.jsonl', 'trace.csv', 'summary.json', 'report.html'},
            run,
        )
        trace = server.ask('GET', '/v1/runs/first/trace.csv')
        expect(len(trace.body) == run['files']['trace.csv'] and trace.body.startswith(b'time_s,'), trace)
        (*_, last_row) = trace.body.splitlines()
        expect(float(last_row.split(b',')[0]) == stopped['time_s'], (last_row, stopped))
        in_lines = server.ask('GET', '/v1/runs/first/trace.csv', headers={'Range': 'lines=1-2'})
        expect(in_lines.status == 200 and in_lines.body.startswith(b'time_s,x_m'), in_lines.status)
        part = server.ask('GET', '/v1/runs/first/trace.csv', headers={'Range': 'bytes=5-9'})
        expect(part.status == 206 and part.body == trace.body[5:10], part)
        expect(server.ask('DELETE', f'/v1/scenes/{name}').status == 204, 'a scene out of use can go')


def test_a_remote_loop_gets_wrenches_with_its_own_stamps():
    folder, arguments = rooted()
    pressed = [0, 0, 0.018, 0, 0, 0, 1]
    with Server(*arguments) as server:
        name = named(server)
        (line,) = lines_of(
            palpate('query', folder / 'scene.json', '--pose', ' '.join(map(str, pressed)), '--backend', 'cpu')
        )
        with WebSocket(server, f'/v1/scenes/{name}/haptic') as loop:
            hello = loop.json()
            expect(
                hello['type'] == 'hello' and hello['stiffness'] == 2000 and hello['watchdog_ms'] > 0, hello
            )
            loop.send({'type': 'pose', 'seq': 41, 'time': 12.25, 'pose': pressed, 'full': True})
            wrench = loop.json()
            expect(
                wrench['type'] == 'wrench'
                and wrench['seq'] == 41
                and wrench['time'] == 12.25
                and wrench['skipped'] == 0,
                wrench,
            )
            expect(
                wrench['force'] == line['force']
                and wrench['torque'] == line['torque']
                and wrench['frame']['cst'] == line['cst'],
                wrench,
            )
            loop.send({'type': 'pose', 'seq': 41, 'pose': pressed, 'full': True, 'area_lists': False})
            bare = loop.json()['frame']
            gone = {'zones', 'static', 'mobile'}
            expect(
                bare['cst'] == line['cst']
                and bare['areas']
                == [
                    {key: value for key, value in area.items() if key not in gone}
                    for area in wrench['frame']['areas']
                ],
                bare,
            )
            loop.send(struct.pack('<Qd7d', 42, 1.5, *pressed))
            data = loop.receive()
            seq, time_back, *rest = struct.unpack_from('<Qd9d', data)
            us, skipped, bits, planes = struct.unpack_from('<fIII', data, 88)
            expect(
                (seq, time_back, skipped, bits) == (42, 1.5, 0, 1)
                and planes == len(line['areas'])
                and len(data) == 104 + 64 * planes,
                (seq, time_back, bits, planes),
            )
            # Many poses at once: the last is answered, and every one is answered or counted.
            for i in range(300):
                loop.send(
                    {
                        'type': 'pose',
                        'seq': 100 + i,
                        'time': i,
                        'pose': [0, 0, 0.018 + 0.00001 * i, 0, 0, 0, 1],
                    }
                )
            answered = skipped = 0
            while answered == 0 or wrench['seq'] != 399:
                wrench = loop.json()
                answered, skipped = answered + 1, skipped + wrench['skipped']
            # Every pose is answered, or counted with the answer to a newer one.
            expect(
                answered + skipped == 300 and server.metric('palpate_loop_poses_total') >= answered,
                (answered, skipped),
            )
            loop.send({'type': 'pose', 'seq': 1, 'pose': [0, 0, 0, 0, 0, 0, 0]})
            refused = loop.json()
            expect(
                refused['type'] == 'error'
                and refused['problem']['status'] == 400
                and 'pose' in refused['problem']['field'],
                refused,
            )
            expect(loop.receive() is None and loop.closed_with == 1008, 'closed after an error')
        expect(server.ask('GET', f'/v1/scenes/{name}').json()['users'] in (0, 1), 'users')


def test_a_near_pose_is_answered_from_the_one_before_and_a_pose_alone_as_a_query():
    folder, arguments = rooted()
    poses = [[0.0002 * i, 0, 0.018, 0, 0, 0, 1] for i in range(20)]
    with Server(*arguments) as server:
        name = named(server)
        (last,) = lines_of(
            palpate(
                'query', folder / 'scene.json', '--pose', ' '.join(map(str, poses[-1])), '--backend', 'cpu'
            )
        )
        evaluations = {False: 0, True: 0}
        with WebSocket(server, f'/v1/scenes/{name}/haptic') as loop:
            loop.json()
            for near in (False, True):
                for i, pose in enumerate(poses):
                    loop.send(
                        {'type': 'pose', 'seq': 100 * near + i, 'pose': pose, 'full': True, 'near': near}
                    )
                    answer = loop.json()
                    expect(answer['seq'] == 100 * near + i, answer)
                    evaluations[near] += answer['frame']['evaluations']
                apart = math.dist(answer['force'], last['force']) / math.hypot(*last['force'])
                expect(
                    apart < 2e-3
                    if near
                    else answer['force'] == last['force'] and answer['torque'] == last['torque'],
                    (near, apart, answer['force'], last['force']),
                )
            expect(evaluations[True] < evaluations[False], evaluations)
            # After others, one without it is a query's again.
            loop.send({'type': 'pose', 'seq': 500, 'pose': poses[-1], 'full': True})
            answer = loop.json()
            expect(
                answer['force'] == last['force']
                and answer['torque'] == last['torque']
                and answer['frame']['evaluations'] == last['evaluations'],
                answer,
            )
            loop.send({'type': 'pose', 'seq': 501, 'pose': poses[-1], 'near': 1})
            refused = loop.json()
            expect(refused['type'] == 'error' and refused['problem']['field'] == 'near', refused)


def test_planes_say_what_pushes_where_the_tool_is():
    folder, arguments = rooted()
    pressed = [0.0003, 0, 0.018, 0.02, 0.01, 0, 0.99975]
    with Server(*arguments) as server:
        name = named(server)
        (felt,) = lines_of(
            palpate('query', folder / 'scene.json', '--pose', ' '.join(map(str, pressed)), '--backend', 'cpu')
        )
        with WebSocket(server, f'/v1/scenes/{name}/haptic') as loop:
            loop.json()

            def ask(seq, pose, **more):
                loop.send({'type': 'pose', 'seq': seq, 'pose': pose, **more})
                return loop.json()

            # Where the spring holds the tool of a hand at `pressed`, the field pushes as much as is felt.
            there = ask(1, felt['tool'], planes=True)
            expect(there['areas'] == [] and len(there['planes']) > 1, there)
            size = math.hypot(*felt['force'])
            expect(math.dist(there['force'], felt['force']) < 1e-4 * size, (there, felt))
            for told, part in (('force', 'normal'), ('torque', 'lever')):
                total = [sum(p['force'] * p[part][k] for p in there['planes']) for k in range(3)]
                expect(math.dist(total, there[told]) < 1e-9 * size, (told, total, there))
            expect(
                all(p['stiffness'] > 0 and abs(math.hypot(*p['normal']) - 1) < 1e-9 for p in there['planes']),
                there,
            )
            # Nothing is felt through a spring: no balance is looked for, and the next answer has one again.
            framed = ask(2, felt['tool'], planes=True, full=True)
            expect('evaluations' not in framed['frame'] and framed['force'] == there['force'], framed)
            plain = ask(3, pressed)
            expect(plain['force'] == felt['force'] and 'planes' not in plain, plain)
            free = ask(4, [0, 0, 1, 0, 0, 0, 1], planes=True)
            expect(not free['contact'] and free['planes'] == [], free)
            refused = ask(5, pressed, planes=1)
            expect(refused['type'] == 'error' and refused['problem']['field'] == 'planes', refused)


def test_sigterm_in_mid_session_sends_zero_force_tells_clients_and_exits_0():
    folder, arguments = rooted()
    simulated(folder)
    with Server(*arguments) as server:
        name = named(server)
        session = server.ask('POST', '/v1/sessions', {'scene': name, 'record': 'cut'}).json()['id']
        with WebSocket(server, f'/v1/sessions/{session}/stream') as viewer, WebSocket(
            server, f'/v1/scenes/{name}/haptic'
        ) as loop:
            expect(loop.json()['type'] == 'hello', 'hello')
            loop.send({'type': 'pose', 'seq': 8, 'time': 0.5, 'pose': [0, 0, 0.018, 0, 0, 0, 1]})
            felt = loop.json()
            expect(felt['force'][2] > 0.1, felt)
            viewer.json()
            while not (message := viewer.json())['force'][2] > 0.1:
                pass
            server.process.send_signal(signal.SIGTERM)
            last = None
            while (message := viewer.json()) is not None:
                last = message
            expect(last['type'] == 'bye', last)
            still = loop.json()
            expect(
                still['type'] == 'wrench'
                and still['stopped']
                and still['seq'] == 8
                and still['force'] == still['torque'] == [0, 0, 0]
                and still['areas'] == [],
                still,
            )
            # M: the wrench's is rounded to the lattice.
            expect(math.dist(still['gc'], felt['gc']) < 1e-6, still)
            expect(
                loop.json() == {'type': 'bye', 'reason': 'the server stops'}
                and loop.receive() is None
                and loop.closed_with == 1001,
                'the loop is told',
            )
            expect(server.process.wait(WAIT_S) == 0, server.log_text()[-2000:])
    log = server.log_text()
    expect(
        log.index('"event":"stopping"')
        < log.index('"event":"session_over"')
        < log.index('"event":"stopped"'),
        log[-1500:],
    )
    summary = json.loads((folder / 'cut' / 'summary.json').read_text())
    rows = (folder / 'cut' / 'trace.csv').read_text().splitlines()
    expect(summary['ticks'] == len(rows) - 1 > 0 and 'failure' not in summary, summary)


def test_stopped_is_the_last_word_also_of_a_scene_that_is_being_read():
    folder, arguments = rooted()
    folder.write('large.stl', stl(sphere(0.03, 160)))
    scene = folder.save(static=[{'mesh': 'large.stl', 'units': 'm'}])
    with Server(*arguments) as server:
        server.ask('POST', '/v1/scenes', {'path': pathlib.Path(scene).name})
        server.process.send_signal(signal.SIGTERM)
        expect(server.process.wait(WAIT_S) == 0, server.log_text()[-2000:])
    events = [json.loads(line)['event'] for line in server.log_text().splitlines() if line.startswith('{')]
    expect('scene_failed' in events and events[-1] == 'stopped', events)


def test_metrics_health_and_log_tell_what_happened():
    folder, arguments = rooted()
    with Server(*arguments) as server:
        expect(
            server.ask('GET', '/healthz').status == 200 and server.ask('GET', '/readyz').status == 200,
            'alive',
        )
        name = named(server)
        server.ask('POST', f'/v1/scenes/{name}/query', {'poses': poses(10)})
        text = server.ask('GET', '/metrics').body.decode()
        for line in text.splitlines():
            expect(
                re.fullmatch(
                    r'# (HELP|TYPE) (palpate|process)_\w+ .+|(palpate|process)_\w+(\{[^}]*\})? [-+0-9.e]+',
                    line,
                ),
                line,
            )
        expect(
            server.metric('palpate_poses_total') == 10 and server.metric('palpate_scenes_ready') == 1, text
        )
        expect(
            server.metric('palpate_query_seconds_count') == 10
            and server.metric('process_resident_memory_bytes') > 1e6,
            text,
        )
        for wanted in (
            'tick_lateness_seconds_bucket',
            'result_age_seconds_bucket',
            'session_frame_seconds_bucket',
            'stage_seconds_total{engine="cpu",stage="sets"}',
            'scene_queue',
            'batches',
            'scene_memory_bytes',
            'backend_errors_total',
            'requests_total{route="v1/scenes/*/query",status="200"}',
            'session_missed_ticks_total',
        ):
            expect(f'palpate_{wanted}' in text, f'{wanted} is missing in {text}')
        for line in server.log_text().splitlines():
            expect({'time', 'level', 'event'} <= set(json.loads(line)), line)


def test_beyond_loopback_without_token_and_tls_is_refused():
    for arguments in ([], ['--token-file', 'x'], ['--tls-certificate', 'x', '--tls-key', 'y']):
        expect_refused(
            palpate('serve', '--listen', '0.0.0.0:0', *arguments), 2, '--token-file', '--tls-certificate'
        )
    expect_refused(palpate('serve', '--tls-key', 'y'), 2, 'go together')
    expect_refused(palpate('serve', '--listen', '127.0.0.1'), 3, 'ADDRESS:PORT')
    expect_refused(palpate('serve', '--root', '/no/such/folder'), 3, '/no/such/folder')


main(globals())
