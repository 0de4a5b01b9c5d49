"""One model through all commands: what became of it, and where lagc stumbled."""

import json
import os
import random
import re
import shutil
import subprocess
import sysconfig
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzz.commands import Said, call, complaint
from tests.fuzz.models import Case

Tell = Callable[[str], None]  # is told each command before it is called
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wshadow", "-Wconversion", "-fsyntax-only"]


@dataclass
class Report:
    """`outcomes`: command -> how it ended; `stumbles`: (command, what was wrong)."""

    outcomes: dict[str, str] = field(default_factory=dict)
    stumbles: list[tuple[str, str]] = field(default_factory=list)


def trial(case: Case, seed: int, folder: Path, tell: Tell, compiled: float = 1.0) -> Report:
    """The case through all commands, in `folder`, which is empty; by `seed` with one option or another, and
    through a C compiler for the share `compiled`."""
    return _Trial(case, random.Random(seed), folder, tell, compiled).run()


class _Trial:
    def __init__(self, case: Case, chance: random.Random, folder: Path, tell: Tell, compiled: float):
        self.case, self.chance, self.folder, self.tell = case, chance, folder, tell
        self.with_c = chance.random() < compiled
        self.report = Report()
        self.file = "model.lag"

    def run(self) -> Report:
        before = os.getcwd()
        os.chdir(self.folder)
        os.environ["LAGC_CACHE"] = str(self.folder.parent / "cache")  # of the kernels, which others need too
        try:
            for name, text in {**self.case.files, self.file: self.case.text}.items():
                Path(name).write_text(text, encoding="utf-8", errors="surrogatepass")
            self._all()
        finally:
            os.chdir(before)
            shutil.rmtree(self.folder, ignore_errors=True)
        return self.report

    def _all(self) -> None:
        sound = self._check()
        self._fmt(sound)
        if not sound and self.chance.random() < 0.7:  # the others say the same: one of them is enough
            self.chance.choice([self._sim, self._build, self._show])(sound)
            return
        for part in (self._show, self._build, self._sim, self._study):
            part(sound)

    def _show(self, sound: bool) -> None:
        explained = self._call("explain", *self.case.options, *self.chance.choice([[], ["-v"], ["--json"]]))
        self._agree(sound, "explain", explained)
        where = self.chance.choice([[], [], [], ["--equilibrium"], ["--at", "0.01", "--max-time", "2"]])
        self._call("linearize", *self.case.options, *where, *self.chance.choice([[], ["-v"], ["--json"]]))
        forms = ["text", "latex", "sympy"]
        if self.chance.random() < 0.7:
            forms = [self.chance.choice(forms)]
        for form in forms:
            said = self._call("equations", "--format", form, *self.case.options)
            self._agree(sound, "equations", said)
            if form == "sympy" and said.code == 0:
                self._python("equations", said.out)

    def _call(self, command: str, *words: str, label: str = "", stdin: str | None = None) -> Said:
        whole = (command, self.file if stdin is None else "-", *words)
        self.tell(" ".join(whole))
        said = call(*whole, stdin=stdin or "")
        label = label or command
        outcome = {0: "done", 3: "failed", 4: "out of time or memory"}.get(said.code, f"refused {said.fault}")
        self.report.outcomes[label] = outcome
        wrong = complaint(whole, said)
        if wrong is not None:
            self._stumble(label, wrong)
        return said

    def _stumble(self, label: str, what: str) -> None:
        self.report.stumbles.append((label, what))

    def _check(self) -> bool:
        said = self._call("check", *self.case.options, *self.chance.choice([[], ["--json"]]))
        if said.code == 2 and not self.case.options:
            self._stumble("check", f"exit code 2: {said.err[:200]}")
        return said.code == 0

    def _agree(self, sound: bool, command: str, said: Said) -> None:
        """What `check` lets pass is not refused later; wrong usage apart, where options are given."""
        if said.fault == "LAG0215":  # packages alone are sound, and nothing that could be built
            return
        if sound and said.code in (1, 2) and not (said.code == 2 and self.case.options):
            self._stumble(command, f"refused after `check` passed: {said.fault}")

    def _fmt(self, sound: bool) -> None:
        said = self._call("fmt", stdin=self.case.text)
        if said.code != 0:
            if sound:
                self._stumble("fmt", "refused after `check` passed")
            return
        again = self._call("fmt", label="fmt again", stdin=said.out)
        if again.code != 0 or again.out != said.out:
            self._stumble("fmt again", "what is laid out is laid out otherwise a second time")
        if sound and self.chance.random() < 0.4:
            Path("laid_out.lag").write_text(said.out, encoding="utf-8")
            before, after = [self._meaning(file).split("\n") for file in (self.file, "laid_out.lag")]
            if before != after:
                apart = next((x for x in zip(before, after) if x[0] != x[1]), "one is longer")
                self._stumble("fmt", f"what is laid out means something else: {apart}")

    def _meaning(self, file: str) -> str:
        """The generated Python less what names lines of the source."""
        said = call("build", file, "--target", "numpy", "-o", f"meaning_{file}", "-q")
        if said.code != 0:
            return said.fault
        text = "".join(p.read_text(encoding="utf-8") for p in sorted(Path(f"meaning_{file}").iterdir()))
        return re.sub(rf"{re.escape(file)}(:\d+)?", "", text)

    def _build(self, sound: bool) -> None:
        for label, words in (("numpy", []), ("c", []), ("c", ["--derivatives"])):
            given = ["--target", label, "-o", "".join([label, *words]), *words, *self.case.options]
            label = " ".join(["build", label, *words])
            said = self._call("build", *given, label=label)
            if not words:
                self._agree(sound, label, said)
            if said.code != 0:
                continue
            paths = sorted(Path(given[3]).iterdir())
            if label == "build numpy":
                for path in paths:
                    self._python(label, path.read_text(encoding="utf-8"))
            elif self.with_c and self.chance.random() < 0.3:
                units = [str(p) for p in paths if p.suffix == ".c"]
                done = subprocess.run(["cc", *STRICT, *units], capture_output=True, text=True, check=False)
                if done.returncode != 0:
                    self._stumble(label, f"the C is not accepted: {done.stderr[:300]}")

    def _python(self, label: str, text: str) -> None:
        try:
            compile(text, label, "exec")
        except (SyntaxError, ValueError) as error:
            self._stumble(label, f"the Python is not accepted: {error}")

    def _sim(self, sound: bool) -> None:
        step = self.chance.choice(["1e-3", "1e-4", "0.01"])
        by_hand = ["--method", self.chance.choice(["dopri5", "dop853"]), "--step", step]
        by_hand += ["--stop", f"{3 * float(step):g}", "--points", "4"]
        verified = ["--stop", self.chance.choice(["0.01", "0.1", "1"]), "--points", "5", "--max-time", "10"]
        given = [*self.case.options, *self.case.run]
        for words, label in ((by_hand, "sim"), (verified, "sim verified")):
            if label == "sim verified" and self.chance.random() < 0.5:
                continue
            self._both(label, [*words, *given], sound and not given)

    def _study(self, sound: bool) -> None:
        """What costs many runs, of a short motion."""
        if not (sound and self.with_c and self.chance.random() < 0.1):
            return
        self._call("cost", "--stop", "0.01", "--budget", "0.3", *self.case.options)
        if "effect " in self.case.text:
            self._call(
                "effects", "--stop", "0.01", "--accuracy", "1e-2", "--points", "11", *self.case.options
            )

    def _both(self, label: str, words: list[str], sound: bool) -> None:
        found = []
        for backend in ("numpy", "c") if self.with_c else ("numpy",):
            csv = f"{label.replace(' ', '_')}_{backend}.csv"
            said = self._call(
                "sim", "--backend", backend, "--json", "-o", csv, *words, label=f"{label} {backend}"
            )
            if said.code == 4:  # where that is differs
                return
            if sound and said.code not in (0, 3):
                self.report.outcomes[f"{label} {backend}"] = f"passed `check`, refused {said.fault}"
            found.append(
                (said.code, _lasting(said.out), Path(csv).read_bytes() if os.path.exists(csv) else b"")
            )
        if len(found) < 2:
            return
        for one, other, what in zip(*found, ("exit code", "report", "file")):
            if one != other and not (what == "report" and _alike(one, other)):
                self._stumble(
                    label, f"C and Python differ in the {what}: {found[0][:2]} {found[1][:2]}"[:600]
                )
                return


