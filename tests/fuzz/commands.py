"""Commands called in this process, and what every answer of theirs has to meet."""

import io
import json
import os
import re
import sys
import tempfile
from dataclasses import dataclass

from lagc.cli.main import main

_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
_STATUS = {
    0: ("ok", "terminated"), 1: ("refused",), 2: ("refused",), 3: ("failed",), 4: ("failed", "refused"),
}  # fmt: skip


@dataclass(frozen=True)
class Said:
    """The exit code, and what came out of standard output and standard error."""

    code: int
    out: str
    err: str

    @property
    def fault(self) -> str:
        """The code of the first error, or the kind of answer."""
        found = re.search(r"(?:error\[|\"code\": \")(LAG\d{4})", self.out + self.err)
        return found[1] if found else f"exit {self.code}"


def call(*words: str, stdin: str = "") -> Said:
    """`lagc WORDS`, its streams replaced down to the file descriptors."""
    before, given = (sys.stdin, sys.stdout, sys.stderr), stdin.encode("utf-8", "surrogatepass")
    kept = os.dup(1), os.dup(2)
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        os.dup2(out.fileno(), 1)
        os.dup2(err.fileno(), 2)
        sys.stdin = io.TextIOWrapper(io.BytesIO(given), encoding="utf-8")
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        try:
            code = main(list(words))
            sys.stdout.flush()
            sys.stderr.flush()
        finally:
            sys.stdin, sys.stdout, sys.stderr = before
            for own, number in zip(kept, (1, 2)):
                os.dup2(own, number)
                os.close(own)
        texts = []
        for file in (out, err):
            file.seek(0)
            texts.append(file.read().decode("utf-8", "replace"))
    return Said(code, *texts)


def complaint(words: tuple[str, ...], said: Said) -> str | None:
    """What is wrong with an answer; None where nothing is."""
    both = said.out + said.err
    if "Traceback (most" in both:
        return "a traceback: " + both[-300:]
    if "LAG0799" in both:
        return "an internal error: " + both[both.index("LAG0799") :][:300]
    if said.code not in _STATUS:
        return f"exit code {said.code}"
    if said.code == 3 and words[0] not in ("sim", "linearize", "cost", "effects"):
        return "exit code 3 of a command that runs nothing"
    if "--json" in words:
        return _json_complaint(said)
    if said.code == 0 and "error[" in said.err:
        return f"exit code 0 with an error: {said.err[:200]}"
    if said.code in (1, 4) and "error[" not in both:
        return f"exit code {said.code} without an error"
    if said.code == 2 and not ("lagc: " in said.err or "error[" in both):
        return "exit code 2 without a reason"
    odd = _CONTROL.search(both) if words[0] != "fmt" else None  # which gives back what it was given
    return f"the control character {odd.group()!r} in what is printed" if odd else None


def _json_complaint(said: Said) -> str | None:
    if said.code == 2 and not said.out:
        return None
    try:
        found = json.loads(said.out)
    except ValueError as error:
        return f"what is printed is no JSON ({error}): {said.out[:100]!r}"
    status = found.get("status") if isinstance(found, dict) else None
    return None if status in _STATUS[said.code] else f"exit code {said.code} with the status {status!r}"
