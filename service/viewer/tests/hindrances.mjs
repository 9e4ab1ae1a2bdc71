// What hinders people in a page, as axe-core finds it: nothing serious or critical may be left.
import {readFileSync} from 'node:fs';
import {join} from 'node:path';

import {check} from './page_harness.mjs';

export async function no_hindrance(page, where) {
  if (!(await page.evaluate(() => 'axe' in window)))
    await page.evaluate(readFileSync(join(process.cwd(), 'node_modules/axe-core/axe.min.js'), 'utf8'));
  const found = await page.evaluate(
      async () => (await window.axe.run(document, {resultTypes: ['violations']}))
                      .violations.filter(({impact}) => impact === 'serious' || impact === 'critical')
                      .map(
                          ({id, help, nodes}) => `${id}: ${help} (${
                              nodes.slice(0, 4).map(({target}) => target.join(' ')).join('; ')})`));
  check(
      found.length === 0,
      `${where}: axe-core finds nothing serious${found.length > 0 ? `, but ${found.join('\n    ')}` : ''}`);
}
