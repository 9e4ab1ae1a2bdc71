"""`palpate serve` against clients that mean no good, or know no better: a clear status each, nothing lost, up
throughout.

Bounded in count and time, loopback only.
"""
import random
import resource
import select
import shutil
import socket
import subprocess
import ssl
import threading

from harness import *
from server import *

PRESSED = [0, 0, 0.018, 0, 0, 0, 1]
TOKEN = 'a-token-for-a-test-0123456789'


def problem(answer, status, word):
    """The answer is a problem of this status and type."""
    expect(answer.status == status, answer)
    told = answer.json()
    expect(answer.headers['Content-Type'] == 'application/problem+json' and told['status'] == status, answer)
    expect(told['type'] == f'urn:palpate:problem:{word}' and told['detail'], told)
    return told


def status_of(raw):
    return int(raw.split(b' ', 2)[1]) if raw.startswith(b'HTTP/1.1 ') else None


def up(server):
    expect(server.ask('GET', '/healthz').status == 200, 'the server is down')


def rooted(**changes):
    folder = Folder()
    folder.save(**changes)
    return folder


def files(folder):
    return {
        'static': ('block.stl', (folder / 'block.stl').read_bytes()),
        'tool': ('ball.stl', (folder / 'ball.stl').read_bytes()),
    }


def test_each_is_spoken_to_in_the_http_it_speaks():
    folder = rooted()
    with Server('--root', folder.path) as server:
        name = server.ready(server.ask('POST', '/v1/scenes', {'path': 'scene.json'}))
        body = json.dumps({'poses': [PRESSED] * 300}).encode()

        def ask(version, more=b'', method=b'POST'):
            return server.raw(
                method
                + f' /v1/scenes/{name}/query HTTP/{version}\r\nHost: localhost\r\nConnection: close\r\n'
                f'Content-Type: application/json\r\nContent-Length: {len(body)}\r\n'.encode()
                + more
                + b'\r\n'
                + body
            )

        head, lines = ask('1.0').split(b'\r\n\r\n', 1)
        expect(status_of(head) == 200 and b'Transfer-Encoding' not in head, head)
        expect([json.loads(line)['number'] for line in lines.splitlines()] == list(range(300)), lines[:200])
        head, chunks = ask('1.1').split(b'\r\n\r\n', 1)
        expect(b'Transfer-Encoding: chunked' in head and int(chunks.split(b'\r\n')[0], 16) > 0, head)
        head, told = ask('1.1', b'Content-Encoding: gzip\r\n').split(b'\r\n\r\n', 1)
        expect(status_of(head) == 415 and b'Content-Encoding' in told, (head, told))
        for identity in (b'identity', b'Identity'):  # RFC 9110: codings are told in any case
            expect(status_of(ask('1.1', b'Content-Encoding: ' + identity + b'\r\n')) == 200, identity)
        answer = server.raw(
            f'POST /v1/scenes/{name}/query HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n'
            'Transfer-Encoding: gzip, chunked\r\n\r\n0\r\n\r\n'.encode()
        )
        expect(status_of(answer) == 501 and b'Transfer-Encoding' in answer, answer)
        head, rest = server.raw(b'HEAD /v1/info?x=1 HTTP/1.1\r\nHost: localhost\r\n\r\n').split(
            b'\r\n\r\n', 1
        )
        expect(status_of(head) == 400 and rest == b'', (head, rest))


