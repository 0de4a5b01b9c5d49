"""The comparison of formulas with their expressions sees a wrong sign in each of them, and the sum of all
terms sees one that is missing."""

import pytest

from lagc.base.records import replace
from lagc.reports.patterns.formula_trees import Term, Total
from lagc.symbolic.walk import evaluate
from tests.derivation.test_every_model import assert_terms_add_up
from tests.derivation.values import gap, solution, states, value
from tests.reports.models import derived

MODELS = [
    "classic/double_pendulum",
    "classic/heavy_top",
    "classic/rolling_disc",
    "course/rough_wedge_explicit",
]
SMALL = 1e-3  # a term that hardly counts at the state


def with_wrong_sign(form: Total) -> Total:
    """The form with the other sign of its last term."""
    *others, last = form.terms
    assert isinstance(last, Term)
    return Total((*others, replace(last, negative=not last.negative)))


@pytest.mark.parametrize("name", MODELS)
def test_a_wrong_sign_is_seen(name: str) -> None:
    equations, found = derived(name), solution(name)
    (at, *_) = states(equations, found)
    tried = 0
    for written in found.written:
        axes = evaluate([node for _, node in written.forms], at)
        for k, ((form, axis), weight) in enumerate(zip(written.forms, axes)):
            if not form.terms or abs(weight * value(form.terms[-1], at)) < SMALL:
                continue
            forms = (*written.forms[:k], (with_wrong_sign(form), axis), *written.forms[k + 1 :])
            assert gap(replace(written, forms=forms), at) > 1e-6, written.about
            tried += 1
    assert tried > 50


@pytest.mark.parametrize("name", MODELS)
def test_a_missing_term_is_seen(name: str) -> None:
    equations, found = derived(name), solution(name)
    (at, *_) = states(equations, found)
    for k, term in enumerate(found.terms):
        if any(abs(x) > SMALL for x in evaluate(list(term.forces.values()), at)):
            others = (*found.terms[:k], *found.terms[k + 1 :])
            with pytest.raises(AssertionError):
                assert_terms_add_up(equations, replace(found, terms=others), at)
