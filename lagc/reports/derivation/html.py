"""A solution in HTML: a page of its own, or a part of a notebook. Sections fold; formulas are MathML."""

import re
from collections.abc import Sequence
from html import escape

from lagc.reports.derivation.document import Block, Formulas, Heading, Items, Picture, Table, spelt
from lagc.reports.equations.latex import GREEK

_STYLE = """
body { font: 17px/1.5 Georgia, serif; max-width: 46em; margin: 1.5em auto; padding: 0 1em; color: #1b1b1b }
math { font-family: "Latin Modern Math", "STIX Two Math", "Cambria Math", "DejaVu Math TeX Gyre", math }
summary { font-size: 1.25em; font-weight: bold; margin: 1.1em 0 .4em; cursor: pointer }
h1 { font-size: 1.6em } h3 { margin: 1.2em 0 .2em } table { border-collapse: collapse; margin: .6em 0 }
td, th { padding: .2em .8em; border-bottom: 1px solid #ccc; text-align: left }
svg { max-width: 100%; height: auto }
"""
_SCROLL = '<div style="overflow:auto hidden;padding:.4em 0">{}</div>'  # what is wider than the page


def to_page(blocks: Sequence[Block], language: str) -> str:
    """Return a complete page that loads nothing."""
    title = next((spelt(b.text, escape, escape, "{}") for b in blocks if isinstance(b, Heading)), "")
    viewport = '<meta name="viewport" content="width=device-width, initial-scale=1">'
    head = f'<meta charset="utf-8">{viewport}<title>{title}</title><style>{_STYLE}</style>'
    body = to_fragment(blocks, "open")
    return f'<!DOCTYPE html>\n<html lang="{language}"><head>{head}</head><body>\n{body}\n</body></html>\n'


def to_fragment(blocks: Sequence[Block], state: str = "") -> str:
    """Return the solution for a notebook, its sections folded; with the `state` "open" they are not."""
    found, number = list[str](), 0
    for block in blocks:
        if isinstance(block, Heading) and block.level == 2:
            found += ["</details>"] * (number > 0)
            number += 1
            found.append(f"<details {state}><summary>{number}. {_html(block.text)}</summary>")
        else:
            found.append(_block(block))
    return "\n".join([*found, *["</details>"] * (number > 0)])


def _block(block: Block) -> str:
    if isinstance(block, Heading):
        return f"<h{block.level}>{_html(block.text)}</h{block.level}>"
    if isinstance(block, Formulas):
        rows = "".join(map(_row, block.latex))
        return _SCROLL.format(f'<math display="block"><mtable displaystyle="true">{rows}</mtable></math>')
    if isinstance(block, Items):
        return "<ul>" + "".join([f"<li>{_html(item)}</li>" for item in block.items]) + "</ul>"
    if isinstance(block, Picture):
        return _SCROLL.format(block.svg.decode())
    if isinstance(block, Table):
        tags = ["th", *["td"] * (len(block.rows) - 1)]
        rows = "".join(["<tr>" + "".join([f"<{tag}>{_html(cell)}</{tag}>" for cell in row]) + "</tr>"
                        for tag, row in zip(tags, block.rows)])  # fmt: skip
        return _SCROLL.format(f"<table>{rows}</table>")
    return f"<p>{_html(block)}</p>"


def _row(latex: str) -> str:
    """Return a row of formulas that are aligned at their equals signs."""
    style = '<mtd style="text-align:{};padding:.15em .1em">{}</mtd>'
    return "<mtr>" + "".join(map(style.format, ("right", "left"), cells(latex))) + "</mtr>"


def _html(text: str) -> str:
    return spelt(text, escape, to_mathml, "<b>{}</b>")


# -- MathML (W3C, MathML Core), which browsers show without a script or a font -------------------------

_TOKENS = re.compile(r"\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|.", re.DOTALL)
_FUNCTION = re.compile(r"<mi>[a-z]\w+</mi>")  # an element that a function is
_SPACES = {r"\,": 0.17, r"\;": 0.28, r"\ ": 0.33, r"\quad": 1.0, r"\qquad": 2.0}
_ACCENTS = {r"\dot": "˙", r"\ddot": "¨", r"\vec": "→", r"\overrightarrow": "→", r"\hat": "^", r"\tilde": "~"}
_STYLES = {
    r"\mathrm": ' mathvariant="normal"', r"\operatorname": ' mathvariant="normal"',
    r"\mathit": ' style="font-style:italic"', r"\mathbf": ' mathvariant="normal" style="font-weight:bold"',
    r"\mathcal": "",
}  # fmt: skip
_OPERATORS = {
    r"\cdot": "⋅", r"\le": "≤", r"\ge": "≥", r"\ne": "≠", r"\perp": "⊥", r"\times": "×", r"\ldots": "…",
    r"\sum": "∑", r"\land": "∧", r"\lor": "∨", r"\lnot": "¬", r"\lfloor": "⌊", r"\rfloor": "⌋", "-": "−",
    r"\{": "{", r"\}": "}",
}  # fmt: skip
_LETTERS = {"vartheta": "ϑ", "partial": "∂", "phi": "ϕ", "epsilon": "ϵ", "P": "𝒫", "L": "ℒ"}


def to_mathml(latex: str) -> str:
    """Return the element `math` of one formula."""
    return f"<math>{''.join(cells(latex))}</math>"


def cells(latex: str) -> list[str]:
    """Return the parts between `&` of a formula."""
    return _Reader(latex).cells("")


