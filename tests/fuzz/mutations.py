"""Model texts with a few things wrong, by a seed: what people and programs write by mistake."""

import random
import re
from collections.abc import Callable
from pathlib import Path

MODELS = Path(__file__).resolve().parents[2] / "models"
TOKEN = re.compile(r"//[^\n]*|\s+|[A-Za-z_]\w*|\d[\w.]*|\"[^\"]*\"|.", re.DOTALL)

WORDS = [
    "model", "end", "effect", "scene", "uses", "unless", "requires", "coordinate", "parameter", "structural",
    "Integer", "speed", "frame", "point", "body", "constraint", "potential", "force", "torque", "at", "on",
    "from", "initial", "for", "loop", "if", "then", "else", "import", "extends", "partial", "package",
    "function", "type", "joint", "when", "Orientation", "Particle", "Solid", "Gravity", "der",
    "velocity", "position", "acceleration", "reaction", "energy", "norm", "cross", "dot", "rotate",
    "rotate_z", "sqrt", "log", "asin", "time", "world", "pi", "lambda", "int", "None", "__import__", "exec",
    "nan", "inf", "self", "eval", "system",
]  # fmt: skip
NUMBERS = [
    "0", "1", "-1", "2", "1e999", "1e308", "1e-308", "1e-320", "99999999999999999999", "0.1", "3.5",
    "1000000", "0x1f", "1.2.3", "1e", ".5", "5.", "9007199254740993", "-0.0", "64", "65",
]  # fmt: skip
SIGNS = [*"+-*/^=<>(){}[],;:.\"'\\@#$%&|!?~`\t\n\0é\u202e𝜃", "==", ">=", "<>", "/*", "*/", "//", "**"]
UNITS = ["[m]", "[kg]", "[s]", "[rad/s]", "[m/s2]", "[]", "[foo]", "[m/]", "[kg.m2]", "[1]", "[deg]"]


def library() -> list[str]:
    """The texts of all models that come with lagc."""
    return [path.read_text(encoding="utf-8") for path in sorted(MODELS.rglob("*.lag"))]


def mutated(texts: list[str], seed: int) -> str:
    """One text of the library with one to five mutations."""
    chance = random.Random(seed)
    tokens = TOKEN.findall(chance.choice(texts))
    for _ in range(chance.choice([1, 1, 1, 2, 3, 5])):
        chance.choice(MUTATIONS)(tokens, chance, texts)
    return "".join(tokens)


def _place(tokens: list[str], chance: random.Random) -> int:
    return chance.randrange(len(tokens)) if tokens else 0


def _delete(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    at = _place(tokens, chance)
    del tokens[at : at + chance.choice([1, 1, 2, 5, 20])]


def _double(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    at = _place(tokens, chance)
    tokens[at:at] = tokens[at : at + chance.choice([1, 2, 5, 30])]


def _swap(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    if tokens:
        a, b = _place(tokens, chance), _place(tokens, chance)
        tokens[a], tokens[b] = tokens[b], tokens[a]


def _word(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    places = [k for k, token in enumerate(tokens) if token[:1].isalpha()]
    if places:
        own = [tokens[k] for k in places]
        tokens[chance.choice(places)] = chance.choice(WORDS if chance.random() < 0.5 else own)


def _number(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    places = [k for k, token in enumerate(tokens) if token[:1].isdigit()]
    if places:
        tokens[chance.choice(places)] = chance.choice(NUMBERS)


def _operator(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    places = [k for k, token in enumerate(tokens) if token in "+-*/^" and token]
    if places:
        tokens[chance.choice(places)] = chance.choice("+-*/^")


def _alike(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    """A name of the model for another one: often well formed, seldom meant."""
    places = [k for k, token in enumerate(tokens) if token.isidentifier() and token not in WORDS]
    if places:
        tokens[chance.choice(places)] = tokens[chance.choice(places)]


def _insert(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    table = chance.choice([WORDS, NUMBERS, SIGNS, UNITS])
    tokens.insert(_place(tokens, chance), chance.choice(table))


def _splice(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    other = TOKEN.findall(chance.choice(texts))
    start = _place(other, chance)
    at = _place(tokens, chance)
    tokens[at:at] = other[start : start + chance.choice([3, 10, 40])]


def _nest(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    deep = chance.choice([10, 150, 1000])
    opening, closing = chance.choice(
        [("(", ")"), ("{", "}"), ("-", ""), ("sin(", ")"), ("if x then ", " else 1")]
    )
    at = _place(tokens, chance)
    tokens[at : at + 1] = [opening * deep, *tokens[at : at + 1], closing * deep]


def _cut(tokens: list[str], chance: random.Random, texts: list[str]) -> None:
    del tokens[_place(tokens, chance) :]


MUTATIONS: list[Callable[[list[str], random.Random, list[str]], None]] = [
    *(_delete, _delete, _double, _swap, _splice, _nest, _cut),
    *(_word, _word, _number, _number, _number, _number, _insert, _insert),
    *(_operator, _operator, _operator, _operator, _alike, _alike, _alike, _alike, _alike),
]
