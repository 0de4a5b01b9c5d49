"""Where the chunks of a sweep are computed: in this process, in others of this machine, or on a cluster.

An executor is one of `concurrent.futures`, whose `submit` a sweep calls, or a `distributed.Client`.
"""

import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from threading import local
from typing import Any

TRIES = 3  # processes that may die with a chunk
AHEAD = 2  # chunks for each worker that wait or run
MANY = 32  # workers of an executor that does not tell their number
SERVE = "import sys; sys.path[:] = {!r}; from lagc.study.sweep.executors import serve; serve()"


class Processes(Executor):
    """Worker processes of this machine.  Each belongs to a thread, and gets chunks through a pipe; one that
    dies is replaced, and its chunk computed again.  They end with this process, also if it is killed, and
    need no `if __name__ == "__main__"`."""

    def __init__(self, count: int):
        self.threads, self.own = ThreadPoolExecutor(count), local()
        self.all: list[subprocess.Popen[bytes]] = []
        self.over = False

    def submit(self, function: Callable[..., Any], /, *given: Any, **named: Any) -> Future[Any]:
        return self.threads.submit(self._send, function, given)

    def _send(self, function: Callable[..., Any], given: tuple[Any, ...]) -> Any:
        for _ in range(TRIES):
            if self.over:
                break
            if not hasattr(self.own, "process"):
                self.own.process = self._started()
            process: subprocess.Popen[bytes] = self.own.process
            try:
                pickle.dump((function, given), process.stdin)  # type: ignore[arg-type]
                process.stdin.flush()  # type: ignore[union-attr]
                done, result = pickle.load(process.stdout)  # type: ignore[arg-type]
            except (OSError, EOFError, pickle.UnpicklingError):
                del self.own.process
                process.kill()
                process.wait()
                continue
            if done:
                return result
            raise result
        raise ChildProcessError(f"{TRIES} worker processes ended with the same runs: they may lack memory")

    def _started(self) -> subprocess.Popen[bytes]:
        # In a group of its own: Ctrl-C goes to this process alone.
        alone: dict[str, Any] = {"process_group": 0} if sys.platform != "win32" else {"creationflags": 0x200}
        found = subprocess.Popen(
            [sys.executable, "-c", SERVE.format(sys.path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            **alone,
        )
        self.all.append(found)
        return found

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all processes, and drop what they do."""
        self.over = True
        for process in self.all:
            process.kill()
        self.threads.shutdown(wait=True, cancel_futures=True)
        for process in self.all:  # one may have begun meanwhile
            process.kill()
            process.communicate()


def serve() -> None:
    """The loop of a worker process: functions and arguments by the standard input, results by its output."""
    receive, answer = sys.stdin.buffer, sys.stdout.buffer
    sys.stdout = sys.stderr
    while True:
        with suppress(EOFError, BrokenPipeError):  # the sweep has ended, or was killed
            function, given = pickle.load(receive)
            try:
                found = True, function(*given)
            except Exception as error:
                found = False, error
            pickle.dump(found, answer)
            answer.flush()
            continue
        return


@contextmanager
def opened(given: Any) -> Iterator[tuple[Executor, Callable[[], int]]]:
    """Yield the executor of `given`, which is a number of processes, an executor or a Dask client, and a
    function that tells how many chunks it may have at a time.  Its chunks that wait are dropped at the
    end."""
    if isinstance(given, Executor):
        yield given, lambda: AHEAD * getattr(given, "_max_workers", MANY)
        return
    if isinstance(given, int):
        executor: Executor = Processes(given)
        width = given.__mul__
    elif hasattr(given, "get_executor") and hasattr(given, "nthreads"):
        executor = given.get_executor(pure=False)

        def width(ahead: int) -> int:  # of a cluster that may grow
            threads: int = sum(given.nthreads().values())
            return ahead * (threads + 1)

    else:
        raise TypeError(f"`executor` is a number of processes, an Executor or a Dask client, not {given!r}")
    try:
        yield executor, lambda: width(AHEAD)
    finally:
        executor.shutdown(wait=False)
