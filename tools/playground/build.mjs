// node build.mjs FOLDER: the page, from the sources here and the packages of node_modules; lagc.zip is there.
// All files are scripts and styles, which a page may load from a folder too, where it may fetch nothing.
import { build } from 'esbuild';
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const here = dirname(fileURLToPath(import.meta.url));
const [folder] = process.argv.slice(2);
const common = { absWorkingDir: here, bundle: true, minify: true, charset: 'ascii', legalComments: 'none' };

const worker = await build({
  ...common,
  entryPoints: ['worker.mjs'],
  write: false,
  format: 'iife',
  banner: { js: 'self.importScripts = null;' }, // by which Pyodide tells a classic worker, the only kind in a folder
  define: { 'import.meta.url': '"https://lagc.invalid/"' }, // its files come by message
  external: ['node:*', 'ws'],
});
await build({
  ...common,
  entryPoints: { page: 'page.mjs', style: 'style.css' },
  outdir: folder,
  format: 'iife',
  define: { WORKER: JSON.stringify(worker.outputFiles[0].text) },
  loader: { '.woff2': 'dataurl', '.woff': 'empty', '.ttf': 'empty' },
});
copyFileSync(join(here, 'index.html'), join(folder, 'index.html'));

const pyodide = join(here, 'node_modules/pyodide');
const files = {
  python: gzipSync(readFileSync(join(pyodide, 'pyodide.asm.wasm')), { level: 9 }),
  library: readFileSync(join(pyodide, 'python_stdlib.zip')),
  lagc: readFileSync(join(folder, 'lagc.zip')),
};
for (const [name, bytes] of Object.entries(files))
  writeFileSync(join(folder, `${name}.js`), `(self.FILES ??= {}).${name} = "${bytes.toString('base64')}";\n`);
