// Checks the types, then bundles the unit tests with what they test and runs them: node run_unit.mjs, where
// the build keeps the packages.
import {spawnSync} from 'node:child_process';
import {existsSync, readdirSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const packages = join(process.cwd(), 'node_modules');
if (!existsSync('installed')) {
  console.error('the viewer\'s packages are not here: `npm ci` failed when the viewer was built');
  process.exit(1);
}
const node = (...args) => spawnSync(process.execPath, args, {stdio: 'inherit'}).status ?? 1;
const types = node(join(packages, 'typescript/bin/tsc'), '--noEmit', '-p', '.');
if (types !== 0) process.exit(types);

const here = dirname(fileURLToPath(import.meta.url));
const out = join(process.cwd(), 'unit');
rmSync(out, {recursive: true, force: true});
await createRequire(join(process.cwd(), 'package.json'))('esbuild').build({
  entryPoints: readdirSync(here).filter((name) => name.endsWith('.test.ts')).map((name) => join(here, name)),
  outdir: out,
  outExtension: {'.js': '.mjs'},
  bundle: true,
  platform: 'node',
  format: 'esm',
  target: 'node18',
  nodePaths: [packages],
  logLevel: 'warning',
});
process.exit(node('--test', ...readdirSync(out).map((name) => join(out, name))));
