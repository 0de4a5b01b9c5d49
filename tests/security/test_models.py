"""What a model file cannot do: the claims of SECURITY.md, seen by an audit hook and in the generated text."""

import ast
import json
import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

import pytest

from lagc.codegen.c.emit import render as render_c
from lagc.codegen.python.emit import render as render_numpy
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Refused, Source
from lagc.simulation.backends.compile import compiler as c_compiler

ROOT = Path(__file__).parents[2]
TEMPLATE = """
model NAME0 "TEXT0"
  parameter Mass NAME1(min = 0) = 1 [kg] "TEXT1";
  parameter Length NAME2 = 0.5 [m] "TEXT2";
  input Force NAME3 = 0 "TEXT3";
  coordinate Angle NAME4(start = 1) "TEXT4";
  coordinate Length NAME5(start = 0.1) "TEXT5";
  body NAME6 = Particle(mass = NAME1, at = {NAME5, NAME2*sin(NAME4), -NAME2*cos(NAME4)});
  force NAME7 = -NAME1*velocity(NAME6)*(1 [1/s]) + NAME3*world.x at NAME6;
  constraint NAME8: NAME5 = 0.1*NAME2*sin(NAME4);
  output Energy NAME9 = energy();
end NAME0;
"""
HOSTILE_NAMES = [
    "__import__", "eval", "exec", "open", "__class__", "__builtins__", "os", "system", "goto", "__file__",
]  # fmt: skip
HOSTILE_TEXTS = [
    '*/ int evil = system(\\"id\\"); /*',
    '\\"\\"\\"\\nimport os\\nos.system(\'touch pwned\')\\n\\"\\"\\"',
    "' + __import__('os').system('touch pwned') + '",
    '??/\\n#include \\"/etc/passwd\\"',
    "\\\\\\n#include </etc/passwd>\\n//",
    "{__import__('os').system('touch pwned')} %n%s %(x)s {0.__class__}",
    "$(touch pwned) `touch pwned` ; touch pwned | touch pwned",
    "\\\\input{/etc/passwd} \\\\write18{touch pwned} $$",
    "<script>alert(1)</script>",
    "\x1b]0;evil\x07 \\N{DIGIT ONE} \\u0022 \u202e",
]
IMPORTS = ["/etc/passwd", "../secret.lag", "sub/../../secret.lag", "link.lag", "~/secret.lag",
           "$HOME/secret.lag", "file:///etc/passwd", "http://localhost/m.lag", "|id", "/dev/stdin",
           "//etc/passwd", "./../secret.lag"]  # fmt: skip


def model(names: list[str], texts: list[str]) -> str:
    words = {f"NAME{k}": name for k, name in enumerate(names)} | {
        f"TEXT{k}": text for k, text in enumerate(texts)
    }
    return re.sub(r"NAME\d|TEXT\d", lambda found: words[found[0]], TEMPLATE)


HOSTILE = model(HOSTILE_NAMES, HOSTILE_TEXTS)
# As long, since long statements are divided.
PLAIN = model(
    [re.sub("[a-z]", letter, name) for letter, name in zip("bdfghijkno", HOSTILE_NAMES)], ["a text"] * 10
)
OURS = tuple(dict.fromkeys(
    os.path.realpath(path) + os.sep
    for path in (ROOT / "lagc", ROOT / "grammar", ROOT / "models", ROOT / "tests", sys.prefix,
                 sys.base_prefix, sysconfig.get_paths()["stdlib"], sysconfig.get_paths()["purelib"])
))  # fmt: skip
MEMORY = "/proc/self/statm"  # how much the process has
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC
# What a run does besides opening files: lists folders of Python, makes and renames its own files.
FILES = {"os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.chmod", "os.link", "shutil.rmtree", "os.utime"}
QUIET = {"os.listdir", "os.scandir", "fcntl.fcntl", "marshal.dumps", "ctypes.create_string_buffer",
         "fcntl.flock", "resource.setrlimit", "tempfile.mkdtemp", "os.putenv", "os.unsetenv"}  # fmt: skip
DEFINITIONS = ("def __", "lambda _cls", "def foo(", "Callable[")  # those of dataclasses, named tuples, NumPy
TYPE = r"\w+(\[[\w., \[\]]*\])?( \| \w+)*"  # it calls nothing


def run(folder: Path, *words: str) -> tuple[int, list[Any], str]:
    """Exit code, events and all that was said of a command in the folder `folder/models`."""
    environment = {**os.environ, "WATCHED": str(folder / "events.json"), "LAGC_CACHE": str(folder / "cache"),
                   "TMPDIR": str(folder / "scratch"), "PYTHONPATH": str(ROOT), "HOME": str(folder),
                   "PYTHONDONTWRITEBYTECODE": "1"}  # fmt: skip
    command = [sys.executable, "-P", "-m", "tests.security.watched", *words]
    done = subprocess.run(command, cwd=folder / "models", env=environment, capture_output=True, timeout=240)
    return (
        done.returncode,
        json.loads((folder / "events.json").read_text()),
        (done.stdout + done.stderr).decode(),
    )


