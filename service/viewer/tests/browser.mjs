// The viewer in a real browser, against the real program: node browser.mjs PALPATE WORK [SCREENSHOTS]
// What it needs and does not find (chromium, the viewer's packages, a viewer in the program) is a failure.
// Environment: CHROMIUM.
import {mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

import {count_drawing} from './count_drawing.mjs';
import {check, open_browser, palpate_runs, server_of, shown as shown_on, until} from './page_harness.mjs';

const [palpate, work, pictures] = process.argv.slice(2);
const run = (...args) => palpate_runs(palpate, ...args);

// A small mock-up and four seconds of the task on it; the first contact is in the third.
rmSync(work, {recursive: true, force: true});
const root = join(work, 'root');
mkdirSync(root, {recursive: true});
run('generate', 'disassembly', '--triangles', '4000', '--tool-triangles', '1000', '--out',
    join(root, 'engine'));
run('run', join(root, 'engine/scene.json'), '--pace', 'asap', '--backend', 'cpu', '--duration', '4', '--out',
    join(root, 'first'));

mkdirSync(join(root, 'broken'));
writeFileSync(
    join(root, 'broken/scene.json'), '{"static": [{"mesh": "none.stl"}], "tool": {"mesh": "none.stl"}}');
const server = await server_of(palpate, root);
const {address} = server;

// Small pictures are drawn sooner by the processor; for the README they are larger.
const WIDE = pictures ? {width: 1440, height: 900} : {width: 1000, height: 640};
const NARROW = pictures ? {width: 760, height: 900} : {width: 500, height: 640};
let browser = null;
async function main() {
  await server.start();
  if (!(await (await fetch(address)).text()).includes('viewer.js'))
    throw new Error('this program has no viewer');
  browser = await open_browser();
  const page = await browser.newPage({viewport: WIDE, colorScheme: 'light'});
  page.setDefaultTimeout(
      120_000);  // a machine without a GPU, busy with other tests, may need seconds a picture
  const errors = [];
  page.on('console', (message) => {
    if (message.type() === 'error') errors.push(message.text());
  });
  page.on('pageerror', (error) => errors.push(String(error)));
  const text = (id) => page.textContent(`#${id}`);
  const picture = async (name) => {
    if (pictures) {
      mkdirSync(pictures, {recursive: true});
      await page.screenshot({path: join(pictures, `${name}.png`)});
    }
  };
  /**
   * Pixels of the picture as warm as CST, BST and EST are, also where they shine through a surface; nothing
   * else in it is.
   */
  const warm = async () => {
    const others = (visibility) => page.evaluate((value) => {
      for (const id of ['legend', 'labels', 'readout', 'corner', 'banner'])
        document.getElementById(id).style.visibility = value;
    }, visibility);
    await others('hidden');  // they lie over the canvas and have such colours, too
    const png =
        (await page.screenshot({clip: await page.locator('#canvas').boundingBox()})).toString('base64');
    await others('');
    return page.evaluate(async (data) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const canvas =
          Object.assign(document.createElement('canvas'), {width: image.width, height: image.height});
      const pen = canvas.getContext('2d');
      pen.drawImage(image, 0, 0);
      const pixels = pen.getImageData(0, 0, image.width, image.height).data;
      let count = 0;
      for (let i = 0; i < pixels.length; i += 4)
        if (pixels[i] > 140 && pixels[i] - pixels[i + 2] > 50 && pixels[i] > pixels[i + 1]) ++count;
      return count;
    }, png);
  };

  const shown = () => shown_on(page);

  // Nothing is open: the page says so and offers the scene file.
  await page.goto(address);
  await page.click('#empty-list button:has-text("engine/scene.json")');
  await until('the scene opens', async () => /[0-9]/.test(await text('facts')));
  check((await warm()) === 0, 'the picture shows no contact yet');
  await picture('scene');

  // What is not there, or can't be opened, is said by its name, and nothing else is shown in its place.
  const at = async (hash) => {
    await page.goto('about:blank');
    await page.goto(`${address}#${hash}`);
  };
  await at('path=gone/scene.json');
  await until(
      'a link to a scene that is missing says so',
      async () => (await page.isVisible('#empty')) && /not here/.test(await text('empty-title')) &&
          /gone\/scene\.json/.test(await text('empty-text')));
  check((await text('facts')) === '', 'and no other scene is shown');
  await page.click('#empty-list button:has-text("engine/scene.json")');
  await until(
      'another can be chosen',
      async () => /[0-9]/.test(await text('facts')) && !(await page.isVisible('#empty')));
  const rows = await page.locator('#scene option').allTextContents();
  check(
      rows.filter((row) => row.includes('engine/scene.json')).length === 1,
      `one row for the open scene: ${rows.join(', ')}`);
  await page.selectOption('#scene', 'at:broken/scene.json');
  await until(
      'a scene that can\'t be opened is said by its name, not over another\'s picture',
      async () => (await page.isVisible('#empty')) && /broken\/scene\.json/.test(await text('empty-title')) &&
          /none\.stl/.test(await text('empty-text')));
  await page.click('#empty-list button:has-text("Back to engine/scene.json")');
  check(!(await page.isVisible('#empty')), 'and one can go back');
  let offered = '';
  await until('replay is not offered without a file', async () => {
    offered = await page.evaluate(
        () => JSON.stringify(
            [...document.querySelectorAll('#device option')].map(({text, disabled}) => [text, disabled])));
    return JSON.parse(offered).some(([name, disabled]) => name.startsWith('replay') && disabled);
  }, 20).catch((error) => {
    throw new Error(`${error.message}: ${offered}`);
  });
  await at('path=engine/scene.json&source=run&run=gone');
  await until(
      'a link to a run that is missing says so',
      async () => (await page.isVisible('#banner')) && /gone/.test(await text('banner')));
  check((await text('run-note')) === '' && (await text('duration')) === '', 'and no other run is shown');
  errors.length = 0;  // the browser's own about the refused scene
  await page.click('[data-source=live]');
  check(!(await page.isVisible('#banner')), 'what was said of the link goes with what was shown');

  // A recorded run: found, played, scrubbed to a contact.
  await page.click('[data-source=run]');
  await until('the run that fits the scene is read', async () => /ticks/.test(await text('run-note')));
  await page.keyboard.press('f');
  await page.click('#play');
  await until('it plays', async () => parseFloat(await text('clock')) > 0.2);
  await page.click('#play');
  const paused = await text('clock');
  const entries = readFileSync(join(root, 'first/frames.jsonl'), 'utf8')
                      .trim()
                      .split('\n')
                      .map((line) => JSON.parse(line));
  const deepest = entries.reduce(
      (best, frame) =>
          (frame.cst.length + frame.bst.length > best.cst.length + best.bst.length && frame.contact ? frame :
                                                                                                      best));
  check(deepest.contact, 'the run has a contact');
  await page.evaluate((time) => {
    const bar = document.getElementById('scrubber');
    bar.value = String(time);
    bar.dispatchEvent(new Event('input'));
  }, deepest.tick / 1000);
  await until(
      'the legend counts what the frame holds',
      async () => (await page.textContent('[data-kind=bst] b')) === deepest.bst.length.toLocaleString('en'));
  check((await text('clock')) !== paused, 'the scrubber moves the clock');
  const forces = (await page.locator('#areas tr:not(.more) td:last-child').allTextContents())
                     .map((value) => parseFloat(value) || 0);
  check(
      forces.length > 0 && forces.every((force, i) => i === 0 || force <= forces[i - 1]),
      `areas that push come first: ${forces.join(', ')}`);
  check(
      (await text('felt-title')) === 'to the device' && parseFloat(await text('force-response')) >= 0,
      'two forces, each with its name');
  check(
      (await text('areas-force')) === 'field N' &&
          (await page.getAttribute('#areas-force', 'title')).length > 40,
      'the areas\' figures are not taken for the response');
  check(
      (await page.locator('#labels div:not([hidden])').allTextContents())
          .every((label) => / mm$/.test(label)),
      'nor does a label say another force');
  let boxes = [];
  await until('labels lie neither over one another nor under the readout', async () => {
    boxes = await page.evaluate(
        () => ['#readout', '#bottom', '#labels div:not([hidden])']
                  .flatMap((query) => [...document.querySelectorAll(query)])
                  .map((one) => {
                    const {x, y, right, bottom} = one.getBoundingClientRect();
                    return {x, y, right, bottom};
                  }));
    return boxes.every(
        (a, i) => boxes.slice(i + 1).every(
            (b) => a.x >= b.right || b.x >= a.right || a.y >= b.bottom || b.y >= a.bottom));
  }, 60).catch((error) => {
    throw new Error(`${error.message}: ${JSON.stringify(boxes)}`);
  });
  await until('contact triangles have their colours in the picture', async () => (await warm()) > 100);
  await picture('contact');
  for (const key of ['1', '2', '3']) await page.keyboard.press(key);
  await until('kinds that are switched off go', async () => (await warm()) === 0);
  for (const key of ['1', '2', '3', 't']) await page.keyboard.press(key);
  check((await page.getAttribute('html', 'data-theme')) === 'dark', 'dark on a key');
  await page.keyboard.press('?');
  check(await page.isVisible('#help'), 'the keys are told on a key');
  await page.keyboard.press('Escape');
  check(!(await page.isVisible('#help')), 'and Escape takes them away');
  await page.setViewportSize(NARROW);
  await picture('small_dark');
  await page.setViewportSize(WIDE);
  await page.keyboard.press('t');

  // A device of the server's machine: started, watched, with voxels asked for beside it, stopped.
  await page.click('[data-source=live]');
  await page.click('#start');
  await until('telemetry comes', async () => /^(free|contact)$/.test(await text('contact')));
  for (const kind of ['boundary', 'internal', '']) {
    await page.selectOption('#voxels', kind);
    await shown();
    check((await page.inputValue('#voxels')) === kind, `voxels beside a session: ${kind || 'none'}`);
  }
  await page.click('#stop');
  await until(
      'a session that was stopped has ended',
      async () => (await text('contact')) === 'ended' && (await text('force')) === '0');

  // The mouse: the clamp is drawn against its pipe, which pushes back.
  const drag = async () => {
    await page.click('[data-source=mouse]');
    await page.click('#mouse-reset');
    await until('the loop answers', async () => /^(free|contact)$/.test(await text('contact')));
    await page.keyboard.press('f');
    await shown();
    const box = await page.locator('#canvas canvas').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    // Over the tool the pointer is a hand: its parts are looked for, for the middle of a clamp may be a hole.
    let grip = null;
    for (const [dx, dy] of [[0, 0], [0, -40], [40, 0], [-40, 0], [0, 40], [40, -90], [-40, -90], [0, -120]]) {
      await page.mouse.move(x + dx, y + dy);
      await shown();
      if ((await page.evaluate(() => document.querySelector('#canvas canvas').style.cursor)) === 'grab') {
        grip = [x + dx, y + dy];
        break;
      }
    }
    check(grip, 'the tool can be taken');
    await page.mouse.down();
    for (let i = 1; i <= 12; ++i) {
      await page.mouse.move(grip[0], grip[1] - 12 * i);
      await shown();
    }
    await until('the tool that is dragged feels a force', async () => parseFloat(await text('force')) > 0.1);
    await picture('mouse');
    await page.mouse.up();
    await until('and none when it is let go', async () => parseFloat(await text('force')) < 0.1);
  };
  await drag();
  check(errors.length === 0, `no error on the console${errors.length > 0 ? `: ${errors.join('; ')}` : ''}`);

  await light();

  // The server goes and comes back.
  await server.stop();
  await until(
      'the page says that the server is gone',
      async () => (await page.isVisible('#banner')) && /does not answer/.test(await text('banner')));
  await picture('gone');
  await server.start();
  await until(
      'the page finds the server again',
      async () => (await page.getAttribute('#link', 'data-state')) === 'up');
  errors.length = 0;  // connections refused while it was away
  await drag();
  await until(
      'the list names the scene again', async () => (await page.inputValue('#scene')).startsWith('id:'));
  check(
      errors.length === 0, `no error after the restart${errors.length > 0 ? `: ${errors.join('; ')}` : ''}`);
}

