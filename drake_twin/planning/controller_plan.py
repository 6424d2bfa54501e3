"""The plan of one controller of a robot: its typed parameters, its claims and its state at the start."""

from collections.abc import Container, Mapping
from dataclasses import field
from typing import Any

from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller_class
from drake_twin.controllers.sensor_reader import SensorReader
from drake_twin.dataclass import dataclass
from drake_twin.description.controllers_yaml import nested
from drake_twin.description.declared_parameters import DeclaredParameter, declared_parameters
from drake_twin.description.gazebo_drive import GazeboDrive
from drake_twin.errors import InputError
from drake_twin.messages.parameter_value import flat, type_of

USE_SIM_TIME = "use_sim_time"
UNLOADED, UNCONFIGURED, INACTIVE, ACTIVE = "unloaded", "unconfigured", "inactive", "active"


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
        wiring: The Gazebo plugin that it comes from, with its topics; None for a controller of ros2_control.
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
    wiring: GazeboDrive | None = None
    fallbacks: tuple[str, ...] = ()
    exported: tuple[str, ...] = ()
    ros_parameters: Mapping[str, Any] = field(default_factory=dict)

    @property
    def declared(self) -> dict[str, DeclaredParameter]:
        """Its parameters as its node declares them in ROS, by their names; those of a plugin cannot be set."""
        found = [
            DeclaredParameter(USE_SIM_TIME, 1, value=True, description="Whether the time is that of /clock"),
            DeclaredParameter("update_rate", 2, round(self.update_rate), description="The rate of its updates (Hz)"),
        ]
        dialects = getattr(type(self.parameters), "dialects", ())
        has_dialect = any(dialect.signs & nested(self.ros_parameters).keys() for dialect in dialects)
        if self.parameters is None or self.wiring is not None or has_dialect:
            plain = {name: value for name, value in flat(self.ros_parameters) if name != "update_rate"}
            found += (
                DeclaredParameter(name, type_of(value), value, is_read_only=True) for name, value in plain.items()
            )
        else:
            asynchronous = bool(self.ros_parameters.get("is_async", False))
            found.append(DeclaredParameter("is_async", 1, asynchronous, description="Without effect in the twin"))
            found += declared_parameters(self.parameters)
        return {item.name: item for item in found}

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
