// Stands in for the server while the viewer is worked on: node stand_in.mjs SITE ENGINE RUNS [PORT].
// SITE: the bundled viewer. ENGINE: what `palpate generate` writes (mockup.stl, tool.stl). RUNS: a folder
// with a folder for each `palpate run --out`. Sessions replay the first run; the haptic loop answers with the
// frame of that run that was judged nearest to the pose.
import {createHash} from 'node:crypto';
import {existsSync, readdirSync, readFileSync, statSync} from 'node:fs';
import {createServer} from 'node:http';
import {join} from 'node:path';

const [site, engine, runs_folder, port = '8090'] = process.argv.slice(2);
const types = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript',
  '.css': 'text/css'
};

/** Binary STL: one corner list, points welded by their bytes. */
function read_stl(path) {
  const bytes = readFileSync(path);
  const count = bytes.readUInt32LE(80);
  const vertices = [], corners = new Uint32Array(3 * count), known = new Map();
  for (let i = 0; i < 3 * count; ++i) {
    const at = 84 + 50 * Math.floor(i / 3) + 12 + 12 * (i % 3);
    const key = bytes.toString('latin1', at, at + 12);
    if (!known.has(key)) {
      known.set(key, vertices.length / 3);
      vertices.push(bytes.readFloatLE(at), bytes.readFloatLE(at + 4), bytes.readFloatLE(at + 8));
    }
    corners[i] = known.get(key);
  }
  return {
    vertices: Float32Array.from(vertices),
    corners,
    ids: Uint32Array.from({length: count}, (_, i) => i)
  };
}
const mockup = read_stl(join(engine, 'mockup.stl')), tool = read_stl(join(engine, 'tool.stl'));

function geometry() {
  const head = Buffer.alloc(32);
  head.write('PGEO');
  [1, 0, mockup.vertices.length / 3, mockup.ids.length, tool.vertices.length / 3, tool.ids.length, 0].forEach(
      (value, i) => head.writeUInt32LE(value, 4 + 4 * i));
  return Buffer.concat([
    head,
    ...[mockup, tool].flatMap(
        (body) => [body.vertices, body.corners, body.ids].map((array) => Buffer.from(array.buffer)))
  ]);
}

/** An area of a frame as a plane about a pose's own place. */
const plane_of = (pose) => ({normal, point, depth, force}) => {
  const [x, y, z] = [0, 1, 2].map((k) => point[k] - pose[k]), [a, b, c] = normal, size = Math.hypot(...force);
  return {normal, lever: [y * c - z * b, z * a - x * c, x * b - y * a], force: size, stiffness: size / depth};
};

const run_names = readdirSync(runs_folder).filter((name) => existsSync(join(runs_folder, name, 'trace.csv')));
const lines = (file) => readFileSync(join(runs_folder, run_names[0], file), 'utf8').trim().split('\n');
const rows = lines('trace.csv').slice(1).map((line) => line.split(',').map(Number));
const frames = lines('frames.jsonl').map((line) => JSON.parse(line));
for (const frame of frames)
  for (const area of frame.areas)
    Object.assign(area, {rays: 40, height_mean: area.depth, height_max: 1.7 * area.depth});

const bounds = {
  min: [0, 1, 2].map(
      (axis) =>
          mockup.vertices.reduce((least, v, i) => (i % 3 === axis ? Math.min(least, v) : least), Infinity)),
  max: [0, 1, 2].map(
      (axis) =>
          mockup.vertices.reduce((most, v, i) => (i % 3 === axis ? Math.max(most, v) : most), -Infinity))
};
const scene = {
  id: 'a'.repeat(32),
  name: 'disassembly',
  state: 'queued',
  step: null,
  progress: null,
  error: null,
  profile: 'refined',
  stiffness: 2000,
  static_triangles: mockup.ids.length,
  tool_triangles: tool.ids.length,
  memory_bytes: 5e7,
  backend: 'gpu',
  device: 'stand-in',
  voxel_size: 0.004,
  bounds,
  tool_radius: 0.066,
  tool_gc: [0, 0, 0],
  start: rows[0].slice(1, 8),
  stages: [
    'initial position', 'against the first obstacle', 'upper part of the obstacle', 'against the pipe',
    'against the pipe', 'final position'
  ],
  driver: 'simulated',
  warnings: [],
  users: 0
};
let opened = false, session = null, paused = false, tick = 0;