/**
 * What a picture may cost, without a clock: no more triangles than the level has, nothing handed over twice,
 * curves drawn once.
 */
async function light() {
  const page = await browser.newPage({viewport: WIDE});
  page.setDefaultTimeout(120_000);
  await page.addInitScript(count_drawing);
  // A thousandth of the triangles, so that a small mock-up is one too large to be drawn whole; and the first
  // level stays.
  let most = 0;
  await page.route('**/geometry*', (route) => {
    if (most > 0) return;  // never answered
    const url = route.request().url().replace(
        /max_triangles=(\d+)/, (_, asked) => `max_triangles=${most = Math.max(100, Number(asked) / 1000)}`);
    void route.continue({url});
  });
  const frames = (count, each) => page.evaluate(async ([wanted, act]) => {
    const act_now = new Function('i', act);
    for (let i = 0; i < wanted; ++i) {
      act_now(i);
      await new Promise((resolve) => {
        requestAnimationFrame(() => resolve());
      });
    }
    return window.drawing.take().pictures;
  }, [count, each]);
  await page.goto(address);
  await until(
      'the scene is open on a second page', async () => /[0-9]/.test(await page.textContent('#facts')));
  await until(
      'it says that fewer triangles are drawn',
      async () => /drawn: [0-9,]+ triangles, contact exact/.test(await page.textContent('#scales')));
  await frames(30, '');
  const turn = `
    const canvas = document.querySelector('#canvas canvas');
    canvas.setPointerCapture = canvas.releasePointerCapture = () => {};   // there is no such pointer
    const box = canvas.getBoundingClientRect();
    canvas.dispatchEvent(new PointerEvent(i === 0 ? 'pointerdown' : i === 29 ? 'pointerup' : 'pointermove', { pointerId: 1, pointerType: 'mouse', clientX: box.x + 40 + 3 * i, clientY: box.y + 40, buttons: 1, bubbles: true }));`;
  const turned = await frames(30, turn);
  const largest = (pictures, key) => Math.max(...pictures.map((picture) => picture[key]));
  check(turned.length > 5, `the camera turns: ${turned.length} pictures`);
  check(
      most > 0 && largest(turned, 'triangles') <= 3 * most,
      `a picture has at most ${most} triangles of the mock-up, and as many of each side of the tool: ${
          largest(turned, 'triangles')}`);
  check(
      largest(turned, 'uploaded') === 0,
      `nothing is handed over anew while the camera turns: ${largest(turned, 'uploaded')} bytes`);
  await page.click('[data-source=run]');
  await until(
      'the run is read on the second page', async () => /ticks/.test(await page.textContent('#run-note')));
  await frames(5, '');
  await page.click('#play');
  await frames(3, '');
  const clock = await page.textContent('#clock');
  const played = await frames(30, '');
  check(
      (await page.textContent('#clock')) !== clock && played.length > 5,
      `the run plays: ${played.length} pictures`);
  check(
      largest(played, 'strokes') === 0,
      `the curves of a recorded run are not drawn again while it plays: ${
          largest(played, 'strokes')} strokes for a picture`);
  await page.close();
}

let status = 1;
try {
  await main();
  status = 0;
} catch (error) {
  console.error(`FAILED  ${error.message}`);
  if (pictures && browser)
    for (const page of browser.contexts().flatMap((context) => context.pages()))
      await page.screenshot({path: join(pictures, 'failed.png')}).catch(() => {});
}
await browser?.close();
await server.stop();
process.exit(status);