def test_what_is_too_large_is_refused_before_it_is_read():
    folder = rooted()
    with Server(
        '--root', folder.path, '--max-upload', '1', '--max-poses', '10', '--max-triangles', '100'
    ) as server:
        answer = server.raw(
            b'POST /v1/scenes HTTP/1.1\r\nHost: localhost\r\nContent-Type:'
            b' application/json\r\nContent-Length: 2000000\r\n\r\n'
        )
        expect(status_of(answer) == 413 and b'too-large' in answer, answer[:300])
        body, kind = form({'tool': ('a.stl', b'x' * 3_000_000)})
        answer = server.raw(
            f'POST /v1/scenes HTTP/1.1\r\nHost: localhost\r\nContent-Type: {kind}\r\nContent-Length:'
            f' {10**15}\r\n\r\n'.encode()
        )
        expect(status_of(answer) == 413, answer[:300])
        # A client that sends all it has before it listens hears it, too.
        answer = server.raw(
            b'POST /v1/scenes HTTP/1.1\r\nHost: localhost\r\nContent-Type:'
            b' application/json\r\nContent-Length: 64000000\r\n\r\n' + b'x' * 64_000_000
        )
        expect(status_of(answer) == 413 and b'too-large' in answer, answer[:300])
        chunk = b'10000\r\n' + b'x' * 65536 + b'\r\n'
        answer = server.raw(
            f'POST /v1/scenes HTTP/1.1\r\nHost: localhost\r\nContent-Type: {kind}\r\nTransfer-Encoding:'
            ' chunked\r\n\r\n'.encode() + chunk * 40
        )
        # None: a reset overtook the answer, since the client went on sending.
        expect(status_of(answer) in (413, None), answer[:300])
        answer = server.raw(b'GET / HTTP/1.1\r\nHost: localhost\r\nX-Long: ' + b'y' * 40_000 + b'\r\n\r\n')
        expect(status_of(answer) in (431, None), answer[:300])
        told = problem(server.ask('GET', '/' + 'z' * 5000), 431, 'header')
        expect(told['field'] == 'target' and '2048' in told['detail'], told)
        scene = server.ask('POST', '/v1/scenes', {'path': 'scene.json'}).json()['id']
        failed = server.settled(scene)
        expect(
            failed['state'] == 'failed'
            and failed['error']['status'] == 413
            and '100' in failed['error']['detail'],
            failed,
        )
        up(server)
    with Server('--root', folder.path, '--max-poses', '10') as server:
        name = server.ready(server.ask('POST', '/v1/scenes', {'path': 'scene.json'}))
        told = problem(
            server.ask('POST', f'/v1/scenes/{name}/query', {'poses': [PRESSED] * 11}), 413, 'too-large'
        )
        expect(told['field'] == 'poses', told)
        with WebSocket(server, f'/v1/scenes/{name}/haptic') as loop:
            loop.json()
            try:
                loop.send('x' * 70_000)
            except ConnectionError:  # refused by its length, before the rest was sent
                pass
            # None: a reset overtook the code.
            expect(loop.receive() is None and loop.closed_with in (1009, None), loop.closed_with)
        up(server)


def test_slow_clients_are_cut_off_and_hold_up_nobody():
    with Server() as server:
        head = (
            b'POST /v1/scenes HTTP/1.1\r\nHost: localhost\r\nContent-Type:'
            b' application/json\r\nContent-Length: 100\r\n\r\n{'
        )
        ends = {}

        def drip(name, start, piece):
            with server.connect() as link:
                began, got = time.monotonic(), b''
                try:
                    link.sendall(start)
                    link.settimeout(0.5)
                    while time.monotonic() - began < WAIT_S:
                        try:
                            part = link.recv(4096)
                            if not part:
                                break
                            got += part
                        except TimeoutError:
                            link.sendall(piece)  # nothing, where it stops
                except ConnectionError:
                    pass
                ends[name] = (status_of(got), time.monotonic() - began < WAIT_S)

        threads = [
            threading.Thread(target=drip, args=arguments)
            for arguments in [
                ('head', b'GET / HTTP/1.1\r\nHost: loc', b'a'),
                ('head that stops', b'GET / HTTP/1.1\r\nHost: loc', b''),
                ('silence', b'', b''),
                ('body', head, b' '),
                ('body that stops', head, b''),
            ]
        ]
        for thread in threads:
            thread.start()
        time.sleep(1)
        up(server)
        for thread in threads:
            thread.join()
        for name, (status, cut_off) in ends.items():
            expect(
                status == (None if name == 'silence' else 408) and cut_off,
                f'{name}: {status}, cut off: {cut_off}',
            )
        up(server)


def test_rubbish_is_400_or_the_end():
    chance = random.Random(11)
    lines = [
        b'',
        b'\r\n\r\n',
        b'GET\r\n\r\n',
        b'GET / HTTP/9.9\r\n\r\n',
        b'GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n',
        b'GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n',
        b'POST / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n',
        (
            b'POST /v1/scenes HTTP/1.1\r\nHost: localhost\r\nContent-Type:'
            b' application/json\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n'
        ),
        b'\x16\x03\x01' + bytes(200),
        b'GET /%00 HTTP/1.1\r\nHost: localhost\r\n\r\n',
        b'GET /%zz HTTP/1.1\r\nHost: localhost\r\n\r\n',
        b'PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n',
    ]
    lines += [
        bytes(chance.randrange(256) for _ in range(chance.randrange(1, 400))) + b'\r\n\r\n'
        for _ in range(100)
    ]
    with Server() as server:
        for line in lines:
            with server.connect() as link:
                got = b''
                try:
                    link.sendall(line)
                    link.shutdown(socket.SHUT_WR)
                    while piece := link.recv(65536):
                        got += piece
                except ConnectionError:
                    pass
                expect(status_of(got) in (400, 403, 408, 431, None), (line[:80], got[:200]))
        up(server)
        expect(server.ask('PUT', '/v1/scenes').headers.get('Allow') == 'GET, HEAD, POST', 'Allow')
        problem(server.ask('PUT', '/v1/scenes'), 405, 'method')
        problem(server.ask('GET', '/nothing'), 404, 'not-found')


