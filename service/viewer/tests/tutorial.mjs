// What docs/TUTORIAL.md shows, done in a browser: node tutorial.mjs PALPATE WORK WRITE_STEP [PICTURES]
// WRITE_STEP may be empty: then the assembly comes as a GLB alone. PICTURES: where the steps' pictures go
// (docs/tutorial).
import {spawnSync} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, rmSync} from 'node:fs';
import {join} from 'node:path';

import {as_glb, as_text, gearbox} from './gearbox.mjs';
import {no_hindrance} from './hindrances.mjs';
import {check, drop, middle_colour, open_browser, server_of, shown, until} from './page_harness.mjs';

const [palpate, work, write_step, pictures] = process.argv.slice(2);
rmSync(work, {recursive: true, force: true});
const root = join(work, 'root');
mkdirSync(root, {recursive: true});
const solids = gearbox();
check(solids.length === 50, 'the assembly has 50 parts');
const step_file = join(work, 'gearbox.step');
if (write_step) {
  const {status, stderr} = spawnSync(write_step, [step_file], {input: as_text(solids), encoding: 'utf8'});
  check(status === 0 && existsSync(step_file), `OpenCASCADE writes it as STEP ${stderr}`);
}
const server = await server_of(palpate, root);
let browser = null;

/**
 * The whole way with one file: dropped, a part clicked, taken out, dragged into contact, recorded, examined,
 * saved, loaded anew, replayed. `shows`: each step has its picture and is looked at in every look.
 */
