"""Commands whose files, signals and compilers fail: nothing old is lost, nothing half-written is read."""

import errno
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
ERRORS = [
    errno.ENOSPC, errno.EACCES, errno.EIO, errno.EINTR, errno.EMFILE, errno.EROFS, errno.ENOENT, errno.ELOOP,
]  # fmt: skip
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL, signal.SIGQUIT, signal.SIGPIPE]
ENDS = {0, 1, 2, 3, 4, 74, 130, *(128 + s for s in SIGNALS)}
MODEL = """\
model M
parameter Length l = 0.5 [m];
coordinate Angle a(start = 1);
body b = Particle(mass = 1, at = l*{sin(a), 0, -cos(a)});
Gravity g;
end M;
"""
RUN = ("sim", "model.lag", "--stop", "0.1", "--points", "20")
COMMANDS: list[tuple[str, ...]] = [
    (*RUN, "-o", "out.csv"), (*RUN, "-o", "out.npz"), (*RUN, "-o", "out.csv", "--backend", "c"),
    (*RUN, "--plot", "out.svg"), (*RUN, "-o", "out.csv", "--json"),
    ("build", "model.lag", "-o", "gen"), ("build", "model.lag", "-o", "gen", "--target", "numpy"),
    ("fmt", "model.lag"), ("new", "Other"), ("new", "Old", "--force"), ("check", "model.lag"),
    ("equations", "model.lag"), ("linearize", "model.lag", "-o", "out.json"),
]  # fmt: skip
COMPILERS = {
    "dies": "kill -SEGV $$", "fails": "echo 'error: no' >&2; exit 1", "says nothing": "exit 3",
    "writes nothing": "exit 0",
    "writes half": 'cc "$@" && for f; do case $f in *.so) truncate -s 5000 "$f";; esac; done',
    "writes garbage": 'while [ "$1" != -o ]; do shift; done; head -c 3000 /dev/urandom > "$2"',
    "writes too little": 'while [ "$1" != -o ]; do shift; done; : > "$2"',
    "prints garbage": "head -c 300000 /dev/urandom >&2; exit 1",
    "has no memory": 'ulimit -v 20000; cc "$@"',
    "hangs": "sleep 30",
}  # fmt: skip


@dataclass(frozen=True)
class Disturbance:
    """`call` (how, number of the call on a file), `signal` (which, after how long) or `compiler` (which)."""

    command: tuple[str, ...]
    kind: str
    by: str
    at: float = 0.0
    warm: bool = True  # the cache holds what an undisturbed run leaves there

    def __str__(self) -> str:
        return (
            f"{' '.join(self.command)}: {self.kind} {self.by} at {self.at:g}{' (warm)' if self.warm else ''}"
        )


