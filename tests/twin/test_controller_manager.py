"""Random sequences of the controller manager's calls keep what must always hold; single calls that they seldom make."""

from collections import Counter
from dataclasses import replace
from typing import ClassVar

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule, run_state_machine_as_test
from made_up_controllers import Manager, controller, robot_plan

from drake_twin.twin.controller_manager import BEST_EFFORT, STRICT, ControllerManager

CHAIN = ("low", "middle", "high")  # from the joint up: each writes to the one before it
BELOW = {"middle": "low", "high": "middle", "rival": "middle"}  # controller → the one that it writes to

# Two that exclude each other, one beside them, a chain of three with two that exclude each other at its upper end, one
# that cannot be configured, one without claims.
CONTROLLERS = (
    controller("broadcaster", state="active"),
    controller("one", "a/position", "a/velocity", state="active"),
    controller("other", "a/velocity", "b/position"),
    controller("beside", "b/velocity", state="inactive"),
    controller("low", "c/position", references=("c/position",)),
    controller("middle", "low/c/position", references=("c/position",)),
    controller("high", "middle/c/position", "c/velocity"),
    controller("rival", "middle/c/position"),
    controller("broken", "a/position", problem="its joint is missing"),
)
CLAIMS = {item.name: set(item.claims) for item in CONTROLLERS}
NAMES = st.sampled_from([*CLAIMS, "nobody"])
LISTS = st.lists(NAMES, max_size=4)
PARTS = st.lists(st.sampled_from([*CHAIN, "rival"]), unique=True)
CHAINS = st.sampled_from([CHAIN[:1], CHAIN[:2], CHAIN, (*CHAIN[:2], "rival")]).flatmap(st.permutations)
STRICTNESSES = st.sampled_from([0, 1, 2, 3, 4, 9])


def is_possible(states, activate, deactivate):
    """Tell whether a strict switch is done, by the rules of ros2_control's controller_manager.cpp (4.46.0)."""
    active = {name for name, state in states.items() if state == "active"}
    if not set(deactivate) <= active:  # lines 1989, 2135
        return False
    held = set().union(*(CLAIMS[name] for name in active.difference(deactivate)))
    for name in dict.fromkeys(activate):
        if states.get(name) not in ("inactive", "active") or (name in active and name not in deactivate):  # 2051, 2060
            return False
        below = None if name in active else BELOW.get(name)
        if below is not None and (below in deactivate if below in active else below not in activate):  # 3936, 3966
            return False
        if CLAIMS[name] & held:  # 4378, 4389
            return False
        held |= CLAIMS[name]
    for above, below in BELOW.items():
        stays = above not in deactivate if above in active else above in activate  # 4089, 4074
        starts_again = above in active and above in activate and below not in activate  # on what is not there then
        if below in deactivate and (stays or starts_again):
            return False
    return True


