"""Run all points of a plan, in chunks, and keep those that are done."""

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, wait
from math import inf
from time import perf_counter
from typing import Any

from lagc.diagnostics.faults import Fault, Refused
from lagc.study.sweep.executors import opened
from lagc.study.sweep.journal import Journal
from lagc.study.sweep.table import Sweep
from lagc.study.sweep.worker import Point, Record, Task, run, version

SECONDS = 0.5  # of a chunk
GROWTH = 8  # of the chunks, which begin with one run
LARGEST = 20_000  # runs of a chunk
SHARES = 3  # chunks that are left for each worker, at the least
LOOK = 0.2  # s between two calls of `progress`
ALONE = 2.0  # s of work before processes begin

Progress = Callable[[], None]


class Running:
    """A sweep that runs: its results so far, and the points that are left.  `progress` is called some times a
    second, and may end the sweep by KeyboardInterrupt; `journal` is its file."""

    def __init__(self, table: Sweep, task: Task, progress: Progress, journal: Journal | None = None):
        self.table, self.task, self.progress, self.journal = table, task, progress, journal
        for record in () if journal is None else journal.records():
            table.add(record)
        self.left = table.gaps()
        self.size, self.spent, self.looked = 1, 0.0, -inf

    def run(self, executor: Any) -> None:
        """Run all points: the first ones in this process, to compile the model and to see how long a run
        takes, the others by `executor`; None: in this process too."""
        self._run_here(
            inf if executor is None or executor == 1 else ALONE if isinstance(executor, int) else 0.0
        )
        if self.left:
            with opened(executor) as (pool, width):
                self._run_by(pool, width)

    def _look(self, _: float = 0.0) -> None:
        """Call `progress`, if it was not called a moment ago."""
        now = perf_counter()
        if now - self.looked >= LOOK:
            self.looked = now
            self.progress()

    def _run_here(self, most: float) -> None:
        """Run chunks in this process, until their work took `most` seconds."""
        while self.left and self.spent <= most:
            self._take(run(self.task, *self._next(1), self._look))
            self._look()

    def _run_by(self, pool: Any, width: Callable[[], int]) -> None:
        """Run all chunks by the workers of a pool, which has room for `width()` of them at a time."""
        running: set[Future[Record]] = set()
        try:
            while running or self.left:
                room = width()
                while self.left and len(running) < room:
                    running.add(pool.submit(run, self.task, *self._next(room)))
                done, running = wait(running, LOOK, FIRST_COMPLETED)
                for future in done:
                    self._take(future.result())
                self._look()
        finally:
            for future in running:
                future.cancel()

    def _next(self, workers: int) -> tuple[int, list[Point]]:
        """Take the next chunk from the points that are left."""
        first, last = self.left.pop(0)
        share = (last - first) // (SHARES * workers) + 1 if workers > 1 else last - first
        end = min(last, first + min(self.size, share))
        if end < last:
            self.left.insert(0, (end, last))
        return first, [*self.table.plan.points(first, end - first)]

    def _take(self, chunk: Record) -> None:
        """Keep the results of a chunk.  Raises Refused (LAG0626) for a worker with another lagc."""
        if chunk.other:
            message = f"a worker has lagc {chunk.other}, this sweep lagc {version()}: results could differ"
            raise Refused([Fault("LAG0626", message, remedy="install the same lagc on all machines")])
        if self.journal is not None:
            self.journal.add(chunk)
        count = self.table.add(chunk)
        self.spent += chunk.seconds
        fitting = int(SECONDS * count / max(chunk.seconds, 1e-9))
        self.size = max(1, min(fitting, GROWTH * count, LARGEST))