class Disturber:
    """Runs commands in folders of its own, disturbed; compares with what undisturbed ones leave."""

    def __init__(self, scratch: Path, tell: Callable[[str], None] = lambda command: None):
        self.scratch, self.tell = scratch, tell
        self.shim = scratch / "disturb.so"
        source = Path(__file__).with_name("disturb.c")
        subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", self.shim, source, "-ldl"], check=True)
        self.whole: dict[tuple[tuple[str, ...], bool], tuple[dict[str, bytes], int, float]] = {}

    def random(self, seed: int) -> Disturbance:
        chance = random.Random(seed)
        command, warm = chance.choice(COMMANDS), chance.random() < 0.5
        kind = chance.choice(["call", "call", "call", "call signal", "signal", "compiler"])
        if kind == "compiler":
            given = (*RUN, "-o", "out.csv", "--backend", chance.choice(["c", "c", "auto"]))
            return Disturbance(given, kind, chance.choice(list(COMPILERS)), warm=False)
        _, calls, seconds = self._whole(command, warm)
        if kind == "signal":
            return Disturbance(
                command, kind, str(int(chance.choice(SIGNALS))), chance.uniform(0, 1.2 * seconds), warm
            )
        at = chance.randint(1, max(calls, 1))
        if kind == "call":
            how, number = chance.choice(["error", "lasting"]), chance.choice(ERRORS)
            if number == errno.EINTR:  # which Python answers by the same call again
                how = "error"
            how = f"{how} {number}"
            return Disturbance(command, kind, how, at, warm)
        return Disturbance(command, "call", f"signal {int(chance.choice(SIGNALS))}", at, warm)

    def _whole(self, command: tuple[str, ...], warm: bool) -> tuple[dict[str, bytes], int, float]:
        """What an undisturbed run leaves, how many calls on files it makes, and how long it takes."""
        if (command, warm) not in self.whole:
            folder = self._folder(command, warm)
            count, began = self.scratch / "count", time.monotonic()
            done = self._run(folder, command, DISTURB_COUNT=str(count))
            assert done.returncode == 0, (command, done.stderr)
            taken = time.monotonic() - began
            self.whole[command, warm] = _files(folder), int(count.read_text()), taken
            shutil.rmtree(folder)
        return self.whole[command, warm]

    def _folder(self, command: tuple[str, ...], warm: bool) -> Path:
        folder = Path(tempfile.mkdtemp(dir=self.scratch))
        (folder / "model.lag").write_text(MODEL)
        if warm:
            self._run(folder, command, shim=False)
            for path in _paths(folder):
                path.unlink()
        old = ("out.csv", "out.npz", "out.svg", "Old.lag", "gen/m.c", "gen/m.h", "gen/m.py")
        for name in ("model.lag", *old):
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(MODEL if name == "model.lag" else f"the old {name}\n")
        return folder

    def _environment(self, folder: Path, shim: bool, more: dict[str, str]) -> dict[str, str]:
        own = {
            **os.environ,
            "LAGC_CACHE": str(folder / "cache"),
            "PYTHONPATH": str(ROOT),
            "MPLBACKEND": "agg",
        }
        own["TMPDIR"] = str(folder / "tmp")
        (folder / "tmp").mkdir(exist_ok=True)
        if shim:
            own |= {"LD_PRELOAD": str(self.shim), "DISTURB_UNDER": str(folder)}
        return own | more

    def _start(
        self, folder: Path, command: tuple[str, ...], shim: bool = True, **more: str
    ) -> subprocess.Popen[str]:
        self.tell(" ".join(command))
        return subprocess.Popen(
            [sys.executable, "-P", "-m", "lagc", *command],
            cwd=folder, env=self._environment(folder, shim, more),
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            errors="replace", start_new_session=True,
        )  # fmt: skip

    def _run(
        self, folder: Path, command: tuple[str, ...], shim: bool = True, **more: str
    ) -> subprocess.CompletedProcess[str]:
        process = self._start(folder, command, shim, **more)
        out, err = process.communicate(timeout=120)
        return subprocess.CompletedProcess(command, process.returncode, out, err)

    def stumbles(self, disturbance: Disturbance) -> Iterator[str]:
        """What went wrong."""
        command = disturbance.command
        lasting = "lasting" in disturbance.by  # what can no more be removed is left
        whole, _, _ = self._whole(command, disturbance.warm)
        folder = self._folder(command, disturbance.warm)
        before = _files(folder)
        try:
            done = self._disturbed(folder, disturbance)
        except subprocess.TimeoutExpired:
            yield "it hangs"
            return
        after = _files(folder)
        yield from _wrong_ending(done)
        for name in sorted(before.keys() | after.keys()):
            if same(name, after.get(name), whole.get(name)) and done.returncode >= 0:
                continue
            if after.get(name) != before.get(name) and not same(name, after.get(name), whole.get(name)):
                if name.startswith((".", "tmp/")) or "lagc-tmp" in name:
                    if done.returncode not in (-signal.SIGKILL, -signal.SIGQUIT) and not lasting:
                        yield f"{name} is left behind, exit code {done.returncode}"
                elif not any(
                    same(name, after.get(name), data) for data in whole.values()
                ):  # under a told name
                    yield f"{name} is neither as it was nor as it should become, exit code {done.returncode}"
            elif (
                done.returncode == 0
                and disturbance.kind != "compiler"
                and not same(name, after.get(name), whole[name])
            ):
                yield f"exit code 0, and {name} is as it was"
        yield from self._afterwards(folder, command, whole)
        shutil.rmtree(folder, ignore_errors=True)

    def _disturbed(self, folder: Path, disturbance: Disturbance) -> subprocess.CompletedProcess[str]:
        if disturbance.kind == "call":
            given = {"DISTURB_AT": f"{disturbance.at:g}", "DISTURB_BY": disturbance.by}
            return self._run(folder, disturbance.command, **given)
        if disturbance.kind == "compiler":
            script = self.scratch / "bad_cc"
            script.write_text(f"#!/bin/sh\n{COMPILERS[disturbance.by]}\n")
            script.chmod(0o755)
            if disturbance.by != "hangs":
                return self._run(folder, disturbance.command, shim=False, LAGC_CC=str(script))
            process = self._start(folder, disturbance.command, shim=False, LAGC_CC=str(script))
            time.sleep(1.0)
            process.send_signal(signal.SIGTERM)
        else:
            process = self._start(folder, disturbance.command, shim=False)
            time.sleep(disturbance.at)
            process.send_signal(int(disturbance.by))
        out, err = process.communicate(timeout=50)
        return subprocess.CompletedProcess(disturbance.command, process.returncode, out, err)

    def _afterwards(self, folder: Path, command: tuple[str, ...], whole: dict[str, bytes]) -> Iterator[str]:
        """The same, undisturbed, with the cache as it was left."""
        if command[0] == "new":
            return
        (folder / "model.lag").write_text(MODEL)
        done = self._run(folder, command, shim=False)
        if done.returncode != 0:
            yield f"afterwards exit code {done.returncode}: {done.stderr[-300:]}"
        left = _files(folder)
        for name in whole:
            if not same(name, left.get(name), whole[name]):
                yield f"afterwards {name} is another"


