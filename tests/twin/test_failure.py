"""A step of the physics that fails: what is said of it, and the state that the twin is left in."""

import json

import numpy as np
import pytest
from conftest import rovers

from drake_twin import TwinBuilder
from drake_twin.errors import RunError
from drake_twin.run import main
from drake_twin.scenario.scenario_file import scenario_to_yaml
from drake_twin.twin.failure import failure
from drake_twin.twin.recording import Recording
from drake_twin.twin.replay import replay
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.stepper import Stepper

ENGINES = [{"time_step": 0.001}, {"time_step": 0.01}, {"engine": "cenic", "accuracy": 1e-3, "time_step": 0.01}]
every_engine = pytest.mark.parametrize("engine", ENGINES, ids=["1ms", "10ms", "cenic"])

LINK = """<link name="{}"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="{1}" type="continuous"><parent link="{0}"/><child link="{2}"/><origin xyz="0.2 0 0"/>
<axis xyz="0 1 0"/></joint>"""
CHAIN = f"""<robot name="chain">{LINK.format("base")}{LINK.format("upper")}{LINK.format("lower")}
{JOINT.format("base", "shoulder", "upper")}{JOINT.format("upper", "elbow", "lower")}
<ros2_control name="s" type="system"><joint name="elbow"><command_interface name="effort"/></joint>
<joint name="shoulder"><command_interface name="position"/><state_interface name="position"/>
<state_interface name="velocity"/></joint></ros2_control>
</robot>"""
# The trajectory controller keeps something from each of its updates, which precede the step of the physics.
CONTROLLERS = {
    "controller_manager": {
        "ros__parameters": {
            "update_rate": 100,
            "effort": {"type": "effort_controllers/JointGroupEffortController"},
            "trajectory": {"type": "joint_trajectory_controller/JointTrajectoryController"},
        }
    },
    "effort": {"ros__parameters": {"joints": ["elbow"]}},
    "trajectory": {
        "ros__parameters": {
            "joints": ["shoulder"],
            "command_interfaces": ["position"],
            "state_interfaces": ["position", "velocity"],
        }
    },
}
TOO_MUCH = 1e40  # N·m


@pytest.fixture
def chains(tmp_path):
    """Builds two robots in free fall."""
    file, controllers = tmp_path / "chain.urdf", tmp_path / "controllers.yaml"
    file.write_text(CHAIN)
    controllers.write_text(json.dumps(CONTROLLERS))

    def builder(**options) -> TwinBuilder:
        found = TwinBuilder(**options)
        for index, name in enumerate(("first", "second")):
            found.robot(name, file, xyz=(0, 3.0 * index, 50), controllers=controllers)
        return found

    return builder


def state(twin):
    return twin.plant.GetPositionsAndVelocities(twin.plant.GetMyContextFromRoot(twin.context))


@every_engine
def test_a_push_that_tears_a_robot_apart_leaves_the_state_before_it(chains, engine):
    twin, stepped = chains(**engine).build(), chains(**engine).build()
    twin.recorder.begin()
    for each in (twin, stepped):
        each.advance_to(0.2)
        each.entities.apply_wrench(
            "second::lower", torque=(0, 1e6 if "engine" not in engine else TOO_MUCH, 0), duration=2.0
        )
    with pytest.raises(
        RunError, match=r"failed after 0\.\d+ s: .*(joint (elbow|shoulder)|the base).* of robot 'second'"
    ):
        twin.advance_to(5.0)
    error = None
    while error is None:
        good, time = stepped.state_sha256(), stepped.time
        try:
            stepped.step()
        except RunError as found:
            error = found
    assert f"failed after {time:.9g} s: " in str(error)
    assert (twin.time, twin.state_sha256()) == (time, good)
    assert (stepped.time, stepped.state_sha256()) == (time, good)
    assert np.isfinite(state(twin)).all()
    assert twin.context.get_time() == pytest.approx(time)
    assert twin.time >= 0.2
    restored = chains(**engine).build()
    restored.restore(twin.snapshot())
    assert restored.state_sha256() == good
    assert replay(twin.recorder.recording()).state_sha256() == good


