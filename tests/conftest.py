"""Caches of the tests: nobody's own is read or filled where it matters; workers, and signals of children."""

import os
import signal
from collections.abc import Iterator
from typing import Any

import pytest

from lagc.cli.program import ALONE
from lagc.simulation.backends import compile as compile_

for each in ALONE:  # before NumPy is loaded
    os.environ.setdefault(each, "1")


@pytest.fixture(scope="module")
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """An empty cache for the tests of one module."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LAGC_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture
def no_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LAGC_CACHE", "")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Each file is one worker's: models that its tests share are compiled once."""
    from xdist.scheduler import LoadFileScheduling

    return LoadFileScheduling(config, log)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the cases of a test with the marker `sample(n, m)`: the first n belong to the quick tier, m of the
    others, evenly spread, to the full tier (all, without m), and the rest to the long one."""
    cases: dict[str, list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("sample") is not None:
            cases.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for own in cases.values():
        quick, *full = own[0].get_closest_marker("sample").args  # type: ignore[union-attr]
        others = own[quick:]
        most = min(full[0] if full else len(others), len(others))
        chosen = {k * len(others) // most for k in range(most)}
        for k, item in enumerate(others):
            item.add_marker("full" if k in chosen else "long")


def pytest_configure() -> None:
    """Restore signals that the shell ignores: programs that tests start would ignore them too. Compile
    libraries without optimization, in a quarter of the time; `tests/codegen` tests that no bit changes."""
    compile_.FLAGS = tuple(flag for flag in compile_.FLAGS if flag != "-O2")
    for each in {"SIGINT", "SIGHUP"} & set(dir(signal)):
        number = getattr(signal, each)
        if signal.getsignal(number) == signal.SIG_IGN:
            signal.signal(number, signal.default_int_handler if each == "SIGINT" else signal.SIG_DFL)
