"""Random sequences of the controller manager's calls keep what must always hold; single calls that they seldom make."""

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from typing import ClassVar

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule, run_state_machine_as_test
from made_up_controllers import Manager, controller, robot_plan

from drake_twin.twin.controller_manager import BEST_EFFORT, STRICT, ControllerManager

CHAIN = ("low", "middle", "high")  # from the joint up: each writes to the one before it

# Two that exclude each other, one beside them, a chain of three, one that cannot be configured, one without claims.
CONTROLLERS = (
    controller("broadcaster", state="active"),
    controller("one", "a/position", "a/velocity", state="active"),
    controller("other", "a/velocity", "b/position"),
    controller("beside", "b/velocity", state="inactive"),
    controller("low", "c/position", references=("c/position",)),
    controller("middle", "low/c/position", references=("c/position",)),
    controller("high", "middle/c/position", "c/velocity"),
    controller("broken", "a/position", problem="its joint is missing"),
)
NAMES = st.sampled_from([*(item.name for item in CONTROLLERS), "nobody"])
LISTS = st.lists(NAMES, max_size=4)
PARTS = st.lists(st.sampled_from(CHAIN), unique=True)
STRICTNESSES = st.sampled_from([0, 1, 2, 3, 4, 9])


class Calls(RuleBasedStateMachine):
    """Calls in any order, the chain's controllers brought up and taken down among them.

    Attributes:
        reached: How often each controller of the chain has been active after a call.
    """

    plan = robot_plan(*CONTROLLERS)
    reached: ClassVar[Counter] = Counter()

    def __init__(self):
        super().__init__()
        self.manager = ControllerManager(self.plan, self.switched)
        self.running = set(self.manager.active)

    def switched(self, started, stopped):
        assert set(stopped) <= self.running
        self.running -= set(stopped)
        assert not self.running & set(started)
        self.running |= set(started)

    @rule(name=NAMES)
    def load(self, name):
        before = self.manager.states
        response = self.manager.load_controller(name)
        assert response.ok == (name != "nobody" and name not in before)
        assert response.ok or response.message

    @rule(name=NAMES)
    def configure(self, name):
        before = self.manager.states.get(name)
        response = self.manager.configure_controller(name)
        assert response.ok == (before in ("unconfigured", "inactive") and name != "broken")

    @rule(name=NAMES)
    def unload(self, name):
        was_active = name in self.manager.active
        response = self.manager.unload_controller(name)
        assert not (response.ok and was_active)

    @rule(activate=LISTS, deactivate=LISTS, strictness=STRICTNESSES)
    def switch(self, activate, deactivate, strictness):
        before = self.manager.states
        response = self.manager.switch_controller(activate, deactivate, strictness)
        if not response.ok:
            assert response.message
            assert self.manager.states == before or "resource conflict" in response.message  # of two in one request
        elif strictness == STRICT:
            assert set(activate) <= set(self.manager.active)
            assert not set(deactivate) - set(activate) & set(self.manager.active)

    @rule(names=st.integers(1, 3).flatmap(lambda count: st.permutations(CHAIN[:count])))
    def bring_up(self, names):
        """Load, configure and activate the lower controllers of the chain, named in any order."""
        for name in names:
            self.manager.load_controller(name)
            self.manager.configure_controller(name)
        assert self.manager.switch_controller(names, strictness=BEST_EFFORT)
        assert set(names) <= set(self.manager.active)

    @rule(activate=PARTS, deactivate=PARTS, strictness=STRICTNESSES)
    def switch_chain(self, activate, deactivate, strictness):
        self.switch(activate, deactivate, strictness)

    @rule(name=NAMES)
    def fail(self, name):
        before = self.manager.states
        stopped = set(self.manager.deactivate_failed(name))
        above = CHAIN[CHAIN.index(name) :] if name in CHAIN else (name,)
        assert stopped == {each for each in above if before.get(each) == "active"}
        assert self.manager.states == {each: "inactive" if each in stopped else before[each] for each in before}

    @rule()
    def restart(self):
        self.manager.restart()
        self.running = set(self.manager.active)
        assert self.manager.states == {"broadcaster": "active", "one": "active", "beside": "inactive"}

    @invariant()
    def an_interface_is_claimed_once(self):
        claims = [claim for item in self.manager.list_controllers() for claim in item.claimed_interfaces]
        assert len(claims) == len(set(claims))

    @invariant()
    def what_is_active_is_what_was_told(self):
        assert set(self.manager.active) == self.running

    @invariant()
    def nothing_writes_to_a_controller_that_is_not_active(self):
        active = [name for name in CHAIN if name in self.manager.active]
        assert active == [*CHAIN[: len(active)]]
        self.reached.update(active)

    @invariant()
    def a_controller_is_chained_while_one_above_it_is_active(self):
        chained = {item.name for item in self.manager.list_controllers() if item.is_chained}
        assert chained == {below for below, above in pairwise(CHAIN) if above in self.running}

    @invariant()
    def the_broken_one_never_runs(self):
        assert self.manager.states.get("broken") in (None, "unconfigured")