@every_engine
@pytest.mark.parametrize("scheduled", [False, True])
def test_a_command_whose_first_step_fails_is_still_to_come(chains, engine, scheduled):
    builder = chains(**engine)
    if scheduled:
        builder.command("/second/effort/commands", [TOO_MUCH], time=0.5)
    twin = builder.build()
    twin.recorder.begin()
    twin.advance_to(0.5)
    if not scheduled:
        twin.publish("/second/effort/commands", [TOO_MUCH])
    before = twin.state_sha256()  # what waits is in it
    for _ in range(2):
        with pytest.raises(RunError, match=r"failed after 0\.5 s: .*robot 'second'"):
            twin.advance_to(3.0)
        assert (twin.time, twin.state_sha256()) == (0.5, before)
    assert replay(twin.recorder.recording()).state_sha256() == before
    twin.entities.delete("second")
    twin.advance_to(1.0)
    assert twin.entities.state("first").linear[2] == pytest.approx(-9.81, rel=0.01)


@every_engine
def test_a_wrench_that_ends_where_a_step_fails_is_not_forgotten(chains, engine):
    twin = chains(**engine).command("/second/effort/commands", [TOO_MUCH], time=0.5).build()
    twin.recorder.begin()
    twin.entities.apply_wrench("first", (1.0, 0, 0), duration=0.5)
    with pytest.raises(RunError):
        twin.advance_to(3.0)
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


def test_what_drake_raises_is_said_with_the_largest_acceleration_before_it(chains, monkeypatch):
    twin = chains().build()
    advance = Stepper._advance_simulator

    def raise_error(self, step):
        advance(self, min(step, 30))
        if step > 30:
            raise RuntimeError("the solver\n did not converge.")
        return False

    monkeypatch.setattr(Stepper, "_advance_simulator", raise_error)
    twin.entities.apply_wrench("second::lower", torque=(0, 30, 0), duration=2.0)
    what = (
        r"failed after 0\.03 s: the solver did not converge\. Just before, .* of robot 'second' accelerated most, at "
    )
    with pytest.raises(RunError, match=what):
        twin.advance_to(1.0)
    assert twin.time == 0.03


def test_a_long_advance_is_cut_without_a_trace():
    """Steps are tried again from where an advance began, so it must not be long; nobody can see where it is cut."""
    twin, stepped = (rovers(2, time_step=0.01).build() for _ in range(2))
    for each in (twin, stepped):
        each.publish("/robot_1/forward_velocity_controller/commands", [3, 2, 3, 2])
    twin.advance_to(3.5)
    while stepped.time < 3.5:
        stepped.step()
    assert twin.state_sha256() == stepped.state_sha256()


def test_the_programs_files_are_those_of_the_last_good_state(chains, tmp_path, capsys):
    scenario = tmp_path / "scenario.yaml"
    builder = chains(time_step=0.01).command("/second/effort/commands", [TOO_MUCH], time=0.5)
    scenario.write_text(scenario_to_yaml(builder.build().scenario))
    options = {name: tmp_path / f"{name}.json" for name in ("summary", "save-state", "record")}
    arguments = [str(word) for name, file in options.items() for word in (f"--{name}", file)]
    assert main([str(scenario), "--headless", "--duration", "2", *arguments]) == 1
    output = capsys.readouterr()
    assert "error: the simulation failed after 0.5 s: " in output.err
    assert output.out.startswith("2 robots, 0.500 s simulated in ")
    summary = json.loads(options["summary"].read_text())
    assert summary["sim_time"] == 0.5
    assert summary["failure"].startswith("the simulation failed after 0.5 s: ")
    assert summary["robots"]["second"]["efforts"] is None
    twin = replay(Recording.load(options["record"]))
    assert twin.state_sha256() == summary["state_sha256"]
    twin.restore(Snapshot.load(options["save-state"]))
    assert twin.state_sha256() == summary["state_sha256"]


def test_a_robot_at_rest_is_not_suspected():
    twin = rovers(2).build()
    context = twin.plant.GetMyContextFromRoot(twin.context)
    said = "the simulation failed after 1.5 s: Drake says so"
    assert str(failure(twin.built, context, 1.5, RuntimeError("Drake\n  says so."))) == said
    (body,) = {name for name in twin.built.plans[1].description.links if "base" in name}
    named = str(failure(twin.built, context, 1.5, RuntimeError(f"body {body} is bad")))
    assert named.endswith(f"body {body} is bad. That is in robot 'robot_2'")
