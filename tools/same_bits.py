"""Record all that lagc makes of the library, and compare two records: before a change and after it.

    python tools/same_bits.py record DIR [--sample N] [--only PART,...] [PATTERN ...]
    python tools/same_bits.py compare DIR DIR

A record has one file for each subject: each scene of each model of `models`, the messages of each model of
`models` and the messages of the refused models of `tests/rejected`.  A file that is there is not made again,
so an interrupted record goes on; `--sample` takes N subjects, evenly spread, and PATTERN those whose name it
matches (`classic/*`).  The parts of a scene are

    code        the generated C and Python
    texts       `explain`, `equations`
    start       the consistent initial state, and what is said of it
    hand        a run by the default method, rtol = 1e-8, 501 points
    verified    a run to the accuracy of the scene, or the default one

Runs end after `--stop` seconds (of the model) at the latest.  `compare` lists the parts that differ, and how.
All but the code is kept as text, so that it can tell.  Its exit code is 1 if anything differs.
"""

from __future__ import annotations

import argparse
import contextlib
import difflib
import fnmatch
import hashlib
import io
import json
import sys
import zlib
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import lagc  # noqa: E402
from lagc.cli.main import main as run_command  # noqa: E402
from lagc.compiler.checking import check  # noqa: E402
from lagc.compiler.stages import Choice, render  # noqa: E402
from lagc.diagnostics.faults import Refused, Source, report  # noqa: E402
from lagc.semantics.scenes import Variant, variants  # noqa: E402
from lagc.simulation.request import Request  # noqa: E402
from lagc.syntax.parse import parse  # noqa: E402

MODELS = ROOT / "models"
PARTS = ("code", "texts", "start", "hand", "verified")
SHOWN = 6  # lines of a difference

Parts = dict[str, str]  # the text of each part


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(required=True)
    recorder = commands.add_parser("record")
    recorder.add_argument("folder", type=Path)
    recorder.add_argument("patterns", nargs="*")
    recorder.add_argument("--sample", type=int)
    recorder.add_argument("--only", default=",".join(PARTS), help="parts, with commas between them")
    recorder.add_argument("--stop", type=float, default=5.0, help="the latest end of a run in s")
    recorder.set_defaults(run=lambda o: record(o.folder, o.patterns, o.sample, o.only.split(","), o.stop))
    comparer = commands.add_parser("compare")
    comparer.add_argument("before", type=Path)
    comparer.add_argument("after", type=Path)
    comparer.set_defaults(run=lambda o: compare(o.before, o.after))
    options = parser.parse_args()
    done: int = options.run(options)
    return done


