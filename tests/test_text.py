"""Numbers that people write are read strictly: as in a model file, with a sign."""

import math
import random
import unicodedata

import pytest

import lagc
from lagc.base.text import number, seconds, whole
from lagc.cli.options import assignments, quantity
from lagc.cli.output import Usage
from lagc.semantics.units import UnknownUnit, unit
from lagc.syntax.lexer import _PATTERN as TOKEN

DIGITS = [chr(c) for c in range(128, 0x20000) if unicodedata.category(chr(c)) in ("Nd", "No")]


def test_a_number_is_what_a_model_file_takes_for_one() -> None:
    chance = random.Random(1)
    taken = 0
    for _ in range(20_000):
        text = "".join(chance.choice("0123456789..eE+-_ x,") for _ in range(chance.randrange(1, 8)))
        bare = text[1:] if text[0] in "+-" else text
        match = TOKEN.match(bare)
        is_one = match is not None and match.lastgroup == "number" and match.end() == len(bare)
        found = number(text)
        assert (found is not None) == is_one, text
        if found is not None:
            assert found == float(text)
            taken += 1
        assert whole(text) == (int(text) if bare.isdigit() else None)
    assert taken > 2000


@pytest.mark.parametrize("word", ["nan", "-inf", "Infinity", "+NaN"])
def test_words_for_what_is_not_finite_are_taken_for_that(word: str) -> None:
    found = number(word)
    assert found is not None and not math.isfinite(found) and whole(word) is None


def test_digits_of_other_scripts_are_none() -> None:
    for text in [*DIGITS, "1_0", "1 ", " 1", "0x1", "1e", "", "1\n"]:
        assert number(text) is None and whole(text) is None
    assert whole("9" * 5000) is None  # which Python refuses to read, for the time it takes
    for digit in DIGITS:
        with pytest.raises(Usage):
            assignments([f"l={digit}[m]"], "-p")
        with pytest.raises(Usage):
            quantity(digit, "s", "--stop")
        with pytest.raises(UnknownUnit):
            unit(f"m{digit}")


def test_a_time_is_a_number_with_one_unit_of_time_bare_or_in_brackets() -> None:
    units = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
    for name, factor in units.items():
        for form in (f"2.5{name}", f" 2.5 {name} ", f"2.5[{name}]", f"2.5 [{name}]"):
            assert seconds(form) == 2.5 * factor
        for form in (f"2.5[{name}", f"2.5{name}]", f"2.5[[{name}]]", f"2.5]{name}[", f"2.5[{name}]]", name):
            assert seconds(form) is None, form
    assert seconds("2.5") == 2.5
    assert all(seconds(form) is None for form in ("2.5[", "2.5]", "2.5[]", "2.5[m]", "-1", "1e3", "1_0"))


def test_python_takes_text_no_less_strictly() -> None:
    model = lagc.load("simple_pendulum").compile(backend="numpy")
    assert model.bind({"l": "0.5"}).start() is not None
    for wrong in ("1_0", "\N{ARABIC-INDIC DIGIT ONE}", b"1", "", [], None, 10**400, ("1_0", "m"), ("1",)):
        with pytest.raises(lagc.Refused, match="LAG0602"):
            model.bind({"l": wrong})
