"""Bounds and lock of what lagc needs say the same, and nothing about machines. `tools/same_bits.py` lists
each part that differs between two records, and nothing else."""

import importlib.util
import json
from pathlib import Path

import pytest
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


PATH = Path(__file__).resolve().parents[2] / "tools" / "same_bits.py"
SPEC = importlib.util.spec_from_file_location("same_bits", PATH)
assert SPEC and SPEC.loader
same_bits = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(same_bits)


def test_a_changed_digit_is_listed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = {"one": {"start": "x 1.0\ny 2.0", "code c": "a"}, "two": {"start": "z 3.0"}}
    monkeypatch.setattr(same_bits, "subjects", lambda *_: {n: lambda n=n: made[n] for n in made})
    records = [tmp_path / name for name in "abc"]
    for folder in records[:2]:
        same_bits.record(folder, [], None, [], 1.0)
    made["one"] = {"start": "x 1.0\ny 2.5", "code c": "b"}
    same_bits.record(records[2], [], None, [], 1.0)
    capsys.readouterr()
    assert same_bits.compare(*records[:2]) == 0
    assert capsys.readouterr().out == "0 of 2 subjects differ; 0 are in one record only\n"
    assert same_bits.compare(records[0], records[2]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert [line for line in lines if not line.startswith("    ")] == [
        "one: code c", "one: start", "1 of 2 subjects differ; 0 are in one record only",
    ]  # fmt: skip
    assert "    -y 2.0" in lines and "    numbers differ by up to 0.2 of their size" in lines


def test_a_record_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(same_bits, "subjects", lambda *_: {n: lambda: {"start": ""} for n in "abcdef"})
    same_bits.record(tmp_path, [], 3, [], 1.0)
    assert sorted(p.stem for p in tmp_path.glob("*.json")) == ["a", "c", "e"]
    (tmp_path / "a.json").write_text(json.dumps({}))
    same_bits.record(tmp_path, ["a", "b"], None, [], 1.0)
    assert sorted(p.stem for p in tmp_path.glob("*.json")) == ["a", "b", "c", "e"]
    assert json.loads((tmp_path / "a.json").read_text()) == {}


@pytest.mark.full
def test_every_scene_of_a_model_is_a_subject() -> None:
    names = [name for name in same_bits.subjects([], 1.0) if name.startswith("contact/bouncing_ball ")]
    scenes = ("messages", "BouncingBall all", "BouncingBall first")
    assert names == [f"contact/bouncing_ball {scene}" for scene in scenes]
