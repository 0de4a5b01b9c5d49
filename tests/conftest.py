"""Caches of the tests: nobody's own is read or filled where it matters."""

from __future__ import annotations

from collections.abc import Iterator

import pytest


@pytest.fixture(scope="module")
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """An empty cache for the tests of one module."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LAGC_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture
def no_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LAGC_CACHE", "")
