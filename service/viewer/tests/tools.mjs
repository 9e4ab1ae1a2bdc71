// What the page offers beside the tutorial's way, in chromium against the program: node tools.mjs PALPATE
// WORK [SCREENSHOTS] Clearance, hidden parts, settings that change while the tool is felt, a SpaceMouse, a
// headset, section, measure, screenshot and video, the keyboard alone, a touch screen.
import {mkdirSync, readFileSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

import {count_drawing} from './count_drawing.mjs';
import {as_glb, gearbox} from './gearbox.mjs';
import {no_hindrance} from './hindrances.mjs';
import {check, drop, open_browser, palpate_runs, server_of, shown, until} from './page_harness.mjs';
import {stand_in_hid} from './stand_in_hid.mjs';

const [palpate, work, pictures] = process.argv.slice(2);
rmSync(work, {recursive: true, force: true});
const root = join(work, 'root');
mkdirSync(root, {recursive: true});
const glb = as_glb(gearbox());
const server = await server_of(palpate, root);
let browser = null;

/** A page with its errors kept, and what the tests say and ask of it. */
async function new_page(options = {}) {
  const context = await browser.newContext(
      {viewport: {width: 1100, height: 700}, colorScheme: 'light', acceptDownloads: true, ...options});
  const page = await context.newPage();
  page.setDefaultTimeout(300_000);
  const errors = [];
  page.on('console', (message) => {
    if (message.type() === 'error') errors.push(message.text());
  });
  page.on('pageerror', (error) => errors.push(String(error)));
  const text = (id) => page.textContent(`#${id}`);
  const picture = async (name) => {
    for (let i = 0; i < 4; ++i) await shown(page);
    await page.waitForTimeout(300);
    if (pictures) {
      mkdirSync(pictures, {recursive: true});
      await page.screenshot({path: join(pictures, `${name}.png`)});
    }
  };
  const force = async () => parseFloat(await text('force'));
  const loop = () => until('the loop answers', async () => /^(free|contact)$/.test(await text('contact')));
  return {page, errors, text, picture, force, loop};
}
const drop_gearbox = async (page, text) => {
  await drop(page, [['gearbox.glb', glb]]);
  await until(
      'fifty parts are there',
      async () => /^50 parts/.test(await text('assembly-words')) && (await page.isVisible('#part-tree')));
};
const choose = async (page, name) => {
  await page.fill('#part-filter', name);
  await page.locator(`#part-tree [role=treeitem][aria-label^="${name}"]`).last().click();
  await page.fill('#part-filter', '');
};

/** The most triangles of a picture that is drawn now. */
const triangles = async (page) => {
  await page.evaluate(() => window.drawing.take());
  await page.keyboard.press('l');
  await shown(page);
  await page.keyboard.press('j');
  await shown(page);
  return Math.max(
      0, ...(await page.evaluate(() => window.drawing.take().pictures)).map((one) => one.triangles));
};

async function felt() {
  const {page, errors, text, picture, force, loop} = await new_page();
  await page.addInitScript(count_drawing);
  await page.addInitScript(stand_in_hid);
  await page.goto(server.address);
  await drop_gearbox(page, text);
  await choose(page, 'wall_front');
  await page.click('#hide-part');
  await choose(page, 'handle');
  await page.click('#take-out');
  await page.fill('#place-z', '12');
  await page.keyboard.press('Tab');
  await page.click('#feel');
  await loop();

  // Parts: what was hidden stays hidden, and the picture has its triangles when it is shown again.
  await until(
      'the scene has its parts, one of them not drawn',
      async () => (await text('scene-parts-words')) === 'Parts: 49 of 50 are drawn');
  const fewer = await triangles(page);
  await page.click('#scene-parts-words');
  await page.fill('#scene-part-filter', 'wall_front');
  await page.click('#scene-parts label:has-text("wall_front")');
  check((await text('scene-parts-words')) === 'Parts: all 50 are drawn', 'it is shown again');
  const all = await triangles(page);
  check(
      fewer > 0 && all === fewer + 12,
      `a picture has the twelve triangles of its box more: ${fewer}, ${all}`);

  // Clearance: from the handle's lower end (118 + 12 mm) to the cover (111 mm).
  await page.keyboard.press('c');
  await until(
      'the clearance is said with its parts and its engine',
      async () => (await text('clearance-words')) === '19 mm apart: handle ↔ cover (measured by cpu)');
  await page.keyboard.press('f');
  await until(
      'and stands in the picture beside its line',
      async () => (await page.isVisible('#clearance-label')) && (await text('clearance-label')) === '19 mm');
  await picture('clearance');

  // Settings: another stiffness and another engine, the tool where it was.
  await page.fill('#set-stiffness', '3000');
  await page.keyboard.press('Tab');
  await until(
      'another stiffness holds at once',
      async () => (await text('scene-facts')).includes('3,000 N/m') &&
          /^(free|contact)$/.test(await text('contact')));
  await until(
      'the tool has stayed',
      async () => (await text('clearance-words')) === '19 mm apart: handle ↔ cover (measured by cpu)');
  check((await text('scene-parts-words')) === 'Parts: all 50 are drawn', 'and what is drawn is the same');
  await page.selectOption('#set-engine', 'ref');
  await until(
      'another engine answers',
      async () =>
          (await text('scene-facts')).includes('ref on ') && /^(free|contact)$/.test(await text('contact')));
  await page.selectOption('#set-engine', '');
  await until(
      'and the first again',
      async () => (await text('scene-facts')).includes('cpu on ') &&
          (await text('scene-facts')).includes('3,000 N/m') &&
          /^(free|contact)$/.test(await text('contact')));

  // A SpaceMouse: its cap is pressed down (z of the device) until the tool meets the cover.
  await page.keyboard.press('f');
  await page.click('#space-mouse');
  await until(
      'the SpaceMouse is taken', async () => /SpaceMouse Compact/.test(await text('space-mouse-note')));
  await page.click('#record');
  await page.evaluate(() => window.cap.report(1, [0, 0, 350, 0, 0, 0]));
  await until('its cap moves the tool into contact', async () => (await force()) > 0.1);
  check(
      (await text('clearance-words')) === '' && !(await page.isVisible('#clearance-label')),
      'in contact there is no clearance');
  await picture('space_mouse');
  await page.evaluate(() => window.cap.unplug());
  await until(
      'unplugged, it holds the tool no longer',
      async () => (await force()) < 0.1 && (await text('space-mouse')) === 'Take a SpaceMouse');
  await page.click('#record');

  // The path that it went, examined by the server.
  await page.click('#examine-path');
  await until(
      'the path is examined',
      async () => /^The path is not clear: open the report$/.test(await text('path-verdict')));
  const [report] = await Promise.all([page.waitForEvent('popup'), page.click('#path-verdict a')]);
  await report.waitForLoadState();
  check(
      /handle and cover|First to come together/.test(await report.textContent('body')) &&
          (await report.textContent('h1')) === 'The path is not clear',
      'the report says what comes together first');
  if (pictures) await report.screenshot({path: join(pictures, 'path_report.png')});
  await report.close();

  // The picture's tools.
  const label = async (selector) => page.textContent(selector);
  await page.selectOption('#section-axis', '+x');
  const cut = await page.locator('#canvas canvas').screenshot();
  await page.selectOption('#section-axis', '');
  await shown(page);
  check(!cut.equals(await page.locator('#canvas canvas').screenshot()), 'a plane cuts the picture open');
  await page.keyboard.press('a');
  await page.click('#measure');
  const box = await page.locator('#canvas canvas').boundingBox();
  await page.mouse.click(box.x + box.width * 0.45, box.y + box.height * 0.55);
  await page.mouse.click(box.x + box.width * 0.55, box.y + box.height * 0.55);
  await until(
      'two points have a distance',
      async () =>
          (await page.isVisible('#measure-label')) && /[0-9.]+ (mm|m)/.test(await label('#measure-label')));
  await picture('measure');
  await page.click('#measure');
  const [shot] = await Promise.all([page.waitForEvent('download'), page.click('#screenshot')]);
  check(
      shot.suggestedFilename().endsWith('.png') &&
          readFileSync(await shot.path()).subarray(1, 4).toString() === 'PNG',
      'a screenshot is a PNG');
  await page.click('#video');
  for (let i = 0; i < 10; ++i) {
    await page.keyboard.press('l');
    await shown(page);
  }
  const [film] = await Promise.all([page.waitForEvent('download'), page.click('#video')]);
  check(
      /\.(webm|mp4)$/.test(film.suggestedFilename()) && statSync(await film.path()).size > 1000,
      `a video has bytes: ${statSync(await film.path()).size}`);

  // While a device runs nothing is changed under it.
  await page.click('[data-source=live]');
  await page.selectOption('#device', 'simulated');
  await page.click('#start');
  await until(
      'a device runs',
      async () => /^(free|contact)$/.test(await text('contact')) && (await page.isEnabled('#stop')));
  await page.fill('#set-stiffness', '5000');
  await page.keyboard.press('Tab');
  await until(
      'a change is refused with its reason',
      async () => /A device runs on this scene/.test(await text('banner')));
  check((await page.inputValue('#set-stiffness')) === '3000', 'and the field says what holds');
  await page.click('#stop');
  await until('it has ended', async () => (await text('contact')) === 'ended');
  await no_hindrance(page, 'a felt scene with all of it');
  check(errors.length === 0, `no error on the console${errors.length > 0 ? `: ${errors.join('; ')}` : ''}`);
  await page.context().close();
}

/** Placed by its handles into contact: the start is told, and can be left out; then answers come late. */
async function starts_in_contact() {
  const {page, errors, text, picture, force, loop} = await new_page();
  await page.goto(server.address);
  await drop_gearbox(page, text);
  await choose(page, 'handle');
  await page.click('#look-part');
  await page.click('#take-out');
  await shown(page);
  await page.waitForTimeout(500);
  const box = await page.locator('#canvas canvas').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const placed = async () => parseFloat(await page.inputValue('#place-z'));
  for (let up = 40; up <= 140 && (await placed()) === 0;
       up += 8) {  // the handle of z stands above the middle
    await page.mouse.move(x, y - up);
    await shown(page);
    await page.mouse.down();
    await page.mouse.move(x, y - up + 20, {steps: 4});
    await page.mouse.move(x, y - up + 30, {steps: 2});
    await shown(page);
    await page.mouse.up();
  }
  check(
      (await placed()) < 0 && (await page.inputValue('#place-x')) === '0',
      `a handle moves the tool along its axis: ${await placed()} mm`);
  await page.click('#undo');
  check((await placed()) === 0, 'undo takes it back');
  await page.fill('#place-z', '-8');
  await page.keyboard.press('Tab');
  await page.fill('#set-walls', 'thin');
  await page.keyboard.press('Tab');
  check(
      await page.$eval('#set-walls', (field) => !field.checkValidity()),
      'walls that are no number are refused');
  await page.fill('#set-walls', '1.5');
  await page.keyboard.press('Tab');
  const [archive] = await Promise.all([page.waitForEvent('download'), page.click('#download')]);
  const zipped = readFileSync(await archive.path());
  check(
      zipped.subarray(0, 2).toString() === 'PK' && zipped.includes('scene.json') &&
          zipped.includes('gearbox.glb') && zipped.includes('"sheet_thickness": 0.0015'),
      'scene, with its walls, and mesh can be taken home');
  await page.click('#feel');
  await loop();
  await until(
      'the contact at the start is said in words',
      async () =>
          /^At its start the tool is in contact already: handle ↔ cover, [0-9.]+ mm deep, [0-9.]+ N\.$/
              .test(await page.textContent('#start-note p').catch(() => '')));
  await picture('start_note');
  await page.click('#leave-out');
  await until(
      'left out, it says so',
      async () => /^Contacts that are there at the start are left out/.test(
                      await page.textContent('#start-note p').catch(() => '')) &&
          (await force()) === 0);
  await loop();
  server.pause();
  await page.evaluate(() => document.activeElement?.blur());
  await until('where an answer stays away, it says for how long and on which engine', async () => {
    await page.keyboard.press('ArrowUp');
    return /^this contact takes more than [0-9.]+ m?s on cpu/.test(await text('contact'));
  });
  check((await force()) === 0, 'and no force is shown');
  server.go_on();
  await loop();
  check(errors.length === 0, `no error on the console${errors.length > 0 ? `: ${errors.join('; ')}` : ''}`);
  await page.context().close();
}

/** From the parts to a force and a saved scene, without a pointer. */
async function by_keyboard() {
  const {page, errors, text, loop} = await new_page();
  const {keyboard} = page;
  await page.goto(server.address);
  await drop_gearbox(page, text);
  /** Tab until something has the focus: what can't be reached so can't be used. */
  const tab_to = async (selector) => {
    for (let i = 0; i < 80; ++i) {
      if (await page.evaluate((wanted) => document.activeElement?.matches(wanted) ?? false, selector)) return;
      await keyboard.press('Tab');
    }
    throw new Error(`Tab does not reach ${selector}`);
  };
  await tab_to('#part-filter');
  await keyboard.type('handle');
  await tab_to('#part-tree [role=treeitem]');
  await keyboard.press('End');
  await keyboard.press('Enter');
  check((await text('part-name')) === 'handle', 'arrow keys and Enter choose a part');
  await tab_to('#take-out');
  await keyboard.press('Enter');
  await tab_to('#place-z');
  await keyboard.press('Control+A');
  await keyboard.type('-6.8');
  await tab_to('#feel');
  await keyboard.press('Enter');
  await loop();
  await page.evaluate(() => document.activeElement?.blur());
  await keyboard.press('f');
  await keyboard.press('r');
  // Page Up goes away from the eye, Arrow Down down: towards the cover from where the camera stands.
  for (let i = 0; i < 60 && !(parseFloat(await text('force')) > 0.1); ++i) {
    await keyboard.press('ArrowDown');
    await shown(page);
  }
  await until('arrow keys press the tool on the cover', async () => {
    await keyboard.press('ArrowDown');
    return parseFloat(await text('force')) > 0.1;
  });
  await keyboard.press('r');
  await until('r has recorded it', async () => /poses/.test(await text('path-words')));
  await keyboard.press('1');
  check((await page.getAttribute('[data-kind=cst]', 'aria-pressed')) === 'false', 'a number hides a kind');
  await tab_to('#save');
  await keyboard.press('Enter');
  await until('it is saved', async () => /scene\.json/.test(await text('banner')));
  check((await page.getAttribute('#canvas canvas', 'aria-label')) === 'The scene', 'the picture has a name');
  const told = await page.evaluate(
      () => document.querySelector('#canvas canvas')
                .getAttribute('aria-describedby')
                .split(' ')
                .map((id) => document.getElementById(id).textContent)
                .join(' '));
  check(/handle ↔ cover/.test(told), `and is described in words: ${told}`);
  check(
      await page.evaluate(
          () => [...document.querySelectorAll('canvas')].every(
              (canvas) => canvas.getAttribute('aria-label'))),
      'every canvas has a name');
  check(errors.length === 0, `no error on the console${errors.length > 0 ? `: ${errors.join('; ')}` : ''}`);
  await page.context().close();
}

/** With fingers, on a screen of 390 pixels. */
async function by_touch() {
  const {page, errors, text, picture, force, loop} =
      await new_page({viewport: {width: 390, height: 760}, hasTouch: true, isMobile: true});
  await page.goto(server.address);
  await drop(page, [['gearbox.glb', glb]]);
  await until('the parts are there', async () => /^50 parts/.test(await text('assembly-words')));
  await page.tap('#panel-button');
  await page.fill('#part-filter', 'handle');
  await page.locator('#part-tree [role=treeitem][aria-label^="handle"]').last().tap();
  await page.tap('#take-out');
  await page.fill('#place-z', '-6.8');
  await page.tap('#feel');
  await loop();
  if (!(await page.isVisible('#panel'))) await page.tap('#panel-button');
  await page.tap('#look-tool');
  await page.tap('#panel-button');
  await shown(page);
  await page.waitForTimeout(300);
  const box = await page.locator('#canvas canvas').boundingBox();
  const finger = await page.context().newCDPSession(page);
  const touch = (type, x, y) =>
      finger.send('Input.dispatchTouchEvent', {type, touchPoints: type === 'touchEnd' ? [] : [{x, y}]});
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await touch('touchStart', x, y);
  for (let i = 1; i <= 20 && (await force()) < 0.3; ++i) {
    await touch('touchMove', x, y + 6 * i);
    await shown(page);
  }
  await until('a finger drags the tool into contact', async () => (await force()) > 0.1);
  await picture('touch');
  await touch('touchEnd');
  await until('and lets it go', async () => (await force()) < 0.1);
  check(errors.length === 0, `no error on the console${errors.length > 0 ? `: ${errors.join('; ')}` : ''}`);
  await page.context().close();
}

/** In a headset, of which npm's iwer is the stand-in. */
async function by_headset() {
  const {page, errors, text, picture, force, loop} = await new_page();
  await page.addInitScript(
      {content: readFileSync(join(process.cwd(), 'node_modules/iwer/build/iwer.min.js'), 'utf8')});
  await page.addInitScript(() => {
    window.headset = new window.IWER.XRDevice(window.IWER.metaQuest3);
    window.headset.installRuntime({forceInstall: true});
  });
  await page.goto(server.address);
  await drop_gearbox(page, text);
  await choose(page, 'handle');
  await page.click('#take-out');
  await page.click('#feel');
  await loop();
  await page.click('#headset');
  await until('the headset has the picture', async () => (await text('headset')) === 'Put the headset down');
  const hand = (place, trigger) => page.evaluate(([[x, y, z], value]) => {
    const {right} = window.headset.controllers;
    right.position.set(x, y, z);
    right.updateButtonValue('trigger', value);
  }, [place, trigger]);
  const a_while = () => page.waitForTimeout(400);
  await hand([0.1, -0.2, -0.4], 0);
  await a_while();
  await hand([0.1, -0.2, -0.4], 1);
  await a_while();
  for (let i = 1; i <= 12 && (await force()) < 0.3; ++i) {
    await hand([0.1, -0.2 - 0.01 * i, -0.4], 1);
    await a_while();
  }
  await until(
      'the trigger holds the tool, and the hand presses it on the cover', async () => (await force()) > 0.1);
  if (pictures) await page.screenshot({path: join(pictures, 'headset.png')});
  await hand([0.1, -0.4, -0.4], 0);
  await until('it is let go', async () => (await force()) < 0.1);
  await page.evaluate(() => document.getElementById('headset').click());  // the stand-in lies over the page
  await until('the headset is put down', async () => (await text('headset')) === 'Look with the headset');
  await page.keyboard.press('a');
  await picture('after_headset');
  await until('and the page goes on', async () => /^(free|contact)$/.test(await text('contact')));
  check(errors.length === 0, `no error on the console${errors.length > 0 ? `: ${errors.join('; ')}` : ''}`);
  await page.context().close();
}

/** What lies beside scenes is none. */
async function listed() {
  mkdirSync(join(root, 'loose'));
  writeFileSync(join(root, 'loose/notes.json'), '{"static": 3, "tool": "a word"}');
  palpate_runs(palpate, 'generate', 'contacts', '--out', join(root, 'contacts'));
  palpate_runs(
      palpate, 'run', join(root, 'contacts/scene.json'), '--pace', 'asap', '--backend', 'cpu', '--duration',
      '0.1', '--out', join(root, 'a_run'));
  const {available} = await (await fetch(`${server.address}v1/scenes`)).json();
  check(
      available.includes('contacts/scene.json') && !available.some((name) => /summary|notes/.test(name)),
      `a run's summary is not listed as a scene: ${available.join(', ')}`);
}

let status = 1;
try {
  await server.start();
  browser = await open_browser();
  const wanted =
      (process.env.ONLY ?? 'listed,felt,starts_in_contact,by_keyboard,by_touch,by_headset').split(',');
  for (const [name, act] of Object.entries(
           {listed, felt, starts_in_contact, by_keyboard, by_touch, by_headset}))
    if (wanted.includes(name)) await act();
  status = 0;
} catch (error) {
  console.error(`FAILED  ${error.message}`);
  if (browser)
    for (const page of browser.contexts().flatMap((context) => context.pages()))
      await page.screenshot({path: join(work, 'failed.png')}).catch(() => {});
}
await browser?.close();
await server.stop();
process.exit(status);
