"""Bounds and lock of what lagc needs say the same, and nothing about machines."""

from packaging.version import Version

from tests.supply.bounds import LOCK, bound, locked, project, requirements


def test_every_requirement_is_bounded_on_both_sides() -> None:
    assert len(requirements()) > 15
    for requirement in requirements():
        below, above = bound(requirement, ">="), bound(requirement, "<")
        assert below is not None and above is not None and below < above, str(requirement)


def test_one_requirement_has_one_bound() -> None:
    """Where it is named twice, as the builder of the wheel is."""
    found: dict[str, set[str]] = {}
    for requirement in requirements():
        found.setdefault(requirement.name, set()).add(str(requirement.specifier))
    assert {name: words for name, words in found.items() if len(words) > 1} == {}


def test_the_lock_is_within_the_bounds() -> None:
    """`uv pip compile` makes it anew, as its first lines say."""
    lock = locked()
    for requirement in requirements():
        versions, hashes = lock[requirement.name]
        assert all(requirement.specifier.contains(version) for version in versions), requirement.name
        assert hashes >= len(versions)
    assert all(hashes > 0 and versions for versions, hashes in lock.values())


def test_the_lock_names_neither_a_host_nor_a_folder() -> None:
    text = LOCK.read_text(encoding="utf-8")
    body = [line for line in text.splitlines() if not line.startswith("#")]
    assert not [line for line in body if "/" in line or "@" in line]
    assert "://" not in text and "index" not in text


def test_pythons_that_are_named_are_those_that_are_allowed() -> None:
    metadata = project()["project"]
    named = [word.rpartition(" ")[2] for word in metadata["classifiers"] if "Python :: 3." in word]
    lowest = metadata["requires-python"].removeprefix(">=")
    assert min(map(Version, named)) == Version(lowest) and len(named) >= 3
