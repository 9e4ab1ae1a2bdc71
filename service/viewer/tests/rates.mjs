// How many pictures a second, and how old the answers in them, while a tool is moved by the mouse where it
// lies in contact. node rates.mjs PALPATE WORK SCENE.json …, in the build's service/viewer/work. Prints a
// line of JSON for each scene; no test, since it is the machine that decides. The meshes that a scene names
// are copied below WORK. The tool is taken where it starts and led in a circle of 25 pixels at every picture.
// Of SECONDS (10): the time between pictures; how old the force of a picture is, from the question for it,
// and how old its contact triangles; the way to the server and back, and the server's own time; and the
// processor time that each kind of process used for a picture. Environment: CHROMIUM; BACKEND (cpu); SECONDS;
// PICTURES (a folder for a screenshot of each).
import {copyFileSync, mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {basename, dirname, isAbsolute, join} from 'node:path';

import {count_drawing} from './count_drawing.mjs';
import {open_browser, server_of, shown} from './page_harness.mjs';
import {processor_times, used_since} from './processor_time.mjs';

const [palpate, work, ...scenes] = process.argv.slice(2);
const seconds = Number(process.env.SECONDS ?? 10);
const root = join(work, 'root');
const names = scenes.map((file) => {
  const scene = JSON.parse(readFileSync(file, 'utf8'));
  const name = basename(file, '.json');
  mkdirSync(join(root, name), {recursive: true});
  for (const body of [...scene.static, scene.tool]) {
    const from = isAbsolute(body.mesh) ? body.mesh : join(dirname(file), body.mesh);
    copyFileSync(from, join(root, name, basename(from)));
    body.mesh = basename(from);
  }
  writeFileSync(join(root, name, 'scene.json'), JSON.stringify(scene));
  return name;
});

/** For the page's start: what the mouse's worker says, and how old it is in each picture. */
function count_answers() {
  const Real = window.Worker;
  const now = {force: NaN, frame: NaN};
  let trips = [], contacts = 0, answers = 0;
  window.Worker = class extends Real {
    constructor(...args) {
      super(...args);
      this.addEventListener('message', ({data}) => {
        if (data.type !== 'moment' || !(data.asked_at > 0)) return;
        const {frame_us, late, contact} = data.moment;
        if (data.frame) now.frame = data.asked_at;
        if (data.asked_at === now.force) return;  // the tool has moved on by the same answer
        now.force = data.asked_at;
        trips.push([late, frame_us / 1000]);
        ++answers;
        if (contact) ++contacts;
      });
    }
  };
  window.drawing.began = () => {
    const time = performance.timeOrigin + performance.now();
    return [time - now.force, time - now.frame];
  };
  window.answers = {
    take() {
      const taken = {trips, contacts, answers};
      trips = [];
      contacts = 0;
      answers = 0;
      return taken;
    },
  };
}

/** Takes the tool at a place of the page and leads it in a circle, a step a picture. */
const lead = (page, [x, y], lasts) => page.evaluate(
    ([left, top, time]) => new Promise((resolve) => {
      const canvas = document.querySelector('#canvas canvas');
      canvas.setPointerCapture = canvas.releasePointerCapture = () => {};  // there is no such pointer
      const event = (type, dx, dy) => canvas.dispatchEvent(new PointerEvent(type, {
        pointerId: 1,
        pointerType: 'mouse',
        clientX: left + dx,
        clientY: top + dy,
        button: 0,
        buttons: type === 'pointerup' ? 0 : 1,
        bubbles: true
      }));
      event('pointerdown', 0, 0);
      const began = performance.now();
      const step = (now) => {
        const angle = ((now - began) / 2000) * 2 * Math.PI;
        event('pointermove', 25 * Math.sin(angle), 25 * (1 - Math.cos(angle)));
        if (now - began < 1000 * time)
          requestAnimationFrame(step);
        else {
          event('pointerup', 0, 0);
          resolve();
        }
      };
      requestAnimationFrame(step);
    }),
    [x, y, lasts]);

const spread = (list) => {
  const sorted = list.filter(Number.isFinite).sort((a, b) => a - b);
  return [0.5, 0.95, 1].map(
      (share) =>
          Math.round(10 * (sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? NaN)) /
          10);
};
const server = await server_of(palpate, root, process.env.BACKEND ?? 'cpu');
await server.start();
const browser = await open_browser();
try {
  for (const name of names) {
    const page = await browser.newPage({viewport: {width: 1000, height: 640}});
    page.setDefaultTimeout(300_000);
    await page.addInitScript(count_drawing);
    await page.addInitScript(count_answers);
    await page.goto(`${server.address}#path=${name}/scene.json&source=mouse`);
    while (!/[0-9]/.test(await page.textContent('#facts')) ||
           !/^(free|contact)$/.test(await page.textContent('#contact')))
      await page.waitForTimeout(100);
    await page.keyboard.press('f');
    await shown(page);
    const box = await page.locator('#canvas canvas').boundingBox();
    let grip = null;
    for (let i = 0; i < 400 && !grip;
         ++i) {  // a spiral from the middle: a tool may have a hole there, or lie behind others
      const at =
          [box.x + box.width / 2 + 1.2 * i * Math.cos(i), box.y + box.height / 2 + 0.7 * i * Math.sin(i)];
      await page.mouse.move(...at);
      if ((await page.evaluate(() => document.querySelector('#canvas canvas').style.cursor)) === 'grab')
        grip = at;
    }
    if (!grip) throw new Error(`${name}: the tool is not found in the picture`);
    await lead(page, grip, 3);  // levels of detail settle
    await page.evaluate(() => {
      window.drawing.take();
      window.answers.take();
    });
    const before = processor_times();
    await lead(page, grip, seconds);
    const {pictures} = await page.evaluate(() => window.drawing.take());
    const ages = pictures.map(({told}) => told);
    const {trips, contacts, answers} = await page.evaluate(() => window.answers.take());
    const processor = used_since(before, pictures.length);
    const between = pictures.map((picture) => picture.between);
    console.log(JSON.stringify({
      scene: name,
      triangles: await page.textContent('#facts'),
      engine: process.env.BACKEND ?? 'cpu',
      pictures_a_second: Math.round(pictures.length / seconds * 10) / 10,
      between_ms_p50_p95_max: spread(between),
      drawn: Math.max(0, ...pictures.map((picture) => picture.triangles)),
      script_ms_p50_p95_max: spread(pictures.map((picture) => picture.script)),
      age_of_force_ms_p50_p95_max: spread(ages.map(([force]) => force)),
      age_of_triangles_ms_p50_p95_max: spread(ages.map(([, frame]) => frame)),
      there_and_back_ms_p50_p95_max: spread(trips.map(([trip]) => trip)),
      server_ms_p50_p95_max: spread(trips.map(([, own]) => own)),
      processor_ms_a_picture: processor,
      answers_a_second: Math.round(answers / seconds),
      contact_share: Math.round(100 * contacts / Math.max(1, answers)) / 100,
    }));
    if (process.env.PICTURES) {
      mkdirSync(process.env.PICTURES, {recursive: true});
      await page.screenshot({path: join(process.env.PICTURES, `${name}.png`)});
    }
    await page.close();
  }
} finally {
  await browser.close();
  await server.stop();
}
