"""The services of a robot's controller manager, as in ``controller_manager_msgs``."""

from typing import Any

from drake_twin.controllers.interface import Interface
from drake_twin.planning.controller_plan import ACTIVE, INACTIVE, UNCONFIGURED, ControllerPlan, is_chained
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.services.registry import Fields, robot_service
from drake_twin.services.running import refused
from drake_twin.twin.controller_manager import ControllerState, HardwareInterface, Response
from drake_twin.twin.twin import Twin

_NODE = "controller_manager"
_STATES = {UNCONFIGURED: 1, INACTIVE: 2, ACTIVE: 3}  # lifecycle_msgs/msg/State


def _plan(twin: Twin, robot: str) -> RobotPlan:
    return next(plan for plan in twin.built.plans if plan.name == robot)


@robot_service("controller_manager_msgs/srv/ListControllers", "list_controllers", _NODE)
def _list_controllers(twin: Twin, robot: str, request: Any) -> Fields:
    plans = {plan.name: plan for plan in _plan(twin, robot).controllers}
    states = twin.control.manager(robot).list_controllers()
    return {"controller": [_controller(state, plans) for state in states]}


def _controller(state: ControllerState, plans: dict[str, ControllerPlan]) -> Fields:
    plan = plans[state.name]
    is_configured = state.state != UNCONFIGURED
    chains: dict[str, list[str]] = {}
    for claim in plan.claims if is_configured else ():
        if is_chained(claim, plans):
            owner, _, joint = claim.joint.partition("/")
            chains.setdefault(owner, []).append(str(Interface(joint, claim.name)))
    return {
        "name": state.name,
        "state": state.state,
        "type": state.type,
        "update_rate": round(state.update_rate),
        "claimed_interfaces": state.claimed_interfaces,
        "required_command_interfaces": state.required_command_interfaces,
        "is_chainable": bool(plan.references or plan.exported),
        "is_chained": state.is_chained,
        "exported_state_interfaces": plan.exported if is_configured else (),
        "reference_interfaces": state.reference_interfaces,
        "chain_connections": [{"name": name, "reference_interfaces": items} for name, items in chains.items()],
    }


@robot_service("controller_manager_msgs/srv/ListControllerTypes", "list_controller_types", _NODE)
def _list_controller_types(twin: Twin, robot: str, request: Any) -> Fields:
    types = twin.control.manager(robot).list_controller_types()
    return {"types": types, "base_classes": ["controller_interface::ControllerInterface"] * len(types)}


@robot_service("controller_manager_msgs/srv/ListHardwareInterfaces", "list_hardware_interfaces", _NODE)
def _list_hardware_interfaces(twin: Twin, robot: str, request: Any) -> Fields:
    commands, states = twin.control.manager(robot).list_hardware_interfaces()
    return {"command_interfaces": [*map(_interface, commands)], "state_interfaces": [*map(_interface, states)]}


def _interface(item: HardwareInterface) -> Fields:
    return {"data_type": "double", **vars(item)}


@robot_service("controller_manager_msgs/srv/ListHardwareComponents", "list_hardware_components", _NODE)
def _list_hardware_components(twin: Twin, robot: str, request: Any) -> Fields:
    manager, rate = twin.control.manager(robot), round(_plan(twin, robot).manager.update_rate)
    known = {
        kind: {item.name: item for item in items}
        for kind, items in zip(("command", "state"), manager.list_hardware_interfaces(), strict=True)
    }

    def interfaces(kind: str, names: tuple[str, ...]) -> list[Fields]:
        return [_interface(known[kind][name]) for name in names if name in known[kind]]

    return {
        "component": [
            {
                "name": item.name,
                "type": item.type,
                "rw_rate": rate,
                "plugin_name": item.plugin,
                "state": {"id": _STATES[item.state], "label": item.state},
                "command_interfaces": interfaces("command", item.command_interfaces),
                "state_interfaces": interfaces("state", item.state_interfaces),
            }
            for item in manager.list_hardware_components()
        ]
    }


@robot_service("controller_manager_msgs/srv/LoadController", "load_controller", _NODE)
def _load_controller(twin: Twin, robot: str, request: Any) -> Fields:
    return _ok(robot, twin.control.manager(robot).load_controller(request.name))


@robot_service("controller_manager_msgs/srv/ConfigureController", "configure_controller", _NODE)
def _configure_controller(twin: Twin, robot: str, request: Any) -> Fields:
    return _ok(robot, twin.control.manager(robot).configure_controller(request.name))


@robot_service("controller_manager_msgs/srv/UnloadController", "unload_controller", _NODE)
def _unload_controller(twin: Twin, robot: str, request: Any) -> Fields:
    return _ok(robot, twin.control.manager(robot).unload_controller(request.name))


@robot_service("controller_manager_msgs/srv/SwitchController", "switch_controller", _NODE)
def _switch_controller(twin: Twin, robot: str, request: Any) -> Fields:
    response = twin.control.manager(robot).switch_controller(
        request.activate_controllers, request.deactivate_controllers, int(request.strictness)
    )
    return {"ok": response.ok, "message": response.message}


@robot_service("controller_manager_msgs/srv/ReloadControllerLibraries", "reload_controller_libraries", _NODE)
def _reload_controller_libraries(twin: Twin, robot: str, request: Any) -> Fields:
    return {"ok": True}  # the twin's controllers are not in libraries: there is nothing to reload


def _ok(robot: str, response: Response) -> Fields:
    return {"ok": True} if response else refused(f"{robot}: controller_manager", response.message, "ok")