def test_bad_bodies_are_named_with_their_field():
    folder = rooted()
    with Server('--root', folder.path) as server:
        name = server.ready(server.ask('POST', '/v1/scenes', {'path': 'scene.json'}))
        query = f'/v1/scenes/{name}/query'
        as_json, as_csv, as_bytes = (
            {'Content-Type': kind}
            for kind in ('application/json', 'text/csv', 'application/vnd.palpate.poses')
        )
        nan = struct.pack('<7d', 0, 0, float('nan'), 0, 0, 0, 1)
        for body, headers, field, *word in [
            (b'{', as_json, 'body'),
            (b'[' * 100_000, as_json, 'body'),
            (b'{"a":' * 50_000, as_json, 'body'),
            (b'\xff\xfe', as_json, 'body'),
            (b'{"poses":1}', as_json, 'poses'),
            (b'{"poses":[]}', as_json, 'poses', 'no pose'),
            (b'{"poses":[[1,2]]}', as_json, 'poses[0]'),
            (b'{"poses":[[0,0,0,0,0,0,1],[0,0,0,0,0,0,9]]}', as_json, 'poses[1]'),
            (b'{"pose":[0,0,0,0,0,0,"1"]}', as_json, 'pose'),
            (b'{"pozes":[]}', as_json, 'pozes'),
            (b'{"poses":[],"poses":[]}', as_json, 'body'),
            (b'x,y\n1,2\n', as_csv, 'body'),
            (b'', as_csv, 'body'),
            (b'x,y,z,qx,qy,qz,qw\n1,2,3,4,5,6,seven\n', as_csv, 'body'),
            (b'', as_bytes, 'body', 'no pose'),
            (b'x' * 55, as_bytes, 'body', '56'),
            (nan, as_bytes, 'poses[0]'),
        ]:
            told = problem(server.ask('POST', query, body, headers), 400, 'bad-value')
            expect(told['field'] == field and '\n' not in told['detail'], (body[:60], told))
            expect(all(w in told['detail'] for w in word), (body[:60], told))
        problem(server.ask('POST', query, b'x', {'Content-Type': 'image/png'}), 415, 'media-type')
        problem(server.ask('POST', query + '?sets=2', b'x', as_csv), 400, 'bad-value')
        problem(server.ask('GET', f'/v1/scenes/{name}?wait=nan'), 400, 'bad-value')
        problem(server.ask('GET', f'/v1/scenes/{name}/triangles?ids=5-'), 400, 'bad-value')
        problem(server.ask('GET', f'/v1/scenes/{name}/triangles?ids=0-99999999'), 400, 'bad-value')
        problem(server.ask('POST', '/v1/sessions', {'scene': name, 'device': 'no such'}), 400, 'bad-value')
        problem(server.ask('POST', '/v1/sessions', {'scene': name, 'record': '../x'}), 400, 'bad-value')
        problem(server.ask('POST', '/v1/sessions', {'scene': name, 'duration_s': -1}), 400, 'bad-value')
        problem(server.ask('POST', '/v1/sessions', {'scene': 'none'}), 404, 'not-found')
        for message in (
            '{',
            '[[[[',
            '{"type":"pose"}',
            '{"type":"pose","seq":-1,"pose":[0,0,0,0,0,0,1]}',
            b'short',
            struct.pack('<Qd', 1, 1) + nan,
        ):
            with WebSocket(server, f'/v1/scenes/{name}/haptic') as loop:
                loop.json()
                loop.send(message)
                told = loop.json()
                expect(
                    told['type'] == 'error' and told['problem']['status'] == 400 and loop.receive() is None,
                    told,
                )
                expect(loop.closed_with == 1008, loop.closed_with)
        up(server)


