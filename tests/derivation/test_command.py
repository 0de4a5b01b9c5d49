"""The command `derive` and `model.derivation()`. The sentences, and the formats: Markdown, LaTeX, HTML."""

import json
import re
import shutil
import string
import xml.etree.ElementTree as XML
from html import unescape
from pathlib import Path

import pytest

import lagc
from lagc.cli.main import main
from lagc.reports.derivation.derivation import Derivation, derivation_of, with_motion
from lagc.reports.derivation.document import Formulas
from lagc.reports.derivation.formats import NoLatex, to_pdf
from lagc.reports.derivation.html import to_mathml
from lagc.reports.derivation.phrases import _TABLE, LANGUAGES, Phrases
from tests.derivation.test_every_model import CASES
from tests.derivation.values import solution
from tests.reports.models import derived, equations_of

Capture = pytest.CaptureFixture[str]


def test_markdown_is_printed(capsys: Capture) -> None:
    assert main(["derive", "simple_pendulum"]) == 0
    text = capsys.readouterr().out
    assert (
        text.startswith("# A mass on a massless string")
        and r"l \, \ddot{\theta} + g \, \sin \theta = 0" in text
    )


@pytest.mark.parametrize(
    "ending, begins", [(".md", "# "), (".tex", r"\documentclass"), (".html", "<!DOCTYPE html>")]
)
def test_the_ending_chooses_the_format(ending: str, begins: str, tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / f"solution{ending}"
    assert main(["derive", "simple_pendulum", "--language", "fr", "-o", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    assert text.startswith(begins) and "Énergie cinétique" in text
    assert capsys.readouterr().err == f"{path} written\n"


def test_another_ending_is_refused(capsys: Capture) -> None:
    assert main(["derive", "simple_pendulum", "-o", "solution.doc"]) == 2
    assert ".md, .tex, .html, .pdf" in capsys.readouterr().err


def test_a_pdf_without_latex_is_refused(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    path = tmp_path / "solution.pdf"
    assert main(["derive", "simple_pendulum", "-o", str(path)]) == 2
    assert "pdflatex" in capsys.readouterr().err and not path.exists()


def test_the_scene_is_chosen_and_json_holds_the_text(capsys: Capture) -> None:
    assert main(["derive", "simple_pendulum", "--scene", "room", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["scene"] == "room" and "drag" in found["solution"]


def test_notebooks_fold_the_sections() -> None:
    found = lagc.load("simple_pendulum").derivation("de")
    assert found._repr_html_().count("<details >") == 12 and "Kinematik" in found._repr_markdown_()


def test_long_formulas_are_abbreviated_and_counted_unless_all_is_asked_for() -> None:
    total = " + ".join([f"cos({n}*x)" for n in range(1, 43)])
    text = f"""model M
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Angle x;
  body b = Particle(mass = m, at = {{l*x, 0, 0}});
  potential V = 1 [J]*({total});
end M;
"""
    model = lagc.loads(text).compile()
    short, whole = model.derivation(), model.derivation(full=True)
    assert "(34 more terms)" in short.markdown and "Abbreviated formulas" in short.markdown
    assert "more terms" not in whole.markdown and len(whole.markdown) > len(short.markdown)


def test_each_phrase_is_in_each_language_with_the_same_places() -> None:
    for line in _TABLE.strip().splitlines():
        key, *sentences = line.split(" | ")
        assert len(sentences) == len(LANGUAGES) and all(x.strip() for x in sentences), key
        assert len({sentence.count("{}") for sentence in sentences}) == 1, key


def test_another_language_is_refused() -> None:
    with pytest.raises(ValueError):
        Phrases("xx")


def test_languages_change_words_and_no_formula() -> None:
    english, *others = [derivation_of(derived("course/rough_wedge_explicit"), x) for x in LANGUAGES]

    def bare(found: list[str]) -> list[str]:
        return [re.sub(r"\\text\{[^{}]*\}", "", line) for line in found]

    def formulas(found: Derivation) -> list[str]:
        return bare([line for block in found.blocks if isinstance(block, Formulas) for line in block.latex])

    for other in others:
        assert formulas(other) == formulas(english)
        assert other.markdown != english.markdown


CHILDREN = {"msub": 2, "msup": 2, "msubsup": 3, "munder": 2, "mover": 2, "munderover": 3, "mfrac": 2}


def inside(tag: str, page: str) -> list[str]:
    return re.findall(rf"<{tag}.*?</{tag}>", page, re.DOTALL)


@pytest.mark.sample(6)
@pytest.mark.parametrize("name", CASES)
def test_pages_are_well_formed_and_load_nothing(name: str) -> None:
    page = solution(name).html
    assert "http" not in page and "<script" not in page
    for element in inside("math", page):
        named = r"&(?!lt;|gt;|amp;|quot;)\w+;"  # entities that XML does not know
        root = XML.fromstring(re.sub(named, lambda name: unescape(name[0]), element))
        assert all(len(x) == CHILDREN.get(x.tag, len(x)) for x in root.iter()), element
        text = "".join(root.itertext())
        assert "\\" not in text, text
    assert page.count("<details") == page.count("</details>")


@pytest.mark.parametrize("latex, shown", [
    (r"\frac{a}{b}", "<mstyle><mfrac><mrow><mi>a</mi></mrow><mrow><mi>b</mi></mrow></mfrac></mstyle>"),
    (r"\dot{\theta}^{2}", '<msup><mover accent="true"><mrow><mi>θ</mi></mrow><mo stretchy="false">˙</mo>'
                          "</mover>"
                          "<mrow><mn>2</mn></mrow></msup>"),
    (r"x_{0}^{*}", "<msubsup><mi>x</mi><mrow><mn>0</mn></mrow><mrow><mo>*</mo></mrow></msubsup>"),
    (r"\text{a\_b}", "<mtext>a_b</mtext>"),
])  # fmt: skip
def test_mathml(latex: str, shown: str) -> None:
    assert to_mathml(latex) == f"<math><mrow>{shown}</mrow></math>"


def test_texts_of_a_model_are_no_markup() -> None:
    """Signs that mean something in a format stand in a description."""
    signs = "".join(sorted(set(string.punctuation) - {'"', "\\"})) + " é θ ж"
    text = f'model M "{signs}"\n  parameter Mass m = 1 [kg];\n  coordinate Length x_1 "{signs}";\n'
    text += "  body b = Particle(mass = m, at = {x_1, 0, 0});\nend M;\n"
    found = derivation_of(equations_of(text))
    assert "&lt;=&gt;" in found.html and r"\#\$\%\&" in found.latex.replace("{}", "")
    assert r"\$" in found.markdown and r"\|" in found.markdown


def test_a_pdf_without_latex_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(NoLatex, match="pdflatex"):
        to_pdf(solution("course/simple_pendulum").latex, {})


@pytest.mark.full
@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no LaTeX")
@pytest.mark.parametrize(
    "name", ["course/simple_pendulum", "course/rough_wedge_explicit", "classic/heavy_top_quaternion"]
)
def test_latex_compiles(name: str) -> None:
    assert solution(name).pdf.startswith(b"%PDF")


@pytest.mark.full
def test_a_solution_to_the_motion_ends_with_its_plot() -> None:
    pytest.importorskip("matplotlib")
    run = lagc.load("simple_pendulum").compile(backend="numpy").simulate(stop=1.0, points=11)
    found = with_motion(solution("course/simple_pendulum"), run)
    assert "<svg" in found.html and "solution-motion.svg" in found.pictures(".md")
    assert found.pictures(".tex")["solution-motion.pdf"].startswith(b"%PDF")
