"""A user's program: it uses the public names, runs, and passes ``mypy --strict`` without a ``type: ignore``.

``assert_type`` fails where a name's type has become Any on its way to the user.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import sin
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, ClassVar, assert_type, cast

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, Diagram

import drake_twin
from drake_twin import (
    ActionGoal,
    CommandError,
    EntityState,
    Finding,
    InputError,
    Kind,
    Recording,
    Rewind,
    Robot,
    RobotState,
    RunError,
    Scenario,
    Snapshot,
    StaticTransform,
    Twin,
    TwinBuilder,
    TwinError,
    TwinPage,
    World,
    messages,
    replay,
    show,
)
from drake_twin.calibration import Fitted, Result, calibrate
from drake_twin.controllers import Controller, ControllerSetup, Interface, PeriodicController, Update, controller
from drake_twin.description.gazebo_drive import DrivePlugin, GazeboDrive, gazebo_plugin
from drake_twin.description.repairs import Mended, repair
from drake_twin.description.robot_description import RobotDescription
from drake_twin.description.sensor_element import SensorElement
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Findings
from drake_twin.gym import TwinEnv
from drake_twin.saved import saved
from drake_twin.scenario import Push
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.sensors import sensor
from drake_twin.sensors.noise import Noise, read_noise
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem
from drake_twin.sweeps.episode import Runner, Sweep
from drake_twin.sweeps.results import read_table, write_table
from drake_twin.sweeps.variation import Design, Variation

ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
ROVER = "package://rover_description/urdf/rover.urdf.xacro"


@dataclass(frozen=True)
class WaveParameters:
    """Parameters of ``my_pkg/Wave``."""

    joint: str
    amplitude: float = field(default=1.0, metadata={"lower": 0.0})


@saved("my_pkg/WaveMemory")
@dataclass(frozen=True)
class WaveMemory:
    """The time of the activation (s)."""

    start: float


@controller("my_pkg/Wave")
class Wave(PeriodicController):
    """Write a sine wave to a joint."""

    Parameters: ClassVar[type] = WaveParameters

    @classmethod
    def claimed_interfaces(cls, parameters: WaveParameters, description: RobotDescription) -> tuple[Interface, ...]:
        return (Interface(parameters.joint, "velocity"),)

    def __init__(self, setup: ControllerSetup) -> None:
        super().__init__(setup)
        self._offset = self.declare_topic_input("offset", "std_msgs/msg/Float64MultiArray")
        self._own = self.declare_topic_output("own", "std_msgs/msg/Float64", self._calc, {self.all_state_ticket()})

    def read(self, topic: str, message: Any, context: Context) -> float:
        if len(message.data) != 1:
            raise CommandError("the offset is one number")
        return float(message.data[0])

    def start(self, context: Context) -> WaveMemory:
        return WaveMemory(context.get_time())

    def update(self, context: Context, time: float, memory: WaveMemory) -> Update:
        offset = self.received(self._offset, context) or 0.0
        here = self.positions(context, [self.setup.parameters.joint])
        return Update(memory, [float(here[0]) + offset + sin(time - memory.start)])

    def _calc(self, context: Context, output: AbstractValue) -> None:
        output.set_value(messages.message("std_msgs/msg/Float64", {"data": context.get_time()}))


@controller("my_pkg/Still")
class Still(Controller):
    """Claim nothing."""

    Parameters: ClassVar[type] = WaveParameters


@dataclass(frozen=True)
class HeightSettings:
    """The noise of a height."""

    noise: Noise


@sensor("height")
class Height(SensorSystem):
    """Publish the height of a link (m)."""

    message_type = "std_msgs/msg/Float64"

    @classmethod
    def read(cls, element: SensorElement) -> HeightSettings:
        return HeightSettings(read_noise(element, "height/noise"))

    @classmethod
    def noises(cls, settings: HeightSettings) -> dict[str, Noise]:
        return {"height": settings.noise}

    def __init__(self, setup: SensorSetup) -> None:
        super().__init__(setup)
        self._body = int(setup.body.index())
        self._start = float(setup.start.translation()[2])
        self._poses = self.declare_plant_input("body_poses")
        self.declare_message_output(self._calc)

    def _calc(self, context: Context, output: AbstractValue) -> None:
        poses = cast("list[RigidTransform]", self._poses.Eval(context))  # pydrake types a port's value as object
        height = float(poses[self._body].translation()[2]) - self._start
        height = self.noisy("height", height, context.get_time())
        output.set_value(messages.message("std_msgs/msg/Float64", {"data": height}))


@repair("light_link")
def light_link(reader: XmlReader) -> Mended:
    """Name the links without mass."""
    for link in reader.root.iterfind("link"):
        if link.find("inertial") is None:
            yield link, "it has no mass"


@gazebo_plugin("libmy_spinner.so")
def my_spinner(plugin: DrivePlugin) -> GazeboDrive:
    """Turn a joint."""
    joints = plugin.joints("joint")
    drive = plugin.controller("velocity_controllers/JointGroupVelocityController", {"joints": list(joints)})
    return GazeboDrive(plugin.plugin, drive, interfaces=tuple((joint, "velocity") for joint in joints))


def drive(file: Path) -> str:
    """Build a twin, command it, look at it, and repeat it."""
    arm = TwinBuilder(time_step=0.001, seed=1).robot("arm", ARM, active_controllers=["joint_state_broadcaster"])
    twin = (
        arm.robot("rover", ROVER, xyz=(0, 2, 0.13))
        .controller("arm", "wave", "my_pkg/Wave", {"joint": "joint_1"})
        .build()
    )
    assert_type(twin, Twin)
    assert_type(twin.diagram, Diagram)
    heard: list[float] = []
    end = twin.subscribe("/arm/joint_states", lambda message: heard.append(message.velocity[0]), rate=10)
    twin.recorder.begin()
    twin.publish("/rover/forward_velocity_controller/commands", [2, 2, 2, 2])
    assert_type(twin.advance_to(0.2), float)
    end()
    assert_type(twin.robot_state("rover"), RobotState)
    assert_type(twin.entities.state("rover"), EntityState)
    assert_type(twin.findings, Findings)
    assert_type(twin.findings[0], Finding)
    assert_type(twin.findings[0].kind, Kind)
    assert_type(twin.robots, tuple[str, ...])
    assert_type(twin.recorder.recording(), Recording)
    twin.recorder.recording().save(file)
    again = replay(Recording.load(file))
    assert_type(again, Twin)
    assert again.state_sha256() == twin.state_sha256()
    kept = twin.snapshot()
    assert_type(kept, Snapshot)
    twin.restore(kept)
    with Rewind(twin, seconds=10.0) as rewind:
        assert_type(rewind.times, tuple[float, ...])
        twin.entities.spawn(Robot("second", ROVER, xyz=(0, 4, 0.13)))
        twin.step(10)
    with show(twin, port=0) as page:
        assert_type(page, TwinPage)
        assert_type(page.url, str)
    assert len(heard) == 2
    assert_type(drake_twin.__version__, str)
    return f"{twin.state_sha256()} {drake_twin.__version__}"


def follow(twin: Twin) -> ActionGoal:
    """Send a goal to a controller."""
    return twin.graph.send_goal(
        "/arm/joint_trajectory_controller/follow_joint_trajectory", {}, lambda goal: print(goal.status)
    )


def plain(file: Path) -> Scenario:
    """Build a twin from plain data, and keep them in a file."""
    push = Push("rover", 0.1, strength=20.0)
    frames = (StaticTransform("world", "map"),)
    rover = Robot("rover", ROVER, xyz=(0, 0, 0.13))
    scenario = Scenario(robots=(rover,), world=World(), pushes=(push,), static_transforms=frames, seed=3)
    with Twin(scenario) as twin:
        assert_type(twin, Twin)
        twin.advance_to(0.05)
    file.write_text(scenario_to_yaml(scenario), encoding="utf-8")
    return ScenarioFile.read(file).scenario


def learn(scenario: Scenario) -> float:
    """Step an environment."""
    environment = TwinEnv(scenario, reward=lambda twin: twin.time, values={"rover.friction": (0.5, 1.0)})
    observation, information = environment.reset(seed=3)
    observation, reward, terminated, truncated, information = environment.step(environment.action_space.sample())
    assert_type(environment.twin, Twin)
    assert_type(terminated, bool)
    print(np.asarray(observation).shape, truncated, information)
    environment.close()
    return reward


def sweep(scenario: Scenario, file: Path) -> int:
    """Run some episodes and keep their table."""
    design = Design((Variation.parse("friction=0.1,0.5"),))
    plan = Sweep.of(scenario, design, 0.05)
    runner = Runner(plan)
    rows = [runner.run(episode) for episode in design.episodes()]
    runner.close()
    write_table(file, plan.definition, rows)
    _definition, read = read_table(file)
    assert_type(read, list[dict[str, Any]])
    return len(read)


def fit(scenario: Scenario) -> Mapping[str, float]:
    """Find a payload from a log."""
    result = calibrate(scenario, ["run.json"], [Fitted("arm.claw.payload", 0.01, 1.0)], method="least-squares")
    assert_type(result, Result)
    return result.values


def main() -> int:
    """Do all but the fit, which takes longer."""
    try:
        with TemporaryDirectory() as folder:
            print(drive(Path(folder, "run.json")))
            scenario = plain(Path(folder, "rover.yaml"))
            print(learn(scenario), sweep(scenario, Path(folder, "table.csv")))
    except (InputError, RunError, CommandError) as error:
        print(error)
        return 2
    except TwinError:
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
