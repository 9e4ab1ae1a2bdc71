// What the browser tests share: checks that say what they saw, the program as a server, chromium.
import {spawn, spawnSync} from 'node:child_process';
import {existsSync} from 'node:fs';
import {createRequire} from 'node:module';
import {createServer} from 'node:net';
import {join} from 'node:path';

const browser_path = process.env.CHROMIUM ?? '/usr/bin/chromium';
const missing = (reason) => {
  console.error(`FAILED  ${reason}`);
  process.exit(1);
};

export function check(truth, sentence) {
  if (!truth) throw new Error(sentence);
  console.log(`ok  ${sentence}`);
}
export async function until(sentence, ask, seconds = Number(process.env.UNTIL ?? 300)) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end;
       await new Promise((resolve) => setTimeout(resolve, 100)))
    if (await ask()) return check(true, sentence);
  throw new Error(`not within ${seconds} s: ${sentence}`);
}
export function palpate_runs(palpate, ...args) {
  const {status, stderr} = spawnSync(palpate, args, {encoding: 'utf8'});
  if (status !== 0) throw new Error(`palpate ${args.join(' ')}: ${status} ${stderr}`);
}

/**
 * `palpate serve` on a free port; `start` and `stop` may be called again and again, and the address stays.
 */
export async function server_of(palpate, root, backend = 'cpu') {
  const port = await new Promise((resolve) => {
    const probe = createServer().listen(0, '127.0.0.1', () => {
      const {port: free} = probe.address();
      probe.close(() => resolve(free));
    });
  });
  const address = `http://127.0.0.1:${port}/`;
  let process_ = null;
  return {
    address,
    async start() {
      process_ = spawn(
          palpate, ['serve', '--listen', `127.0.0.1:${port}`, '--root', root, '--backend', backend],
          {stdio: 'ignore'});
      for (let i = 0; i < 200; ++i) {
        if (await fetch(`${address}readyz`).then((answer) => answer.ok, () => false)) return;
        await new Promise((resolve) => setTimeout(resolve, 100));
      }
      throw new Error('the server does not start');
    },
    /** Whatever it is asked waits until it goes on. */
    pause: () => process_.kill('SIGSTOP'),
    go_on: () => process_.kill('SIGCONT'),
    stop: () => new Promise((resolve) => {
      if (!process_ || process_.exitCode !== null) {
        resolve();
        return;
      }
      process_.once('exit', resolve);
      process_.kill('SIGTERM');
    }),
  };
}

export async function open_browser() {
  if (!existsSync(browser_path))
    missing(`no browser at ${browser_path} (Debian: chromium; scripts/install-packages browser)`);
  if (!existsSync('installed'))
    missing('the viewer\'s packages are not here: `npm ci` failed when the viewer was built');
  const {chromium} = createRequire(join(process.cwd(), 'package.json'))(
      'playwright-core');  // run where the build keeps the packages
  return chromium.launch({
    executablePath: browser_path,
    args: [
      '--headless', '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage',
      '--enable-unsafe-swiftshader'  // WebGL where there is no GPU; the page itself is not drawn by it
    ]
  });
}

/** The page has taken what came before, and drawn it. */
export const shown = (page) =>
    page.evaluate(() => new Promise((resolve) => {
                    requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(resolve, 50)));
                  }));

/** Files, each a name and bytes, as a person drops them on the page. */
export async function drop(page, files) {
  const data = await page.evaluateHandle((list) => {
    const transfer = new DataTransfer();
    for (const [name, base64] of list)
      transfer.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
    return transfer;
  }, files.map(([name, bytes]) => [name, bytes.toString('base64')]));
  for (const kind of ['dragenter', 'dragover', 'drop'])
    await page.dispatchEvent('body', kind, {dataTransfer: data});
}

/** Red, green and blue of the middle of the picture, added up. */
export async function middle_colour(page) {
  const {x, y, width, height} = await page.locator('#canvas canvas').boundingBox();
  const png = (await page.screenshot({
                clip: {x: x + width / 2, y: y + height / 2, width: 1, height: 1}
              })).toString('base64');
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const pen = Object.assign(document.createElement('canvas'), {width: 1, height: 1}).getContext('2d');
    pen.drawImage(image, 0, 0);
    const [red, green, blue] = pen.getImageData(0, 0, 1, 1).data;
    return red + green + blue;
  }, png);
}
