"""Texts that are kept where they reach what none reached before, and changed again: the front end, guided by
the lines that it takes."""

from __future__ import annotations

import hashlib
import os
import random
import sys
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

import lagc
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Refused, Source, as_json, report
from lagc.syntax.formatter import format_source
from tests.fuzz import workers
from tests.fuzz.mutations import mutated
from tests.fuzz.statements import spliced

_PACKAGE = os.path.dirname(lagc.__file__)
ROOMS = tuple(os.path.join(_PACKAGE, room) + os.sep for room in ("syntax", "semantics"))


class Steps:
    """From which line to which the front end goes, as numbers that are the same in every process."""

    def __init__(self) -> None:
        self.found: set[int] = set()
        self.bases: dict[Any, int | None] = {}

    def __enter__(self) -> Steps:
        sys.settrace(self._call)
        return self

    def __exit__(self, *_: object) -> None:
        sys.settrace(None)

    def _call(self, frame: FrameType, event: str, _: object) -> Callable[..., Any] | None:
        code = frame.f_code
        if code not in self.bases:
            self.bases[code] = _base(code.co_filename, code.co_firstlineno)
        base = self.bases[code]
        if base is None:
            return None
        found, before = self.found, 0

        def line(frame: FrameType, event: str, _: object) -> Callable[..., Any]:
            nonlocal before
            if event == "line":
                found.add(base + (before << 14 ^ frame.f_lineno))
                before = frame.f_lineno
            return line

        return line


def _base(file: str, line: int) -> int | None:
    if not file.startswith(ROOMS):
        return None
    return (
        int.from_bytes(hashlib.sha256(f"{os.path.relpath(file, _PACKAGE)}:{line}".encode()).digest()[:7])
        << 32
    )


def read(text: str) -> None:
    """The text through the front end.  Raises what is wrong with lagc, AssertionError among it."""
    source = Source("text.lag", text)
    try:
        tree = pipeline.parse(source)
        laid_out = format_source(source)
        assert format_source(Source("text.lag", laid_out)) == laid_out, "laid out otherwise a second time"
        pipeline.resolve(tree, pipeline.Choice())
    except Refused as refused:
        assert (
            refused.faults
            and report(list(refused.faults))
            and all(f["code"] for f in as_json(refused.faults))
        )
        spans = [f.span for f in refused.faults if f.span is not None and f.span.source is source]
        assert all(0 <= s.start <= s.end <= len(text) for s in spans), "a place outside of the text"


class Guided:
    """Generations of texts; `kept` are those that went where none had gone."""

    def __init__(self, texts: list[str], seed: int, jobs: int, size: int):
        """`size`: how many texts are tried before those kept are looked at."""
        self.chance, self.jobs, self.size = random.Random(seed), jobs, size
        self.kept = self.chance.sample(texts, min(size, len(texts)))
        self.seen: set[int] = set()
        self.tried = 0

    def generations(self) -> Iterator[tuple[str, str]]:
        """(text, what was wrong with its reading, "" for nothing), of each text that is new in what it
        reaches, or makes lagc stumble.  It never ends."""
        if not self.seen:
            for _ in self._generation(self.kept[:]):  # from where to go on
                pass
        while True:
            yield from self._generation([self._changed() for _ in range(self.size)])

    def _changed(self) -> str:
        change = self.chance.choice([mutated, mutated, spliced])
        recent = self.kept[-200:] if self.chance.random() < 0.5 else self.kept
        text = change(
            [self.chance.choice(recent)] if change is mutated else recent, self.chance.getrandbits(60)
        )
        return text[:20_000]

    def _generation(self, texts: list[str]) -> Iterator[tuple[str, str]]:
        for text, found in workers.run(self._look, texts, self.jobs):
            self.tried += 1
            if isinstance(found, workers.Died):
                yield text, found.how
                continue
            wrong, steps = found
            new = steps - self.seen
            if new:
                self.seen |= new
                if text not in self.kept:
                    self.kept.append(text)
            if wrong or new:
                yield text, wrong

    def _look(self, text: str, tell: Callable[[str], None]) -> tuple[str, set[int]]:
        tell("read")
        wrong, steps = "", Steps()
        try:
            with steps:
                read(text)
        except Exception as error:
            wrong = f"{type(error).__name__}: {error}"[:300]
        return wrong, steps.found - self.seen
