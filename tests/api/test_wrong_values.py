"""What makes no sense in Python is refused at once, by the exceptions that Python has for it."""

from typing import Any

import pytest

import lagc
from lagc.diagnostics.faults import Refused

pytestmark = pytest.mark.usefixtures("own_cache")


@pytest.fixture(scope="module")
def pendulum() -> Any:
    return lagc.load("simple_pendulum").compile(scene="vacuum", backend="numpy")


@pytest.mark.parametrize(
    "given",
    [
        {"scene": (1, 2)}, {"model": 1}, {"until": 0}, {"until": []}, {"use": [1]}, {"without": (None,)},
        {"parameters": 1.0}, {"parameters": 0}, {"parameters": ""}, {"parameters": []},
        {"parameters": {1: 2}}, {"inputs": "x"}, {"inputs": 0}, {"inputs": {1: 2}},
    ],
)  # fmt: skip
def test_names_are_texts_and_values_have_names(given: Any) -> None:
    with pytest.raises(TypeError, match=next(iter(given))):
        lagc.load("simple_pendulum").compile(**given)


@pytest.mark.parametrize(
    "given", [{"parameters": 0}, {"parameters": [1]}, {"starts": ""}, {"inputs": ()}, {"sensitivity": [1]}]
)
def test_those_of_a_run_too(given: Any, pendulum: Any) -> None:
    with pytest.raises(TypeError, match=next(iter(given))):
        pendulum.simulate(stop=1, **given)


def test_a_column_has_a_name(pendulum: Any) -> None:
    run = pendulum.simulate(stop=0.1, points=3)
    for wrong in ((1,), 1, None):
        with pytest.raises(TypeError, match="name"):
            run[wrong]
    with pytest.raises(TypeError, match="name"):
        run.plot((1,))


@pytest.mark.parametrize("word", ["\u0663", "1_0", "one"])
def test_text_is_read_as_strictly_as_on_the_command_line(word: Any, pendulum: Any) -> None:
    x = pendulum.start()
    for call in (
        lambda: pendulum.rhs(word, x),
        lambda: pendulum.rhs(0.0, [word, 0.0]),
        lambda: pendulum.jacobian("rates", "state", t=word),
        lambda: pendulum.jacobian("rates", "state", x=[word, 0.0]),
        lambda: pendulum.linearize(word),
    ):
        with pytest.raises(ValueError, match="must be a number"):
            call()


@pytest.mark.parametrize("tries", [10**400, -1])
def test_no_search_without_end(tries: int, pendulum: Any) -> None:
    with pytest.raises(ValueError, match="tries"):
        pendulum.equilibria(tries=tries)


def test_no_condition_and_too_many_points(pendulum: Any) -> None:
    with pytest.raises(Refused, match="LAG0604: `until` needs a condition"):
        pendulum.simulate(until="")
    with pytest.raises(Refused, match="LAG0804"):
        pendulum.simulate(points=10**12)


def test_integers_may_be_larger_than_numbers_are(pendulum: Any) -> None:
    large, x = 10**400, pendulum.start()
    for call in (
        lambda: pendulum.rhs(large, x),
        lambda: pendulum.rhs(0.0, [large, 0.0]),
        lambda: pendulum.jacobian("rates", "state", t=large),
        lambda: pendulum.linearize(large),
    ):
        with pytest.raises(ValueError, match="too large"):
            call()
    with lagc.Limits(time=large, memory=large):
        assert pendulum.simulate(stop=0.1, points=2).status == "ok"