def unexpected(events: list[Any], folder: Path, generated: str = "") -> list[Any]:
    """Of the events those that nothing in lagc has reason for.  Written is within `folder`, but not
    where models lie; code that is run is Python's, lagc's, or the module `generated`."""
    mine = os.path.realpath(folder)

    def within(path: str, *roots: str) -> bool:
        return os.path.realpath(os.path.join(folder / "models", path)).startswith(roots)

    def fine(event: str, a: list[Any]) -> bool:
        if event == "open" and not isinstance(a[0], int):
            writes = bool(a[2] & WRITING) and a[0] != os.devnull
            if a[0] == os.sep and a[2] & getattr(os, "O_PATH", os.O_DIRECTORY):
                return True  # where the way to an import begins
            if os.sep not in a[0] and not a[0].endswith(".lag"):
                return True  # in the folder of the cache, by its descriptor
            return within(
                a[0], *((mine + "/cache", mine + "/out", mine + "/scratch") if writes else (*OURS, mine))
            ) or a[0] in (os.devnull, MEMORY)
        if event in FILES:
            paths = [path for path in a if isinstance(path, str) and os.sep in path]
            return all(within(path, mine + "/cache", mine + "/out", mine + "/scratch") for path in paths)
        if event == "compile":
            known = a[0].startswith(DEFINITIONS) or re.fullmatch(TYPE, a[0]) is not None
            return a[1] == generated or (a[1] == "<string>" and known) or within(a[1], *OURS)
        if event == "exec":
            return a[0] in (generated, "<string>") or a[0].startswith("<frozen") or within(a[0], *OURS)
        if event == "subprocess.Popen":
            words = c_compiler()
            return (
                words is not None and tuple(a[1][: len(words)]) == words and within(a[2], mine + "/scratch")
            )
        if event == "ctypes.dlopen":
            return a[0] is None or a[0].startswith("/proc/self/fd/") or "libm" in a[0]
        if event.startswith("glob.glob"):
            return within(a[0], *OURS)  # the kernels of lagc
        return event in QUIET or event == "open"

    return [event for event in events if not fine(*event)]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("models", "out", "scratch"):
        (tmp_path / name).mkdir()
    (tmp_path / "models" / "evil.lag").write_text(HOSTILE)
    return tmp_path


COMMANDS = {
    "check": ["check", "evil.lag"],
    "equations": ["equations", "evil.lag", "--format", "latex"],
    "explain": ["explain", "evil.lag"],
    "linearize": ["linearize", "evil.lag", "-o", "../out/linear.npz"],
    "fmt": ["fmt", "--check", "evil.lag"],
    "numpy": ["sim", "evil.lag", "--backend", "numpy", "-o", "../out/run.csv"],
    "c": ["sim", "evil.lag", "--backend", "c", "-o", "../out/run.npz"],
    "build": ["build", "evil.lag", "--target", "c", "-o", "../out"],
}


@pytest.mark.sample(1, 3)
@pytest.mark.skipif(os.name != "posix", reason="the paths of the events are those of POSIX")
@pytest.mark.parametrize("name", COMMANDS)
def test_a_model_opens_starts_and_runs_nothing(name: str, folder: Path) -> None:
    if name == "c" and c_compiler() is None:
        pytest.skip("there is no C compiler")
    status, events, said = run(folder, *COMMANDS[name])
    assert status == (1 if name == "fmt" else 0), said
    generated = {"numpy": "import_model.py", "linearize": "import_model.py", "check": "evaluation"}
    assert (
        any(event == "open" for event, _ in events)
        and unexpected(events, folder, generated.get(name, "")) == []
    )
    assert not list(folder.rglob("pwned")) and "\x1b" not in said and "\x07" not in said
    started = [event for event, _ in events if event == "subprocess.Popen"]
    assert len(started) == (name == "c")


def test_the_watch_sees_what_it_is_for(folder: Path) -> None:
    bad = [["open", ["/etc/passwd", "r", 0]], ["open", [str(folder / "models/x.lag"), "w", os.O_WRONLY]],
           ["subprocess.Popen", ["/bin/sh", ["/bin/sh", "-c", "id"], None, None]],
           ["socket.__new__", ["x", 2, 1, 0]], ["os.system", ["id"]], ["exec", ["evil.py"]],
           ["compile", ["import os", "<string>"]],
           ["os.remove", [str(ROOT / "README.md"), -1]], ["pickle.find_class", ["os", "system"]]]  # fmt: skip
    assert unexpected(bad, folder) == bad


