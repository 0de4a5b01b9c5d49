// node bits.mjs ZIP PACKAGES MODEL ...: the states of runs in Pyodide, and its answers to some requests.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [zip, packages, ...models] = process.argv.slice(2);
const { loadPyodide } = await import(pathToFileURL(join(packages, 'pyodide/pyodide.mjs')));
const python = await loadPyodide();
const folder = python.runPython('import site; site.getsitepackages()[0]');
python.unpackArchive(new Uint8Array(readFileSync(zip)), 'zip', { extractDir: folder });
const states = python.runPython(`
import json, lagc
lambda name: json.dumps(lagc.load(name).compile(backend="numpy").simulate().states)
`);
const { answer } = python.pyimport('answers');
const found = Object.fromEntries(models.map(name => [name, JSON.parse(states(name))]));
const text = python.pyimport('lagc.host.model_library').read(models[0]).text;
const ask = (what, more = {}) => JSON.parse(answer(JSON.stringify({ do: what, text, ...more })));
const run = ask('run', { parameters: { l1: 2 } });
const wrong = { text: text.replace('sin(theta1)', 'sin(theta3)') };
console.log(JSON.stringify({
  found,
  run: { ...run, page: run.page.length },
  check: ask('check'),
  wrong: [ask('check', wrong), ask('fixes', wrong), ask('whole', wrong), ask('run', wrong)],
  offers: ask('complete', { offset: text.indexOf('Particle') }).offers.map(offer => offer.label),
  hover: ask('hover', { offset: text.indexOf('theta1(start') }).hover,
}));
