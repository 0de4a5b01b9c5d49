"""The code and the documentation use the terms of the literature, not home-made ones.

To add a word, add a row to WORDS: what to use instead, then up to two regular expressions.

* `names` matches a whole word of an identifier or of a file name, in lower case: `listen` finds the function
  `listen_along`, the class `Listen` and the file `listen.py`, but not `listener`.
* `prose` is searched in docstrings, comments, texts and messages of `lagc`, in `docs`, in `README.md` and in
  generated C.  Upper and lower case differ, since some rows are about the beginning of a sentence.

Ban a word only where it is a home-made term: a word that also has an ordinary meaning in prose gets `names`
alone.
"""

import ast
import io
import re
import tokenize
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

from lagc.codegen.c.emit import render
from tests.codegen.tools import of_model

ROOT = Path(__file__).resolve().parent.parent


class Word(NamedTuple):
    instead: str
    names: str = ""
    prose: str = ""


WORDS: dict[str, Word] = {
    "listening": Word("round-off estimate, perturb", "listen(s|ing)?|heard|shak(e|es|en|ing)",
                      r"\b(listen(s|ing)?|heard|shak(e|es|en|ing))\b"),
    "foretold": Word("predicted", "foret(ell|ells|old)", r"\bforet(ell|ells|old)\b"),
    "halted": Word("higher-order rigidity", "halted", r"\bhalted\b"),
    "leftovers": Word("orphan processes", "leftovers?", r"\bleftovers?\b"),
    "blame": Word("source provenance", "blam(e|ed|es)", r"\bblam(e|ed|es)\b"),
    "resting": Word("sliding mode, sticking", "resting", r"\bresting\b"),
    "grounds": Word("sampling domain", "grounds", r"\bgrounds\b"),
    "judge": Word("zero test", "judg(e|es|ed|ing)", r"\bjudg(e|es|ed|ing)\b"),
    "opposing": Word("passivity check", "opposing|feeding"),
    "noisy": Word("round-off dominated", "noisy", r"\bnoisy\b"),
    "still": Word("constant, round-off dominated", "still"),
    "home": Word("guess (of an unknown)", "home|loose"),
    "switch": Word("relation, zero crossing", "switch(es|ing)?"),
    "locating": Word("event location", "locating"),
    "lift": Word("articulated-body form", "lift(s|ed|ing)?"),
    "rolled": Word("loop rerolling", "rolled"),
    "last places": Word("round-off, unit in the last place", "", r"\b(last places|its last place)\b"),
    "posture": Word("configuration", "postures?", r"\bpostures?\b"),
    "constraint row": Word("constraint equation", "", r"\bconstraint rows?\b"),
    "way": Word("direction, distance, kind", "ways?"),
    "soon, seldom, told": Word("early, rare, reported", "soon|seldom|told"),
    "missed": Word("residual, unmet", "missed"),
    "lessened": Word("reduced", "lessen(ed)?"),
    "lettered": Word("with letters for indices", "lettered"),
    "bend, jolt": Word("curvature, shift", "b[ae]n[dt]s?|jolts?|nudge[ds]?"),
    "what is left of": Word("residual, rest", "", r"\b[Ww]hat is left of\b"),
    "comes to": Word("reaches, evaluates to", "", r"\bcomes? to\b"),
    "start's": Word("initial", "", r"\bstart's\b"),
    "of which": Word("a second sentence", "", r"\bof which\b"),
    "What, Who": Word("a sentence with a subject", "", r"\b(What|Who) (?![^.?]*\?)"),
}  # fmt: skip
PROSE = re.compile("|".join(filter(None, [row.prose for row in WORDS.values()])), re.MULTILINE)

# A function is named by what it does or returns; these words alone do not say it.
NO_NAMES = re.compile(
    r"_*("
    r"acted|again|ahead|all|alone|anywhere|apart|around|aside|asked|away|back|behind|below|"
    r"beside|elsewhere|followed|given|held|kept|met|moved|other|others|outside|own|parted|put|"
    r"rest|same|taken|tied|together|touching|unmoved"
    r")_*"
)

# A docstring is a sentence with a subject or a verb; these words alone begin none.
NO_BEGINNING = re.compile(
    r':\n +"""((?:All|As|But|By|Counted|Each|For|In|Not|Of|On|Only|Those|Where|With(?! the)|Without)\b.*)'
)

# The longest functions that explain themselves: numerical methods need words sooner.
LONGEST, LONGEST_KERNEL = 35, 25
SOURCES = sorted((ROOT / "lagc").rglob("*.py"))


class Use(NamedTuple):
    word: str
    place: str


def words_of(name: str) -> list[str]:
    """Return the words of an identifier: `listen`, `along` for `listen_along` and `ListenAlong`."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower().split("_")


def identifiers(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Yield the names that a module defines, with their lines."""
    for node in ast.walk(tree):
        line = getattr(node, "lineno", 0)
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name, line
        elif isinstance(node, ast.arg):
            yield node.arg, line
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id, line
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.attr, line


