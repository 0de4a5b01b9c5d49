// Python in a worker: the first message has its files, each later one a request, answered under its number.
import { loadPyodide } from 'pyodide';
import createPyodideModule from 'pyodide/pyodide.asm.mjs';
import lock from 'pyodide/pyodide-lock.json';

let answer;

async function start({ python, library, lagc }) {
  // Pyodide asks for these two by address.
  self.fetch = async () => new Response(library);
  WebAssembly.instantiateStreaming = async (_, imports) => ({
    instance: await WebAssembly.instantiate(python, imports),
    module: python,
  });
  const pyodide = await loadPyodide({
    indexURL: 'https://lagc.invalid/',
    createPyodideModule,
    lockFileContents: { info: lock.info, packages: {} },
  });
  const folder = pyodide.runPython('import site; site.getsitepackages()[0]');
  pyodide.unpackArchive(lagc, 'zip', { extractDir: folder });
  answer = pyodide.pyimport('answers').answer;
}

onmessage = async ({ data }) => {
  try {
    if (data.files) {
      await start(data.files);
      postMessage({ ready: true });
    } else {
      postMessage({ id: data.id, found: JSON.parse(answer(JSON.stringify(data.asked))) });
    }
  } catch (error) {
    postMessage({ id: data.id, broken: String(error.message ?? error) });
  }
};
