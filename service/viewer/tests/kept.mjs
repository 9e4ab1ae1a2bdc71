// Whether a picture laid on what is kept is the one that is drawn whole, pixel by pixel, whatever changed
// before it, and colours are those of three's flat Lambert and of its unlit material: node kept.mjs, in the
// build's service/viewer/work. In chromium.
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

import {check, open_browser} from './page_harness.mjs';

const browser = await open_browser();
let status = 1;
try {
  const {outputFiles} = await createRequire(join(process.cwd(), 'package.json'))('esbuild').build({
    entryPoints: [join(dirname(fileURLToPath(import.meta.url)), 'kept_page.ts')],
    bundle: true,
    write: false,
    format: 'esm',
    target: 'es2022',
    nodePaths: [join(process.cwd(), 'node_modules')],
    logLevel: 'warning',
  });
  const page = await browser.newPage({viewport: {width: 600, height: 450}});
  const errors = [];
  page.on('console', (message) => {
    // That pictures are read back, as this test does, takes time: no fault of theirs.
    if (message.type() !== 'log' && !message.text().includes('GPU stall due to ReadPixels'))
      errors.push(message.text());
  });
  page.on('pageerror', (error) => errors.push(String(error)));
  await page.setContent(
      '<!doctype html><div id="empty-title"></div><div id="host" style="position: absolute; left: 0; top: 0; width: 500px; height: 400px"></div>');
  await page.addScriptTag({type: 'module', content: outputFiles[0].text});
  await page.waitForFunction(() => window.changes);
  for (const name of await page.evaluate(() => window.changes)) {
    const {differ, most, kept, new_pixels, lambert, basic} =
        await page.evaluate((what) => window.change(what), name);
    check(
        new_pixels > 100,
        `${name}: another picture${Number.isFinite(new_pixels) ? `, in ${new_pixels} pixels` : ''}`);
    check(kept === (name !== 'glass'), `${name}: ${kept ? 'it is kept' : 'it is drawn whole'}`);
    check(differ === 0, `${name}: both pictures are the same (${differ} pixels differ, by ${most} at most)`);
    // Three takes the normal from what neighbouring pixels differ by, which is rough where a triangle is seen
    // from its edge.
    check(
        lambert.far < 20,
        `${name}: colours are those of flat Lambert (${
            lambert.far} pixels of 200,000 differ by more than 2 of 255, by ${lambert.most} at most)`);
    check(
        basic.most <= 1,  // rounded once more or less
        `${name}: colours of the contact are those of three's (${basic.differ} pixels differ, by ${
            basic.most} at most)`);
  }
  check(errors.length === 0, `no word on the console${errors.length > 0 ? `: ${errors.join('; ')}` : ''}`);
  status = 0;
} catch (error) {
  console.error(`FAILED  ${error.message}`);
}
await browser.close();
process.exit(status);
