import { loadPyodide } from "pyodide"; import fs from "fs";
const c=()=>{const u=process.cpuUsage();return ((u.user+u.system)/1e6).toFixed(2)};
const s=fs.readFileSync("/tmp/pg/out/lagc.js","utf8"); const zip=new Uint8Array(Buffer.from(s.slice(s.indexOf('"')+1,s.lastIndexOf('"')),"base64"));
console.log("start",c());
const py=await loadPyodide(); console.log("loaded",c());
py.unpackArchive(zip,"zip",{extractDir:"/lib/python3.14/site-packages"}); console.log("unpacked",c());
const a=py.pyimport("answers").answer; console.log("imported",c());
const text=py.runPython("import lagc.host.model_library as m; m.read('classic/double_pendulum').text");
for(const d of ["check","run","run","check"]){ const r=JSON.parse(a(JSON.stringify({do:d,text}))); console.log(d,c(),r.faults?JSON.stringify(r.faults):r.all_s);}
console.log(py.runPython("import sys; len(sys.modules)"));