def test_of_two_that_claim_one_interface_one_switch_starts_the_first():
    manager = Manager(
        controller("first", "a/effort", state="inactive"),
        controller("second", "a/effort", "b/effort", state="inactive"),
        controller("third", "b/effort", state="inactive"),
    )
    assert not manager.switch_controller(["first", "second"], strictness=STRICT)
    assert manager.active == ()
    response = manager.switch_controller(["first", "second", "third"], strictness=BEST_EFFORT)
    assert manager.active == ("first", "third")  # what was refused claims nothing
    assert "command interface a/effort is already claimed by 'first'" in response.message
    assert manager.switches == [(("first", "third"), ())]


KNOWN, UNKNOWN = ["known"], ["unknown"]


@pytest.mark.parametrize(
    ("activate", "deactivate", "strictness", "ok"),
    [  # test_controller_manager_srvs.cpp:2210-2271, in their order
        (UNKNOWN, [], BEST_EFFORT, False),
        ([], UNKNOWN, BEST_EFFORT, False),
        (UNKNOWN, [], STRICT, False),
        ([], UNKNOWN, STRICT, False),
        (KNOWN + UNKNOWN, [], STRICT, False),
        ([], KNOWN + UNKNOWN, STRICT, False),
        (KNOWN + UNKNOWN, [], BEST_EFFORT, True),
        ([], KNOWN + UNKNOWN, BEST_EFFORT, True),
        (KNOWN, [], STRICT, True),
        (UNKNOWN, KNOWN, STRICT, False),
        (UNKNOWN, KNOWN, BEST_EFFORT, False),
        (KNOWN, [], BEST_EFFORT, True),  # already active: nothing is left to do (controller_manager.cpp:2174)
    ],
)
def test_what_a_switch_answers_about_unknown_controllers(activate, deactivate, strictness, ok):
    inactive = (activate == KNOWN and strictness == STRICT) or activate == KNOWN + UNKNOWN
    manager = Manager(controller("known", "a/effort", state="inactive" if inactive else "active"))
    before = manager.states
    assert manager.switch_controller(activate, deactivate, strictness).ok is ok
    assert ok or manager.states == before


@pytest.mark.parametrize("default", [BEST_EFFORT, STRICT])
def test_a_switch_without_a_strictness_has_that_of_the_parameters(default):
    plan = replace(robot_plan(controller("one", "a/effort", state="inactive")), strictness=default)
    manager = ControllerManager(plan, lambda *switch: None)
    assert manager.switch_controller(["one", "nobody"]).ok is (default == BEST_EFFORT)
    assert manager.active == (("one",) if default == BEST_EFFORT else ())


