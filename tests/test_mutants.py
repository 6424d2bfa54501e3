"""The mutants can be made, and tests notice them."""

import ast

import mutants
import pytest
import sampled_mutants
from mutants import (
    MUTANTS,
    PACKAGE,
    ROOT,
    MutantError,
    copied_package,
    find,
    mutated,
    try_mutant,
)

SAMPLE = (
    "chain: a failure stops one level above",
    "subscriptions: what has ended is due",
    "trajectory: the chain rule of curvatures",
)


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_a_mutant_is_one_other_line_that_compiles(mutant):
    file = find(mutant, ROOT / PACKAGE)
    before, after = file.read_text(), mutated(mutant, file)
    changed = [pair for pair in zip(before.splitlines(), after.splitlines(), strict=True) if pair[0] != pair[1]]
    assert len(changed) == 1
    assert compile(after, str(file), "exec") != compile(before, str(file), "exec")
    assert all((ROOT / test).is_file() for test in mutant.tests)


def test_there_are_enough_mutants_and_those_of_chains_among_them():
    names = [mutant.name for mutant in MUTANTS]
    assert len(set(names)) == len(names) >= 65
    assert sum(name.startswith("chain: ") for name in names) >= 40


def test_a_line_that_is_not_there_or_is_there_twice_is_said():
    mutant = mutants.Mutant("none", "twin/schedule.py", "no such line", "", ())
    with pytest.raises(MutantError, match=r"'no such line' is to be once in twin/schedule\.py, and is in nowhere"):
        find(mutant, ROOT / PACKAGE)
    mutant = mutants.Mutant("two", "twin/schedule.py", "self.published", "", ())
    with pytest.raises(MutantError, match=r"is in schedule\.py, schedule\.py"):
        find(mutant, ROOT / PACKAGE)


def test_tests_notice_a_sample_of_the_mutants():
    with copied_package() as package:
        for mutant in (mutant for mutant in MUTANTS if mutant.name in SAMPLE):
            original = find(mutant, package).read_text()
            assert try_mutant(mutant, package).is_caught, mutant.name
            assert find(mutant, package).read_text() == original


def test_faults_that_are_drawn_at_random_are_the_same_each_time_and_compile():
    drawn = sampled_mutants.sample("control", 30, seed=1)
    assert drawn == sampled_mutants.sample("control", 30, seed=1) != sampled_mutants.sample("control", 30, seed=2)
    assert len({(fault.file, fault.line) for fault in drawn}) == 30
    for fault in drawn:
        original = (ROOT / PACKAGE / fault.file).read_text(encoding="utf-8")
        assert compile(fault.text(original), fault.file, "exec") != compile(original, fault.file, "exec"), str(fault)
        tests = sampled_mutants.related_tests(fault.file)
        assert tests
        assert all((ROOT / test).is_file() for test in tests)


def test_tests_that_import_a_module_by_its_name_belong_to_it():
    """Before those that are named after something else of that name; nodes import theirs from ``rclpy``."""
    for tool in ("param", "control"):
        first = sampled_mutants.related_tests(f"tools/{tool}.py")[:2]
        assert set(first) == {"tests/tools/test_graph_tools.py", "tests/tools/test_tools.py"}
    for module, test in (("qos", "qos"), ("clock", "node_clocks")):
        assert f"tests/nodes/test_{test}.py" in sampled_mutants.related_tests(f"nodes/rclpy/{module}.py")[:3]


def test_tests_that_fail_without_a_fault_say_nothing_about_it(monkeypatch):
    results, fault = [], sampled_mutants.Fault("control/tolerances.py", 1, 0, 0, "", "")
    monkeypatch.setattr(sampled_mutants, "sample", lambda *options: [fault, fault])
    monkeypatch.setattr(sampled_mutants, "related_tests", lambda file: ["tests/control/test_tolerances.py"])
    monkeypatch.setattr(sampled_mutants, "run_tests", lambda *what: results.pop(0))
    results += [mutants.SURVIVED, mutants.CAUGHT, mutants.CAUGHT]  # without a fault, and with each
    assert [result for _, result in sampled_mutants.try_room("control", 2, 1, "")] == [mutants.CAUGHT] * 2
    results.append(mutants.CAUGHT)
    with pytest.raises(MutantError, match=r"without a fault, these tests do not pass: .*test_tolerances\.py"):
        next(sampled_mutants.try_room("control", 2, 1, ""))


def test_a_fault_is_one_small_change():
    text = "def f(a, b):\n    if a < b and not a:\n        return a + 1\n    return 'a' + b\n"
    places = sampled_mutants._Places("it.py", text)
    places.visit(ast.parse(text))
    changed = {(fault.was, fault.replacement) for fault in places.faults}
    assert changed == {
        *(("<", "<="), ("and", "or"), ("not ", ""), ("a < b and not a", "not (a < b and not a)")),
        *(("+", "-"), ("1", "2"), ("a + 1", "None"), ("'a' + b", "None")),
    }


@pytest.mark.slow
def test_tests_notice_nearly_all_mutants(capsys):
    """Takes about half an hour."""
    with capsys.disabled():
        assert mutants.main([]) == 0