const session_json = () => ({
  id: 's1',
  scene: scene.id,
  device: 'simulated',
  state: session,
  started: '',
  duration_s: null,
  record: null,
  viewers: 1,
  tick,
  time_s: tick / 1000,
  error: null,
  summary: null
});

createServer((request, response) => {
  const url = new URL(request.url, 'http://localhost');
  const json = (value, status = 200) => {
    response.writeHead(
        status, {'Content-Type': status < 400 ? 'application/json' : 'application/problem+json'});
    response.end(JSON.stringify(value));
  };
  const bytes = (value) => {
    response.writeHead(200, {'Content-Type': 'application/octet-stream'});
    response.end(value);
  };
  const path = decodeURIComponent(url.pathname).replace(/^\/v1/, '');
  let body = '';
  request
      .on('data',
          (piece) => {
            body += piece;
          })
      .on('end', () => {
        const what = `${request.method} ${path}`;
        if (path === '/readyz') return json({});
        if (what === 'GET /scenes')
          return json({scenes: opened ? [scene] : [], available: ['engine/scene.json']});
        if (what === 'POST /scenes') {
          opened = true;
          scene.state = 'preparing';
          scene.step = 'voxels';
          scene.progress = 0.4;
          setTimeout(() => {
            scene.state = 'ready';
          }, 300);
          return json(scene, 202);
        }
        if (path === `/scenes/${scene.id}`)
          return opened ? json(scene) : json({title: 'Not found', status: 404, detail: 'no such scene'}, 404);
        if (path.endsWith('/geometry')) return bytes(geometry());
        if (path.endsWith('/voxels')) {
          const size = 0.01, counts = [106, 85, 51], cells = new Set();
          for (let i = 0; i < mockup.vertices.length; i += 3)
            cells.add([0, 1, 2].reduce(
                (sum, axis) => sum +
                    Math.floor((mockup.vertices[i + axis] - bounds.min[axis]) / size) *
                        [1, counts[0], counts[0] * counts[1]][axis],
                0));
          const head = Buffer.alloc(72);
          head.write('PVOX');
          head.writeUInt32LE(1, 4);
          head.writeUInt32LE(1, 8);
          [...bounds.min, size].forEach((value, i) => head.writeDoubleLE(value, 16 + 8 * i));
          counts.forEach((value, i) => head.writeUInt32LE(value, 48 + 4 * i));
          head.writeBigUInt64LE(BigInt(cells.size), 64);
          return bytes(Buffer.concat([head, Buffer.from(Uint32Array.from(cells).buffer)]));
        }
        if (path === '/devices')
          return json({
            devices: [
              {kind: 'haptic', name: 'simulated', usable: true, reason: ''},
              {kind: 'haptic', name: 'falcon', usable: false, reason: 'none on the bus'}
            ]
          });
        if (what === 'GET /sessions') return json({sessions: session ? [session_json()] : []});
        if (what === 'POST /sessions') {
          session = 'running';
          tick = 1900;
          return json(session_json(), 201);
        }
        if (path === '/sessions/s1/pause' || path === '/sessions/s1/resume') {
          paused = path.endsWith('pause');
          return json(session_json());
        }
        if (what === 'DELETE /sessions/s1') {
          session = 'ended';
          return json(session_json());
        }
        if (path === '/runs') {
          return json({
            runs: run_names.map((name) => ({
                                  name,
                                  files: Object.fromEntries(['trace.csv', 'frames.jsonl'].map(
                                      (file) => [file, statSync(join(runs_folder, name, file)).size])),
                                  modified: 0,
                                  static_triangles: mockup.ids.length,
                                  tool_triangles: tool.ids.length,
                                  backend: 'gpu',
                                  ticks: rows.length
                                }))
          });
        }
        if (path.startsWith('/runs/')) return bytes(readFileSync(join(runs_folder, path.slice(6))));
        const file = join(site, path === '/' ? 'index.html' : path);
        if (!existsSync(file)) return json({title: 'Not found', status: 404, detail: path}, 404);
        response.writeHead(200, {'Content-Type': types[file.slice(file.lastIndexOf('.'))] ?? 'text/plain'});
        response.end(readFileSync(file));
      });
})
    .on('upgrade',
        (request, socket) => {
          const key =
              createHash('sha1')
                  .update(`${request.headers['sec-websocket-key']}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`)
                  .digest('base64');
          socket.write(
              `HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${
                  key}\r\n\r\n`);
          const send = (value) => {
            const data = Buffer.from(JSON.stringify(value));
            const head = data.length < 126 ?
                Buffer.from([0x81, data.length]) :
                data.length < 65536 ?
                Buffer.from([0x81, 126, data.length >> 8, data.length & 255]) :
                Buffer.from(
                    [0x81, 127, 0, 0, 0, 0, ...[24, 16, 8, 0].map((shift) => (data.length >> shift) & 255)]);
            if (!socket.destroyed) socket.write(Buffer.concat([head, data]));
          };
          socket.on('error', () => {});
          if (request.url.includes('/stream')) {
            send({
              type: 'hello',
              session: 's1',
              scene: scene.id,
              stiffness: 2000,
              device: 'simulated',
              max_force: 10,
              stages: scene.stages
            });
            let seq = 0;
            const timer = setInterval(() => {
              if (session === 'ended') {
                send({type: 'bye', reason: 'stopped'});
                clearInterval(timer);
                socket.end();
                return;
              }
              if (!paused) tick = (tick + 16) % rows.length;
              const row = rows[tick], frame = frames.findLast((candidate) => candidate.tick <= tick) ?? null;
              send({
                type: 'telemetry',
                seq: ++seq,
                dropped: 0,
                tick,
                time_s: tick / 1000,
                pose: row.slice(1, 8),
                force: row.slice(8, 11),
                torque: row.slice(11, 14),
                response_force: row.slice(14, 17),
                response_torque: row.slice(17, 20),
                result_age_ticks: row[20],
                contact: row[21] !== 0,
                stage: row[22],
                lateness_us: 20,
                lateness_max_us: 40 + 30 * Math.random(),
                missed_ticks: 0,
                frame_us: frame?.time_us.total ?? 0,
                paused,
                frame,
                frame_pose: row.slice(1, 8)
              });
            }, 16);
            socket.on('close', () => clearInterval(timer));
            return;
          }
          send({
            type: 'hello',
            scene: scene.id,
            stiffness: 2000,
            watchdog_ms: 100,
            tool_gc: [0, 0, 0],
            start: scene.start
          });
          let pending = Buffer.alloc(0);
          socket.on('data', (piece) => {
            pending = Buffer.concat([pending, piece]);
            for (;;) {
              if (pending.length < 6) return;
              const short = pending[1] & 127, at = short === 126 ? 4 : 2,
                    size = short === 126 ? pending.readUInt16BE(2) : short;
              if (pending.length < at + 4 + size) return;
              const mask = pending.subarray(at, at + 4),
                    data = Buffer.from(pending.subarray(at + 4, at + 4 + size))
                               .map((byte, i) => byte ^ mask[i % 4]);
              const code = pending[0] & 15;
              pending = pending.subarray(at + 4 + size);
              if (code === 8) {
                socket.end(Buffer.from([0x88, 0]));
                return;
              }
              const {seq, time, pose} = JSON.parse(data.toString());
              const far = (row) => Math.hypot(row[1] - pose[0], row[2] - pose[1], row[3] - pose[2]);
              let best = 0;
              for (let i = 0; i < rows.length; i += 20)
                if (far(rows[i]) < far(rows[best])) best = i;
              const near = far(rows[best]) < 0.004 ?
                  (frames.findLast((candidate) => candidate.tick <= best) ?? frames[0]) :
                  frames[0];
              send({
                type: 'wrench',
                seq,
                time,
                skipped: 0,
                server_us: 800,
                contact: near.contact,
                truncated: false,
                pairs: near.pairs,
                gc: pose.slice(0, 3),
                force: near.force,
                torque: near.torque,
                areas: [],
                planes: near.areas.filter(({depth}) => depth > 0).map(plane_of(pose)),
                frame: near
              });
            }
          });
        })
    .listen(Number(port), '127.0.0.1', () => console.log(`listening on ${port}`));
