"""What exerts forces lives as other robots do: spawned, deleted, restored, wound back, reset and replayed."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import pytest
from flyers import FLAP, plugin
from multicopters import HOVER, quadcopter, speeds
from test_airships import hull
from waters import SEA, bladder, box, hydrodynamics, propelled, thruster

from drake_twin import Rewind, Twin, TwinBuilder
from drake_twin.messages.interface_types import make
from drake_twin.recording import Recording, replay
from drake_twin.scenario import Robot, World


class Kind(NamedTuple):
    """Robots that exert a kind of forces.

    Attributes:
        model: SDF of one.
        commands: Message types and fields, by topic below the robot's name.
        world: SDF of the world's elements.
        velocity: With which it starts (m/s).
    """

    model: str
    commands: Mapping[str, Any] = MappingProxyType({})
    world: str = ""
    velocity: Sequence[float] = (0.0, 0.0, 0.0)


def body_with(plugins: str) -> str:
    """SDF of a body of 2 kg with a flap, which has plugins."""
    link = """<link name="body"><inertial><mass>2</mass><inertia><ixx>0.5</ixx><iyy>0.8</iyy><izz>1.2</izz></inertia>
    </inertial></link>"""
    return f'<model name="flyer">{link}{FLAP}{plugins}</model>'


def number(value):
    return make("std_msgs/msg/Float64", {"data": value})


def twist(**linear):
    return make("geometry_msgs/msg/Twist", {"linear": linear})


WING = {"a0": 0.05, "cla": 3.0, "cda": 0.4, "cma": -0.2, "area": 0.6, "alpha_stall": 0.35, "cp": "0.1 0.2 0"}
AIRCRAFT = {"AR": 15, "eff": 0.8, "area": 0.6, "CL0": 0.2, "CLa": 4.5, "CD0": 0.03, "Cellp": -0.4, "Cemq": -0.4}
WIND = "<wind><linear_velocity>3 -2 1</linear_velocity></wind>"
WATER_MODEL = propelled(
    (1.0, 0.4, 0.3), hydrodynamics(xUabsU=-20, yDotV=-60, nR=-3, xDotU=-50), thruster(deadband=1.0), side=0.1
)
KINDS = {
    "rotors": Kind(quadcopter(), {"command/motor_speed": speeds(HOVER, HOVER, 1.1 * HOVER, 1.1 * HOVER)}),
    "rotors in wind": Kind(quadcopter(), {"command/motor_speed": speeds(*[HOVER] * 4)}, WIND),
    "controlled velocity": Kind(quadcopter(controlled=True), {"command/twist": twist(x=1.0, z=0.4)}),
    "wing": Kind(body_with(plugin("LiftDrag", WING)), velocity=(12.0, 1.0, 0.0)),
    "aircraft": Kind(body_with(plugin("AdvancedLiftDrag", AIRCRAFT)), world=WIND, velocity=(12.0, 1.0, 0.0)),
    "airship": Kind(hull({"yy": 2.0}, axial_drag_coeff=5.0, force_viscous_coeff=8.0), velocity=(2.0, 1.0, 0.0)),
    "floating": Kind(box("hull", (0.6, 1.0, 0.3), 400.0), world=SEA),
    "submarine": Kind(WATER_MODEL, {"joint/shaft/cmd_thrust": number(8.0)}, SEA, (0.5, 0.2, -0.1)),
}
GLIDER = bladder(namespace="s", max_volume=0.1, neutral_volume=0.01, max_inflation_rate=0.02)
KINDS["glider"] = Kind(box("hull", (0.6, 1.0, 0.3), 990.0, more=GLIDER), {"buoyancy_engine": number(0.02)}, SEA)
HEIGHTS = {"glider": -5.0, "floating": 0.05, "submarine": -5.0}


@pytest.fixture(params=KINDS)
def start(request, tmp_path) -> Any:
    """Builds a twin with two robots of the kind, which move."""
    kind, height = KINDS[request.param], HEIGHTS.get(request.param, 100.0)
    text = kind.model if kind.model.startswith("<sdf") else f'<sdf version="1.9">{kind.model}</sdf>'
    (tmp_path / "robot.sdf").write_text(text)
    (tmp_path / "world.sdf").write_text(f'<sdf version="1.9"><world name="w">{kind.world}</world></sdf>')

    def build() -> Twin:
        builder = TwinBuilder(time_step=0.005, world=World(file=str(tmp_path / "world.sdf"), ground=False))
        for number, name in enumerate(("one", "two")):
            builder.robot(name, tmp_path / "robot.sdf", xyz=(0, 4 * number, height), rpy=(0.1, 0.2, 0.3))
        return builder.build()

    build.robot = Robot("three", str(tmp_path / "robot.sdf"), xyz=(0, 8, height))
    build.kind = kind
    return build


def command(twin: Twin, kind: Kind, robot: str) -> None:
    """Lets a robot move as its kind does."""
    for topic, message in kind.commands.items():
        twin.publish(f"/{robot}/{topic}", message)
    if any(kind.velocity):
        twin.entities.set_state(robot, linear=tuple(kind.velocity))


def lived(twin: Twin, start: Any) -> str:
    """The state at 0.6 s of a run in which one comes and one goes."""
    for robot in ("one", "two"):
        command(twin, start.kind, robot)
    twin.advance_to(0.2)
    twin.entities.spawn(start.robot)
    command(twin, start.kind, "three")
    twin.advance_to(0.3)
    twin.entities.delete("two")
    twin.advance_to(0.6)
    return twin.state_sha256()


def motion(twin: Twin, robot: str) -> list[float]:
    state = twin.entities.state(robot)
    return [*state.position, *state.orientation, *state.linear, *state.angular]


def test_a_run_in_which_one_comes_and_one_goes_repeats_from_the_start_a_reset_and_a_recording(start, tmp_path):
    twin = start()
    first = twin.scenario
    twin.recorder.begin()
    end = lived(twin, start)
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    assert lived(start(), start) == end
    twin.reset(first)
    assert lived(twin, start) == end


def test_it_goes_on_from_a_snapshot_and_when_wound_back(start):
    twin = start()
    with Rewind(twin, period=0.1) as rewind:
        for robot in ("one", "two"):
            command(twin, start.kind, robot)
        twin.advance_to(0.25)
        snapshot, middle = twin.snapshot(), twin.state_sha256()
        twin.advance_to(0.5)
        end = twin.state_sha256()
        twin.restore(snapshot)
        assert twin.state_sha256() == middle
        twin.advance_to(0.5)
        assert twin.state_sha256() == end
        rewind.go_to(0.2)
        twin.advance_to(0.5)
        assert twin.state_sha256() == end


def test_others_that_come_and_go_do_not_move_it(start):
    """Nothing of the air and the water goes from one robot to another one; last bits may follow from their number."""
    twin, beside = start(), start()
    lived(twin, start)
    command(beside, start.kind, "one")
    beside.advance_to(0.6)
    assert motion(twin, "one") == pytest.approx(motion(beside, "one"), rel=1e-9, abs=1e-9)
    assert all(map(math.isfinite, motion(twin, "three")))
