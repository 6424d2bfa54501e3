"""Random sequences of the controller manager's calls keep what must always hold."""

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from drake_twin.controllers.interface import Interface
from drake_twin.description.package_index import PackageIndex
from drake_twin.planning.controller_plan import ControllerPlan
from drake_twin.planning.robot_plan import plan_robot
from drake_twin.scenario import Robot
from drake_twin.twin.controller_manager import STRICT, ControllerManager

INTERFACES = [Interface(joint, kind) for joint in ("a", "b", "c") for kind in ("position", "velocity")]


def controller(name, *claims, references=(), state="unloaded", problem=None):
    return ControllerPlan(name, "a/Type", None, claims, references, state, problem=problem)


# Two that exclude each other, one beside them, a chain of three, one that cannot be configured, one without claims.
CONTROLLERS = (
    controller("broadcaster", state="active"),
    controller("one", INTERFACES[0], INTERFACES[1], state="active"),
    controller("other", INTERFACES[1], INTERFACES[2]),
    controller("beside", INTERFACES[3], state="inactive"),
    controller("low", INTERFACES[4], references=(Interface("c", "position"),)),
    controller("middle", Interface("low/c", "position"), references=(Interface("c", "position"),)),
    controller("high", Interface("middle/c", "position"), INTERFACES[5]),
    controller("broken", INTERFACES[0], problem="its joint is missing"),
)
NAMES = st.sampled_from([*(item.name for item in CONTROLLERS), "nobody"])
LISTS = st.lists(NAMES, max_size=4)


@pytest.fixture(scope="module", autouse=True)
def robot_plan():
    from dataclasses import replace

    with TemporaryDirectory() as folder:
        file = Path(folder) / "robot.urdf"
        file.write_text('<robot name="robot"><link name="base"/></robot>')
        Calls.plan = replace(plan_robot(Robot("robot", str(file)), PackageIndex()), controllers=CONTROLLERS)
    return Calls.plan


class Calls(RuleBasedStateMachine):
    plan = None

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

    @rule(activate=LISTS, deactivate=LISTS, strictness=st.sampled_from([0, 1, 2, 3, 4, 9]))
    def switch(self, activate, deactivate, strictness):
        before = self.manager.states
        response = self.manager.switch_controller(activate, deactivate, strictness)
        if not response.ok:
            assert self.manager.states == before
            assert response.message
        elif strictness == STRICT:
            assert set(activate) <= set(self.manager.active)
            assert not set(deactivate) - set(activate) & set(self.manager.active)

    @rule(name=NAMES)
    def fail(self, name):
        self.manager.deactivate_failed(name)
        assert name not in self.manager.active

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
        active = set(self.manager.active)
        for item in CONTROLLERS:
            if item.name in active:
                owners = {claim.joint.partition("/")[0] for claim in item.claims if "/" in claim.joint}
                assert owners <= active

    @invariant()
    def the_broken_one_never_runs(self):
        assert self.manager.states.get("broken") in (None, "unconfigured")


TestCalls = Calls.TestCase
TestCalls.settings = settings(max_examples=2000, stateful_step_count=15, deadline=None)
