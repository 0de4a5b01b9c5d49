// node compile.mjs FILE.zip: puts what Python makes of each module in its place, so that the browser need not.
// The compiler of kernels reads its own text and theirs: these stay beside it.
import { readFileSync, writeFileSync } from 'node:fs';
import { loadPyodide } from 'pyodide';

const [file] = process.argv.slice(2);
const python = await loadPyodide();
python.unpackArchive(new Uint8Array(readFileSync(file)), 'zip', { extractDir: '/files' });
python.runPython(`
import compileall, pathlib, py_compile, shutil
compileall.compile_dir("/files", quiet=1, invalidation_mode=py_compile.PycInvalidationMode.UNCHECKED_HASH)
for made in pathlib.Path("/files").rglob("*.pyc"):
    source = made.parent.parent / f"{made.stem.partition('.')[0]}.py"
    if not {"kernels", "codegen"} & {*made.parts}:
        source.unlink()
        made.rename(source.with_suffix(".pyc"))
shutil.make_archive("/all", "zip", "/files")
`);
writeFileSync(file, python.FS.readFile('/all.zip'));
