"""Who shares a plant, against a flood fill."""

from itertools import pairwise

import numpy as np
import pytest

from drake_twin.islands.partition import after_blows, components, packed, touched

SEEDS = range(20)


def boxes(seed, count=60, movers=25):
    """Boxes, some of which meet, with their owners; the last owners have none."""
    rng = np.random.default_rng(seed)
    lower = rng.uniform(0, 10, (count, 3))
    return lower, lower + rng.uniform(0.1, 2.5, (count, 3)), rng.integers(0, movers - 3, count)


def meet(lower, upper, one, other):
    return all(lower[one][k] <= upper[other][k] and upper[one][k] >= lower[other][k] for k in range(3))


def flood(pairs, numbers):
    """The parts of a graph."""
    left, found = set(numbers), []
    while left:
        part = edge = {min(left)}
        while edge:
            edge = {b for a, b in [*pairs, *((b, a) for a, b in pairs)] if a in edge and b in left} - part
            part = part | edge
        left -= part
        found.append(sorted(part))
    return found


def judge(lower, upper, owners, rows, numbers, tied):
    pairs = {(owners[a], owners[b]) for a in rows for b in rows if meet(lower, upper, a, b)} | set(tied)
    return flood({(a, b) for a, b in pairs if a in numbers and b in numbers}, numbers)


@pytest.mark.parametrize("seed", SEEDS)
def test_movers_whose_boxes_hang_together_are_together(seed):
    lower, upper, owners = boxes(seed)
    rows, tied = np.arange(len(owners)), [(3, 24), (24, 23)]
    found = components(lower, upper, owners, rows, range(25), tied)
    assert found == judge(lower, upper, owners, rows, range(25), tied)
    assert 3 < len(found) < 25


@pytest.mark.parametrize("seed", SEEDS)
def test_only_the_boxes_and_movers_that_are_looked_at_count(seed):
    lower, upper, owners = boxes(seed)
    numbers = sorted(np.random.default_rng(seed).choice(25, 12, replace=False).tolist())
    rows = np.flatnonzero(np.isin(owners, numbers))
    tied = [(numbers[0], numbers[1]), (next(n for n in range(25) if n not in numbers), numbers[2])]
    found = components(lower, upper, owners, rows, numbers, tied)
    assert found == judge(lower, upper, owners, rows, numbers, tied)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_order_of_boxes_pairs_and_numbers_is_none_of_the_groups(seed):
    lower, upper, owners = boxes(seed)
    rng, tied = np.random.default_rng(seed), [(3, 24), (24, 23), (0, 22)]
    first = components(lower, upper, owners, np.arange(len(owners)), range(25), tied)
    other = rng.permutation(len(owners))
    rows, numbers = rng.permutation(len(owners)), rng.permutation(25).tolist()
    turned = [tied[k] if k else tied[k][::-1] for k in rng.permutation(3)]
    assert components(lower[other], upper[other], owners[other], rows, numbers, turned) == first
    assert all(part == sorted(part) for part in first)
    assert first == sorted(first)


def test_boxes_that_share_a_corner_meet_and_those_an_ulp_apart_do_not():
    lower = np.array([[0.0, 0, 0], [1, 1, 1]])
    upper = lower + 1
    arguments = np.arange(2), np.arange(2), range(2)
    assert components(lower, upper, *arguments) == [[0, 1]]
    for axis in range(3):
        apart = lower.copy()
        apart[1, axis] = np.nextafter(1.0, 2.0)
        assert components(apart, upper, *arguments) == [[0], [1]]


def test_endless_boxes_meet_all_and_nobody_is_nothing():
    lower = np.array([[0.0, 0, 0], [50, 0, 0], [-np.inf] * 3])
    upper = np.array([[1.0, 1, 1], [51, 1, 1], [np.inf] * 3])
    assert components(lower, upper, np.arange(3), np.arange(3), range(3)) == [[0, 1, 2]]
    none = np.empty((0, 3))
    assert components(none, none, np.empty(0, int), np.empty(0, int), ()) == []
    assert components(none, none, np.empty(0, int), np.empty(0, int), range(2)) == [[0], [1]]


def test_those_that_may_be_hit_leave_with_twice_the_speed_of_the_fastest_at_most():
    owners, speeds = np.array([0, 0, 1, 2, 3]), np.array([4.0, 1.0, 3.0, 0.5, 7.0])
    assert after_blows([[0, 2], [1], [3]], owners, speeds).tolist() == [4.0, 7.0, 0.0, 7.5, 0.0]


@pytest.mark.parametrize("seed", SEEDS)
def test_touched_are_those_that_meet_one_of_some(seed):
    lower, upper, _ = boxes(seed)
    rows = np.random.default_rng(seed).choice(60, 5, replace=False)
    expected = [any(meet(lower, upper, row, index) for row in rows) for index in range(60)]
    assert touched(lower, upper, rows).tolist() == expected
    assert touched(lower, upper, rows)[rows].all()
    assert not touched(lower, upper, np.empty(0, dtype=int)).any()


@pytest.mark.parametrize("seed", SEEDS)
def test_packed_groups_are_whole_components_in_order_and_as_full_as_may_be(seed):
    rng = np.random.default_rng(seed)
    cuts = np.sort(rng.choice(np.arange(1, 40), 18, replace=False))
    parts = [part.tolist() for part in np.split(rng.permutation(40), cuts)]
    for most in (1, 3, 8, 100):
        found = packed(parts, most)
        assert sorted(number for group in found for number in group) == list(range(40))
        assert all(group == tuple(sorted(group)) for group in found)
        for part in parts:
            assert sum(set(part) <= set(group) for group in found) == 1
        for group, following in pairwise(found):
            own = [part for part in parts if set(part) <= set(group)]
            assert len(group) <= most or len(own) == 1
            first = next(part for part in parts if set(part) <= set(following))
            assert parts.index(own[-1]) + 1 == parts.index(first)
            assert len(group) + len(first) > most
    assert packed([], 8) == []


def test_packing_does_not_change_what_it_is_given():
    parts = [[0, 3], [1], [2]]
    packed(parts, 8)
    assert parts == [[0, 3], [1], [2]]
