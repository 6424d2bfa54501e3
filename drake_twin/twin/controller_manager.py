"""A robot's controller manager: which controllers are loaded and active, and their claims.

Its methods are named like ROS 2's controller_manager services and answer as those do, with ``ok`` and a message; none
raises because of a name or a conflict. A switch takes effect at the next physics step, also while the twin is paused.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller_types
from drake_twin.dataclass import dataclass
from drake_twin.planning.controller_plan import ACTIVE, INACTIVE, UNCONFIGURED, UNLOADED, ControllerPlan
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.twin.controller_switch import Switch, SwitchRules
from drake_twin.twin.owner import Owned, Owner, any_thread

# Strictness of a switch, as in controller_manager_msgs/srv/SwitchController.
UNSPECIFIED, BEST_EFFORT, STRICT, AUTO, FORCE_AUTO = 0, 1, 2, 3, 4


@dataclass(frozen=True)
class Response:
    """The answer of a service; true if it succeeded."""

    ok: bool
    message: str = ""

    def __bool__(self) -> bool:
        return self.ok


@dataclass(frozen=True)
class ControllerState:
    """A loaded controller, as in ``list_controllers``.

    Attributes:
        name: Its name.
        state: Unconfigured, inactive or active.
        type: The plugin's name.
        claimed_interfaces: The command interfaces that it has claimed.
        required_command_interfaces: The command interfaces that it claims while active; none before it is configured.
        reference_interfaces: Its references, which other controllers may write, without its name as prefix; none
            before it is configured.
        is_chained: Whether an active controller writes its references.
        update_rate: The rate of its updates (Hz).
    """

    name: str
    state: str
    type: str
    claimed_interfaces: tuple[str, ...]
    required_command_interfaces: tuple[str, ...]
    reference_interfaces: tuple[str, ...]
    is_chained: bool
    update_rate: float


@dataclass(frozen=True)
class HardwareInterface:
    """A command or state interface, as in ``list_hardware_interfaces``."""

    name: str
    is_available: bool = True
    is_claimed: bool = False


@dataclass(frozen=True)
class HardwareComponent:
    """A ``<ros2_control>`` tag, as in ``list_hardware_components``."""

    name: str
    type: str
    plugin: str
    state: str
    command_interfaces: tuple[str, ...]
    state_interfaces: tuple[str, ...]


class ControllerManager(Owned, path="twin.control.manager(…)"):
    """The controllers of one robot.

    Args:
        plan: The robot.
        switched: Called at every change with the activated controllers and those deactivated before.
        note: Called with the method and the arguments of every call that may change something.
        owner: The thread that the twin belongs to; by default this one.

    Attributes:
        loaded: Is called with a controller that has been loaded.
        configured: Is called with a controller that has been configured.
        default_strictness: Returns the strictness of a switch that names none.
        tell: Is called with what it does, as ros2_control's logs it.
    """

    def __init__(
        self,
        plan: RobotPlan,
        switched: Callable[[tuple[str, ...], tuple[str, ...]], None],
        note: Callable[..., object] = lambda *call: None,
        owner: Owner | None = None,
    ):
        self._owner = owner or Owner()
        self._plan = plan
        self._plans = {item.name: item for item in plan.controllers}
        self._switched = switched
        self._note = note
        self.loaded: Callable[[str], None] = lambda name: None
        self.configured: Callable[[str], None] = lambda name: None
        self.default_strictness: Callable[[], int] = lambda: self._plan.manager.strictness
        self.tell: Callable[[str], None] = lambda text: None
        self._states: dict[str, str] = {}
        self.restart()

    def restart(self) -> None:
        """Return to the states at the start, without a call of ``switched``."""
        self._states = {item.name: item.state for item in self._plan.controllers if item.state != UNLOADED}

    def follow(self, plan: RobotPlan) -> None:
        """Follow another plan of the robot, with other parameters of its controllers."""
        self._plan, self._plans = plan, {item.name: item for item in plan.controllers}

    def retire(self) -> None:
        """Remove all controllers: the robot has been deleted."""
        self._plans, self._states = {}, {}
        self._switched = lambda started, stopped: None
        self._note = lambda *call: None

    def set_states(self, states: Mapping[str, str]) -> None:
        """Set the states that `states` returned, without a call of ``switched``.

        Raises:
            ValueError: If a controller is not in the parameters files, or a state is invalid.
        """
        for name, state in states.items():
            if name not in self._plans or state not in (UNCONFIGURED, INACTIVE, ACTIVE):
                raise ValueError(f"controller {name!r} cannot be {state!r}")
        self._states = dict(states)

    @property
    def states(self) -> dict[str, str]:
        """Loaded controller → unconfigured, inactive or active, in the order of loading."""
        return dict(self._states)

    @property
    def active(self) -> tuple[str, ...]:
        """The active controllers, in the order of loading."""
        return tuple(name for name, state in self._states.items() if state == ACTIVE)

    @any_thread
    def is_active(self, controller: str) -> bool:
        """Return whether a controller is active."""
        return self._states.get(controller) == ACTIVE

    @property
    def claims(self) -> dict[Interface, str]:
        """The claimed command interfaces, each with the active controller that has claimed it."""
        return {claim: name for name in self.active for claim in self._plans[name].claims}

    def list_controllers(self) -> tuple[ControllerState, ...]:
        """Return the loaded controllers."""
        claims = self.claims
        return tuple(self._controller_state(self._plans[name], state, claims) for name, state in self._states.items())

    def list_controller_types(self) -> tuple[str, ...]:
        """Return the valid types of controllers."""
        return controller_types()

    def list_hardware_interfaces(self) -> tuple[tuple[HardwareInterface, ...], tuple[HardwareInterface, ...]]:
        """Return the command interfaces and the state interfaces.

        Those that a controller exports are there once it is configured, and available while it is active.
        """
        claims = self.claims
        commands = [
            HardwareInterface(
                str(interface), interface.joint not in self._plan.unconfigured_joints, interface in claims
            )
            for interface in self._hardware_commands()
        ]
        configured = [plan for plan in self._plans.values() if self._states.get(plan.name) in (INACTIVE, ACTIVE)]
        commands += [
            HardwareInterface(str(reference), self.is_active(plan.name), reference in claims)
            for plan in configured
            for reference in plan.reference_interfaces
        ]
        hidden = self._plan.unconfigured_joints
        states = [
            HardwareInterface(f"{joint.name}/{item.name}", joint.name not in hidden)
            for joint in self._plan.description.controlled_joints.values()
            for item in joint.state_interfaces
        ]
        unconfigured = [name for name, state in self._plan.hardware_states.items() if state == UNCONFIGURED]
        states += [
            HardwareInterface(f"{sensor.name}/{name}", system.name not in unconfigured)
            for system in self._plan.description.systems
            for sensor in system.sensors
            for name in sensor.state_interfaces
        ]
        gpios = self._plan.description.gpios.values()
        states += [
            HardwareInterface(f"{gpio.name}/{name}", gpio.name not in hidden) for gpio in gpios for name in gpio.states
        ]
        states += [
            HardwareInterface(f"{plan.name}/{name}", self.is_active(plan.name))
            for plan in configured
            for name in plan.exported
        ]
        return tuple(commands), tuple(states)

    def list_hardware_components(self) -> tuple[HardwareComponent, ...]:
        """Return the ``<ros2_control>`` tags; they are active unless the parameters name another state."""
        return tuple(
            HardwareComponent(
                name=system.name,
                type=system.type,
                plugin=system.plugin,
                state=self._plan.hardware_states.get(system.name, ACTIVE),
                command_interfaces=(
                    *(f"{j.name}/{i.name}" for j in system.joints for i in j.command_interfaces),
                    *(f"{gpio.name}/{name}" for gpio in system.gpios for name in gpio.commands),
                ),
                state_interfaces=(
                    *(f"{j.name}/{i.name}" for j in system.joints for i in j.state_interfaces),
                    *(f"{sensor.name}/{name}" for sensor in system.sensors for name in sensor.state_interfaces),
                    *(f"{gpio.name}/{name}" for gpio in system.gpios for name in gpio.states),
                ),
            )
            for system in self._plan.description.systems
        )

    def load_controller(self, name: str) -> Response:
        """Load a controller of the parameters files."""
        (name,) = _names([name])
        self._note("load_controller", name)
        if name in self._states:
            return Response(False, f"a controller named {name!r} is already loaded")
        if name not in self._plans:
            known = ", ".join(self._plans) or "none"
            return Response(False, f"the parameters files have no controller {name!r}; they have {known}")
        self.tell(f"Loading controller : '{name}' of type '{self._plans[name].type}'")
        self._states[name] = UNCONFIGURED
        self.loaded(name)
        return Response(True)

    def configure_controller(self, name: str) -> Response:
        """Configure a controller that is loaded but not active."""
        (name,) = _names([name])
        self._note("configure_controller", name)
        if name not in self._states:
            return Response(False, self._rules.not_loaded(name))
        if self._states[name] == ACTIVE:
            return Response(False, f"controller {name!r} is active: deactivate it first")
        problem = self._plans[name].problem
        if problem is not None:
            return Response(False, f"controller {name!r} cannot be configured: {problem}")
        self.tell(f"Configuring controller: '{name}'")
        self._states[name] = INACTIVE
        self.configured(name)
        return Response(True)

    def unload_controller(self, name: str) -> Response:
        """Unload a controller that is not active."""
        (name,) = _names([name])
        self._note("unload_controller", name)
        if name not in self._states:
            return Response(False, self._rules.not_loaded(name))
        if self._states[name] == ACTIVE:
            return Response(False, f"controller {name!r} is active: deactivate it first")
        self.tell(f"Unloading controller: '{name}'")
        del self._states[name]
        return Response(True)

    def switch_controller(
        self,
        activate: Iterable[str] = (),
        deactivate: Iterable[str] = (),
        strictness: int = UNSPECIFIED,
        *,
        start: Iterable[str] = (),
        stop: Iterable[str] = (),
    ) -> Response:
        """Deactivate and activate controllers at once; one that is in both lists is restarted.

        With ``STRICT`` all of the switch is done or nothing. With ``BEST_EFFORT`` (and ``AUTO``) the impossible parts
        are left out and named in the message. As in ROS 2, nothing is switched if a claim is held by a controller that
        stays active or is activated as well, its hardware is not active, or all of one list are unknown, and active
        controllers that enter or leave chained mode are restarted. ``FORCE_AUTO`` also deactivates controllers with
        conflicting claims.

        Args:
            activate: The controllers to activate (``start`` is its older name).
            deactivate: The controllers to deactivate (``stop`` is its older name).
            strictness: One of the four; 0 for the controller manager's default, ``BEST_EFFORT`` unless its parameters
                say otherwise.
        """
        to_start = list(dict.fromkeys([*_names(activate), *_names(start)]))
        to_stop = list(dict.fromkeys([*_names(deactivate), *_names(stop)]))
        self._note("switch_controller", tuple(to_start), tuple(to_stop), strictness)
        if strictness not in (UNSPECIFIED, BEST_EFFORT, STRICT, AUTO, FORCE_AUTO):
            return Response(False, f"unknown strictness {strictness!r}: 1 is BEST_EFFORT, 2 is STRICT")
        strictness = strictness or self.default_strictness()
        for names in (to_stop, to_start):
            if names and not any(name in self._states for name in names):
                unknown = "; ".join(map(self._rules.not_loaded, names))
                return Response(False, f"nothing is switched: {unknown}")
        if strictness == FORCE_AUTO:
            to_stop += [name for name in self._in_the_way(to_start) if name not in to_start + to_stop]
        switch = self._rules.resolve(to_start, to_stop)
        if switch.conflicts or (switch.message and strictness == STRICT):
            return Response(False, f"nothing is switched: {switch.message}")
        switch = self._rules.with_chained_mode(switch)
        for what, concerned in (("Activating", switch.started), ("Deactivating", switch.stopped)):
            if concerned:
                self.tell(f"{what} controllers: [ {' '.join(concerned)} ]")
        self._apply(switch)
        self.tell("Successfully switched controllers!")
        return Response(True, switch.message)

    def deactivate_failed(self, name: str) -> tuple[str, ...]:
        """Deactivate a controller that has failed, and those that write to its references; activate their fallbacks.

        Fallback controllers take their interfaces from the controllers that claim them, which are deactivated as well.
        They are activated all or none.

        Returns:
            The deactivated controllers.
        """
        failed = self._with_writers([name] if self._states.get(name) == ACTIVE else [])
        fallbacks = list(dict.fromkeys(fallback for each in failed for fallback in self._plans[each].fallbacks))
        stopped = self._with_writers([*failed, *(self._in_the_way(fallbacks) if fallbacks else ())])
        switch = self._rules.resolve(fallbacks, stopped)
        if not fallbacks or switch.message:
            switch = Switch((), tuple(failed))
        self._apply(switch)
        return switch.stopped

    def _with_writers(self, names: Iterable[str]) -> list[str]:
        """Return active controllers and, up the chains, the active ones that write to them."""
        stopped = list(dict.fromkeys(names))
        for below in stopped:  # grows during the loop: up the chain
            stopped += [
                other
                for other in self.active
                if other not in stopped
                and any(claim.joint.startswith(f"{below}/") for claim in self._plans[other].claims)
            ]
        return stopped

    def _apply(self, switch: Switch) -> None:
        self._states.update(dict.fromkeys(switch.stopped, INACTIVE))
        self._states.update(dict.fromkeys(switch.started, ACTIVE))
        if switch.started or switch.stopped:
            self._switched(switch.started, switch.stopped)

    @property
    def _rules(self) -> SwitchRules:
        return SwitchRules(self._plans, self._states, self._plan.idle_joints)

    def _in_the_way(self, to_start: Iterable[str]) -> list[str]:
        claims = self.claims
        wanted = [claim for name in to_start if name in self._plans for claim in self._plans[name].claims]
        return list(dict.fromkeys(claims[claim] for claim in wanted if claim in claims))

    def _controller_state(self, plan: ControllerPlan, state: str, claims: Mapping[Interface, str]) -> ControllerState:
        is_configured = state != UNCONFIGURED
        required = tuple(map(str, plan.claims)) if is_configured else ()
        return ControllerState(
            name=plan.name,
            state=state,
            type=plan.type,
            claimed_interfaces=required if state == ACTIVE else (),
            required_command_interfaces=required,
            reference_interfaces=tuple(map(str, plan.references)) if is_configured else (),
            is_chained=any(reference in claims for reference in plan.reference_interfaces),
            update_rate=plan.update_rate,
        )

    def _hardware_commands(self) -> list[Interface]:
        description = self._plan.description
        return [
            *(
                Interface(j.name, item.name)
                for j in description.controlled_joints.values()
                for item in j.command_interfaces
            ),
            *(Interface(gpio.name, name) for gpio in description.gpios.values() for name in gpio.commands),
        ]


def _names(names: Any) -> list[str]:
    """Return one name, several or none as a list; an invalid name is replaced by its text for the answer."""
    if names is None:
        return []
    several = [names] if isinstance(names, str | bytes) or not isinstance(names, Iterable) else names
    return [name if isinstance(name, str) else repr(name) for name in several]
