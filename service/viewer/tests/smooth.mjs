// How smooth the viewer is on a large mock-up, with its levels of detail and with everything drawn: while the
// scene loads, while the camera turns, while a recorded run plays. node smooth.mjs PALPATE WORK [TRIANGLES
// [SCREENSHOTS]], in the build's service/viewer/work. Prints a line of JSON for each; no test, since it is
// the machine that decides. Of each phase: times between pictures and of the page's own work for each;
// triangles and bytes handed to WebGL for a picture, the largest; the page's main thread when it was busy for
// more than 50 ms (longtask); and the processor time that each kind of process used for a picture
// (gpu-process: SwiftShader). WORK is used again where it holds the scene. Environment: CHROMIUM; BACKEND
// (gpu); SECONDS (20) of turning before what counts, and 10 that count.
import {spawn, spawnSync} from 'node:child_process';
import {existsSync, mkdirSync} from 'node:fs';
import {createRequire} from 'node:module';
import {createServer} from 'node:net';
import {join} from 'node:path';

import {count_drawing} from './count_drawing.mjs';
import {processor_times, used_since} from './processor_time.mjs';

const [palpate, work, triangles = '1000000', pictures] = process.argv.slice(2);
const settle_s = Number(process.env.SECONDS ?? 20);
const {chromium} = createRequire(join(process.cwd(), 'package.json'))('playwright-core');
const backend = process.env.BACKEND ?? 'gpu';

const root = join(work, 'root');
const run = (...args) => {
  const {status, stderr} = spawnSync(palpate, args, {encoding: 'utf8'});
  if (status !== 0) throw new Error(`palpate ${args.join(' ')}: ${status} ${stderr}`);
};
mkdirSync(root, {recursive: true});
if (!existsSync(join(root, 'engine')))
  run('generate', 'disassembly', '--triangles', triangles, '--out', join(root, 'engine'));
if (!existsSync(join(root, 'first')))
  run('run', join(root, 'engine/scene.json'), '--pace', 'asap', '--backend', backend, '--duration', '8',
      '--out', join(root, 'first'));
const port = await new Promise((resolve) => {
  const probe = createServer().listen(0, '127.0.0.1', () => {
    const {port: free} = probe.address();
    probe.close(() => resolve(free));
  });
});
const server = spawn(
    palpate, ['serve', '--listen', `127.0.0.1:${port}`, '--root', root, '--backend', backend],
    {stdio: 'ignore'});
const address = `http://127.0.0.1:${port}/`;
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
for (let i = 0; i < 200 && !(await fetch(`${address}readyz`).then((answer) => answer.ok, () => false)); ++i)
  await pause(100);
// The scene is prepared before the first page asks for it: that is not what is measured.
const {id} = await (await fetch(`${address}v1/scenes`, {
               method: 'POST',
               headers: {'Content-Type': 'application/json'},
               body: JSON.stringify({path: 'engine/scene.json'})
             })).json();
while ((await (await fetch(`${address}v1/scenes/${id}?wait=60`)).json()).state !== 'ready')
  ;

/** Turns the camera by a little at every picture, as a hand on the mouse does. */
const turn = (page, seconds) => page.evaluate(
    (lasts) => new Promise((resolve) => {
      const canvas = document.querySelector('#canvas canvas');
      const box = canvas.getBoundingClientRect();
      let x = box.x + box.width * 0.1;
      const y = box.y + box.height * 0.1;
      const event = (type) => canvas.dispatchEvent(new PointerEvent(type, {
        pointerId: 1,
        pointerType: 'mouse',
        clientX: x,
        clientY: y,
        button: 0,
        buttons: type === 'pointerup' ? 0 : 1,
        bubbles: true
      }));
      canvas.setPointerCapture = canvas.releasePointerCapture = () => {};  // there is no such pointer
      event('pointerdown');
      const began = performance.now();
      const step = (now) => {
        x += 3;
        event('pointermove');
        if (now - began < 1000 * lasts)
          requestAnimationFrame(step);
        else {
          event('pointerup');
          resolve();
        }
      };
      requestAnimationFrame(step);
    }),
    seconds);

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: [
    '--headless', '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage',
    '--enable-unsafe-swiftshader'  // as in page_harness.mjs
  ]
});
try {
  for (const all of [false, true]) {
    const page = await browser.newPage({viewport: {width: 1000, height: 640}});
    page.setDefaultTimeout(300_000);
    await page.addInitScript(count_drawing);
    let bytes = 0;
    page.on('response', (answer) => {
      if (answer.url().includes('/geometry')) bytes += Number(answer.headers()['content-length']);
    });
    if (all)
      await page.route('**/geometry*', (route) => route.continue({
        url: route.request().url().replace(/max_triangles=\d+/, 'max_triangles=10000000')
      }));
    let before = processor_times();
    const rounded = (value) => Math.round(10 * value) / 10;
    const told = async (phase) => {
      const {pictures: list, tasks} = await page.evaluate(() => window.drawing.take());
      const times = (key) => {
        const all_times = list.map((picture) => picture[key]).filter(Number.isFinite).sort((a, b) => a - b);
        return [0.5, 0.95, 1].map(
            (share) => rounded(
                all_times[Math.min(all_times.length - 1, Math.floor(share * all_times.length))] ?? NaN));
      };
      const most = (key) => Math.max(0, ...list.map((picture) => picture[key]));
      console.log(JSON.stringify({
        levels: !all,
        mockup: Number(triangles),
        phase,
        pictures: list.length,
        between_ms_p50_p95_max: times('between'),
        script_ms_p50_p95_max: times('script'),
        triangles: most('triangles'),
        uploaded: most('uploaded'),
        longtasks: tasks.length,
        longest_task_ms: rounded(Math.max(0, ...tasks)),
        geometry_bytes: bytes,
        processor_ms_a_picture: used_since(before, list.length)
      }));
      before = processor_times();
      bytes = 0;
    };
    const photo = async (name) => {
      if (pictures) {
        mkdirSync(pictures, {recursive: true});
        await page.screenshot({path: join(pictures, `${all ? 'all' : 'levels'}_${name}.png`)});
      }
    };
    await page.goto(address);
    while (!/[0-9]/.test(await page.textContent('#facts'))) await pause(100);
    await pause(1000);
    await told('load');
    await photo('load');
    await turn(page, settle_s);
    await told('settle');
    await turn(page, 10);
    await told('turn');
    await photo('turn');
    await page.click('[data-source=run]');
    while (!/ticks/.test(await page.textContent('#run-note'))) await pause(100);
    await page.keyboard.press('f');
    await pause(1000);
    await told('run read');
    await page.click('#play');
    await pause(10_000);
    await told('play');
    await photo('play');
    await page.close();
  }
} finally {
  await browser.close();
  server.kill('SIGTERM');
}