def test_parameters_that_are_unknown_or_contradict_each_other_are_named():
    folder = rooted()
    with Server('--root', folder.path) as server:
        name = server.ready(server.ask('POST', '/v1/scenes', {'path': 'scene.json'}))
        scene = f'/v1/scenes/{name}'
        for method, path, field, word in [
            ('POST', scene + '/query?nmaes=1', 'nmaes', '"names"'),
            ('POST', scene + '/query?any=1&tolerance=0.001', 'tolerance', 'unknown'),
            ('POST', scene + '/query?any=1&any=0', 'any', 'twice'),
            ('POST', scene + '/query?any=1&clearance=1', 'clearance', 'any'),
            ('POST', scene + '/query?any=1&within=0.1', 'within', 'any'),
            ('POST', scene + '/query?any=1&names=1', 'names', 'any'),
            ('POST', scene + '/query?clearance=1&names=1', 'names', 'clearance'),
            ('POST', scene + '/query?within=near', 'within', '100'),
            ('POST', scene + '/query?within=-1', 'within', '100'),
            ('POST', scene + '/query?within=', 'within', '100'),
            ('POST', scene + '/path?names=1', 'names', 'takes none'),
            ('GET', scene + '?wiat=1', 'wiat', '"wait"'),
            ('GET', scene + '/geometry?max_triangle=100', 'max_triangle', '"max_triangles"'),
            ('GET', scene + '/triangles?id=1', 'id', '"ids"'),
            ('GET', scene + '/voxels?klass=internal', 'klass', '"class"'),
            ('GET', scene + '/haptic?format=binary', 'format', 'takes none'),
            ('GET', '/v1/assemblies/x/geometry?triangles=1', 'triangles', '"max_triangles"'),
            ('GET', '/v1/sessions/x/stream?fromat=binary', 'fromat', '"format"'),
            ('GET', '/v1/scenes?page=2', 'page', 'takes none'),
            ('POST', '/v1/scenes?profile=paper', 'profile', 'takes none'),
            ('GET', '/v1/runs/x/trace.csv?from=1', 'from', 'takes none'),
        ]:
            body = {'poses': [PRESSED]} if method == 'POST' else None
            told = problem(server.ask(method, path, body), 400, 'bad-value')
            expect(told['field'] == field and word in told['detail'], (path, told))
        with WebSocket(server, '/v1/sessions/x/stream?format=xml') as viewer:
            expect(viewer.status == 400, viewer.head)
        for path in ('/healthz?probe=1', '/?utm=1'):
            expect(server.ask('GET', path).status == 200, path)


def test_each_status_has_a_type_of_its_own():
    folder = rooted()
    (folder / 'run').mkdir()
    (folder / 'run' / 'trace.csv').write_text('time_s\n')
    with Server('--root', folder.path) as server:
        beyond = server.ask('GET', '/v1/runs/run/trace.csv', headers={'Range': 'bytes=99999999-'})
        problem(beyond, 416, 'range')
        expect(beyond.headers['Content-Range'] == 'bytes */7', beyond.headers)
        plain = server.ask('GET', '/v1/sessions/x/stream')
        problem(plain, 426, 'upgrade')
        expect(
            plain.headers['Upgrade'] == 'websocket' and 'upgrade' in plain.headers['Connection'].lower(),
            plain.headers,
        )
        problem(server.ask('GET', '/v1/info', headers={'X-Long': 'y' * 40_000}), 431, 'header')


