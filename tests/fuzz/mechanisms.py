"""Random mechanisms, by a seed: contacts, friction, joints, servos, events, and what acts on them, in models
that a user could have written.

The models are made of texts with slots (mechanisms.txt).  `<a|b>` is one of its alternatives, `<word>` one of
those of a rule, or a name of the model so far (of `NAMES`), `<word1>` the same one wherever it stands in a
text, and `#` the number of the text.
"""

import random
import re
from pathlib import Path

from tests.fuzz.models import VALUES, Case
from tests.fuzz.words import NASTY

TEXTS = Path(__file__).with_suffix(".txt")

# The names that a text declares: (kind, pattern with them as its group, as what each is written).
NAMES = [
    ("slide", r"coordinate Length ([^;]*)", "{}"),
    ("slide", r"joint (\w+) = Prismatic", "{}.slide"),
    ("hinge", r"coordinate Angle ([^;]*)", "{}"),
    ("hinge", r"joint (\w+) = (?:Revolute|Screw)\([^;]*angle\(", "{}.angle"),
    ("body", r"body (\w+) = ", "{}"),
    ("solid", r"body (\w+) = Solid", "{}"),
    ("particle", r"body (\w+) = Particle", "{}"),
    ("joint", r"joint (\w+) = (?!Distance|Gear|Rack|Rolling)", "{}"),
    ("contact", r"constraint (\w+): [^;]*?[<>]=", "{}"),
    ("straight", r"constraint (?!stop|post|limit)(\w+): [^;]*?[<>]=", "{}"),
    ("row", r"constraint ((?:rail|track|tie)\w*): ", "{}"),
]
# What stands between blanks compares.
_SLOT = re.compile(r"<([^\s<>=](?:[^<>]|(?<=\s)[<>]=?(?=\s))*)(?<!\s)>")
_ATTRIBUTES = re.compile(r"\([^()]*(?:\([^()]*\)[^()]*)*\)|\[[^\]]*\]")


def _rules() -> dict[str, list[str]]:
    """The alternatives of each rule and of each section."""
    found: dict[str, list[str]] = {}
    for section in TEXTS.read_text(encoding="utf-8").split("\n-- ")[1:]:
        title, _, text = section.partition("\n")
        if title == "rules":
            lines = [line.partition(":") for line in text.split("\n") if line]
            found |= {kind: [one.strip() for one in rest.split(" | ")] for kind, _, rest in lines}
        else:
            found[title] = [one for one in text.strip("\n").split("\n\n") if one]
    found["carried"] = [one.replace("(world, ", "(c#, ") for one in found["placed"]]
    return found


RULES = _rules()


class Missing(Exception):
    """No name of the model fits a slot."""


class _Mechanism:
    def __init__(self, chance: random.Random):
        self.chance = chance
        self.known: dict[str, list[str]] = {}

    def fill(self, text: str, number: int) -> str:
        """The text without slots."""
        same: dict[str, str] = {}

        def chosen(slot: re.Match[str]) -> str:
            word = slot[1]
            if "|" in word:
                return self.chance.choice(word.split("|"))
            kind = word.rstrip("0123456789")
            others = [v for k, v in same.items() if k.startswith(kind)]
            if word not in same:
                choices = RULES.get(kind) or [n for n in self.known.get(kind, []) if n not in others]
                if not choices:
                    raise Missing(word)
                same[word] = self.chance.choice(choices)
            found = same[word]
            if word == kind:
                del same[word]
            return found

        while (filled := _SLOT.sub(chosen, text, count=1)) != text:
            text = filled
        return text.replace("#", str(number))

    def note(self, text: str, prefix: str = "") -> None:
        """Enter the names that a text declares."""
        for kind, pattern, written in NAMES:
            for found in re.findall(pattern, text):
                names = _ATTRIBUTES.sub("", found).split(",")
                if not re.search(rf"\b{names[0].strip()}\[", text):
                    self.known.setdefault(kind, []).extend(prefix + written.format(n.strip()) for n in names)

    def case(self) -> Case:
        chance, head, items = self.chance, list[str](), list[str]()
        items.append(self.fill("parameter Length z0 = <origin>;\nparameter Real mu0 = 0.3, e0 = 0.4;", 0))
        for number in range(1, chance.choice([2, 2, 2, 3, 4])):
            text = self.fill("<parts>", number)
            if chance.random() < 0.15:
                inner = f"parameter Length z0 = 0;\nparameter Real mu0 = 0.3, e0 = 0.4;\n{text}"
                head.append(f"model Part{number}\n{_indented(inner)}end Part{number};\n")
                self.note(text, f"part{number}.")
                text = f"Part{number} part{number}(z0 = z0);"
            else:
                self.note(text)
            items.append(text)
        gravity = self.fill("Gravity field<weight>;", 0)
        effects = []
        for number in range(10, 10 + chance.choice([1, 2, 3, 5, 8])):
            try:
                text = self.fill("<actions>", number)
            except Missing:
                continue
            if chance.random() < 0.15:
                effects.append(f"effect_{number}")
                text = f"effect {effects[-1]}\n{_indented(text)}end {effects[-1]};"
            else:
                self.note(text)
            items.append(text)
        if chance.random() < 0.2:
            effects.append("weight")
            gravity = f"effect weight\n  {gravity}\nend weight;"
        items += [gravity, *self._scenes(effects)]
        return self._named(f"{''.join(head)}model M\n{_indented(*items)}end M;\n")

    def _scenes(self, effects: list[str]) -> list[str]:
        chance, found = self.chance, list[str]()
        for number in range(chance.choice([0, 1, 1, 2]) if not effects else 2):
            used = [e for e in effects if chance.random() < 0.7]
            inside = [f"simulate({chance.choice(RULES['simulation'])});"]
            if chance.random() < 0.2:
                inside.append("parameter mu0 = 0.6;")
            if self.known.get("slide") and chance.random() < 0.2:
                own = chance.choice(self.known["slide"])
                inside.append(f"start der({own}) = {chance.choice(RULES['speed'])};")
            uses = f" uses {', '.join(used)}" if used else ""
            found.append(f"scene run{number}{uses}\n{_indented(*inside)}end run{number};")
        return found

    def _named(self, text: str) -> Case:
        """With words for `sim`; now and then under names that programs stumble over."""
        chance, run = self.chance, list[str]()
        for own in self.known.get("slide", []):
            if chance.random() < 0.05:
                run += ["--start", f"der({own})={chance.choice(VALUES)}"]
        own = sorted(set(re.findall(r"\b[A-Za-z_]+\d+\b", text)) - {"m2", "s2"})
        if not run and chance.random() < 0.1:
            given = dict(zip(own, chance.sample([n for n in NASTY if n != "field"], len(own))))
            text = re.sub(r"\b[A-Za-z_]+\d+\b", lambda name: given.get(name[0], name[0]), text)
        return Case(text, run=tuple(run))


def _indented(*texts: str) -> str:
    return "".join(f"  {line}\n" for text in texts for line in text.split("\n") if line.strip())


def mechanism(seed: int) -> Case:
    """The model of this seed."""
    return _Mechanism(random.Random(seed)).case()
