"""The long trial, `python -m tests.fuzz --hours N` or `--rounds N`: texts of all kinds through every command
of lagc, texts guided by what they reach in its front end, commands whose files, signals and compilers fail.

Prints a table of what became of them.  Whatever made lagc stumble is made small and written to the folder
`-o`; what was done is noted there, and a later call goes on from it.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

from lagc.simulation.backends.compile import compiler
from tests.fuzz import workers
from tests.fuzz.coverage_guided import Guided
from tests.fuzz.findings import Finds
from tests.fuzz.grammar import rules
from tests.fuzz.interference import Disturber
from tests.fuzz.mechanisms import mechanism
from tests.fuzz.models import Case, model
from tests.fuzz.mutations import library, mutated
from tests.fuzz.statements import spliced
from tests.fuzz.trial import Report, quick_compiler, trial

SOURCES = 200  # generated models among the texts that are spliced and mutated
LOADED = "model M coordinate Length x(start = 1); body b = Particle(mass = 1, at = {x, 0, 0}); end M;"
KINDS = ("models", "mechanisms", "splices", "tokens", "guided", "disturbed")
Task = tuple[str, int]
Tell = Callable[[str], None]


class Trials:
    """What is tried, by kind and seed, in child processes."""

    def __init__(self, scratch: Path, compiled: float, jobs: int):
        self.scratch, self.jobs = scratch, jobs
        self.texts = [*library(), *(model(seed).text for seed in range(SOURCES))]
        self.cases: dict[str, Callable[[int], Case]] = {
            "models": model,
            "mechanisms": mechanism,
            "splices": lambda seed: Case(spliced(self.texts, seed)),
            "tokens": lambda seed: Case(mutated(self.texts, seed)),
        }
        own = quick_compiler(scratch)
        self.compiled = compiled if own else 0.0
        if own:
            os.environ["LAGC_CC"] = own
        compiler.cache_clear()  # of which this process may have found another before
        for seed in range(4):  # what is loaded now every child has
            self._try((Case(LOADED), seed), lambda command: None)

    def texts_of(self, tasks: Iterator[Task]) -> Iterator[tuple[str, int, Case, Report]]:
        """Texts through all commands."""
        given = ((self.cases[kind](seed), seed, kind) for kind, seed in tasks)
        for (case, seed, kind), found in workers.run(self._try, given, self.jobs):
            yield kind, seed, case, _report(found)

    def stumbles(self, case: Case, seed: int) -> list[tuple[str, str]]:
        ((_, found),) = workers.run(self._try, [(case, seed)], 1)
        return _report(found).stumbles

    def _try(self, task: Any, tell: Tell) -> Report:
        folder = Path(tempfile.mkdtemp(dir=self.scratch))
        return trial(task[0], task[1], folder, tell, self.compiled)

    def disturbed(self, seeds: Sequence[int]) -> Iterator[tuple[int, str, Report]]:
        """Commands that are disturbed; the second is what by."""
        disturber = Disturber(self.scratch)

        def attempt(seed: int, tell: Tell) -> tuple[str, Report]:
            disturber.tell = tell
            disturbance = disturber.random(seed)
            wrong = list(disturber.stumbles(disturbance))
            command = disturbance.command[0]
            label = f"{command}, {disturbance.kind}"
            stumbles = [(label, f"{what} ({disturbance})") for what in wrong]
            return str(disturbance), Report({label: "wrong" if wrong else "as it should be"}, stumbles)

        for seed, found in workers.run(attempt, seeds, self.jobs, memory=None):
            yield (seed, "", _report(found)) if isinstance(found, workers.Died) else (seed, *found)


def _report(found: Any) -> Report:
    if isinstance(found, workers.Died):
        command = found.command.partition(" ")[0] or "start"
        return Report({command: "died"}, [(command, f"{found.how}: {found.command}")])
    assert isinstance(found, Report)
    return found


class Run:
    """Rounds of trials, and what became of them all."""

    def __init__(self, options: argparse.Namespace, trials: Trials):
        self.trials, self.count, self.kinds = trials, options.texts, options.kinds.split(",")
        self.folder = Path(options.output)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.state = self.folder / "state.json"
        done = json.loads(self.state.read_text()) if self.state.exists() else {}
        self.round = done.get("round", options.seed)
        self.finds = Finds(self.folder, done.get("finds", {}))
        self.table = Counter({tuple(key): count for key, count in done.get("table", [])})
        self.guided = Guided(trials.texts, options.seed, options.jobs, 2 * options.texts)

    def rounds(self, limit: int, deadline: float) -> None:
        while limit and time.monotonic() < deadline:
            limit -= 1
            seeds = range(self.round * self.count, (self.round + 1) * self.count)
            self._texts([(kind, seed) for seed in seeds for kind in self.kinds if kind in self.trials.cases])
            if "guided" in self.kinds:
                self._guided()
            if "disturbed" in self.kinds:
                self._disturbed(range(seeds[0] // 4, seeds[-1] // 4 + 1))
            self.round += 1
            left = {"round": self.round, "finds": self.finds.counts, "table": list(self.table.items())}
            self.state.write_text(json.dumps(left))

    def _texts(self, tasks: list[Task]) -> None:
        for kind, seed, case, report in self.trials.texts_of(iter(tasks)):
            for command, outcome in report.outcomes.items():
                self.table[kind, command, outcome] += 1
            for stumble in report.stumbles:
                again = partial(self.trials.stumbles, seed=seed)
                self._say(f"{kind}_{seed}", case, stumble, again)

    def _guided(self) -> None:
        """Those that go where none had gone go through all commands too."""
        before, new = self.guided.tried, list[str]()
        for text, wrong in islice(self.guided.generations(), self.count):
            new.append(text)
            if wrong:
                stumble = ("reading", wrong)
                self._say(f"guided_{self.round}_{len(new)}", Case(text), stumble, lambda case: [])
        self.table["guided", "reading", "read"] += self.guided.tried - before
        self.trials.cases["guided"] = lambda k: Case(new[k])
        self._texts([("guided", k) for k in range(len(new))])
        del self.trials.cases["guided"]

    def _disturbed(self, seeds: Sequence[int]) -> None:
        for seed, what, report in self.trials.disturbed(seeds):
            for command, outcome in report.outcomes.items():
                self.table["disturbed", command, outcome] += 1
            for stumble in report.stumbles:
                self._say(f"disturbed_{seed}", Case(f"// {what}\n"), stumble, lambda case: [])

    def _say(
        self, name: str, case: Case, stumble: tuple[str, str], again: Callable[[Case], list[tuple[str, str]]]
    ) -> None:
        said = self.finds.note(name, case, stumble, again)
        if said:
            print(said, flush=True)

    def summary(self) -> None:
        """How each command ended, which faults `check` named, what was found."""
        ways, faults = Counter[tuple[str, str, str]](), Counter[str]()
        for (kind, command, outcome), count in self.table.items():
            way, _, fault = outcome.partition(" LAG")
            ways[kind, command, way] += count
            if fault and (command == "check" or "passed" in way):
                faults[f"{'' if command == 'check' else way + ' '}LAG{fault}"] += count
        for (kind, command, way), count in sorted(ways.items()):
            print(f"{kind:10} {command:20} {count:8} {way}")
        print("faults: " + ", ".join(f"{count} {fault}" for fault, count in faults.most_common()))
        used = rules(model(seed).text for seed in range(SOURCES))
        print(
            f"rules of the grammar in {SOURCES} models: "
            + ", ".join(f"{n} {k}" for k, n in sorted(used.items()))
        )
        for what, count in Counter(self.finds.counts).most_common():
            print(f"STUMBLED {count:6} {what}")


def main(words: Sequence[str] | None = None) -> int:
    options = _options(words)
    with tempfile.TemporaryDirectory() as scratch:
        run = Run(options, Trials(Path(scratch), options.compiled, options.jobs))
        deadline = time.monotonic() + 3600 * options.hours if options.hours else float("inf")
        run.rounds(-1 if options.hours else options.rounds, deadline)
    run.summary()
    return 1 if run.finds.counts else 0


def _options(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--hours", type=float, help="for how long")
    parser.add_argument("--rounds", type=int, default=1, help="how many rounds, where no time is given")
    parser.add_argument("--texts", type=int, default=100, help="texts of each kind in a round")
    parser.add_argument("--seed", type=int, default=0, help="the first round")
    parser.add_argument("--kinds", default=",".join(KINDS), help="what is tried")
    parser.add_argument(
        "--compiled", type=float, default=0.5, help="the share that goes through a C compiler"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="how many at the same time")
    parser.add_argument("-o", "--output", default="fuzz", help="the folder of finds")
    return parser.parse_args(words)


if __name__ == "__main__":
    sys.exit(main())