def test_bad_uploads_leave_nothing_behind():
    folder = rooted()
    spool = Folder()
    good = files(folder)
    with Server('--spool', spool.path) as server:
        (inside,) = [path for path in spool.path.iterdir() if path.is_dir()]
        for parts in [
            {},
            {'tool': good['tool']},
            {**good, 'colour': 'red'},
            {**good, 'static': ('../block.stl', b'x')},
            {**good, 'static': ('.hidden', b'x')},
            {**good, 'tool': [good['tool'], good['tool']]},
            {**good, 'stiffness': 'soft'},
            {**good, 'stiffness': '-5'},
            {**good, 'units': 'm' * 200},
            {**good, 'units': 'km'},
            {'scene': '{"static":' * 40},
            {'scene': json.dumps(folder.scene)},
            {'scene': json.dumps({**folder.scene, 'tool': {'mesh': '/etc/passwd'}})},
            {**good, 'scene': '{}'},
            {'file': [(f'{i}.stl', b'x') for i in range(70)]},
            {'scene': 'x' * 1_100_000},
        ]:
            answer = server.upload(**parts)
            expect(answer.status in (400, 403, 413) and answer.json()['detail'], (list(parts), answer))
            expect(not list(inside.iterdir()), ('left behind', list(parts)))
        for field, value, word in [
            ('units', 'km', '"mm"'),
            ('tool_units', 'km', '"mm"'),
            ('static_units', 'km', '"mm"'),
            ('stiffness', '-5', 'from 0'),
            ('stiffness', '1e300', 'from 0'),
            ('stiffness', 'soft', 'no number'),
            ('profile', 'fine', '"refined"'),
        ]:
            told = problem(server.upload(**good, **{field: value}), 400, 'bad-value')
            expect(told['field'] == field and word in told['detail'], told)
            expect('scene.json' not in told['detail'], told)
        told = problem(server.upload(scene='{"static":[]}'), 400, 'bad-value')
        expect(told['field'] == 'scene' and told['detail'].startswith('scene.json: /static'), told)
        for kind in (
            'multipart/form-data',
            'multipart/form-data; boundary=',
            'multipart/form-data; boundary=' + 'b' * 80,
        ):
            problem(
                server.ask('POST', '/v1/scenes', b'--b\r\n\r\n', {'Content-Type': kind}), 400, 'bad-value'
            )
        for body in (
            b'',
            b'--b\r\n',
            b'--b\r\nno colon\r\n\r\n\r\n--b--',
            b'--b\r\n' + b'x' * 20_000,
            b'--bxx',
            b'--b--',
        ):
            answer = server.ask(
                'POST', '/v1/scenes', body, {'Content-Type': 'multipart/form-data; boundary=b'}
            )
            expect(answer.status == 400, (body[:40], answer))
        # Broken off in the middle.
        body, kind = form(good)
        with server.connect() as link:
            link.sendall(
                f'POST /v1/scenes HTTP/1.1\r\nHost: localhost\r\nContent-Type: {kind}\r\nContent-Length:'
                f' {len(body)}\r\n\r\n'.encode() + body[:1000]
            )
        # A mesh that names a file of this machine is not given it.
        secret = folder.write('secret.bin', struct.pack('<9f', 0, 0, 0, 1, 0, 0, 0, 1, 0))
        gltf = json.dumps(
            {
                'asset': {'version': '2.0'},
                'buffers': [{'byteLength': 36, 'uri': str(secret)}],
                'bufferViews': [{'buffer': 0, 'byteLength': 36}],
                'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 3, 'type': 'VEC3'}],
                'meshes': [{'primitives': [{'attributes': {'POSITION': 0}}]}],
                'nodes': [{'mesh': 0}],
                'scenes': [{'nodes': [0]}],
                'scene': 0,
            }
        )
        for uri in (str(secret), os.path.relpath(secret, inside / 'upload-1'), 'file://' + str(secret)):
            answer = server.upload(**{**good, 'tool': ('tool.gltf', gltf.replace(str(secret), uri))})
            if answer.status == 202:
                scene = server.settled(answer.json()['id'])
                expect(scene['state'] == 'failed', scene)
                expect(str(inside) not in json.dumps(scene), 'a path of this machine is told')
                server.ask('DELETE', f"/v1/scenes/{scene['id']}")
        until('nothing is left behind', lambda: (not (left := list(inside.iterdir())), left))
        up(server)
    expect(
        not list(path for path in spool.path.iterdir() if path.is_dir()), 'the spool of a server that ended'
    )


def test_a_file_system_that_is_full_is_507_and_what_fits_goes_through():
    """A file system of half a megabyte, in a name space of its own, where this user may have one."""
    place = Folder()  # while it lives, so does the folder
    spool = place.path / 'small'
    spool.mkdir()
    small = [
        'unshare',
        *([] if os.geteuid() == 0 else ['--user', '--map-root-user']),
        '--mount',
        'sh',
        '-c',
        f'mount -t tmpfs -o size=512k none {spool} && exec "$@"',
        'sh',
    ]
    if (
        not shutil.which('unshare')
        or subprocess.run([*small, 'true'], capture_output=True, timeout=60).returncode != 0
    ):
        print(
            'skipped: no file system may be mounted here; the limit on a file\'s size stands in for it below'
        )
        return
    folder = rooted()
    large = stl(sphere(0.02, 100))
    expect(len(large) > 600_000, len(large))
    with Server('--spool', spool, before=small) as server:
        # The mount is the server's alone: outside its name space the folder is an empty one.
        seen = pathlib.Path(f'/proc/{server.process.pid}/root{spool.resolve()}')
        (inside,) = [path for path in seen.iterdir() if path.is_dir()]
        # What was written of it is gone by the time the answer is there: the room is free for the next.
        for _ in range(10):
            problem(server.upload(**{**files(folder), 'tool': ('large.stl', large)}), 507, 'storage')
            expect(not list(inside.iterdir()), 'left behind')
        server.ready(server.upload(**files(folder)))
        up(server)


