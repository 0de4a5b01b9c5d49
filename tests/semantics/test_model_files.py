"""Model files and imports are read whole or refused, and nothing waits."""

import os
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import lagc
from lagc.cli.main import main
from lagc.compiler.checking import check
from lagc.compiler.stages import Choice, parse, resolve
from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.host import model_library
from lagc.semantics.names.namespace import TOGETHER

POSIX = os.name == "posix"
MAIN = """import "lib.lag";
model A
  coordinate Length x(start = x0, rate = 1);
  body b = Particle(mass = 1, at = {x, 0, 0});
end A;
"""
WHOLE = "constant Length x0 = 2;"
only_posix = pytest.mark.skipif(not POSIX, reason="these files are of other systems")


def faults(folder: Path, text: str = MAIN) -> list[Fault]:
    (folder / "main.lag").write_text(text)
    return check(model_library.read(str(folder / "main.lag")), Choice())


def refusal(name: str) -> Fault:
    with pytest.raises(Refused) as caught:
        model_library.read(name)
    (fault,) = caught.value.faults
    return fault


def padded(size: int) -> bytes:
    """A model of so many bytes; what it declares stands at the end, where a cut would lose it."""
    return b"//" + b"x" * (size - len(WHOLE) - 3) + b"\n" + WHOLE.encode()


def test_a_file_of_the_largest_size_is_read_whole(tmp_path: Path) -> None:
    (tmp_path / "lib.lag").write_bytes(padded(model_library.LARGEST))
    assert faults(tmp_path) == []
    assert len(model_library.read(str(tmp_path / "lib.lag")).text) == model_library.LARGEST


@pytest.mark.parametrize("more", [1, 2, 3_000_000])
def test_a_larger_one_is_refused(tmp_path: Path, more: int) -> None:
    (tmp_path / "lib.lag").write_bytes(padded(model_library.LARGEST + more))
    (fault,) = faults(tmp_path)
    assert (fault.code, str(fault.span)) == ("LAG0216", f"{tmp_path}/main.lag:1:1")
    assert "larger than 4 MB" in fault.message
    assert refusal(str(tmp_path / "lib.lag")).code == "LAG0704"


def test_all_imports_together_are_bounded(tmp_path: Path) -> None:
    """Each of them is small enough."""
    number = TOGETHER // model_library.LARGEST + 1
    for k in range(number):
        (tmp_path / f"l{k}.lag").write_bytes(b"//" + b"x" * (model_library.LARGEST - 2))
    (tmp_path / f"l{number - 1}.lag").write_bytes(b"//")
    lines = "".join(f'import "l{k}.lag";\n' for k in range(number))
    (fault,) = faults(tmp_path, lines + MAIN.split("\n", 1)[1].replace("x0", "2"))
    assert str(fault.span) == f"{tmp_path}/main.lag:{number}:1" and "larger than 40 MB" in fault.message


def make_pipe(path: Path) -> None:
    os.mkfifo(path)


def make_socket(path: Path) -> None:
    here = os.getcwd()
    os.chdir(path.parent)  # the name of a socket is short
    try:
        socket.socket(socket.AF_UNIX).bind(path.name)
    finally:
        os.chdir(here)


def make_device(path: Path) -> None:
    try:
        os.mknod(path, 0o600 | 0o020000, os.makedev(1, 5))  # /dev/zero
    except OSError:
        pytest.skip("only root makes devices")