@pytest.mark.skipif(os.name != "posix", reason="paths of POSIX")
def test_an_import_reads_nothing_outside_of_its_folder(folder: Path) -> None:
    """Nor does a message tell what is there, or whether it is."""
    (folder / "secret.lag").write_text("constant Real token = 42; // only for me")
    (folder / "models" / "link.lag").symlink_to("../secret.lag")
    lines = [f'import "{path}";' for path in IMPORTS] + [f'import "{path}.missing";' for path in IMPORTS]
    (folder / "models" / "evil.lag").write_text("\n".join(lines) + HOSTILE)
    status, events, said = run(folder, "check", "evil.lag")
    assert status == 1 and unexpected(events, folder) == [] and "only for me" not in said
    here = os.path.realpath(folder / "models")
    tried = {
        os.path.realpath(os.path.join(here, a[0]))
        for e, a in events
        if e == "open" and isinstance(a[0], str) and a[0] not in (MEMORY, os.sep)
    }
    assert here + "/evil.lag" in tried
    assert all(path.startswith((here + "/", os.path.realpath(folder / "cache"), *OURS)) for path in tried)
    outside = [path for path in IMPORTS if path.startswith(("/", "..", "sub/..", "./.."))]
    for path in outside:
        assert f"`{path}` is outside" in said and f"`{path}.missing` is outside" in said


def rendered(text: str) -> tuple[str, str]:
    """The C, and the Python module, of a model."""
    try:
        resolved = pipeline.resolve(
            pipeline.parse(Source('evil */ ??/ """ \n#.lag', text)), pipeline.Choice()
        )
    except Refused as refused:
        raise AssertionError([fault.message for fault in refused.faults]) from None
    program = pipeline.optimize(pipeline.derive(resolved), True)
    c = render_c(program)
    return "".join(c[name] for name in sorted(c, reverse=True)), next(iter(render_numpy(program).values()))


def shape_of_c(text: str) -> list[str]:
    """Its tokens, names and texts all alike."""
    comment, quoted, name = r"/\*.*?\*/|//[^\n]*", r"\"(?:\\.|[^\"\\\n])*\"", r"[A-Za-z_]\w*"
    bare = re.sub(rf"({quoted})|{comment}", lambda m: '"' if m[1] else " ", text, flags=re.S)
    return re.findall(r"\.?\d[\w.]*(?:[+-]\d+)?|\w+|\S", re.sub(rf"\b{name}", "a", bare))


def shape_of_python(text: str) -> list[str]:
    """Its syntax tree, names and texts all alike."""
    return [type(node).__name__ for node in ast.walk(ast.parse(text))]


@pytest.mark.full
def test_what_names_and_descriptions_say_does_not_change_generated_code() -> None:
    """It is the code of the same model with plain words, word for word."""
    for hostile, plain, shape in zip(rendered(HOSTILE), rendered(PLAIN), (shape_of_c, shape_of_python)):
        assert shape(hostile) == shape(plain)
        assert hostile != plain and len(shape(hostile)) > 1000


def test_the_shape_of_code_tells_more_than_words() -> None:
    assert shape_of_c('x = "a"; /* b */ y(1.0e-3);') == shape_of_c('xx = "*/"; // b\nz(1.0e-3);')
    assert shape_of_c("x = 1;") != shape_of_c("x = 1; y();")
    assert (
        shape_of_python("x = f('a')") == shape_of_python("y = g('b')") != shape_of_python("y = g('b'); z()")
    )


@pytest.mark.full
@pytest.mark.parametrize("number", range(5))
def test_generated_code_calls_nothing_but_itself_and_mathematics(number: int) -> None:
    """No input or output, no allocation, no module but those of arithmetic and types."""
    names = [
        "classic/four_bar", "classic/heavy_top_quaternion", "classic/kepler", "course/wheel_implicit", "",
    ]  # fmt: skip
    path = ROOT / "models" / f"{names[number]}.lag"
    c, python = rendered(path.read_text() if names[number] else HOSTILE)
    assert set(re.findall(r"^\s*#\s*include\s*(\S+)", c, re.M)) <= {
        "<float.h>",
        "<stdbool.h>",
        "<stddef.h>",
        "<string.h>",
        "<math.h>",
        *re.findall(r'"\w+\.h"', c),
    }
    tree = ast.parse(python)
    modules = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    modules |= {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    assert modules <= {"__future__", "collections.abc", "typing", "math", "numpy"}
    called = {
        node.func.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    assert not called & {"eval", "exec", "compile", "open", "__import__", "input"}


@pytest.mark.full
@pytest.mark.skipif(os.name != "posix", reason="paths of POSIX")
def test_what_is_written_names_no_folder(folder: Path) -> None:
    commands = [["build", "evil.lag", "--target", target, "-o", "../out"] for target in ("c", "numpy")]
    commands.append(
        ["sim", str(folder / "models" / "evil.lag"), "--backend", "numpy", "-o", "../out/run.csv"]
    )
    commands.append(
        ["sim", str(folder / "models" / "evil.lag"), "--backend", "numpy", "-o", "../out/run.npz"]
    )
    for words in commands:
        status, _, said = run(folder, *words)
        assert status == 0, said
    files = {path.name: path.read_bytes() for path in (folder / "out").iterdir()}
    assert {"import_model.h", "import_model.c", "import_model.py", "run.csv", "run.npz"} <= set(files)
    assert all(re.fullmatch(r"[a-z0-9_.]+", name) for name in files)
    for name, data in files.items():
        for word in (folder.name, os.path.realpath(folder), str(Path.home()), str(ROOT)):
            assert word.encode() not in data, (name, word)
