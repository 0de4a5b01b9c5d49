"""`python -m tests.supply lowest|newest|generated`: what lagc is made of, and what it makes, tried at length.

lowest, newest: builds sdist and wheel, installs the wheel with its extra `full` into a fresh virtual
environment, at the lower bounds of pyproject.toml or the newest versions that it allows, and runs there, from
the unpacked sdist, the tests that touch a dependency (`--all`: all tests).  `--python`: another interpreter.

generated: every model of the library, or those that are named, through all levels of optimisation of gcc and
clang and every checker that is on this machine.
"""

import argparse
import os
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

from lagc.host import model_library
from tests.codegen.everywhere import LEVELS, compilers, prepare, printed, tools
from tests.codegen.tools import STRICT, of_model
from tests.supply.bounds import ROOT, lowest

TOUCHING = [
    *("tests/syntax/test_grammar.py", "tests/symbolic/test_sympy.py", "tests/reports", "tests/api"),
    *("tests/cli/test_sim.py", "tests/codegen/test_numpy.py", "tests/supply", "tests/test_wheel.py"),
]


def environment(which: str, python: str, tests: list[str]) -> int:
    """Exit code of the tests in a fresh environment."""
    with tempfile.TemporaryDirectory(prefix="supply-") as name:
        folder = Path(name)
        run(sys.executable, "-m", "hatchling", "build", "-d", str(folder), cwd=ROOT)
        with tarfile.open(next(folder.glob("*.tar.gz"))) as archive:
            archive.extractall(folder, filter="data")
        source = next(path for path in folder.glob("lagc-*") if path.is_dir())
        run(python, "-m", "venv", str(folder / "venv"), cwd=folder)
        inside = str(folder / "venv" / ("Scripts" if os.name == "nt" else "bin") / "python")
        (folder / "lowest.txt").write_text("\n".join(lowest() if which == "lowest" else []))
        wheel = f"{next(folder.glob('*.whl'))}[full]"
        run(inside, "-m", "pip", "install", "-q", "-c", str(folder / "lowest.txt"), wheel, cwd=folder)
        run(inside, "-m", "pip", "check", cwd=folder)
        own = {**os.environ, "LAGC_CACHE": str(folder / "cache")}
        return subprocess.run([inside, "-m", "pytest", "-n", "2", *tests], cwd=source, env=own).returncode


def run(*words: str, cwd: Path) -> None:
    print("+", *words, flush=True)
    subprocess.run(words, cwd=cwd, check=True)


def generated(names: list[str]) -> int:
    """1 where the bits differ or a tool has something to say."""
    failures = 0
    missing = [name for name, tool in tools().items() if tool is None]
    print("compilers:", *compilers(), "; not here:", ", ".join(missing) or "nothing", flush=True)
    for name in names:
        with tempfile.TemporaryDirectory(prefix="supply-") as made:
            said = complaints(name, Path(made))
        failures += bool(said)
        print(name, "ok" if not said else "\n".join(said), flush=True)
    return min(failures, 1)


def complaints(model: str, folder: Path) -> list[str]:
    """What compilers and checkers say of one model."""
    units, said, bits = prepare(of_model(model), folder), [], {}
    for compiler, words in compilers().items():
        for level in LEVELS:
            try:
                text = printed([*words, *STRICT, *level], units, folder)
                bits.setdefault(text, f"{compiler} {' '.join(level)}")
            except AssertionError as error:
                said.append(f"{compiler} {' '.join(level)}: {error}")
    for name, tool in tools().items():
        try:
            if tool is not None:
                tool.ask(units, folder)
        except AssertionError as error:
            said.append(f"{name}: {error}")
    return said + ([f"other bits: {', '.join(bits.values())}"] if len(bits) > 1 else [])


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.supply")
    parser.add_argument("what", choices=["lowest", "newest", "generated"])
    parser.add_argument("models", nargs="*", help="of `generated`; all of the library where none is named")
    parser.add_argument("--python", default=sys.executable, help="of the environment")
    parser.add_argument("--all", action="store_true", help="all tests")
    options = parser.parse_args()
    if options.what == "generated":
        return generated(options.models or model_library.library_models())
    return environment(options.what, options.python, ["tests"] if options.all else TOUCHING)


if __name__ == "__main__":
    sys.exit(main())
