"""/openapi.json says what `palpate serve` really answers, and lists what docs/SERVICE.md lists."""
import subprocess

from harness import *
from server import *

JUDGE = os.path.join(os.path.dirname(PROGRAM), 'openapi_judge')
PRESSED = [0, 0, 0.018, 0, 0, 0, 1]


def judged(openapi, answers):
    done = subprocess.run(
        [JUDGE],
        input=json.dumps(
            {'openapi': openapi, 'answers': [{'schema': s, 'answer': a} for s, a in answers]}
        ).encode(),
        capture_output=True,
        timeout=WAIT_S,
    )
    return done.returncode, done.stdout.decode() + done.stderr.decode()


def test_real_answers_fit_their_schemas():
    folder = Folder()
    folder.write(
        'path.csv',
        'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0.03,0,0,0,1,1\n0.2,0,0,0.018,0,0,0,1,1\n60,0,0,0.018,0,0,0,1,1\n',
    )
    folder.save(device={'driver': 'simulated', 'path': 'path.csv'})
    folder.write('broken.stl', b'no mesh')
    folder.save('bad.json', tool={'mesh': 'broken.stl', 'units': 'm'})
    seen = []
    with Server('--root', folder.path) as server:

        def take(schema, method, path, body=None, **more):
            answer = server.ask(method, path, body, **more)
            seen.append((schema, answer.json()))
            return answer.json()

        openapi = server.ask('GET', '/openapi.json').json()
        for schema, path in (
            ('Alive', '/healthz'),
            ('Ready', '/readyz'),
            ('Info', '/v1/info'),
            ('Devices', '/v1/devices'),
            ('Scenes', '/v1/scenes'),
        ):
            take(schema, 'GET', path)
        name = take('Scene', 'POST', '/v1/scenes', {'path': 'scene.json'})['id']
        failed = take('Scene', 'POST', '/v1/scenes', {'path': 'bad.json'})['id']
        for id_, state in ((name, 'ready'), (failed, 'failed')):
            expect(server.settled(id_)['state'] == state, state)
            take('Scene', 'GET', f'/v1/scenes/{id_}')
        take('Scenes', 'GET', '/v1/scenes')
        take('SceneParts', 'GET', f'/v1/scenes/{name}/parts')
        body, kind = form({'file': [('ball.stl', (folder.path / 'ball.stl').read_bytes())]})
        seen.append(('Assembly', server.ask('POST', '/v1/assemblies', body, {'Content-Type': kind}).json()))
        assembly = seen[-1][1]['id']
        until(
            'the assembly is read',
            lambda: server.ask('GET', f'/v1/assemblies/{assembly}').json()['state'] == 'ready',
        )
        take('Assembly', 'GET', f'/v1/assemblies/{assembly}')
        made = {'static': [{'mesh': 'ball.stl', 'units': 'm'}], 'tool': {'mesh': 'ball.stl', 'units': 'm'}}
        take('Scene', 'POST', f'/v1/assemblies/{assembly}/scene', {'scene': made})
        take('SavedScene', 'POST', f'/v1/assemblies/{assembly}/save', {'scene': made, 'folder': 'saved'})
        for path in ('', '?sets=0'):
            take('Answer', 'POST', f'/v1/scenes/{name}/query{path}', {'pose': PRESSED})
        session = take('Session', 'POST', '/v1/sessions', {'scene': name, 'record': 'one'})['id']
        with WebSocket(server, f'/v1/sessions/{session}/stream') as viewer:
            seen.append(('Hello', viewer.json()))
            framed = False
            while not framed:
                message = viewer.json()
                framed = bool(message['frame'] and message['frame']['areas'])
                seen.append(('Telemetry', message))
            take('Session', 'POST', f'/v1/sessions/{session}/pause')
            take('Session', 'DELETE', f'/v1/sessions/{session}')
            while (message := viewer.json())['type'] != 'bye':
                pass
            seen.append(('Bye', message))
        take('Sessions', 'GET', '/v1/sessions')
        take('Runs', 'GET', '/v1/runs')
        with WebSocket(server, f'/v1/scenes/{name}/haptic') as loop:
            seen.append(('HapticHello', loop.json()))
            for full in (False, True):
                pose = {'type': 'pose', 'seq': 1, 'time': 0.5, 'pose': PRESSED, 'full': full, 'near': full}
                loop.send(pose)
                seen += [('PoseMessage', pose), ('Wrench', loop.json())]
            loop.send('{}')
            seen.append(('ErrorMessage', loop.json()))
        for path in ('/v1/scenes/none', '/no'):
            take('Problem', 'GET', path)
    code, text = judged(openapi, seen)
    expect(code == 0, text)
    unseen = (
        set(openapi['components']['schemas'])
        - {schema for schema, _ in seen}
        - {
            'Vector',
            'Pose',
            'PartList',
            'Run',
            'NameScene',
            'UploadScene',
            'UploadAssembly',
            'MakeScene',
            'SaveScene',
            'Query',
            'StartSession',
        }
    )
    expect(not unseen, f'nothing was held against {unseen}')


def test_the_judge_sees_a_missing_and_a_strange_key():
    openapi = json.loads((SOURCE / 'service' / 'server' / 'openapi.json').read_text())
    expect(judged(openapi, [('Alive', {'alive': True})])[0] == 0, 'fits')
    for wrong in ({}, {'alive': True, 'more': 1}, {'alive': 'yes'}):
        expect(judged(openapi, [('Alive', wrong)])[0] == 1, wrong)


def test_it_lists_what_the_documentation_lists_and_all_of_it_is_there():
    openapi = json.loads((SOURCE / 'service' / 'server' / 'openapi.json').read_text())
    listed = {
        (method.upper(), path) for path, operations in openapi['paths'].items() for method in operations
    }
    text = (SOURCE / 'docs' / 'SERVICE.md').read_text()
    told = set()
    for line in re.findall(r'^\| (`(?:GET|POST|DELETE) .*?) \|', text, re.M):
        base = None
        for part in re.findall(r'`([^`]+)`', line):
            if part.startswith('…'):
                told.add((told_method, base.rsplit('/', 1)[0] + part[1:]))
                continue
            told_method, path = part.split(' ', 1)
            base = re.sub(r'\?.*', '', re.sub(r'\[.*', '', path))
            told.add((told_method, base))
    expect(told == listed, f'only in docs/SERVICE.md: {told - listed}; only in openapi.json: {listed - told}')
    with Server() as server:
        for method, path in sorted(listed):
            answer = server.ask(
                method,
                path.replace('{id}', 'x').replace('{name}', 'x').replace('{file}', 'x'),
                b'' if method == 'POST' else None,
            )
            expect(
                answer.status != 405 and 'there is nothing at' not in answer.body.decode(errors='replace'),
                f'{method} {path}: {answer}',
            )


main(globals())