def prose(text: str) -> Iterator[tuple[str, int]]:
    """Yield the comments and the texts of a module, with their lines."""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            yield token.string.lstrip("# "), token.start[0]
        elif token.type in (tokenize.STRING, getattr(tokenize, "FSTRING_MIDDLE", tokenize.STRING)):
            yield token.string, token.start[0]


@cache
def rows_of(part: str) -> list[str]:
    """Return the rows that a word of a name is in."""
    return [word for word, row in WORDS.items() if row.names and re.fullmatch(row.names, part)]


def found_in_names(path: Path, names: Iterator[tuple[str, int]]) -> Iterator[Use]:
    for name, line in names:
        for part in words_of(name):
            for word in rows_of(part):
                yield Use(word, f"{path.relative_to(ROOT)}:{line}: {name}")


def found_in_prose(path: Path, texts: Iterator[tuple[str, int]]) -> Iterator[Use]:
    for text, line in texts:
        for word, row in WORDS.items() if re.search(PROSE, text) else ():
            for match in re.finditer(row.prose, text, re.MULTILINE) if row.prose else ():
                at = line + text.count("\n", 0, match.start())
                yield Use(word, f"{path.relative_to(ROOT)}:{at}: {match[0].strip()}")


def uses() -> list[Use]:
    """Return all uses of the words."""
    found: list[Use] = []
    for path in sorted((ROOT / "lagc").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        found += found_in_names(path, iter([(path.stem, 0)]))
        names = set(re.findall(r"[A-Za-z]\w*", text))
        if any(rows_of(part) for name in names for part in words_of(name)):  # to parse all files takes long
            found += found_in_names(path, identifiers(ast.parse(text)))
        if re.search(PROSE, text):
            found += found_in_prose(path, prose(text))
    pages = [page for page in (ROOT / "docs").rglob("*.md") if page.name != "gallery.md"]  # it quotes models
    for path in sorted([ROOT / "README.md", *pages]):
        found += found_in_prose(path, iter([(path.read_text(encoding="utf-8"), 1)]))
    for name, generated in render(of_model("course/simple_pendulum")).items():
        found += found_in_prose(ROOT / name, iter([(generated, 1)]))
    return found


def test_words_are_not_used() -> None:
    assert not [f"{use.place} (use {WORDS[use.word].instead})" for use in uses()]


def test_words_are_found() -> None:
    path = ROOT / "lagc" / "rooms.py"
    code = (
        'def listen_along(w):\n    """Who listens, knows."""\n    w.NoisyPart = 1  # of which none is seen\n'
    )
    names = [use.word for use in found_in_names(path, identifiers(ast.parse(code)))]
    texts = [use.word for use in found_in_prose(path, prose(code))]
    assert names == ["listening", "noisy"]
    assert sorted(texts) == ["What, Who", "listening", "of which"]


def functions(lines: Sequence[str]) -> Iterator[tuple[str, int, int]]:
    """Yield name, first and last line of the functions of a module, by indentation: to parse all files takes
    long."""
    open_: list[tuple[int, str, int]] = []  # indentation, name, first line
    last = 0  # line with text
    for number, line in enumerate([*lines, "end"]):
        text = line.lstrip()
        if not text or text.startswith(")"):  # a signature ends in the column where it began
            continue
        indentation = len(line) - len(text)
        while open_ and indentation <= open_[-1][0]:
            _, name, first = open_.pop()
            yield name, first, last
        if text.startswith("def "):
            open_.append((indentation, text[4:].partition("(")[0], number))
        last = number


def unexplained(path: Path, text: str) -> Iterator[str]:
    """Yield the long functions without a comment of its own line, and those with a name of NO_NAMES."""
    longest = LONGEST_KERNEL if path.is_relative_to(ROOT / "lagc" / "kernels") else LONGEST
    lines = text.split("\n")
    for name, first, last in functions(lines):
        place, length = f"{path.relative_to(ROOT)}:{first + 1}: {name}", last - first + 1
        if length > longest and not any(line.lstrip().startswith("# ") for line in lines[first:last]):
            yield f"{place} has {length} lines and no comment"
        if NO_NAMES.fullmatch(name):
            yield f"{place} (use what it does or returns)"


def test_long_functions_are_explained() -> None:
    assert not [fault for path in SOURCES for fault in unexplained(path, path.read_text("utf-8"))]


def test_unexplained_functions_are_found() -> None:
    body = "    x = 1\n" * LONGEST
    code = f"def one():\n{body}\ndef two():\n    # Why.\n{body}\ndef _beside():\n    pass\n"
    faults = list(unexplained(ROOT / "lagc" / "rooms.py", code))
    assert [fault.split(": ")[1].split()[0] for fault in faults] == ["one", "_beside"]


def test_docstrings_are_sentences() -> None:
    faults = {path: NO_BEGINNING.findall(path.read_text("utf-8")) for path in SOURCES}
    assert not {str(path): found for path, found in faults.items() if found}


def test_docstrings_without_a_subject_are_found() -> None:
    code = 'def one():\n    """Of what it is made."""\ndef two():\n    """Return what it is made of."""\n'
    assert NO_BEGINNING.findall(code) == ['Of what it is made."""']