def failing(*fallbacks, **states):
    """Two controllers that claim one joint, the second of which replaces the first; and one on another joint."""
    given = {"main": "active", "spare": "inactive", "beside": "active", **states}
    return Manager(
        replace(controller("main", "a/effort", state=given["main"]), fallbacks=fallbacks),
        controller("spare", "a/effort", state=given["spare"]),
        controller("beside", "b/effort", references=("b/position",), state=given["beside"]),
        controller("over", "beside/b/position", state=given["beside"]),
        controller("wide", "a/effort", "b/effort", state="inactive"),
        controller("writer", "spare/x/position", state="inactive"),
    )


def test_a_controller_that_fails_is_replaced_by_its_fallback():
    manager = failing("spare")  # controller_manager.cpp:3532-3570
    assert manager.deactivate_failed("main") == ("main",)
    assert manager.active == ("spare", "beside", "over")
    assert manager.switches == [(("spare",), ("main",))]


def test_a_fallback_takes_its_interfaces_from_whom_they_belong_to():
    manager = failing("wide")
    assert set(manager.deactivate_failed("main")) == {"main", "beside", "over"}
    assert manager.active == ("wide",)


def test_fallbacks_that_are_active_already_are_restarted():
    manager = failing("beside")
    assert set(manager.deactivate_failed("main")) == {"main", "beside", "over"}
    assert manager.active == ("beside",)


def test_fallbacks_are_activated_all_or_none():
    manager = failing("spare", "wide")  # both claim a/effort
    assert manager.deactivate_failed("main") == ("main",)
    assert manager.active == ("beside", "over")


def test_a_controller_whose_fallback_is_not_configured_is_not_activated():
    manager = failing("spare", main="inactive", spare="unloaded")  # test_controller_manager.cpp:1365
    for prepare in (lambda: None, lambda: manager.load_controller("spare")):
        prepare()
        response = manager.switch_controller(["main"], strictness=STRICT)
        assert not response
        assert "its fallback controller 'spare' is not configured" in response.message
    manager.configure_controller("spare")
    assert manager.switch_controller(["main"], strictness=STRICT)


@pytest.mark.parametrize(("fallbacks", "ok"), [(["over"], False), (["over", "beside"], True)])
def test_a_fallback_in_a_chain_needs_what_it_writes_to(fallbacks, ok):
    manager = failing(*fallbacks, main="inactive", beside="inactive")  # test_controller_manager.cpp:1916-1990
    assert manager.switch_controller(["main"], strictness=STRICT).ok is ok


def test_a_controller_in_both_lists_is_started_again():
    manager = Manager(controller("one", "a/effort", state="active"))
    assert manager.switch_controller(["one"], ["one"], STRICT)
    assert manager.active == ("one",)
    assert manager.switches == [(("one",), ("one",))]
    assert not manager.switch_controller(["one"], strictness=STRICT)  # it is active already
    assert manager.switches == [(("one",), ("one",))]


def test_saved_states_that_there_are_not_are_refused():
    manager = Manager(controller("one", "a/effort", state="active"))
    for states in ({"one": "finalized"}, {"two": "active"}):
        with pytest.raises(ValueError, match=f"controller '{next(iter(states))}' cannot be"):
            manager.set_states(states)
    manager.set_states({"one": "unconfigured"})
    assert manager.states == {"one": "unconfigured"}


def test_start_and_stop_are_the_older_names_of_activate_and_deactivate():
    manager = Manager(controller("one", "a/effort", state="active"), controller("two", "a/effort", state="inactive"))
    assert manager.switch_controller(start=["two"], stop=["one"], strictness=STRICT)
    assert manager.switches == [(("two",), ("one",))]


def test_random_calls_keep_what_must_always_hold_and_reach_chains_of_three():
    Calls.reached.clear()
    same = settings(max_examples=1000, stateful_step_count=15, deadline=None, derandomize=True, database=None)
    run_state_machine_as_test(Calls, settings=same)
    assert all(Calls.reached[name] > 500 for name in CHAIN), Calls.reached
