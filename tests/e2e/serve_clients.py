"""The example clients of service/clients do what they say."""
import shutil
import subprocess

from harness import *
from server import *


def run(*command):
    done = subprocess.run([*map(str, command)], capture_output=True, timeout=WAIT_S)
    expect(done.returncode == 0, done.stderr.decode())
    return done.stdout.decode().splitlines()


def with_scene(client):
    folder = Folder()
    folder.write(
        'path.csv', 'time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage\n0,0,0,0.0345,0,0,0,1,1\n1,0,0,0.03,0,0,0,1,1\n'
    )
    folder.save(device={'driver': 'simulated', 'path': 'path.csv'})
    with Server('--root', folder.path) as server:
        lines = run(*client, f'http://127.0.0.1:{server.port}', 'scene.json')
    # 34.5, 24.5 and 14.5 mm above a block, a ball of 20 mm.
    expect([line.split()[1].lower() for line in lines] == ['false', 'false', 'true'], lines)
    return lines


def test_python():
    with_scene(['python3', SOURCE / 'service' / 'clients' / 'query.py'])


def test_javascript():
    node = shutil.which('node')
    if not node:
        print('skipped: node is not there; it is needed for the viewer and this client alone')
        return
    with_scene([node, SOURCE / 'service' / 'clients' / 'query.mjs'])


main(globals())
