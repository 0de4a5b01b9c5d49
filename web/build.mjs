// npm ci && node build.mjs [FOLDER]: the script and the style that the package ships, the same bytes each time.
import { build } from 'esbuild';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const folder = process.argv[2] ?? join(here, '../lagc/reports/animation/page');

/** The name, version and licence of a package, for the first comment of what contains it. */
function licence(name) {
  const root = join(here, 'node_modules', name);
  const { version } = JSON.parse(readFileSync(join(root, 'package.json')));
  return `${name} ${version}\n${readFileSync(join(root, 'LICENSE'), 'utf8').trim()}`;
}

async function bundle(entry, packages, options) {
  const made = await build({
    ...options,
    absWorkingDir: here,
    entryPoints: [entry],
    bundle: true,
    minify: true,
    write: false,
    charset: 'ascii',
    legalComments: 'none',
  });
  return `/*!\n${packages.map(licence).join('\n\n')}\n*/\n${made.outputFiles[0].text}`;
}

const script = await bundle('src/main.js', ['three', 'uplot'], { format: 'iife', target: 'es2020' });
const style = await bundle('src/style.css', ['uplot'], {});
if (/<\/(script|style)|<!--|\r/i.test(script + style)) throw new Error('the bundle would end its element');
mkdirSync(folder, { recursive: true });
writeFileSync(join(folder, 'animate.min.js'), script);
writeFileSync(join(folder, 'animate.min.css'), style);
