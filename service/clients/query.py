"""Asks a palpate server for contact: python3 query.py http://127.0.0.1:8090 contacts/scene.json

Names a scene file below the server's root, waits until it is prepared, asks three poses. Python's standard
library only.
"""
import json
import sys
import urllib.request

if len(sys.argv) != 3:
    sys.exit(__doc__)
server, path = sys.argv[1].rstrip('/'), sys.argv[2]


def ask(method, where, body=None):
    request = urllib.request.Request(
        server + where,
        method=method,
        data=None if body is None else json.dumps(body).encode(),
        headers={'Content-Type': 'application/json'},
    )
    with urllib.request.urlopen(request) as answer:
        return answer.read()


scene = json.loads(ask('POST', '/v1/scenes', {'path': path}))
while scene['state'] not in ('ready', 'failed'):
    scene = json.loads(ask('GET', f"/v1/scenes/{scene['id']}?wait=30"))
if scene['state'] == 'failed':
    sys.exit(scene['error']['detail'])

start = scene['start']  # x y z qx qy qz qw: metres, unit quaternion, world from tool
poses = [[start[0], start[1], start[2] - 0.01 * step, *start[3:]] for step in range(3)]
for line in ask('POST', f"/v1/scenes/{scene['id']}/query", {'poses': poses}).splitlines():
    answer = json.loads(line)
    print(answer['number'], answer['contact'], answer['force'], 'N', answer['torque'], 'N·m')