def _alike(one: object, other: object) -> bool:
    """Whether two reports differ in no more than the estimated error, whose part of rounding is asked of both
    with another rounding, which they do not always do alike, and in what the runs for it cost."""

    def rest(report: object) -> object:
        if not isinstance(report, dict) or report.get("accuracy", {}).get("estimated") is None:
            return report
        return {**report, "accuracy": None, "cost": None}

    def estimated(report: object) -> object:
        return report["accuracy"]["estimated"] if isinstance(report, dict) else None

    return rest(one) == rest(other) and rest(one) is not one and estimated(one) != estimated(other)


def _lasting(out: str) -> object:
    """A report less what may differ between two runs."""
    try:
        found = json.loads(out)
    except ValueError:
        return out
    for key in ("backend", "compile_s", "run_s", "start_s"):
        found.pop(key, None)
        found.get("cost", {}).pop(key, None)
    return found


def quick_compiler(folder: Path) -> str | None:
    """The words of LAGC_CC for a compiler that does not optimize; None where there is no compiler."""
    own = shutil.which("cc") or shutil.which("gcc")
    if own is None or sysconfig.get_platform().startswith("win"):
        return None
    script = folder / "quick_cc"
    script.write_text(f'#!/bin/sh\nexec {own} "$@" -O0\n')
    script.chmod(0o755)
    return str(script)