def _wrong_ending(done: subprocess.CompletedProcess[str]) -> Iterator[str]:
    both = done.stdout + done.stderr
    if "KeyboardInterrupt" in both and "program.py" not in both:
        return  # Python had not come to lagc yet
    if "Traceback (most" in both or "Fatal Python" in both or "Exception ignored" in both:
        yield f"a traceback: {both[-400:]}"
    elif "LAG0799" in both:
        yield f"an internal error: {both[-300:]}"
    elif done.returncode not in ENDS and -done.returncode not in SIGNALS:
        yield f"exit code {done.returncode}: {both[-300:]}"
    elif done.returncode > 0 and not both.strip():
        yield f"exit code {done.returncode} without a word"


def _paths(folder: Path) -> list[Path]:
    """All files but those of the cache."""
    return [p for p in folder.rglob("*") if p.is_file() and p.relative_to(folder).parts[0] != "cache"]


def _files(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in _paths(folder)}


def same(name: str, one: bytes | None, other: bytes | None) -> bool:
    """Whether the content of two files is, times of writing and of computing apart."""
    if one == other or one is None or other is None:
        return one == other
    if name.endswith(".svg"):
        return one.rstrip().endswith(b"</svg>") and other.rstrip().endswith(b"</svg>")
    if name.endswith(".csv.json"):
        return one.rstrip().endswith(b"}") and other.rstrip().endswith(b"}")
    if not name.endswith(".npz"):
        return False
    tables = []
    for data in (one, other):
        with tempfile.TemporaryFile() as file:
            file.write(data)
            try:
                with np.load(file) as table:
                    tables.append(table["time"].tolist())
            except (ValueError, OSError, KeyError, EOFError):
                return False
    return tables[0] == tables[1]
