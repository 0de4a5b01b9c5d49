"""Formulas in LaTeX as MathML, which browsers show without any script or font.

It reads the commands that the writers of lagc use (MathML Core, W3C 2023). An unknown command is shown by its
name.
"""

from __future__ import annotations

import re
from html import escape

_TOKENS = re.compile(r"\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|\s+|.", re.DOTALL)
_SPACES = {r"\,": 0.17, r"\;": 0.28, r"\ ": 0.33, r"\quad": 1.0, r"\qquad": 2.0}
_ACCENTS = {r"\dot": "˙", r"\ddot": "¨", r"\vec": "→", r"\overrightarrow": "→", r"\hat": "^", r"\tilde": "~"}
_ALPHABETS = {
    r"\mathrm": "mi",
    r"\mathit": "mtext",
    r"\mathbf": "bold",
    r"\mathcal": "script",
    r"\operatorname": "mi",
}
_OPERATORS = {
    r"\cdot": "⋅", r"\le": "≤", r"\ge": "≥", r"\ne": "≠", r"\perp": "⊥", r"\times": "×", r"\ldots": "…",
    r"\sum": "∑", r"\land": "∧", r"\lor": "∨", r"\neg": "¬", r"\lnot": "¬", r"\lfloor": "⌊", r"\rfloor": "⌋", "-": "−",
    r"\{": "{", r"\}": "}", r"\vert": "|",
}  # fmt: skip
_LETTERS = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ϵ", "zeta": "ζ", "eta": "η", "theta": "θ",
    "iota": "ι", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ",
    "tau": "τ", "upsilon": "υ", "phi": "ϕ", "chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ", "Delta": "Δ",
    "Theta": "Θ", "Lambda": "Λ", "Xi": "Ξ", "Pi": "Π", "Sigma": "Σ", "Upsilon": "Υ", "Phi": "Φ", "Psi": "Ψ",
    "Omega": "Ω", "vartheta": "ϑ", "partial": "∂",
}  # fmt: skip
_SCRIPT = {"P": "𝒫", "L": "ℒ"}


def to_mathml(latex: str, display: bool = False) -> str:
    """Return the element `math` of one formula."""
    return f"<math{' display=block' if display else ''}>{_Reader(latex).row('')}</math>"


def cells(latex: str) -> list[str]:
    """Return the cells of a row whose cells are parted by `&`."""
    return _Reader(latex).cells("")