def _letter(name: str) -> str:
    """Return a Greek letter by its name."""
    import unicodedata

    case = "CAPITAL" if name[0].isupper() else "SMALL"
    return _LETTERS.get(name) or unicodedata.lookup(
        f"GREEK {case} LETTER {name.upper().replace('LAMBDA', 'LAMDA')}"
    )


class _Reader:
    """A parser by recursive descent over the tokens of a formula."""

    def __init__(self, latex: str):
        self.tokens, self.at = _TOKENS.findall(latex), 0

    def _next(self) -> str:
        self.at += 1
        return str(self.tokens[self.at - 1])

    def _peek(self) -> str:
        """Return the next token that is no space, "" at the end."""
        while self.at < len(self.tokens) and self.tokens[self.at].isspace():
            self.at += 1
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def cells(self, *ends: str) -> list[str]:
        """Return the groups between `&` before one of the tokens `ends`."""
        found, items = list[str](), list[str]()
        while self._peek() not in (*ends, ""):
            if self._peek() == "&":
                self._next()
                found.append(f"<mrow>{''.join(items)}</mrow>")
                items = []
            else:
                items.append(self._scripted(self._atom()))
        return [*found, f"<mrow>{''.join(items)}</mrow>"]

    def _group(self, end: str) -> str:
        """Return what stands before the token `end`, which is passed."""
        found = "".join(self.cells(end))
        self._next()
        return found

    def _scripted(self, base: str) -> str:
        """Return `base` with the subscript and superscript that follow it."""
        parts = {}
        while self._peek() in ("_", "^"):
            mark = self._next()
            parts[mark] = self._argument()
        space = '<mspace width="0.17em"/>' if _FUNCTION.fullmatch(base) else ""
        if not parts:
            return base + space
        names = ("under", "over") if base.startswith(("<munder", "<mo>∑")) else ("sub", "sup")
        tag = "".join([name for name, mark in zip(names, "_^") if mark in parts])
        return f"<m{tag}>{base}{parts.get('_', '')}{parts.get('^', '')}</m{tag}>{space}"

    def _argument(self) -> str:
        return self._atom() if self._peek() != "{" else self._group(self._next().replace("{", "}"))

    def _words(self) -> str:
        """Return the text between the braces that follow, without its escapes."""
        self._peek()
        depth, found = 0, list[str]()
        while not found or depth:
            token = self._next()
            depth += {"{": 1, "}": -1}.get(token, 0)
            found.append("\\" if token == r"\textbackslash" else token.removeprefix("\\"))
        return "".join(found)[1:-1].replace("{}", "")

    def _atom(self) -> str:
        """Return the next symbol, group or command."""
        token = self._next()
        if token == "{":
            return self._group("}")
        if token in (r"\frac", r"\tfrac"):
            style = ' displaystyle="false"' if token == r"\tfrac" else ""
            return f"<mstyle{style}><mfrac>{self._argument()}{self._argument()}</mfrac></mstyle>"
        if token == r"\sqrt":
            return f"<msqrt>{self._argument()}</msqrt>"
        if token in _ACCENTS:
            wide = str(token == r"\overrightarrow").lower()
            accent = f'<mo stretchy="{wide}">{_ACCENTS[token]}</mo>'
            return f'<mover accent="true">{self._argument()}{accent}</mover>'
        if token == r"\underbrace":
            return f"<munder>{self._argument()}<mo>⏟</mo></munder>"
        if token in _STYLES:
            words = self._words()
            words = _LETTERS.get(words, words) if token == r"\mathcal" else words
            return f"<mi{_STYLES[token]}>{escape(words)}</mi>"
        if token == r"\text":
            return f"<mtext>{escape(self._words()).replace(' ', '&nbsp;')}</mtext>"
        if token == r"\mathrel":
            return f"<mo>{escape(self._words())}</mo>"
        if token == r"\begin":
            return self._cases()
        if token == r"\left":
            opening, inner = self._next(), self._group(r"\right")
            marks = [_OPERATORS.get(x, x) for x in (opening, self._next())]
            return f'<mrow><mo form="prefix">{marks[0]}</mo>{inner}<mo form="postfix">{marks[1]}</mo></mrow>'
        return self._symbol(token)

    def _cases(self) -> str:
        """Return the rows of the environment `cases`."""
        self._words()
        rows = []
        while self._peek() != r"\end":
            row = "".join([f'<mtd style="text-align:left">{x}</mtd>' for x in self.cells(r"\\", r"\end")])
            rows.append(f"<mtr>{row}</mtr>")
            if self._peek() == r"\\":
                self._next()
        self._next()
        self._words()
        return f"<mrow><mo>{{</mo><mtable>{''.join(rows)}</mtable></mrow>"

    def _symbol(self, token: str) -> str:
        if token in _SPACES:
            return f'<mspace width="{_SPACES[token]}em"/>'
        if token[0].isdigit():
            return f"<mn>{token}</mn>"
        if token in _OPERATORS:
            return f"<mo>{_OPERATORS[token]}</mo>"
        if token[0] != "\\":
            stretchy = ' stretchy="false"' if token in "()[]|" else ""
            return f"<mi>{token}</mi>" if token.isalpha() else f"<mo{stretchy}>{escape(token)}</mo>"
        name = token[1:]
        if name in GREEK or name in _LETTERS:
            return f"<mi>{_letter(name)}</mi>"
        return f"<mi>{escape(name)}</mi>"  # a function, such as \sin
