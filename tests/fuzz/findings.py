"""What was found: written as a file each, made small."""

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from tests.fuzz.models import Case
from tests.fuzz.statements import smaller

ALIKE = 3  # that are written of one kind
TRIES = 60  # to make one smaller


def kind_of(command: str, what: str) -> str:
    """What finds have in common that differ in names and numbers only."""
    return f"{command}: " + re.sub(r"`[^`]*`|'[^']*'|[\d.e+-]{2,}|/\S+", "_", what)[:70]


class Finds:
    """The finds of a run, in a folder."""

    def __init__(self, folder: Path, before: dict[str, int]):
        self.folder, self.counts = folder, Counter(before)

    def note(
        self, name: str, case: Case, stumble: tuple[str, str], again: Callable[[Case], list[tuple[str, str]]]
    ) -> str:
        """Write one, unless there are enough of its kind; what to print of it, "" for nothing."""
        kind = kind_of(*stumble)
        self.counts[kind] += 1
        if self.counts[kind] > ALIKE:
            return ""
        small = minimised(case, lambda c: any(kind_of(*s) == kind for s in again(c)))
        path = self.folder / f"{name}.lag"
        path.write_text(small.text, encoding="utf-8", errors="surrogatepass")
        for file, text in small.files.items():
            (self.folder / f"{name}.{file}").write_text(text, encoding="utf-8")
        words = " ".join(small.options + small.run)
        said = f"{stumble[0]} {words}: {stumble[1]}"
        (self.folder / f"{name}.txt").write_text(said, encoding="utf-8", errors="backslashreplace")
        return f"{path}: {said}"


def minimised(case: Case, stumbles: Callable[[Case], bool]) -> Case:
    """A case that stumbles alike, with fewer statements."""
    left, shrunk = TRIES, True
    for part, empty in (("options", ()), ("run", ()), ("files", {})):
        fewer = replace(case, **{part: empty})
        if fewer != case and stumbles(fewer):
            case = fewer
    while shrunk and left > 0:
        shrunk = False
        for text in smaller(case.text):
            left -= 1
            if left <= 0:
                break
            fewer = replace(case, text=text)
            if len(text) < len(case.text) and stumbles(fewer):
                case, shrunk = fewer, True
                break
    return case