class _Reader:
    """A parser by recursive descent over the tokens of a formula."""

    def __init__(self, latex: str):
        self.tokens = (
            [t for t in _TOKENS.findall(latex) if not t.isspace()]
            if r"\text" not in latex
            else _TOKENS.findall(latex)
        )
        self.at = 0

    def _next(self) -> str:
        token = self.tokens[self.at]
        self.at += 1
        return token

    def _peek(self) -> str:
        while self.at < len(self.tokens) and self.tokens[self.at].isspace():
            self.at += 1
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def row(self, end: str) -> str:
        """Return what stands before the token `end`, which is passed."""
        return "".join(self.cells(end))

    def cells(self, end: str) -> list[str]:
        """Return the groups between `&` before the token `end`, each as one row."""
        found, items = list[str](), list[str]()
        while self._peek() != end and self.at < len(self.tokens):
            if self._peek() == "&":
                self._next()
                found.append(f"<mrow>{''.join(items)}</mrow>")
                items = []
            else:
                items.append(self._scripts(self._atom(), items))
        if end:
            self._next()
        return [*found, f"<mrow>{''.join(items)}</mrow>"]

    def _scripts(self, base: str, before: list[str]) -> str:
        """Return `base` with the subscript and superscript that follow it."""
        parts = {}
        while self._peek() in ("_", "^") and self._peek() not in parts:
            mark = self._next()
            parts[mark] = self._argument()
        if not parts:
            return base
        over_and_under = base.startswith(("<munder", "<mo>∑"))
        tag = {"_": "sub", "^": "sup", "_^": "subsup"}["".join(sorted(parts, reverse=True))]
        if over_and_under:
            tag = {"sub": "under", "sup": "over", "subsup": "underover"}[tag]
        return f"<m{tag}>{base}{parts.get('_', '')}{parts.get('^', '')}</m{tag}>"

    def _argument(self) -> str:
        if self._peek() == "{":
            self._next()
            return self.row("}")
        return self._atom()

    def _words(self) -> str:
        """Return the text between the braces that follow, without its escapes."""
        self._peek()
        depth, found = 0, list[str]()
        while True:
            token = self._next()
            depth += {"{": 1, "}": -1}.get(token, 0)
            if depth == 0:
                break
            found.append("\\" if token == r"\textbackslash" else token if token[0] != "\\" else token[1:])
        return "".join(found)[1:].replace("{}", "")

    def _atom(self) -> str:
        """Return the next symbol, group or command."""
        token = self._next()
        if token == "{":
            return self.row("}")
        if token in (r"\frac", r"\tfrac"):
            fraction = f"<mfrac>{self._argument()}{self._argument()}</mfrac>"
            return f'<mstyle displaystyle="false">{fraction}</mstyle>' if token == r"\tfrac" else fraction
        if token == r"\sqrt":
            return f"<msqrt>{self._argument()}</msqrt>"
        if token in _ACCENTS:
            wide = str(token == r"\overrightarrow").lower()
            accent = f'<mo stretchy="{wide}">{_ACCENTS[token]}</mo>'
            return f'<mover accent="true">{self._argument()}{accent}</mover>'
        if token == r"\underbrace":
            return f"<munder>{self._argument()}<mo>⏟</mo></munder>"
        if token in _ALPHABETS:
            return self._alphabet(_ALPHABETS[token])
        if token == r"\text":
            return f"<mtext>{escape(self._words()).replace(' ', '&nbsp;')}</mtext>"
        if token == r"\mathrel":
            return f"<mo>{escape(self._words())}</mo>"
        if token == r"\begin":
            return self._cases()
        if token in (r"\left", r"\right"):
            return self._fence(token)
        return self._symbol(token)

    def _alphabet(self, kind: str) -> str:
        words = self._words()
        if kind == "script":
            return f"<mi>{''.join([_SCRIPT.get(x, x) for x in words])}</mi>"
        if kind == "mtext":
            return f'<mi style="font-style:italic">{escape(words)}</mi>'
        style = ' style="font-weight:bold"' if kind == "bold" else ""
        return f'<mi mathvariant="normal"{style}>{escape(words)}</mi>'

    def _fence(self, token: str) -> str:
        mark = self._next()
        form = "prefix" if token == r"\left" else "postfix"
        text = _OPERATORS.get(mark, mark)
        if token == r"\left":
            inner = self.row(r"\right")
            close = self._next()
            return (f'<mrow><mo form="{form}">{text}</mo>{inner}'
                    f'<mo form="postfix">{_OPERATORS.get(close, close)}</mo></mrow>')  # fmt: skip
        return f'<mo form="{form}">{text}</mo>'

    def _cases(self) -> str:
        self._words()  # the name of the environment
        rows, row = [], list[str]()
        while self._peek() != r"\end":
            row = self._until_row_end()
            rows.append(
                "<mtr>" + "".join([f'<mtd style="text-align:left">{cell}</mtd>' for cell in row]) + "</mtr>"
            )
        self._next()
        self._words()
        return f"<mrow><mo>{{</mo><mtable>{''.join(rows)}</mtable></mrow>"

    def _until_row_end(self) -> list[str]:
        found, items = list[str](), list[str]()
        while self._peek() not in (r"\\", r"\end"):
            if self._peek() == "&":
                self._next()
                found.append(f"<mrow>{''.join(items)}</mrow>")
                items = []
            else:
                items.append(self._scripts(self._atom(), items))
        if self._peek() == r"\\":
            self._next()
        return [*found, f"<mrow>{''.join(items)}</mrow>"]

    def _symbol(self, token: str) -> str:
        if token in _SPACES:
            return f'<mspace width="{_SPACES[token]}em"/>'
        if token[0].isdigit():
            return f"<mn>{token}</mn>"
        if token in _OPERATORS:
            return f"<mo>{_OPERATORS[token]}</mo>"
        if token[0] == "\\":
            name = token[1:]
            if name in _LETTERS:
                return f"<mi>{_LETTERS[name]}</mi>"
            return f'<mi>{escape(name)}</mi><mspace width="0.17em"/>'  # a function, such as \sin
        if token.isalpha():
            return f"<mi>{token}</mi>"
        stretchy = ' stretchy="false"' if token in "()[]|" else ""
        return f"<mo{stretchy}>{escape(token)}</mo>"
