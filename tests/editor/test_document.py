"""Answers about one text: names, hover, completion, rename, fixes."""

import random
import subprocess
import sys
from pathlib import Path

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Refused, Source
from lagc.editor import document as documents
from lagc.editor.document import Document, errors_of
from lagc.editor.fixes import fix
from tests.editor.texts import LIBRARY, PENDULUM, ROOT, mistyped, text_of
from tests.rejected.test_rejected import CASES, unmarked, whole
from tests.syntax.test_extreme_texts import mutated

ROOTS = (str(ROOT / "models"),)


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine with much else to do finds the same."""
    monkeypatch.setattr(documents, "QUICK", 10.0)


def hover(place: str, shift: int = 0, text: str = PENDULUM) -> str:
    found = Document("a.lag", text).hover(text.index(place) + shift)
    return found.text if found else ""


@pytest.mark.parametrize(
    ("place", "shift", "words"),
    [
        ("l*{", 0, ("string length", "= 0.5 m")), ("m(min", 0, ("parameter Mass", "= 1 kg (min 0)")),
        ("theta), 0", 0, ("from the vertical", "generalized coordinate [rad]", "rate `0`")),
        ("bob", 0, ("mass `m` kg", "`{l*sin(theta), 0, -l*cos(theta)}`")),
        ("[cm]", 1, ("`cm` = 0.01 in SI", "Length [m]")), ("*l^2", 0, ("Energy [J]",)),
        ("60 [deg]", 0, ("a number: 1.0471975512",)), ("Particle", 0, ("Particle(mass, at)",)),
        ("sin", 0, ("sin(",)), ("Angle", 0, ("`rad`",)), ("E =", 0, ("[J] = `", "der(theta)^2")),
        ("Pendulum", 0, ("coordinates: 1", "scenes: lab")),
    ],
)  # fmt: skip
def test_hover_tells_values_and_units(place: str, shift: int, words: tuple[str, ...]) -> None:
    text = hover(place, shift)
    assert all(word in text for word in words), text


def test_hover_knows_the_names_of_a_text_with_faults() -> None:
    text = PENDULUM.replace("60 [deg])", "60 [deg]").replace("(mass = m,", "(mass = m")
    assert "string length" in hover("l*{", text=text)


@pytest.mark.parametrize(
    ("begun", "offered", "not_offered"),
    [
        ("", "parameter body effect Gravity", "bob kg"),
        ("par", "parameter", "bob"),
        ("parameter ", "Mass Length Orientation", "bob kg"),
        ("parameter Mass k = ", "l m sin norm pi", "Particle kg parameter"),
        ("parameter Mass k = 1 [", "kg cm N.m rad/s", "bob"),
        ("parameter Mass k = 1 [k", "kg kN", "bob"),
        ("body b = ", "Particle Solid bob", "Revolute"),
        ("body b = Particle(", "mass at m bob", "Solid"),
        ("joint j = ", "Revolute Weld", "Particle"),
        ("joint j = Revolute(", "axis friction", "mass"),
        ("coordinate Length y(", "start rate fixed", "restitution"),
        ("constraint c: bob.z >= 0 (", "restitution friction", "start"),
        ("force F = {1, 0, 0} ", "on at", "bob"),
        ("output Length q = bob.", "x y z mass position", "m kg"),
        ("output Length q = world.", "x y z", "m kg"),
        ("scene s uses ", "gravity", "bob m"),
        ("scene s uses gravity\n parameter ", "m l", "bob"),
        ("scene s uses gravity\n simulate(", "stop accuracy", "start"),
        ("when theta > 1 then ", "reinit terminate", "Mass"),
        ("initial\n ", "theta der", "kg"),
        ("output Real z = if theta > 1 ", "then", "bob"),
        ("end ", "Pendulum", "bob"),
        ("for i in 1:3 loop\n output Real q[i] = ", "i l theta sin", "kg"),
        ("for i in 1:3 loop for j in 1:2 loop\n output Real q[i, j] = ", "i j l theta", "kg"),
        ("// l", "", "l m parameter"),
        ('parameter Mass k "of t', "", "theta"),
        ("/* ", "", "theta"),
    ],
)
def test_completion_fits_the_place(begun: str, offered: str, not_offered: str) -> None:
    start = PENDULUM.index("end Pendulum")
    text = f"{PENDULUM[:start]}  {begun}\n{PENDULUM[start:]}"
    labels = [offer.label for offer in Document("a.lag", text).completions(start + 2 + len(begun))]
    assert set(offered.split()) <= set(labels) and not set(not_offered.split()) & set(labels), labels
    assert len(labels) == len(set(labels))


def test_a_text_that_begins_with_a_thing_without_a_name_has_completions() -> None:
    assert Document("a.lag", "body =").completions(6)


def test_arguments_of_an_instance_are_those_of_its_model() -> None:
    text = "model A parameter Mass k = 1; body b; end A;\nmodel B A a("
    assert {offer.label for offer in Document("a.lag", text).completions(len(text))} >= {"k"}
    text = text.replace("a(", "a; output Mass y = a.")
    assert "k" in {offer.label for offer in Document("a.lag", text).completions(len(text))}


def test_names_of_other_files_are_found(tmp_path: Path) -> None:
    (tmp_path / "lib.lag").write_text('package Lib\n  constant Length far = 2 [m] "far away";\nend Lib;\n')
    text = 'import "lib.lag";\nmodel M\n  parameter Length l = Lib.far;\n  coordinate Length x;\nend M;\n'
    document = Document(str(tmp_path / "a.lag"), text, (str(tmp_path),))
    use = document.names.at(text.index("far"))
    assert use is not None and use.target.place.source.name.endswith("lib.lag") and use.target.place.line == 2
    assert "far away" in document.about(use.target)
    with pytest.raises(Refused, match="declared in"):
        document.renamed(use, "near")


def test_names_that_a_model_of_another_file_declares_are_found(tmp_path: Path) -> None:
    (tmp_path / "lib.lag").write_text("model Base\n  coordinate Length x;\nend Base;\n")
    text = 'import "lib.lag";\nmodel M extends Base;\n  output Length y = 2*x;\nend M;\n'
    use = Document(str(tmp_path / "a.lag"), text, (str(tmp_path),)).names.at(text.index("x;"))
    assert use is not None and use.target.place.source.name.endswith("lib.lag") and use.target.place.line == 2


def rename(text: str, place: str, name: str) -> str:
    document = Document("a.lag", text, ROOTS)
    use = document.names.at(text.index(place))
    assert use is not None
    return document.with_edits(document.renamed(use, name)).source.text


def test_rename_changes_all_uses() -> None:
    assert rename(PENDULUM, "theta(start", "phi") == PENDULUM.replace("theta", "phi")
    assert rename(PENDULUM, "gravity", "weight") == PENDULUM.replace("gravity", "weight")
    assert rename(PENDULUM, "Pendulum", "P") == PENDULUM.replace("Pendulum", "P")


@pytest.mark.parametrize("name", ["bob", "l", "1x", "sin(x)"])
def test_rename_is_refused_where_the_text_would_be_wrong(name: str) -> None:
    with pytest.raises(Refused):
        rename(PENDULUM, "theta(start", name)


@pytest.mark.sample(0, 8)
@pytest.mark.parametrize("path", LIBRARY, ids=lambda path: path.stem)
def test_models_keep_their_meaning_when_names_change(path: Path) -> None:
    document, numbers = Document(str(path), text_of(path), ROOTS), random.Random(path.stem)
    for declared in numbers.sample(document.names.declared, min(8, len(document.names.declared))):
        use = document.names.at(declared.place.start)
        assert use is not None
        assert document.renamed(use, "zz9")


BARE = """
import sys
sys.modules.update(dict.fromkeys(("numpy", "pygls", "lsprotocol", "pygments")))  # cannot be imported
from lagc.editor.document import Document
from lagc.editor.fixes import fix
from tests.editor.texts import PENDULUM
document = Document("a.lag", PENDULUM.replace("sin(theta)", "sin(thet)"))
assert fix(document, document.faults[0])
assert document.hover(PENDULUM.index("l*{")) and document.completions(PENDULUM.index("l*{"))
"""


@pytest.mark.full
def test_the_answers_need_no_package() -> None:
    done = subprocess.run([sys.executable, "-c", BARE], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.sample(5, 60)
@pytest.mark.parametrize("text", [text for _, _, text in CASES], ids=[about for about, _, _ in CASES])
def test_faults_are_those_of_the_compiler(text: str) -> None:
    plain, _, _ = unmarked(whole(text))
    source = Source("model.lag", plain)
    quick = ("LAG01", "LAG02", "LAG03")
    wanted = [f for f in errors_of(check(source, Choice())) if f.code.startswith(quick)]
    found = errors_of(Document("model.lag", plain).faults)
    assert [(f.code, f.message, f.edits) for f in found] == [(f.code, f.message, f.edits) for f in wanted]


def test_a_look_ends_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """A text whose names take too long has no faults yet, and no fix is offered on such a text."""
    monkeypatch.setattr(documents, "QUICK", 1e-9)
    document = Document("a.lag", PENDULUM.replace("sin(theta)", "sin(thet)"))
    assert not document.settled and not document.faults
    document = Document("a.lag", PENDULUM.replace("cos(theta)});", "cos(theta)})"))
    assert document.settled and fix(document, document.faults[0]) is None


# -- fixes -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("sin(theta)", "sin(thet)"), ("-cos(theta)});", "-cos(theta)})"), ("Particle(", "Partcle("),
        ("[m/s2]", "[m/z2]"), ("{sin(theta),", "{sin(theta)"), ("{sin(theta)", "{sin(theta"),
        ("60 [deg])", "60 [deg]"), ("end Pendulum", "end Pendulm"), ("parameter Mass", "parametr Mass"),
    ],
)  # fmt: skip
def test_a_fix_restores_the_text(right: str, wrong: str) -> None:
    assert PENDULUM.count(right) >= 1
    document = Document("a.lag", PENDULUM.replace(right, wrong, 1))
    found = fix(document, errors_of(document.faults)[0])
    assert found is not None
    assert "".join(document.with_edits(found.edits).source.text.split()) == "".join(PENDULUM.split())


def test_a_block_is_closed_by_a_line_of_its_own() -> None:
    document = Document("a.lag", PENDULUM.replace("  end gravity;\n", ""))
    found = fix(document, errors_of(document.faults)[0])
    assert found is not None and found.title == "insert `end gravity;`"
    assert not errors_of(document.with_edits(found.edits).faults)


def test_no_fix_is_offered_that_does_not_help() -> None:
    document = Document("a.lag", PENDULUM.replace("= 50 [cm]", "= 50 [s]"))
    (fault,) = errors_of(document.faults)
    assert fix(document, fault) is None


@pytest.mark.full
@pytest.mark.parametrize(("kind", "least"), [("letter", 50), (";", 50), (")", 44), (",", 30), ("unit", 20)])
def test_of_sixty_mistakes_most_have_a_fix(kind: str, least: int) -> None:
    """A letter, a sign or a unit is wrong at a random place of the library."""
    numbers, tried, fixed = random.Random(7), 0, 0
    while tried < 60:
        found = mistyped(kind, numbers)
        if found is None:
            continue
        tried += 1
        document = Document(str(found[0]), found[2], ROOTS)
        wrong = errors_of(document.faults)
        fixed += bool(wrong) and fix(document, wrong[0]) is not None
    assert fixed >= least


@pytest.mark.sample(0, 4)
@pytest.mark.parametrize("part", range(100))
def test_damaged_texts_have_answers(part: int) -> None:
    numbers = random.Random(part)
    for k in range(70):
        text = mutated(text_of(numbers.choice(LIBRARY)), numbers)
        document = Document("a.lag", text)
        found = document.faults
        for offset in (numbers.randint(0, len(text)) for _ in range(4)):
            document.hover(offset)
            document.completions(offset)
        if found and k % 10 == 0:
            fix(document, found[0])