def test_a_file_that_may_not_grow_is_507_and_the_next_upload_goes_through():
    folder = rooted()
    large = stl(sphere(0.02, 60))

    def small_files():
        # Writing beyond fails, as on a full disk.
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

    with Server(preexec=small_files) as server:
        expect(len(large) > 300_000, len(large))
        problem(server.upload(**{**files(folder), 'tool': ('large.stl', large)}), 507, 'storage')
        server.ready(server.upload(**files(folder)))


def test_no_path_leads_out_of_the_root():
    folder = rooted()
    outside = Folder()
    outside.save()
    (folder / 'run').mkdir()
    (folder / 'run' / 'trace.csv').write_text('time_s\n')
    (folder / 'run' / 'frames.jsonl').symlink_to(outside.write('frames.jsonl', 'secret'))
    (folder / 'link.json').symlink_to(outside / 'scene.json')
    (folder / 'linked').symlink_to(outside.path)
    folder.save('names.json', tool={'mesh': str(outside / 'ball.stl'), 'units': 'm'})
    folder.save(
        'climbs.json', tool={'mesh': os.path.relpath(outside / 'ball.stl', folder.path), 'units': 'm'}
    )
    folder.save('by_link.json', tool={'mesh': 'linked/ball.stl', 'units': 'm'})
    with Server('--root', folder.path) as server:
        for path in (
            '../' + outside.path.name + '/scene.json',
            str(outside / 'scene.json'),
            '/etc/passwd',
            'link.json',
            'linked/scene.json',
            '../../../../etc/passwd',
        ):
            problem(server.ask('POST', '/v1/scenes', {'path': path}), 403, 'outside-root')
        for path in ('names.json', 'climbs.json', 'by_link.json'):
            problem(server.ask('POST', '/v1/scenes', {'path': path}), 403, 'outside-root')
        for path in ('', '\0', 'no.json', 'x' * 5000, '.'):
            expect(server.ask('POST', '/v1/scenes', {'path': path}).status in (400, 404), path)
        told = problem(server.ask('POST', '/v1/scenes', {'path': 'block.stl'}), 400, 'bad-value')
        expect(
            told['field'] == 'scene' and told['detail'] == 'scene file: byte 81 is zero: this is no text',
            told,
        )
        for run, status in (
            ('run', 403),
            ('..%2f' + outside.path.name, 403),
            ('linked', 403),
            ('%2fetc', 403),
            ('none', 404),
        ):
            expect(server.ask('GET', f'/v1/runs/{run}/frames.jsonl').status == status, run)
        expect(server.ask('GET', '/v1/runs/run/..%2f..%2fsecret').status == 404, 'a file of another name')
        (run,) = server.ask('GET', '/v1/runs').json()['runs']
        expect(run['name'] == 'run', run)


