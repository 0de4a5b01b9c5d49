"""Speed and accuracy beside other tools, measured in one run.

    python -m tools.benchmarks [--quick] [--write] [--json FILE]
    python -m tools.benchmarks contacts    (separate contacts, beside MuJoCo)
    python -m tools.benchmarks growth | runs | stages | startup | verified    (of lagc alone)

Other tools are used if they are installed: pip install -e '.[peers]'.
"""

from __future__ import annotations

import argparse
import importlib.util
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tools.benchmarks.measured import Report

OTHERS = ("contacts", "growth", "runs", "stages", "startup", "verified")


def main() -> int:
    if sys.argv[1:2] and sys.argv[1] in OTHERS:
        importlib.import_module(f"tools.benchmarks.{sys.argv.pop(1)}").main()
        return 0
    from tools.benchmarks.tools import alone

    alone()  # before NumPy is loaded by others
    return report()


def report() -> int:
    from tools.benchmarks.measured import begun
    from tools.benchmarks.problems import PROBLEMS
    from tools.benchmarks.tools import TOOLS

    parser = argparse.ArgumentParser(
        prog="python -m tools.benchmarks", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    names = [problem.name for problem in PROBLEMS]
    parser.add_argument("--quick", action="store_true", help="two problems, few tolerances, one round")
    parser.add_argument("--problems", help=f"some of {','.join(names)}")
    parser.add_argument("--tools", help="words of the names of other tools, separated by commas, or `none`")
    parser.add_argument("--json", metavar="FILE", help="write all numbers")
    parser.add_argument(
        "--write", action="store_true",
        help="write the figures of the README and of docs (README.md, docs/*.svg, docs/benchmarks.json)",
    )  # fmt: skip
    asked = parser.parse_args()
    wanted = asked.problems.split(",") if asked.problems else names[:: 7 if asked.quick else 1]
    if not set(wanted) <= set(names):
        parser.error(f"the problems are {', '.join(names)}")
    if asked.write and (asked.quick or asked.problems or asked.tools):
        parser.error("the figures of the documentation need all problems and tools")
    if asked.json and not Path(asked.json).absolute().parent.is_dir():
        parser.error(f"there is no folder for {asked.json}")
    lacking = begun(TOOLS).missing if asked.write else {}
    if lacking or (asked.write and importlib.util.find_spec("matplotlib") is None):
        wanting = ", ".join(lacking) or "matplotlib"
        parser.error(f"the figures of the documentation need {wanting}: pip install -e '.[peers]'")
    tools = asked.tools.split(",") if asked.tools else []
    strange = [word for word in tools if word != "none" and not any(word in tool.name for tool in TOOLS)]
    if strange:
        parser.error(f"no tool is called {strange[0]}: {', '.join(t.name for t in TOOLS if t.package)}")
    found = measured(wanted, tools or None, asked.quick)
    from tools.benchmarks.report import numbers, text, write

    text(found)
    if asked.json:
        Path(asked.json).write_text(numbers(found), encoding="utf-8")
    if asked.write:
        for path in write(found):
            print(f"written: {path}")
        words = ("cost", "double_pendulum", "--stop", "10", "-q", "-o", "docs/cost.svg")
        root = Path(__file__).parents[2]
        return subprocess.run([sys.executable, "-m", "lagc", *words], cwd=root).returncode
    return 0


def measured(problems: list[str], words: list[str] | None, quick: bool) -> Report:
    from tools.benchmarks.measured import begun, measure
    from tools.benchmarks.problems import PROBLEMS
    from tools.benchmarks.tools import chosen

    tools = chosen(words)
    found = begun(tools)
    for problem in PROBLEMS:
        if problem.name in problems:
            print(f"measuring: {problem.title}", file=sys.stderr, flush=True)
            found.parts.append(measure(problem, tools, quick))
    return found


if __name__ == "__main__":
    raise SystemExit(main())