def make_link_to_device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def make_hole(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(1 << 40)


ODD = [make_pipe, make_socket, make_device, make_link_to_device, Path.mkdir, make_hole]


@only_posix
@pytest.mark.parametrize("make", ODD, ids=lambda make: make.__name__)
@pytest.mark.parametrize(
    "text", [MAIN, MAIN.replace('"lib.lag"', "lib.x0"), MAIN.replace('"lib.lag"', "lib.*")]
)
def test_an_import_is_a_file(tmp_path: Path, make: Callable[[Path], object], text: str) -> None:
    """Whatever else stands under its name is a fault with its place; nobody waits for it."""
    make(tmp_path / "lib.lag")
    found = faults(tmp_path, text)
    assert {f.code for f in found} <= {"LAG0216", "LAG0217", "LAG0201"}
    assert all(f.span is not None for f in found)
    assert found[0].span is not None and found[0].span.line == 1


@only_posix
@pytest.mark.parametrize("make", [m for m in ODD if m is not make_link_to_device], ids=lambda m: m.__name__)
def test_a_model_is_a_file_or_a_pipe(tmp_path: Path, make: Callable[[Path], object]) -> None:
    path = tmp_path / "m.lag"
    make(path)
    assert refusal(str(path)).code == ("LAG0704" if make is make_hole else "LAG0702")


def test_a_folder_does_not_hide_a_model_of_the_library(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "simple_pendulum").mkdir()
    (tmp_path / "course" / "simple_pendulum").mkdir(parents=True)
    for name in ("simple_pendulum", "course/simple_pendulum"):
        assert "model SimplePendulum" in model_library.read(name).text
    assert refusal("course").code == "LAG0702"


@only_posix
def test_a_pipe_that_is_written_to_is_read(tmp_path: Path) -> None:
    """As the shell's `<(...)` is, also slowly and in pieces."""
    path = tmp_path / "pipe"
    os.mkfifo(path)
    keeper = os.open(path, os.O_RDWR)
    pieces = [f"// {'x' * 70_000}\n" for _ in range(3)] + [WHOLE]

    def write() -> None:
        with open(path, "w") as file:
            os.close(keeper)
            file.writelines(pieces)

    threading.Timer(0.1, write).start()
    assert model_library.read(str(path)).text == "".join(pieces)


@pytest.mark.full
@pytest.mark.skipif(not POSIX or not os.path.exists("/bin/bash"), reason="no bash")
@pytest.mark.parametrize(
    "words", ["<(cat {})", "/dev/stdin < {}", "- < {}", "/dev/stdin < <(sleep 0.1; cat {})"]
)
def test_shells_give_models(tmp_path: Path, words: str) -> None:
    path = tmp_path / "m.lag"
    path.write_text(MAIN.split("\n", 1)[1].replace("x0", "2"))
    command = f"{sys.executable} -m lagc sim -q --stop 0.1 --backend numpy {words.format(path)}"
    done = subprocess.run(["/bin/bash", "-c", command], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("place", ["//\0\n", "\0", "model \0A\nend A;", '"\0"', "/* \n \0 */", "x\n  \0"])
def test_a_nul_has_its_place_and_is_a_fault(tmp_path: Path, place: str) -> None:
    """Everywhere, in comments and texts too; in an import, at its place there."""
    before = place[: place.index("\0")]
    line, column = before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1
    for text in (place, place + WHOLE + "\n" + "\0" * 1000):
        with pytest.raises(Refused) as caught:
            parse(Source("m.lag", text))
        (fault,) = caught.value.faults
        assert (fault.code, str(fault.span)) == ("LAG0101", f"m.lag:{line}:{column}")
        (tmp_path / "lib.lag").write_text(text)
        found = faults(tmp_path)
        assert f"{tmp_path}/lib.lag:{line}:{column}" in {str(f.span) for f in found if f.code == "LAG0101"}


@pytest.mark.parametrize(
    "data", [b"\xff", b"a\n\n  \x80", "model".encode("utf-16"), b"\xed\xa0\x80", b"\xc3"]
)
def test_what_is_no_text_is_refused(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "lib.lag").write_bytes(data)
    fault = refusal(str(tmp_path / "lib.lag"))
    assert fault.code == "LAG0703" and "in line" in fault.message
    (found,) = faults(tmp_path)
    assert found.code == "LAG0216" and "UTF-8" in found.message


@pytest.mark.parametrize(
    "written", ["", ".", "..", "/", "lib.lag/", "x" * 5000, "a/" * 2000 + "b", "C:\\x", "loop"]
)
def test_names_of_no_file(tmp_path: Path, written: str) -> None:
    if POSIX:
        (tmp_path / "loop").symlink_to("loop")
    found = faults(tmp_path, MAIN.replace("lib.lag", written))
    assert {f.code for f in found} <= {"LAG0216", "LAG0217", "LAG0201"} and found[0].span is not None


def started_at(folder: Path) -> float:
    return float(lagc.load(str(folder / "main.lag")).compile(backend="numpy").start()[0])


def test_what_an_import_leads_to_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not what it led to when the model was compiled: a file that now comes first in the search, a link that
    leads elsewhere, a file that has gone."""
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path / "cache"))
    (tmp_path / "a").mkdir()
    (tmp_path / "main.lag").write_text(MAIN.replace('"lib.lag"', "a.b.x0"))
    (tmp_path / "a.lag").write_text("package a package b constant Length x0 = 1; end b; end a;")
    assert [started_at(tmp_path) for _ in range(2)] == [1.0, 1.0]
    (tmp_path / "a" / "b.lag").write_text("package b constant Length x0 = 2; end b;")
    assert started_at(tmp_path) == 2.0
    (tmp_path / "a" / "b").mkdir()
    (tmp_path / "a" / "b" / "x0.lag").write_text("constant Length x0 = 3;")
    assert [started_at(tmp_path) for _ in range(2)] == [3.0, 3.0]
    (tmp_path / "a" / "b" / "x0.lag").unlink()
    assert started_at(tmp_path) == 2.0
    (tmp_path / "a" / "b.lag").unlink()
    assert started_at(tmp_path) == 1.0
    if POSIX:
        for k in (4, 5):
            (tmp_path / f"v{k}").mkdir()
            (tmp_path / f"v{k}" / "l.lag").write_text('import "n.lag"; constant Length x0 = n;')
            (tmp_path / f"v{k}" / "n.lag").write_text(f"constant Length n = {k};")
        (tmp_path / "main.lag").write_text(MAIN)
        for k in (4, 5, 4):
            (tmp_path / "lib.lag").unlink(missing_ok=True)
            (tmp_path / "lib.lag").symlink_to(f"v{k}/l.lag")
            assert started_at(tmp_path) == k


def test_an_import_that_grows_after_it_was_compiled_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path / "cache"))
    (tmp_path / "main.lag").write_text(MAIN)
    (tmp_path / "lib.lag").write_text(WHOLE)
    assert started_at(tmp_path) == 2.0
    with (tmp_path / "lib.lag").open("ab") as file:
        file.write(b" " * model_library.LARGEST)
    with pytest.raises(Refused, match="larger than 4 MB"):
        started_at(tmp_path)


@only_posix
def test_a_link_that_is_exchanged_while_it_is_read_leads_nowhere_else(tmp_path: Path) -> None:
    """Another process exchanges links to a file and to its folder; what is read is inside, or nothing is."""
    inner, outer = tmp_path / "inner", tmp_path / "outer"
    for folder, text in ((inner / "real", "inside"), (outer, "outside")):
        folder.mkdir(parents=True)
        (folder / "d.csv").write_text(text)
    ended = threading.Event()

    def exchange() -> None:
        k = 0
        while not ended.is_set():
            k += 1
            target = (outer, inner / "real")[k % 2]
            for link, goal in ((inner / "d.csv", target / "d.csv"), (inner / "folder", target)):
                spare = inner / "spare"
                spare.symlink_to(goal)
                spare.replace(link)

    other = threading.Thread(target=exchange)
    other.start()
    seen = []
    try:
        for path in [inner / "d.csv", inner / "folder" / "d.csv"] * 1500:
            try:
                seen.append(model_library.content(str(path), roots=[str(inner)]).decode())
            except model_library.Unreadable as error:
                seen.append(type(error).__name__)
    finally:
        ended.set()
        other.join()
    assert {"inside", "Outside"} <= set(seen) <= {"inside", "Outside", "Unreadable"}


def test_resolving_reads_each_file_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reads: list[str] = []
    monkeypatch.setattr(
        "lagc.semantics.names.namespace.content", lambda path, roots: [reads.append(path), WHOLE.encode()][1]
    )
    (tmp_path / "main.lag").write_text(MAIN)
    resolve(parse(model_library.read(str(tmp_path / "main.lag"))), Choice())
    assert reads == [str(tmp_path / "lib.lag")]


@pytest.mark.full
@only_posix
def test_standard_input_that_does_not_wait_is_waited_for(tmp_path: Path) -> None:
    """Somebody else may have set the pipe so."""
    out, into = os.pipe()
    os.set_blocking(out, False)
    command = [sys.executable, "-m", "lagc", "check", "-"]
    process = subprocess.Popen(command, stdin=out, stderr=subprocess.PIPE, text=True)
    os.close(out)
    with open(into, "w") as file:
        for line in MAIN.replace("x0", "2").splitlines(keepends=True)[1:]:
            time.sleep(0.1)
            file.write(line)
            file.flush()
    assert process.communicate(timeout=60)[1] == "no errors in -\n"


@only_posix
def test_what_is_no_file_is_not_laid_out(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for name in ("pipe", "."):
        assert main(["fmt", str(tmp_path / name)]) == 2


@pytest.mark.full
@only_posix
def test_the_folder_where_we_are_may_be_gone(tmp_path: Path) -> None:
    """What needs none goes on; an import from there is a fault."""
    (tmp_path / "main.lag").write_text(MAIN)
    (tmp_path / "lib.lag").write_text(WHOLE)
    command = f"mkdir gone; cd gone; rmdir ../gone; {sys.executable} -m lagc"
    environment = {**os.environ, "PYTHONPATH": str(Path(lagc.__file__).parents[1]), "LAGC_CACHE": ""}
    for words, text, code in [
        (f"sim -q --stop 0.1 --backend numpy {tmp_path}/main.lag", "", 0),
        ("sim -q --stop 0.1 --backend numpy -", MAIN.split("\n", 1)[1].replace("x0", "2"), 0),
        ("sim -q -", MAIN, 1),
        ("sim -q -", MAIN.replace('"lib.lag"', "lib.x0"), 1),
    ]:
        done = subprocess.run(
            ["/bin/sh", "-c", f"{command} {words}"], input=text, cwd=tmp_path, env=environment,
            capture_output=True, text=True, timeout=60,
        )  # fmt: skip
        assert done.returncode == code, (words, done.stderr)
        assert "internal" not in done.stderr