class Calls(RuleBasedStateMachine):
    """Calls in any order, the chain's controllers brought up and taken down among them.

    Attributes:
        reached: How often switches activated each controller of the chain, brought it into chained mode and out of it
            while it stayed active, and gave it another writer.
    """

    plan = robot_plan(*CONTROLLERS)
    reached: ClassVar[Counter] = Counter()

    def __init__(self):
        super().__init__()
        self.manager = ControllerManager(self.plan, self.switched)
        self.running = set(self.manager.active)
        self.restarted = set()

    def switched(self, started, stopped):
        assert set(stopped) <= self.running
        self.running -= set(stopped)
        assert not self.running & set(started)
        self.running |= set(started)
        self.restarted = set(started) & set(stopped)

    def writers(self):
        """Return the controllers in chained mode, each with the active one that writes to it."""
        return {BELOW[name]: name for name in self.running if name in BELOW}

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
        before, running, writers = self.manager.states, set(self.running), self.writers()
        self.restarted = set()
        response = self.manager.switch_controller(activate, deactivate, strictness)
        if not response.ok:
            assert response.message
            assert self.manager.states == before
        if strictness != 9 and is_possible(before, activate, deactivate):
            assert response.ok
            assert set(activate) <= self.running
            assert not (set(deactivate) - set(activate)) & self.running
        elif strictness == STRICT:
            assert not response.ok
        changed = writers.keys() ^ self.writers().keys()
        stayed = running & self.running
        asked = set(activate) & set(deactivate)
        assert changed & stayed <= self.restarted <= changed | asked  # controller_manager.cpp:2207-2215
        self.count(running, writers)

    def count(self, running, writers):
        """Count what a switch has made of the chain."""
        now = self.writers()
        self.reached.update(f"{name} activated" for name in CHAIN if name in self.running - running)
        self.reached.update(f"{name} chained" for name in now.keys() - writers.keys())
        self.reached.update(f"{name} unchained" for name in (writers.keys() - now.keys()) & self.running)
        self.reached.update(f"{name} rewritten" for name in now.keys() & writers.keys() if now[name] != writers[name])

    @rule(names=CHAINS)
    def bring_up(self, names):
        """Load, configure and activate the lower controllers of the chain, named in any order."""
        for name in names:
            self.manager.load_controller(name)
            self.manager.configure_controller(name)
        ends = {"high", "rival"}
        in_the_way = ends & self.running - set(names) if ends & set(names) else ()
        self.switch(names, list(in_the_way), BEST_EFFORT)
        assert set(names) <= self.running

    @rule(upper=st.integers(0, 2))
    def take_down(self, upper):
        """Deactivate the chain's upper controllers."""
        names = self.running & {"rival", *CHAIN[upper:]}
        self.switch([], sorted(names), STRICT)
        assert not names & self.running

    @rule(activate=PARTS, deactivate=PARTS, strictness=STRICTNESSES)
    def switch_chain(self, activate, deactivate, strictness):
        self.switch(activate, deactivate, strictness)

    @rule(name=NAMES)
    def fail(self, name):
        before = self.manager.states
        stopped = set(self.manager.deactivate_failed(name))
        above = [name]
        for lower in above:  # grows during the loop: up the chain
            above += [each for each in BELOW if BELOW[each] == lower]
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
        assert self.writers().keys() <= self.running

    @invariant()
    def a_controller_is_chained_while_one_above_it_is_active(self):
        chained = {item.name for item in self.manager.list_controllers() if item.is_chained}
        assert chained == self.writers().keys()

    @invariant()
    def references_are_available_while_their_controller_is_active(self):
        listed = {item.name: item.is_available for item in self.manager.list_hardware_interfaces()[0]}
        configured = {name for name in CHAIN[:2] if self.manager.states.get(name) in ("inactive", "active")}
        references = {name: available for name, available in listed.items() if name.startswith(CHAIN)}
        assert references == {f"{name}/c/position": name in self.running for name in configured}

    @invariant()
    def the_broken_one_never_runs(self):
        assert self.manager.states.get("broken") in (None, "unconfigured")


@pytest.mark.parametrize("strictness", [BEST_EFFORT, STRICT])
def test_of_two_that_claim_one_interface_a_switch_activates_neither(strictness):
    manager = Manager(  # test_release_interfaces.cpp:179-219
        controller("first", "a/effort", state="inactive"),
        controller("second", "a/effort", "b/effort", state="inactive"),
        controller("third", "b/effort", state="inactive"),
    )
    response = manager.switch_controller(["first", "second", "third"], strictness=strictness)
    assert not response
    assert "controller 'second': command interface a/effort is already claimed by 'first'" in response.message
    assert manager.switches == []


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
    plan = robot_plan(controller("one", "a/effort", state="inactive"))
    plan = replace(plan, manager=replace(plan.manager, strictness=default))
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
    least = {f"{name} activated": 100 for name in CHAIN} | {f"{name} chained": 100 for name in CHAIN[:2]}
    least |= {f"{name} unchained": 20 for name in CHAIN[:2]} | {"middle rewritten": 20}
    assert all(Calls.reached[what] >= number for what, number in least.items()), Calls.reached
