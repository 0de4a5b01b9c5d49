"""Imports of many, in any order, of each other; how often is counted, no time is taken."""

import random
from pathlib import Path
from typing import Any

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Refused, Source
from lagc.semantics.model import Model
from lagc.semantics.names.namespace import Importer, Namespace
from lagc.semantics.resolve import resolve
from lagc.syntax.parse import parse
from tests.semantics.reading import output

MANY = 1000
MODEL = "model M coordinate Length x; output Real y = {}; end M;"


def of(text: str, folder: Path | None = None) -> Model:
    """With the folder that it is in, if any."""
    return resolve(parse(Source("m.lag", text)), roots=() if folder is None else [str(folder)])


def codes(text: str, folder: Path | None = None) -> list[str]:
    with pytest.raises(Refused) as refused:
        of(text, folder)
    return [fault.code for fault in refused.value.faults]


def counted(monkeypatch: pytest.MonkeyPatch, owner: type, name: str) -> list[Any]:
    """What the method is called with, from now on."""
    calls: list[Any] = []
    meant = getattr(owner, name)

    def call(self: Any, *arguments: Any) -> Any:
        calls.append(arguments)
        return meant(self, *arguments)

    monkeypatch.setattr(owner, name, call)
    return calls


def shuffled(lines: list[str], seed: int) -> str:
    random.Random(seed).shuffle(lines)
    return "\n".join(lines)


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", ["here", "files"])
def test_every_import_is_followed_once(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    packages = [f"package P{i} constant Real c{i} = {i}; end P{i};" for i in range(MANY)]
    for i in range(MANY if kind == "files" else 0):
        (tmp_path / f"P{i}.lag").write_text(packages[i])
    text = "\n".join([*(f"import P{i}.*;" for i in range(MANY)), *(packages if kind == "here" else [])])
    followed = counted(monkeypatch, Namespace, "follow")
    asked = counted(monkeypatch, Importer, "in_files")
    model = of(text + MODEL.format(" + ".join(f"c{i}" for i in range(MANY))), tmp_path)
    assert output(model, "y") == MANY * (MANY - 1) / 2
    assert len(followed) == MANY
    assert len(asked) == (MANY if kind == "files" else 0)


def test_each_of_many_absent_packages_is_one_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = counted(monkeypatch, Importer, "in_files")
    text = "".join(f"import P{i}.*;\n" for i in range(MANY)) + MODEL.format("1")
    assert set(codes(text, tmp_path)) == {"LAG0216"}
    assert len(asked) == MANY
    for count in (1, 3):
        text = "".join(f"import P{i}.*;\n" for i in range(count)) + MODEL.format("unknown + 1")
        assert codes(text, tmp_path) == ["LAG0216"] * count  # what they may have brought is not missed again


@pytest.mark.parametrize("order", [1, -1])
def test_chains_of_imports_in_either_order(order: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each needs the one before, or behind; deeper than any stack."""
    lines = [f"import A{i + 1} = A{i};" for i in range(MANY)][::order]
    followed = counted(monkeypatch, Namespace, "follow")
    model = of("\n".join(lines) + "package A0 constant Real c = 7; end A0;" + MODEL.format(f"A{MANY}.c"))
    assert output(model, "y") == 7
    assert len(followed) == MANY + 1  # and the value
    lines = [f"import A{i}.A{i + 1};" for i in range(MANY)][::order]
    assert codes("\n".join(lines) + MODEL.format("1")) == [
        "LAG0216"
    ]  # the first, for which all the others wait


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("form", ["import A{0}.*;", "import A{0}.A{1};"])
def test_packages_within_packages_in_any_order(form: str, seed: int) -> None:
    depth = 40
    within = "".join(f"package A{i} constant Real c{i} = {i}; " for i in range(depth))
    within += " ".join(f"end A{i};" for i in reversed(range(depth)))
    text = shuffled([form.format(i, i + 1) for i in range(depth - 1)], seed) + within
    name = "c38" if form.endswith("*;") else "A39.c39"
    assert output(of(text + MODEL.format(name)), "y") == float(name[-2:])


@pytest.mark.parametrize("seed", range(6))
def test_what_is_known_goes_before_files_in_any_order(seed: int, tmp_path: Path) -> None:
    """Here, or by the name of another import, above or below."""
    (tmp_path / "lib.lag").write_text("package lib package util constant Real c = 1; end util; end lib;")
    (tmp_path / "util.lag").write_text("package util constant Real c = 2; constant Real d = 2; end util;")
    text = shuffled(["import lib.util;", "import util.c;"], seed)
    assert output(of(text + MODEL.format("c"), tmp_path), "y") == 1
    text = shuffled(["import lib.*;", "import util.c;", "package lib end lib;"], seed)
    assert output(of(text + MODEL.format("c"), tmp_path), "y") == 2
    assert codes(shuffled(["import lib.util;", "import util.d;"], seed) + MODEL.format("d"), tmp_path) == [
        "LAG0203"
    ]


@pytest.mark.parametrize("seed", range(4))
def test_imports_within_look_around(seed: int) -> None:
    """What an import here brings hides what is around."""
    util = "package util constant Real c = {}; end util;"
    around = f"{util.format(2)} package lib {util.format(1)} end lib;"
    lines = shuffled(["import lib.util;", "import util.c;"], seed)
    model = of(f"{around} model M {lines} coordinate Length x; output Real y = c; end M;")
    assert output(model, "y") == 1


@pytest.mark.parametrize(
    "text",
    [
        "".join(f"import A{(i + 1) % MANY}.A{i};" for i in range(MANY)),
        "".join(f"import A{i}.A{i};" for i in range(MANY)),
        "import B = A; import A = B;",
        "import A = A;",
    ],
    ids=["in a circle", "of themselves", "two of each other", "one of itself"],
)
def test_imports_in_circles_are_faults(text: str, tmp_path: Path) -> None:
    assert set(codes(text + MODEL.format("1"), tmp_path)) == {"LAG0216"}


def test_an_import_of_all_hands_on_no_imports() -> None:
    text = (
        "package P constant Real c = 1; end P; package Q import P.*; constant Real d = c; end Q; import Q.*;"
    )
    assert output(of(text + MODEL.format("d")), "y") == 1
    assert codes(text + MODEL.format("c")) == ["LAG0201"]


def test_where_two_imports_bring_a_name_it_is_what_the_first_brings() -> None:
    text = "package P constant Real c = 1; end P; package Q constant Real c = 2; end Q;"
    for first, second, expected in (("P.*", "Q.*", 1), ("Q.*", "P.c", 2), ("P.c", "Q.c", 1)):
        model = of(f"{text} import {first}; import {second};" + MODEL.format("c"))
        assert output(model, "y") == expected


def test_packages_of_packages_that_import_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    packages = [f"package P{i} import Q.*; constant Real c{i} = {i}; end P{i};" for i in range(MANY)]
    all_of_them = " ".join(f"import P{i}.*;" for i in range(MANY))
    text = f"package Q {all_of_them} constant Real d = c7; end Q;" + "\n".join(packages)
    followed = counted(monkeypatch, Namespace, "follow")
    assert output(of(text + MODEL.format("Q.d")), "y") == 7
    assert len(followed) == 2 * MANY + 1


def test_imports_of_a_model_are_looked_at_where_they_stand() -> None:
    text = "package P package Q constant Real c = 3; end Q; end P;"
    body = (
        "import Q.c; import P.*; coordinate Length x(rate = 1); body b = Particle(mass = 1, at = {x, 0, 0});"
    )
    source = Source("m.lag", f"{text} model M {body} output Real y = c; end M;")
    assert check(source, Choice()) == []
    assert output(resolve(parse(source)), "y") == 3


def test_the_names_of_a_model_are_found_once_for_all_its_instances(monkeypatch: pytest.MonkeyPatch) -> None:
    made = counted(monkeypatch, Namespace, "__init__")
    model = of(
        "package P constant Real c = 1; end P;"
        "model A import P.*; coordinate Length x; output Real y = c; end A; model M A a[100]; end M;"
    )
    assert len(model.coordinates) == 100
    assert len(made) == 4  # the file, P, A, M