def record(folder: Path, patterns: list[str], sample: int | None, parts: list[str], stop: float) -> int:
    """Write what is missing of a record."""
    made = subjects(parts, stop)
    names = [n for n in made if not patterns or any(fnmatch.fnmatch(n, p) for p in patterns)]
    if sample is not None:
        names = [names[k * len(names) // sample] for k in range(min(sample, len(names)))]
    (folder / "texts").mkdir(parents=True, exist_ok=True)
    for k, name in enumerate(names):
        path = folder / f"{name.replace('/', '+')}.json"
        if path.exists():
            continue
        hashes = {}
        for part, text in made[name]().items():
            hashes[part] = hashlib.sha256(text.encode()).hexdigest()
            if not part.startswith("code"):
                (folder / "texts" / hashes[part]).write_bytes(zlib.compress(text.encode()))
        path.write_text(json.dumps(hashes, indent=1))
        print(f"{k + 1}/{len(names)} {name}", flush=True)
    return 0


def subjects(parts: list[str], stop: float) -> dict[str, Callable[[], Parts]]:
    """What is recorded, by name: functions that make its parts."""
    made: dict[str, Callable[[], Parts]] = {"rejected": rejected}
    for path in sorted(MODELS.rglob("*.lag")):
        name = path.relative_to(MODELS).with_suffix("").as_posix()
        source = Source(path.name, path.read_text(encoding="utf-8"))
        made[f"{name} messages"] = partial(lambda s: {"messages": messages(s)}, source)
        for v in variants(parse(source)):
            effects = [*(f"+{e}" for e in v.with_effects), *(f"-{e}" for e in v.without_effects)]
            words = [w for w in (v.model, v.scene, *effects) if w]
            made[" ".join([name, *words])] = partial(scene, path, v, parts, stop)
    return made


def rejected() -> Parts:
    """The messages of refused models, each under the name of its case."""
    from tests.rejected.test_rejected import CASES, HABITS, unmarked, whole

    texts = {about: unmarked(whole(text))[0] for about, _, text in CASES}
    texts.update({f"habit {name}": habit.text for name, habit in HABITS.items()})
    return {about: messages(Source("model.lag", text)) for about, text in texts.items()}


def messages(source: Source) -> str:
    return report(check(source, Choice()))


def scene(path: Path, v: Variant, parts: list[str], stop: float) -> Parts:
    """The parts of one scene; a refusal is the text of the part."""
    compiled = lagc.load(str(path)).compile(
        v.scene, model=v.model, use=v.with_effects, without=v.without_effects, backend="c"
    )
    choice = {"--model": [v.model] if v.model else [], "--scene": [v.scene] if v.scene else [],
              "--with": v.with_effects, "--without": v.without_effects}  # fmt: skip
    words = [
        str(path),
        *(word for option, names in choice.items() for name in names for word in (option, name)),
    ]
    makers: dict[str, dict[str, Callable[[], str]]] = {
        "code": {f"code {target}": partial(code, compiled, target) for target in ("c", "numpy")},
        "texts": {command: partial(printed, [command, *words]) for command in ("explain", "equations")},
        "start": {"start": partial(start, compiled)},
        "hand": {"hand": partial(motion, compiled, stop, rtol=1e-8, points=501)},
        "verified": {"verified": partial(motion, compiled, stop)},
    }
    return {name: refusal_or(make) for part in parts for name, make in makers[part].items()}


def refusal_or(make: Callable[[], str]) -> str:
    try:
        return make()
    except Refused as refused:
        return report(refused.faults)
    except Exception as error:  # a record of a fault of lagc, too, can be compared
        return f"{type(error).__name__}: {error}"


def code(compiled: lagc.CompiledModel, target: str) -> str:
    return "\n".join(render(compiled.program, target).values())


def printed(words: list[str]) -> str:
    """What a command prints, and its exit code."""
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(out):
        done = run_command(words)
    return f"{out.getvalue()}exit code {done}\n"


def start(compiled: lagc.CompiledModel) -> str:
    begun = compiled._loaded.initialize(
        compiled.load("numpy"), Request().completed(compiled.interface.simulate)
    )
    return "\n".join([*(f"{n} {x!r}" for n, x in zip(compiled.state_names, begun.x)), *begun.notes])


def motion(compiled: lagc.CompiledModel, stop: float, **by_hand: float) -> str:
    """A run as text: what is said of it, then the names of its columns and its rows."""
    end = Request().completed(compiled.interface.simulate).stop or 10.0
    run = compiled.simulate(min(end, stop), **by_hand)  # type: ignore[arg-type]
    said = [run.status, run.message, run.method, repr(run.rtol), repr(run.estimated), *run.notes]
    events = [repr(event) for event in run.events]
    rows = [" ".join([repr(t), *map(repr, x)]) for t, x in zip(run.times, run.states)]
    outputs = [f"{name} {run.column(name)!r}" for name in run.names if name not in run.state_names]
    return "\n".join([*said, *events, *outputs, f"t {' '.join(compiled.state_names)}", *rows])


def compare(before: Path, after: Path) -> int:
    """Print what differs; 1 if anything does."""
    records = [
        {p.stem: json.loads(p.read_text()) for p in folder.glob("*.json")} for folder in (before, after)
    ]
    differing = 0
    for name in sorted(records[0].keys() & records[1].keys()):
        old, new = (r[name] for r in records)
        parts = [part for part in old.keys() | new.keys() if old.get(part) != new.get(part)]
        for part in sorted(parts):
            print(f"{name.replace('+', '/', 1)}: {part}")
            texts = [text_of(f, r.get(part)) for f, r in ((before, old), (after, new))]
            print("".join(f"    {line}\n" for line in difference(*texts)), end="")
        differing += bool(parts)
    both, lone = records[0].keys() & records[1].keys(), records[0].keys() ^ records[1].keys()
    print(f"{differing} of {len(both)} subjects differ; {len(lone)} are in one record only")
    return int(differing > 0)


def text_of(folder: Path, key: str | None) -> list[str]:
    path = folder / "texts" / (key or "-")
    return zlib.decompress(path.read_bytes()).decode().splitlines() if path.exists() else []


def difference(old: list[str], new: list[str]) -> Iterator[str]:
    """The first lines that differ, and the largest relative difference of numbers in the same place."""
    lines = [
        line for line in difflib.unified_diff(old, new, n=0, lineterm="") if line[:3] not in ("---", "+++")
    ]
    yield from (line[:200] for line in lines[:SHOWN])
    if len(lines) > SHOWN:
        yield f"... {len(lines)} lines"
    pairs = [
        (a, b) for one, other in zip(old, new) if one != other for a, b in zip(one.split(), other.split())
    ]
    sizes = [distance for a, b in pairs if a != b and (distance := relative_difference(a, b)) is not None]
    if sizes:
        yield f"numbers differ by up to {max(sizes):.2g} of their size"


def relative_difference(one: str, other: str) -> float | None:
    try:
        a, b = float(one), float(other)
    except ValueError:
        return None
    return abs(a - b) / max(abs(a), abs(b)) if a != b else 0.0


if __name__ == "__main__":
    sys.exit(main())
