// Asks a palpate server for contact: node query.mjs http://127.0.0.1:8090 contacts/scene.json
//
// Names a scene file below the server's root, waits until it is prepared, asks three poses. Node 18 or later,
// or a browser; no packages.
const [server, path] = process.argv.slice(2);

async function ask(method, where, body) {
  const answer = await fetch(server + where, {
    method,
    headers: {'Content-Type': 'application/json'},
    body: body === undefined ? undefined : JSON.stringify(body),
  });
  const text = await answer.text();
  if (!answer.ok) throw new Error(JSON.parse(text).detail);
  return text;
}

let scene = JSON.parse(await ask('POST', '/v1/scenes', {path}));
while (scene.state !== 'ready' && scene.state !== 'failed')
  scene = JSON.parse(await ask('GET', `/v1/scenes/${scene.id}?wait=30`));
if (scene.state === 'failed') throw new Error(scene.error.detail);

const [x, y, z, ...rotation] = scene.start;  // metres, unit quaternion x y z w, world from tool
const poses = [0, 1, 2].map((step) => [x, y, z - 0.01 * step, ...rotation]);
for (const line of (await ask('POST', `/v1/scenes/${scene.id}/query`, {poses})).trim().split('\n')) {
  const answer = JSON.parse(line);
  console.log(
      answer.number, answer.contact, JSON.stringify(answer.force), 'N', JSON.stringify(answer.torque), 'N·m');
}
