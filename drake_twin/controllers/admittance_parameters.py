"""Parameters of admittance_controller (Jazzy)."""

from dataclasses import field
from typing import ClassVar

import numpy as np

from drake_twin.controllers.admittance_rule import AdmittanceRule
from drake_twin.controllers.chain_kinematics import ChainKinematics
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError

_INTERFACES = {"choices": ("position", "velocity", "acceleration")}


@dataclass(frozen=True)
class AdmittanceKinematics:
    """The chain of joints.

    Attributes:
        plugin_name: ROS's plugin for kinematics; in the twin, the kinematics are those of the robot's own plant.
        plugin_package: The package of the plugin's interface.
        base: The link at the start of the chain, which the offset is relative to.
        tip: The link at the end of the chain.
        alpha: The damping of the Jacobian's inverse.
    """

    plugin_name: str
    plugin_package: str
    base: str
    tip: str
    alpha: float = 0.01


@dataclass(frozen=True)
class LinkFrame:
    """A link.

    Attributes:
        id: The link's name.
    """

    id: str


@dataclass(frozen=True)
class AdmittanceSensor:
    """The force/torque sensor.

    Attributes:
        name: The sensor in ``<ros2_control>``.
        frame: The frame of its values.
        filter_coefficient: The share of a new value in the filtered one.
    """

    name: str
    frame: LinkFrame
    filter_coefficient: float = 0.05


@dataclass(frozen=True)
class AdmittanceFrame:
    """A frame of the control law.

    Attributes:
        frame: The frame.
    """

    frame: LinkFrame


@dataclass(frozen=True)
class CenterOfGravity:
    """The weight behind the sensor.

    Attributes:
        pos: Its three coordinates in the frame (m).
        force: The weight (N).
    """

    pos: tuple[float, ...]
    force: float = 0.0

    def __post_init__(self) -> None:
        _check_count(self, "pos", 3)


@dataclass(frozen=True)
class GravityCompensation:
    """What is taken off the measured wrench.

    Attributes:
        frame: The frame of the centre of gravity.
        CoG: The centre of gravity.
    """

    frame: LinkFrame
    CoG: CenterOfGravity


@dataclass(frozen=True)
class AdmittanceGains:
    """The mass, damper and spring of x, y, z, rx, ry and rz.

    Attributes:
        selected_axes: Whether a wrench has an effect, for each axis of the control frame.
        mass: The mass of each axis of the base (kg, kg·m²).
        damping_ratio: The damping ratio of each axis of the control frame: damping / (2·√(mass·stiffness)).
        stiffness: The stiffness of each axis of the control frame (N/m, N·m/rad).
        joint_damping: The deceleration of each joint's offset by its velocity (1/s).
    """

    selected_axes: tuple[bool, ...]
    mass: tuple[float, ...] = field(metadata={"lower": 0.0001, "upper": 1e6})
    damping_ratio: tuple[float, ...]
    stiffness: tuple[float, ...] = field(metadata={"lower": 0.0, "upper": 1e8})
    joint_damping: float = field(default=5.0, metadata={"lower": 0.0})

    def __post_init__(self) -> None:
        for name in ("selected_axes", "mass", "damping_ratio", "stiffness"):
            _check_count(self, name, 6)


@dataclass(frozen=True, kw_only=True)
class AdmittanceParameters:
    """Parameters of ``admittance_controller/AdmittanceController``.

    Attributes:
        joints: The joints of the chain.
        command_joints: The joints or references to command, if they are not ``joints``: as many.
        command_interfaces: The command interfaces of each joint.
        state_interfaces: The state interfaces of each joint: ``position``, with others.
        chainable_command_interfaces: The references of each joint.
        kinematics: The chain of joints.
        ft_sensor: The force/torque sensor.
        control: The frame of stiffness, damping and selected axes.
        fixed_world_frame: The frame in which gravity is along negative z.
        gravity_compensation: The weight behind the sensor.
        admittance: The mass, damper and spring.
        enable_parameter_update_without_reactivation: Whether changed parameters are used at once.
    """

    read_only: ClassVar[tuple[str, ...]] = (
        *("joints", "command_joints", "command_interfaces", "state_interfaces", "chainable_command_interfaces"),
    )
    live: ClassVar[tuple[str, ...]] = ("admittance.*", "gravity_compensation.CoG.*", "ft_sensor.filter_coefficient")

    joints: tuple[str, ...]
    command_joints: tuple[str, ...] = ()
    command_interfaces: tuple[str, ...] = field(metadata=_INTERFACES)
    state_interfaces: tuple[str, ...] = field(metadata=_INTERFACES)
    chainable_command_interfaces: tuple[str, ...] = field(
        default=("position", "velocity"), metadata={"choices": ("position", "velocity")}
    )
    kinematics: AdmittanceKinematics
    ft_sensor: AdmittanceSensor
    control: AdmittanceFrame
    fixed_world_frame: AdmittanceFrame
    gravity_compensation: GravityCompensation
    admittance: AdmittanceGains
    enable_parameter_update_without_reactivation: bool = field(
        default=True, metadata={"unsupported": "changed parameters are used at once"}
    )

    def __post_init__(self) -> None:
        if self.command_joints and len(self.command_joints) != len(self.joints):
            raise ParameterError(
                f"command_joints has {len(self.command_joints)} elements and joints has {len(self.joints)}",
                "command_joints",
            )
        if "position" not in self.state_interfaces:
            raise ParameterError("the state interface 'position' is needed", "state_interfaces")
        if not self.written_interfaces:
            raise ParameterError("the twin does not command accelerations", "command_interfaces")

    @property
    def written_interfaces(self) -> tuple[str, ...]:
        """The command interfaces of each joint that the twin has: all but ``acceleration``."""
        return tuple(name for name in self.command_interfaces if name != "acceleration")

    @property
    def links(self) -> tuple[str, ...]:
        """The links that stand in the parameters, ``kinematics.base`` first."""
        return (
            self.kinematics.base,
            self.kinematics.tip,
            self.ft_sensor.frame.id,
            self.control.frame.id,
            self.fixed_world_frame.frame.id,
            self.gravity_compensation.frame.id,
        )

    def rule(self, kinematics: ChainKinematics) -> AdmittanceRule:
        """Return the control law."""
        gains, gravity = self.admittance, self.gravity_compensation
        mass, stiffness = np.array(gains.mass), np.array(gains.stiffness)
        return AdmittanceRule(
            kinematics=kinematics,
            sensor_frame=self.ft_sensor.frame.id,
            control_frame=self.control.frame.id,
            world_frame=self.fixed_world_frame.frame.id,
            gravity_frame=gravity.frame.id,
            center_of_gravity=np.array(gravity.CoG.pos),
            weight=gravity.CoG.force,
            filter_coefficient=self.ft_sensor.filter_coefficient,
            selected_axes=np.array(gains.selected_axes, dtype=float),
            mass=mass,
            damping=2.0 * np.array(gains.damping_ratio) * np.sqrt(mass * stiffness),
            stiffness=stiffness,
            joint_damping=gains.joint_damping,
        )


def _check_count(parameters: object, name: str, count: int) -> None:
    found = len(getattr(parameters, name))
    if found != count:
        raise ParameterError(f"{name} has {found} elements, where {count} are needed", name)
