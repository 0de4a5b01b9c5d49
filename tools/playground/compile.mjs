// node compile.mjs FILE.zip: puts what Python makes of each module in its place, so that the browser need not.
// Kernels keep their text, which the compiler of kernels reads.
import { readFileSync, writeFileSync } from 'node:fs';
import { loadPyodide } from 'pyodide';

const [file] = process.argv.slice(2);
const python = await loadPyodide();
python.unpackArchive(new Uint8Array(readFileSync(file)), 'zip', { extractDir: '/files' });
python.runPython(`
import compileall, pathlib, shutil
compileall.compile_dir("/files", quiet=1, legacy=True)
for path in pathlib.Path("/files").rglob("*.py"):
    if "kernels" not in path.parts:
        path.unlink()
    else:
        path.with_suffix(".pyc").unlink()
shutil.make_archive("/all", "zip", "/files")
`);
writeFileSync(file, python.FS.readFile('/all.zip'));
