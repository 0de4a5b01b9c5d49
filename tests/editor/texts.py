"""Texts of models, whole and damaged."""

import random
from functools import cache
from pathlib import Path

from lagc.diagnostics.faults import Source
from lagc.syntax.lexer import Token
from lagc.syntax.parse import read

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = sorted((ROOT / "models").rglob("*.lag"))
PENDULUM = """model Pendulum "µ: two bytes, 𝜃: two units of UTF-16"
  parameter Mass m(min = 0) = 1 [kg];
  parameter Length l = 50 [cm] "string length";  // 𝜃
  coordinate Angle theta(start = 60 [deg]) "from the vertical";
  body bob = Particle(mass = m, at = l*{sin(theta), 0, -cos(theta)});
  effect gravity
    Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
  end gravity;
  output Energy E = m*l^2*der(theta)^2/2;
  scene lab uses gravity;
end Pendulum;
"""


@cache
def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def mistyped(kind: str, numbers: random.Random) -> tuple[Path, str, str] | None:
    """A model of the library, its text, and the text with one mistake of a kind, or None if it has none."""
    path = numbers.choice(LIBRARY)
    text = text_of(path)
    tokens = read(Source(str(path), text))[1].tokens[:-1]
    found = [token for token in tokens if _may_be_wrong(token, kind)]
    if not found:
        return None
    token = numbers.choice(found)
    new = ""
    if kind == "letter":
        lost = numbers.randrange(1, len(token.text) - 1)
        new = token.text[:lost] + token.text[lost + 1 :]
    elif kind == "unit":
        new = token.text.replace("m", "x", 1).replace("s", "z", 1)
    return path, text, text[: token.start] + new + text[token.end :]


def _may_be_wrong(token: Token, kind: str) -> bool:
    if kind in ("letter", "unit"):
        return len(token.text) > 3 and token.kind == ("word" if kind == "letter" else "unit")
    return token.text == kind