def test_hosts_origins_and_tokens():
    folder = rooted()
    token = folder.write('token', TOKEN + '\n')
    with Server('--root', folder.path, '--token-file', token, '--host', 'palpate.example') as server:
        bearer = {'Authorization': f'Bearer {TOKEN}'}
        for host in ('evil.example', '', '127.0.0.1.evil.example', '127.0.0.1:99x', '[::1', 'localhost@evil'):
            problem(server.ask('GET', '/v1/info', headers={**bearer, 'Host': host}), 403, 'foreign-host')
        for host in ('localhost', 'LOCALHOST:80', '[::1]:1234', 'palpate.example:443', '127.0.0.1'):
            expect(server.ask('GET', '/v1/info', headers={**bearer, 'Host': host}).status == 200, host)
        for origin in (
            'http://evil.example',
            'null',
            'http://localhost:1',
            'https://127.0.0.1.evil.example',
            f'http://127.0.0.1:{server.port + 1}',
        ):
            problem(
                server.ask('GET', '/v1/info', headers={**bearer, 'Origin': origin}), 403, 'foreign-origin'
            )
        expect(
            server.ask(
                'GET', '/v1/info', headers={**bearer, 'Origin': f'http://127.0.0.1:{server.port}'}
            ).status
            == 200,
            'our own page',
        )
        for wrong in (
            {},
            {'Authorization': ''},
            {'Authorization': 'Bearer '},
            {'Authorization': f'Bearer {TOKEN}x'},
            {'Authorization': f'Bearer {TOKEN[:-1]}'},
            {'Authorization': f'Basic {TOKEN}'},
        ):
            for path in ('/v1/info', '/v1/scenes', '/metrics', '/v1/sessions'):
                problem(server.ask('GET', path, headers=wrong), 401, 'token')
        for path in ('/healthz', '/readyz', '/'):
            expect(server.ask('GET', path).status == 200, path)
        answer = server.ask('POST', '/v1/scenes', {'path': 'scene.json'}, bearer)
        name = answer.json()['id']
        expect(server.settled(name, bearer)['state'] == 'ready', answer)
        for headers, status in (
            ('', 401),
            (f'Sec-WebSocket-Protocol: palpate, palpate.token.{TOKEN}x\r\n', 401),
            (f'Authorization: Bearer {TOKEN}\r\nOrigin: http://evil.example\r\n', 403),
            (f'Authorization: Bearer {TOKEN}\r\n', 101),
            (f'Sec-WebSocket-Protocol: palpate, palpate.token.{TOKEN}\r\n', 101),
            (f'Sec-WebSocket-Protocol: notpalpate, palpate.token.{TOKEN}\r\n', 101),
        ):
            with WebSocket(server, f'/v1/scenes/{name}/haptic', headers) as loop:
                expect(loop.status == status, (headers, loop.head))
                # Chosen is what was offered, or nothing.
                offered = ': palpate,' in headers
                chosen = 'Sec-WebSocket-Protocol: palpate\r\n' in loop.head + '\r\n'
                expect(
                    status != 101
                    or (chosen == offered and ('Sec-WebSocket-Protocol' in loop.head) == chosen),
                    loop.head,
                )
        expect(TOKEN not in server.log_text(), 'the token is in the log')
    short = folder.write('short', 'short\n')
    expect_refused(palpate('serve', '--token-file', short), 3, '16')


def test_beyond_loopback_with_token_and_tls():
    openssl = shutil.which('openssl')
    expect(openssl, 'openssl is missing (scripts/packages.txt)')
    folder = rooted()
    token = folder.write('token', TOKEN)
    made = subprocess.run(
        [
            openssl,
            'req',
            '-x509',
            '-newkey',
            'rsa:2048',
            '-nodes',
            '-days',
            '2',
            '-subj',
            '/CN=localhost',
            '-addext',
            'subjectAltName=DNS:localhost',
            '-keyout',
            folder / 'key.pem',
            '-out',
            folder / 'cert.pem',
        ],
        capture_output=True,
        timeout=WAIT_S,
    )
    expect(made.returncode == 0, made.stderr)
    with Server(
        '--token-file', token, '--tls-certificate', folder / 'cert.pem', '--tls-key', folder / 'key.pem'
    ) as server:
        trust = ssl.create_default_context(cafile=str(folder / 'cert.pem'))
        with trust.wrap_socket(server.connect(), server_hostname='localhost') as link:
            link.sendall(
                f'GET /v1/info HTTP/1.1\r\nHost: localhost:{server.port}\r\nAuthorization: Bearer'
                f' {TOKEN}\r\nConnection: close\r\n\r\n'.encode()
            )
            got = b''
            while piece := link.recv(65536):
                got += piece
        expect(status_of(got) == 200 and b'"version"' in got, got[:300])
        expect(
            status_of(server.raw(b'GET / HTTP/1.1\r\nHost: localhost\r\n\r\n')) is None,
            'plain HTTP on a TLS port',
        )
    expect_refused(
        palpate('serve', '--tls-certificate', folder / 'token', '--tls-key', folder / 'key.pem'),
        3,
        'certificate',
    )


def told_that_it_is_busy(links):
    """How many of the connections; the server still puts older ones away meanwhile, so which of them
    depends."""
    return sum(
        link.recv(20, socket.MSG_PEEK).startswith(b'HTTP/1.1 503')
        for link in select.select(links, [], [], 0.05)[0]
    )


def test_ten_thousand_connections():
    with Server('--max-connections', '200') as server:
        kept = []
        for i in range(10_000):
            link = server.connect()
            kept.append(link)
            if len(kept) == 400:
                until(
                    'two hundred of four hundred are told',
                    lambda: ((told := told_that_it_is_busy(kept)) >= 200, told),
                )
                for old in kept:
                    old.close()
                kept = []
        for old in kept:
            old.close()
        # The last of them are still being put away.
        until('there is room for a connection again', lambda: server.ask('GET', '/metrics').status == 200)
        refused = server.metric('palpate_connections_refused_total')
        expect(refused >= 5000, refused)
        until(
            'no connection is left but the one that asks',
            lambda: ((left := server.metric('palpate_connections')) == 1, left),
        )
        up(server)


