"""Structured cases of every kind of file: each is an accepted robot or one paragraph, in 10 s and 1 GB.

A case is named by its kind and a number, and is the same each time: ``python tests/grammars/tried_cases.py KIND NUMBER
1`` tries one. See `tried_cases`.
"""

from collections import Counter

import pytest
from tried_cases import KINDS, generated, tried

EACH = 5264  # of 19 kinds, more than 100,000 together


def failures(kinds, first, count):
    outcomes = [*tried(kinds, first, count)]
    assert len(outcomes) == len(kinds) * count
    return Counter(outcome for *_, outcome in outcomes), [item for item in outcomes if item[2].startswith("failed")]


@pytest.mark.parametrize("kind", KINDS)
def test_a_case_is_the_same_each_time(kind):
    assert [generated(kind, number) for number in range(3)] == [generated(kind, number) for number in range(3)]


@pytest.mark.parametrize(("first", "count"), [(2, 20), (0, 2)])
def test_some_of_each_kind(first, count):
    counts, failed = failures([*KINDS], first, count)
    assert failed == []
    assert min(counts["accepted"], counts["refused"]) > 5  # so that neither is all


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_hundred_thousand(kind):
    assert failures([kind], 0, EACH)[1] == []