async function from_file_to_report(name, bytes, folder, shows) {
  const context = await browser.newContext({viewport: {width: 1280, height: 800}, colorScheme: 'light'});
  const page = await context.newPage();
  page.setDefaultTimeout(300_000);
  const errors = [];
  page.on('console', (message) => {
    if (message.type() === 'error') errors.push(message.text());
  });
  page.on('pageerror', (error) => errors.push(String(error)));
  const text = (id) => page.textContent(`#${id}`);
  const picture = async (step, of = page) => {
    if (!shows) return;
    for (let i = 0; i < 4; ++i) await shown(of);  // a picture at half the size is followed by a sharp one
    await of .waitForTimeout(500);
    if (pictures) {
      mkdirSync(pictures, {recursive: true});
      await of .screenshot({path: join(pictures, `${step}.png`)});
    }
  };
  /** Light, dark and as narrow as a telephone: nothing hinders, and nothing is wider than the page. */
  const in_all_looks = async (what) => {
    if (!shows) return;
    for (const [look, width, height] of [
             ['light', 1280, 800], ['dark', 1280, 800], ['dark', 390, 760], ['light', 390, 760]]) {
      await page.setViewportSize({width, height});
      if ((await page.getAttribute('html', 'data-theme')) !== look) await page.keyboard.press('t');
      await page.waitForTimeout(300);
      if (width < 500) {
        const wide = await page.evaluate(() => document.documentElement.scrollWidth);
        check(wide <= width, `${what}, ${look}, ${width} px: nothing is wider (${wide})`);
        await page.screenshot({path: join(work, `${what}_${look}_${width}_closed.png`.replaceAll(' ', '_'))});
        if ((await page.isVisible('#panel-button')) && !(await page.isVisible('#panel')))
          await page.click('#panel-button');
      }
      await page.screenshot({path: join(work, `${what}_${look}_${width}.png`.replaceAll(' ', '_'))});
      await no_hindrance(page, `${what}, ${look}, ${width} px`);
    }
    await page.setViewportSize({width: 1280, height: 800});
    await page.waitForTimeout(300);
  };

  await page.goto(server.address);
  await until('the first page asks for files', () => page.isVisible('#empty-drop'));
  await picture('1_first_page');
  await in_all_looks('the first page');

  await drop(page, [[name, bytes]]);
  await until(
      `${name} is read: 50 parts`,
      async () => /^50 parts/.test(await text('assembly-words')) && (await page.isVisible('#part-tree')) &&
          (await text('assembly-files')).includes(name));
  check(
      /240 × 160 × 175 mm/.test(await text('assembly-words')),
      `its size is said in words: ${await text('assembly-words')}`);
  if (name.endsWith('.step'))
    check(/as the file states/.test(await text('assembly-files')), 'its unit is the file\'s own');
  await page.reload();
  await until('a reload comes back to the parts', async () => /^50 parts/.test(await text('assembly-words')));
  check((await page.locator('#part-tree [role=treeitem]').count()) >= 5, 'the tree shows its groups');
  await until(
      'the picture shows them before anybody has pointed at it',
      async () => (await middle_colour(page)) < 640);  // paper is 739, a line of the grid 664
  check(
      await page.evaluate(
          () => [...document.querySelectorAll('#part-tree .size')].every(
              (size) => size.scrollWidth <= size.clientWidth)),
      'no size is cut');
  await picture('2_parts');

  // A part is clicked in the picture: its middle, where the page draws it.
  await page.fill('#part-filter', 'handle');
  await page.locator('#part-tree [role=treeitem]', {hasText: 'handle'}).last().hover();
  await page.fill('#part-filter', '');
  const box = await page.locator('#canvas canvas').boundingBox();
  let found = false;
  search: for (let down = 0.2; down < 0.6; down += 0.04) for (let right = 0.4; right < 0.6; right += 0.04) {
    await page.mouse.click(box.x + box.width * right, box.y + box.height * down);
    if ((await page.isVisible('#part-card')) && (await text('part-name')) === 'handle') {
      found = true;
      break search;
    }
  }
  check(found, 'a click on the handle chooses it');
  check(/28 × 28 × 46 mm/.test(await text('part-words')), `its size: ${await text('part-words')}`);
  await picture('3_choose');
  await page.click('#take-out');
  await until('it is the tool', async () => (await text('tool-name')) === 'handle');
  await page.click('#undo');
  check(!(await page.isVisible('#tool-card')), 'undo puts it back');
  await page.click('#redo');
  check((await text('tool-name')) === 'handle', 'redo takes it out again');
  await page.fill('#place-z', '12');
  await page.keyboard.press('Tab');
  await picture('4_take_out');

  await in_all_looks('parts');
  await page.click('#feel');
  await until(
      'the scene is ready and the loop answers', async () => /^(free|contact)$/.test(await text('contact')));
  await page.keyboard.press('f');
  await shown(page);
  await page.waitForTimeout(300);
  // Dragged down into contact, while it is recorded.
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(...middle);
  await shown(page);
  check(
      (await page.evaluate(() => document.querySelector('#canvas canvas').style.cursor)) === 'grab',
      'key f has brought the tool to the middle, where it can be taken');
  await page.click('#record');
  await page.mouse.move(...middle);
  await page.mouse.down();
  for (let i = 1; i <= 40 && parseFloat(await text('force')) < 0.5; ++i) {
    await page.mouse.move(middle[0], middle[1] + 8 * i);
    await shown(page);
  }
  await until('it meets something and feels a force', async () => parseFloat(await text('force')) > 0.3);
  await until(
      'the readout names who touches whom', async () => /^handle ↔ cover$/.test(await text('touching')));
  await picture('5_feel');
  await page.mouse.up();
  await page.waitForTimeout(500);
  await page.click('#record');
  await until(
      'the path tells what it touched',
      async () => /handle ↔ cover, [0-9.]+ mm/.test(await text('path-touches')));
  await page.click('#play-path');
  await until('it plays', async () => (await text('contact')) === 'played');
  await until('and ends', async () => (await text('contact')) !== 'played');
  await page.click('#examine-path');
  await until(
      'the path is examined',
      async () => /^The path is not clear: open the report$/.test(await text('path-verdict')));
  await picture('6_path');
  const [report] = await Promise.all([page.waitForEvent('popup'), page.click('#path-verdict a')]);
  await report.waitForLoadState();
  const told = await report.textContent('body');
  check(
      /First to come together/.test(told) && /handle/.test(told) && /cover/.test(told),
      'its report names the parts that come together first');
  await report.setViewportSize({width: 1280, height: 800});
  await picture('7_path_report', report);
  await report.close();

  await in_all_looks('a scene');
  await page.fill('#save-name', folder);
  await page.click('#save');
  await until('it is saved', async () => (await text('banner')).includes(`${folder}/scene.json`));
  for (const file of ['scene.json', 'path.csv'])
    check(existsSync(join(root, folder, file)), `${file} lies below the root`);
  await page.reload();
  await until(
      'after a reload the saved scene is there',
      async () => (await page.isVisible('#scene-facts h2')) &&
          (await page.textContent('#scene-facts h2')) === `${folder}/scene.json` &&
          /^(free|contact)$/.test(await text('contact')));

  await page.click('[data-source=live]');
  await page.fill('#record-as', `${folder}_run`);
  await page.selectOption('#device', 'simulated');
  await page.click('#start');
  await until(
      'the simulated hand follows the path into contact', async () => (await text('contact')) === 'contact');
  await picture('8_replay');
  await in_all_looks('a session');
  await page.click('#stop');
  await until('it has ended', async () => (await text('contact')) === 'ended');
  await page.click('[data-source=run]');
  await until('the run is shown', async () => /ticks/.test(await text('run-note')));
  check(await page.isVisible('#run-report a'), 'with a link to its report');
  check(
      (await fetch(new URL(await page.getAttribute('#run-report a', 'href'), server.address))).ok,
      'which is there');
  await picture('9_run');
  await in_all_looks('a run');
  check(errors.length === 0, `no error on the console${errors.length > 0 ? `: ${errors.join('; ')}` : ''}`);
  await context.close();
}

async function main() {
  await server.start();
  browser = await open_browser();
  if (write_step) {
    await from_file_to_report('gearbox.step', readFileSync(step_file), 'my_gearbox', true);
    await server.stop();  // it forgets what was uploaded
    await server.start();
  }
  await from_file_to_report('gearbox.glb', as_glb(solids), 'my_gearbox_glb', !write_step);
}

let status = 1;
try {
  await main();
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
