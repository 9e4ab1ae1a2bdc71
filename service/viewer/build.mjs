// Bundles the viewer: node build.mjs OUT. Writes OUT/index.html, OUT/viewer.js, OUT/viewer.css; nothing is fetched at run time.
import { build } from 'esbuild';
import { copyFileSync, mkdirSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, 'out');
mkdirSync(out, { recursive: true });
await build({
  entryPoints: { viewer: join(here, 'src/main.ts') },
  outdir: out,
  bundle: true,
  minify: true,
  format: 'esm',
  target: 'es2022',
  legalComments: 'none',   // three's licence is named in docs/DEPENDENCIES.md
  charset: 'ascii',
  logLevel: 'warning',
});
copyFileSync(join(here, 'src/theme.css'), join(out, 'viewer.css'));
copyFileSync(join(here, 'src/index.html'), join(out, 'index.html'));
