"""`palpate serve`: the planner's questions over HTTP, a scene's engine, and which files are scenes."""
import select
import threading

from harness import *
from server import *


def test_clearance_is_what_the_command_line_says():
    folder, arguments = rooted()
    rows = poses(40)
    folder.write('poses.csv', csv(rows))
    with Server(*arguments) as server:
        query = f'/v1/scenes/{named(server)}/query'
        answer = server.ask('POST', query + '?clearance=1', {'poses': rows})
        expect(answer.status == 200, answer)
        for wrong in ('?clearance=2', '?clearance=1&any=1'):
            expect(server.ask('POST', query + wrong, {'poses': rows}).status == 400, wrong)
        near = [
            server.ask('POST', query + asked, {'poses': rows})
            for asked in ('?within=0.003', '?clearance=1&within=0.003')
        ]
        none = server.ask('POST', query + '?within=0', {'poses': [[0, 0, 0.05, 0, 0, 0, 1]] * 200})
        expect(none.status == 200 and none.body == b'', none)
    told = palpate(
        'query', folder / 'scene.json', '--poses', folder / 'poses.csv', '--clearance', '--backend', 'cpu'
    )
    expect(told.code == 0, told)
    expect(answer.body.decode() == told.out, f'{answer.body[:300]} instead of {told.out[:300]}')
    lines = [json.loads(line) for line in told.out.splitlines()]
    expect(
        any(line['touches'] for line in lines) and any(line['clearance'] for line in lines),
        'touching and apart',
    )
    told = palpate(
        'query',
        folder / 'scene.json',
        '--poses',
        folder / 'poses.csv',
        '--within',
        '0.003',
        '--backend',
        'cpu',
    )
    kept = [json.loads(line)['clearance'] for line in told.out.splitlines()]
    expect(0 < len(kept) < 40 and max(kept) > 0, 'some, and some of them apart')
    for answer in near:
        expect(answer.status == 200 and answer.body.decode() == told.out, (answer, told.out[:300]))


def test_a_path_is_examined_beside_a_loop_on_the_scene():
    folder, arguments = rooted()
    down = [[0, 0, 0.06 - 0.001 * i, 0, 0, 0, 1] for i in range(50)]
    with Server(*arguments) as server:
        name = named(server)
        clear = server.ask('POST', f'/v1/scenes/{name}/path', {'poses': down[:5]})
        expect(
            clear.status == 200
            and clear.headers['Content-Type'].startswith('text/html')
            and 'The path is clear' in clear.body.decode(),
            clear,
        )
        expect('sandbox' in clear.headers['Content-Security-Policy'], 'it runs nothing')
        with WebSocket(server, f'/v1/scenes/{name}/haptic') as loop:
            loop.json()
            pages = {}
            asked = threading.Thread(
                target=lambda: pages.update(
                    one=server.ask('POST', f'/v1/scenes/{name}/path', {'poses': down})
                )
            )
            asked.start()
            for seq in range(1, 200):
                loop.send({'type': 'pose', 'seq': seq, 'time': 0, 'pose': down[seq % 50]})
                expect(loop.json()['seq'] == seq, 'the loop is answered meanwhile')
            asked.join()
        text = pages['one'].body.decode()
        expect(
            'The path is not clear' in text and 'scene.json' in text and folder.path.name not in text,
            text[:500],
        )
        expect(
            server.ask('POST', f'/v1/scenes/{name}/path', {'poses': []}).status == 400,
            'a path without a pose',
        )
        paper = server.ready(server.ask('POST', '/v1/scenes', {'path': 'scene.json', 'profile': 'paper'}))
        expect(server.ask('POST', f'/v1/scenes/{paper}/path', {'poses': down}).status == 409, 'paper')


def test_a_path_is_left_when_its_client_leaves():
    folder, arguments = rooted()
    down = [[0.0001 * (i % 7), 0, 0.018 - 0.0001 * (i % 11), 0, 0, 0, 1] for i in range(50_000)]
    with Server(*arguments) as server:
        name = named(server)
        body = json.dumps({'poses': down}).encode()
        request = (
            f'POST /v1/scenes/{name}/path HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json'
            f'\r\nContent-Length: {len(body)}\r\n\r\n'.encode() + body
        )

        def seen_busy(link):
            busy = server.ask('POST', f'/v1/scenes/{name}/path', {'poses': down[:2]}).status == 503
            return busy or select.select([link], [], [], 0)[0]

        answered = True
        while answered:  # refused, for the short path was being examined
            with server.connect() as link:
                link.sendall(request)
                until('a path is being examined', lambda: seen_busy(link))
                answered = select.select([link], [], [], 0)[0]
        until(
            'the log has the client that left',
            lambda: re.search(r'"path":"/v1/scenes/[^"]*/path","status":499', server.log_text()),
        )
        answer = server.ask('POST', f'/v1/scenes/{name}/path', {'poses': down[:2]})
        expect(answer.status == 200, answer)


def test_a_scene_has_the_engine_that_it_is_opened_with():
    folder, arguments = rooted()
    rows = poses(20)
    with Server(*arguments) as server:
        names = {
            engine: server.ready(
                server.ask(
                    'POST', '/v1/scenes', {'path': 'scene.json', **({'engine': engine} if engine else {})}
                )
            )
            for engine in ('', 'cpu', 'ref')
        }
        expect(len(set(names.values())) == 3, 'three scenes')
        answers = {
            engine: server.ask('POST', f'/v1/scenes/{name}/query', {'poses': rows}).body
            for engine, name in names.items()
        }
        expect(
            {
                json.loads(answers['ref'].splitlines()[0])['engine'],
                json.loads(answers['cpu'].splitlines()[0])['engine'],
            }
            == {'ref', 'cpu'},
            'each by its own',
        )
        paper = server.ready(
            server.ask('POST', '/v1/scenes', {'path': 'scene.json', 'engine': 'cpu', 'profile': 'paper'})
        )
        warned = json.loads(server.ask('GET', f'/v1/scenes/{paper}').body)['warnings']
        expect(any('cpu' in warning and 'ref answers' in warning for warning in warned), warned)
        shaders = server.ready(server.ask('POST', '/v1/scenes', {'path': 'scene.json', 'engine': 'gpu'}))
        distances = server.ask('POST', f'/v1/scenes/{shaders}/query?clearance=1', {'poses': rows})
        expect(distances.status == 409 and b'problem:conflict' in distances.body, distances)
        strip = lambda body: without_times(body).replace(b'"engine":"ref"', b'"engine":"cpu"')
        expect(strip(answers['ref']) == strip(answers['cpu']), 'and all alike')
        for wrong in ('none', 3, ''):
            expect(
                server.ask('POST', '/v1/scenes', {'path': 'scene.json', 'engine': wrong}).status == 400, wrong
            )


def test_what_is_listed_is_a_scene():
    folder, arguments = rooted()
    folder.write('summary.json', '{"static": {"triangles": 12}, "tool": {"triangles": 3}}')
    folder.write('words.json', '{"static": [], "tool": "a word"}')
    folder.write('torn.json', '{"static": [{"mesh": "block.stl"}], "tool": {"mesh"')
    with Server(*arguments) as server:
        expect(server.ask('GET', '/v1/scenes').json()['available'] == ['scene.json'], 'that one alone')


main(globals())
