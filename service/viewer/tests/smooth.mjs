// How long a picture of a large mock-up takes while the camera turns, with the viewer's levels of detail and with everything drawn:
// node smooth.mjs PALPATE WORK [TRIANGLES], in the build's service/viewer/work. Prints a line of JSON for each; no test, since it is the machine that decides.
// Environment: CHROMIUM; BACKEND (gpu); SECONDS (20) of turning before what counts, and 10 that count.
import { spawn, spawnSync } from 'node:child_process';
import { mkdirSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { createServer } from 'node:net';
import { join } from 'node:path';

const [palpate, work, triangles = '1000000'] = process.argv.slice(2);
const settle_s = Number(process.env.SECONDS ?? 20);
const { chromium } = createRequire(join(process.cwd(), 'package.json'))('playwright-core');

rmSync(work, { recursive: true, force: true });
const root = join(work, 'root');
mkdirSync(root, { recursive: true });
const made = spawnSync(palpate, ['generate', 'disassembly', '--triangles', triangles, '--out', join(root, 'engine')], { encoding: 'utf8' });
if (made.status !== 0) throw new Error(made.stderr);
const port = await new Promise((resolve) => { const probe = createServer().listen(0, '127.0.0.1', () => { const { port: free } = probe.address(); probe.close(() => resolve(free)); }); });
const server = spawn(palpate, ['serve', '--listen', `127.0.0.1:${port}`, '--root', root, '--backend', process.env.BACKEND ?? 'gpu'], { stdio: 'ignore' });
const address = `http://127.0.0.1:${port}/`;
for (let i = 0; i < 200 && !(await fetch(`${address}readyz`).then((answer) => answer.ok, () => false)); ++i) await new Promise((resolve) => setTimeout(resolve, 100));

/** Turns the camera by a little at every picture, as a hand on the mouse does; the times between pictures, ms. */
const turn = (page, seconds) => page.evaluate((lasts) => new Promise((resolve) => {
  const canvas = document.querySelector('#canvas canvas');
  const box = canvas.getBoundingClientRect();
  let x = box.x + box.width * 0.1;
  const y = box.y + box.height * 0.1, times = [];
  const event = (type) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, pointerType: 'mouse', clientX: x, clientY: y, button: 0, buttons: type === 'pointerup' ? 0 : 1, bubbles: true }));
  canvas.setPointerCapture = canvas.releasePointerCapture = () => {};   // there is no such pointer
  event('pointerdown');
  const began = performance.now();
  let last = began;
  const step = (now) => {
    times.push(now - last);
    last = now;
    x += 3;
    event('pointermove');
    if (now - began < 1000 * lasts) requestAnimationFrame(step);
    else { event('pointerup'); resolve(times); }
  };
  requestAnimationFrame(step);
}), seconds);

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--headless', '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
  '--disable-dev-shm-usage', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
try {
  for (const all of [false, true]) {
    const page = await browser.newPage({ viewport: { width: 1000, height: 640 } });
    page.setDefaultTimeout(300_000);
    if (all) await page.route('**/geometry*', (route) => route.continue({ url: route.request().url().replace(/max_triangles=\d+/, 'max_triangles=10000000') }));
    await page.goto(address);
    const file = page.locator('#empty-list button:has-text("engine/scene.json")');   // not offered where the server holds the scene already
    for (let asked = false; !/[0-9]/.test(await page.textContent('#facts')); await new Promise((resolve) => setTimeout(resolve, 100))) {
      if (!asked && await file.isVisible()) { asked = true; await file.click(); }
    }
    await turn(page, settle_s);
    const times = (await turn(page, 10)).slice(1).sort((a, b) => a - b);
    const drawn = /drawn: ([0-9,]+)/.exec(await page.textContent('body'))?.[1] ?? 'all';
    const at = (share) => Math.round(times[Math.min(times.length - 1, Math.floor(share * times.length))] * 10) / 10;
    console.log(JSON.stringify({ levels: !all, mockup: Number(triangles), drawn, pictures: times.length, mean_ms: Math.round(10 * times.reduce((a, b) => a + b, 0) / times.length) / 10, p50_ms: at(0.5), p95_ms: at(0.95), longest_ms: at(1) }));
    await page.close();
  }
} finally {
  await browser.close();
  server.kill('SIGTERM');
}
