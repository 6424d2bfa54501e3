"""The plan of one controller of a robot: its typed parameters, its claims and its state at the start."""

from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from typing import Any

from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller_class
from drake_twin.controllers.sensor_reader import SensorReader
from drake_twin.description.gazebo_drive import Element
from drake_twin.errors import InputError

UNLOADED, UNCONFIGURED, INACTIVE, ACTIVE = "unloaded", "unconfigured", "inactive", "active"


@dataclass(frozen=True)
class Wiring:
    """The topics and odometry of a controller that comes from a Gazebo plugin.

    Attributes:
        topics: The controller's topic → the plugin's topic, below the robot's namespace or with a leading ``/``. Other
            topics do not exist.
        gz_topics: The controller's topic → its name in gz, by which a bridge may rename it; ``{model}`` stands for the
            robot.
        types: The controller's topic → its ROS type, if the plugin's is another one.
        elements: The controller's topic → the field, and its element, of the plugin's message that commands all joints.
        true_odometry: Whether its odometry is the true pose instead of an estimate from its wheels.
        odometry_rate: The rate of its odometry (Hz); None for that of its parameters.
    """

    topics: Mapping[str, str] = field(default_factory=dict)
    gz_topics: Mapping[str, str] = field(default_factory=dict)
    types: Mapping[str, str] = field(default_factory=dict)
    elements: Mapping[str, Element] = field(default_factory=dict)
    true_odometry: bool = False
    odometry_rate: float | None = None


@dataclass(frozen=True)
class ControllerPlan:
    """A controller of a parameters file or of a Gazebo plugin.

    Attributes:
        name: The controller's name, the prefix of its topics.
        type: The name of its plugin.
        parameters: An instance of its class's ``Parameters``; None if ``problem`` is the reason why they cannot be
            read.
        claims: The command interfaces that it writes while active, in order.
        references: The references that other controllers may write, without its name as prefix.
        state: Its state at the start: unloaded, unconfigured, inactive or active.
        update_rate: The rate of its updates (Hz).
        problem: Why it cannot be configured or activated; None if it can.
        error: The same as an error with file and line, if the controller should be loaded and is missing or wrong.
        wiring: The topics of a Gazebo plugin's controller; None for a controller of ros2_control.
        fallbacks: The controllers that replace it when it fails.
        exported: The names of the state interfaces that it exports, without its own as prefix.
        ros_parameters: Its parameters as its files give them, by their names in ROS.
    """

    name: str
    type: str
    parameters: Any = None
    claims: tuple[Interface, ...] = ()
    references: tuple[Interface, ...] = ()
    state: str = UNLOADED
    update_rate: float = 100.0
    problem: str | None = None
    error: InputError | None = None
    wiring: Wiring | None = None
    fallbacks: tuple[str, ...] = ()
    exported: tuple[str, ...] = ()
    ros_parameters: Mapping[str, Any] = field(default_factory=dict)

    @property
    def reference_interfaces(self) -> tuple[Interface, ...]:
        """The references under the names by which other controllers claim them."""
        return tuple(Interface(f"{self.name}/{item.joint}", item.name) for item in self.references)

    @property
    def sensor(self) -> str | None:
        """The name of the sensor that it reads; None if it is not loaded or reads none."""
        kind = controller_class(self.type)
        if self.parameters is None or self.state == UNLOADED or kind is None or not issubclass(kind, SensorReader):
            return None
        return kind.sensor_name(self.parameters)


def is_chained(claim: Interface, controllers: Container[str]) -> bool:
    """Return whether a claim is a reference of another controller; a slash alone may be part of a joint's name."""
    owner, slash, _ = claim.joint.partition("/")
    return bool(slash) and owner in controllers


def chained_to(plan: ControllerPlan, controllers: Container[str]) -> tuple[str, ...]:
    """Return the controllers that a controller writes to, in a chain."""
    owners = (claim.joint.partition("/")[0] for claim in plan.claims if is_chained(claim, controllers))
    return tuple(dict.fromkeys(owners))
