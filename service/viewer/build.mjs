// Bundles the viewer: node build.mjs OUT. Writes OUT/index.html, OUT/viewer.js, OUT/mouse_worker.js,
// OUT/viewer.css; nothing is fetched at run time.
import {build} from 'esbuild';
import {copyFileSync, mkdirSync, readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, 'out');
mkdirSync(out, {recursive: true});
// three's licence asks to go with every copy of it.
const three = dirname(dirname(createRequire(import.meta.url).resolve('three')));
const licence = readFileSync(join(three, 'LICENSE'), 'utf8').trim();
await build({
  entryPoints: {viewer: join(here, 'src/main.ts'), mouse_worker: join(here, 'src/mouse/mouse_worker.ts')},
  outdir: out,
  bundle: true,
  minify: true,
  format: 'esm',
  target: 'es2022',
  banner: {js: `/*! Contains three.js:\n\n${licence}\n*/`},
  legalComments: 'none',  // the banner has it, once and whole
  charset: 'ascii',
  logLevel: 'warning',
});
copyFileSync(join(here, 'src/theme.css'), join(out, 'viewer.css'));
copyFileSync(join(here, 'src/index.html'), join(out, 'index.html'));