def test_clients_that_are_killed_leave_nothing():
    folder = Folder()
    folder.write(
        'path.csv',
        'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0.03,0,0,0,1,1\n0.2,0,0,0.018,0,0,0,1,1\n600,0,0,0.018,0,0,0,1,1\n',
    )
    folder.save(device={'driver': 'simulated', 'path': 'path.csv'})
    with Server('--root', folder.path) as server:
        name = server.ready(server.ask('POST', '/v1/scenes', {'path': 'scene.json'}))
        session = server.ask('POST', '/v1/sessions', {'scene': name}).json()['id']
        body = 'x,y,z,qx,qy,qz,qw\n' + '0,0,0.018,0,0,0,1\n' * 50_000
        head = (
            f'POST /v1/scenes/{name}/query HTTP/1.1\r\nHost: localhost\r\nContent-Type:'
            f' text/csv\r\nContent-Length: {len(body)}\r\n\r\n'
        )
        for _ in range(10):
            links = [
                WebSocket(server, f'/v1/sessions/{session}/stream'),
                WebSocket(server, f'/v1/scenes/{name}/haptic'),
            ]
            links[1].send({'type': 'pose', 'seq': 1, 'pose': PRESSED})
            batch = server.connect()
            batch.sendall((head + body).encode())
            batch.recv(10)
            for link in (batch, *(link.link for link in links)):
                # A reset, as of a process that is killed.
                link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('ii', 1, 0))
                link.close()
        names = ('palpate_viewers', 'palpate_loops', 'palpate_batches')
        until(
            'no viewer, loop or batch is left',
            lambda: ((left := {n: server.metric(n) for n in names}) == dict.fromkeys(names, 0), left),
            every_s=0.3,
        )
        expect(
            server.ask('GET', f'/v1/sessions/{session}').json()['state'] == 'running', 'the session goes on'
        )


def test_more_scenes_than_memory_are_evicted_and_come_back():
    folder = rooted()
    with Server('--root', folder.path) as server:
        name = server.ready(server.ask('POST', '/v1/scenes', {'path': 'scene.json'}))
        one = server.ask('GET', f'/v1/scenes/{name}').json()['memory_bytes']
    # A scene of its own is a bit larger than a MiB, or the budget, which is in MiB, could not be four of
    # them.
    budget = max(1, round(4.5 * one / 2**20))
    count = 24
    with Server('--memory', budget) as server:
        names = []
        for i in range(count):
            names.append(server.ready(server.upload(**files(folder), stiffness=str(1000 + i))))
        scenes = {s['id']: s for s in server.ask('GET', '/v1/scenes').json()['scenes']}
        expect(set(scenes) == set(names), 'a scene was lost')
        ready = [n for n in names if scenes[n]['state'] == 'ready']
        fit = budget * 2**20 // one
        expect(
            len(ready) == min(fit, count) and ready == names[-len(ready) :], (len(ready), fit, one, budget)
        )
        expect(all(scenes[n]['state'] == 'evicted' for n in names if n not in ready), scenes)
        expect(server.metric('palpate_scene_memory_bytes') <= budget * 2**20, 'budget')
        # The first comes back when it is asked for.
        if names[0] not in ready:
            told = problem(server.ask('POST', f'/v1/scenes/{names[0]}/query', {'pose': PRESSED}), 503, 'busy')
            expect('again' in told['detail'], told)
        scene = server.settled(names[0])
        expect(scene['state'] == 'ready' and scene['stiffness'] == 1000, scene)
        expect(
            json.loads(server.ask('POST', f'/v1/scenes/{names[0]}/query', {'pose': PRESSED}).body)['contact'],
            'answers again',
        )
        # What is in use stays.
        session = server.ask('POST', '/v1/sessions', {'scene': names[0], 'duration_s': 600}).json()
        expect(session['state'] == 'running', session)
        for i in range(int(fit) + 1):
            server.ready(server.upload(**files(folder), stiffness=str(5000 + i)))
        expect(
            server.ask('GET', f'/v1/scenes/{names[0]}').json()['state'] == 'ready',
            'a scene in use was evicted',
        )


main(globals())
