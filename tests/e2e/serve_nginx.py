"""service/deploy/nginx.conf spreads queries over two servers, and goes on with one."""
import shutil
import subprocess

from harness import *
from server import *


def free_port():
    with socket.socket() as link:
        link.bind(('127.0.0.1', 0))
        return link.getsockname()[1]


def test_queries_are_spread_and_survive_a_server():
    nginx = shutil.which('nginx') or shutil.which('/usr/sbin/nginx')
    expect(nginx, 'nginx is missing (scripts/packages.txt)')
    folder = Folder()
    folder.save()
    with Server('--root', folder.path) as one, Server('--root', folder.path) as two:
        name, same = (
            server.ready(server.ask('POST', '/v1/scenes', {'path': 'scene.json'})) for server in (one, two)
        )
        expect(name == same, 'the same content has the same id everywhere')
        port = free_port()
        ours = (
            (SOURCE / 'service' / 'deploy' / 'nginx.conf')
            .read_text()
            .replace('127.0.0.1:8090', f'127.0.0.1:{one.port}')
            .replace('127.0.0.1:8091', f'127.0.0.1:{two.port}')
            .replace('127.0.0.1:8089', f'127.0.0.1:{port}')
        )
        temporary = ''.join(
            f'{kind}_temp_path {folder.path}/{kind};'
            for kind in ('client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi')
        )
        conf = folder.write(
            'nginx.conf',
            (
                f'worker_processes 1; daemon off; pid {folder.path}/pid; error_log {folder.path}/error.log;'
                f' events {{}} http {{ access_log off; {temporary} {ours} }}'
            ),
        )
        proxy = subprocess.Popen([nginx, '-e', folder / 'error.log', '-c', conf], stderr=subprocess.PIPE)
        try:

            def listens():
                expect(proxy.poll() is None, 'nginx ended')
                with socket.socket() as link:
                    return link.connect_ex(('127.0.0.1', port)) == 0

            until('nginx listens', listens)

            def ask():
                connection = http.client.HTTPConnection('127.0.0.1', port, timeout=WAIT_S)
                connection.request(
                    'POST',
                    f'/v1/scenes/{name}/query',
                    json.dumps({'pose': [0, 0, 0.018, 0, 0, 0, 1]}),
                    {'Content-Type': 'application/json'},
                )
                answer = connection.getresponse()
                body = answer.read()
                connection.close()
                expect(answer.status == 200, body)
                return re.sub(rb'"time_us":\{[^}]*\}', b'', body)

            answers = {ask() for _ in range(40)}
            expect(len(answers) == 1, answers)
            shares = [server.metric('palpate_poses_total') for server in (one, two)]
            expect(sum(shares) == 40 and min(shares) >= 10, f'{shares}: not spread')
            expect(two.stop() == 0, 'stop')
            expect({ask() for _ in range(20)} == answers, 'with one server')
        finally:
            proxy.terminate()
            proxy.wait(WAIT_S)


main(globals())
