"""``drake-twin control``: the controller managers of a running twin, as ``ros2 control`` has them."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.verb import Verb, positive, run_verbs

if TYPE_CHECKING:
    from drake_twin.client import Client

_LIST = "/list_controllers"
_BEST_EFFORT, _STRICT = 1, 2  # controller_manager_msgs/srv/SwitchController
# Option → its heading, and the fields of ControllerState below it.
_LISTS = {
    "claimed_interfaces": ("claimed interfaces", ("claimed_interfaces",)),
    "required_command_interfaces": ("required command interfaces", ("required_command_interfaces",)),
    "required_state_interfaces": ("required state interfaces", ("required_state_interfaces",)),
    "chained_interfaces": ("chained to interfaces", ()),
    "reference_interfaces": ("exported reference interfaces", ("reference_interfaces",)),
    "exported_interfaces": ("exported state interfaces", ("exported_state_interfaces",)),
}


def _add_manager(parser: ArgumentParser) -> None:
    parser.add_argument(
        "-c",
        "--controller-manager",
        metavar="NODE",
        help="the controller manager, such as /robot_1/controller_manager (default: the only one; lists show all)",
    )


def _managers(client: "Client", name: str | None) -> list[str]:
    """Return the controller managers that are meant.

    Raises:
        InputError: If that name is unknown.
    """
    from drake_twin.client import full_name

    managers = [service.removesuffix(_LIST) for service in client.services() if service.endswith(_LIST)]
    if name is None:
        if not managers:
            raise InputError("no controller manager is on the graph: the robots have no controllers")
        return managers
    if full_name(name) not in managers:
        raise InputError(f"unknown controller manager {name!r}", value=full_name(name), valid=managers)
    return [full_name(name)]


def _manager(client: "Client", options: argparse.Namespace) -> str:
    """Return the one controller manager that is meant.

    Raises:
        InputError: If that name is unknown, or there are several and none is named.
    """
    managers = _managers(client, options.controller_manager)
    if len(managers) > 1:
        raise InputError("which controller manager is meant? Give -c", valid=managers)
    return managers[0]


def _headed(managers: Sequence[str]) -> Iterator[str]:
    """Yield the controller managers, each after its name if there are several."""
    for manager in managers:
        if len(managers) > 1:
            print(f"{manager}:")
        yield manager


def _add_list(parser: ArgumentParser) -> None:
    for option, (heading, _) in _LISTS.items():
        parser.add_argument(f"--{option.replace('_', '-')}", action="store_true", help=f"show the {heading}, too")
    parser.add_argument("-v", "--verbose", action="store_true", help="show all of them, and the update rate")
    _add_manager(parser)


def _list(client: "Client", options: argparse.Namespace) -> int:
    for manager in _headed(_managers(client, options.controller_manager)):
        controllers = client.call(manager + _LIST).controller
        if not controllers:
            print("No controllers are currently loaded!")
            continue
        widths = [max(len(getattr(item, field)) for item in controllers) for field in ("name", "type", "state")]
        for item in controllers:
            print(f"{item.name:<{widths[0]}} {item.type:<{widths[1]}}  {item.state:<{widths[2]}}")
            _print_interfaces(item, options)
    return 0


def _print_interfaces(controller: Any, options: argparse.Namespace) -> None:
    if options.verbose:
        print(f"\tupdate_rate: {controller.update_rate} Hz\n\tis_async: {controller.is_async}")
    chained = [name for item in controller.chain_connections for name in item.reference_interfaces]
    for option, (heading, fields) in _LISTS.items():
        if options.verbose or getattr(options, option):
            names = [name for field in fields for name in getattr(controller, field)] if fields else chained
            print("\n".join([f"\t{heading}:", *(f"\t\t{name}" for name in names)]))


def _add_switch(parser: ArgumentParser) -> None:
    parser.add_argument("--deactivate", nargs="*", metavar="NAME", default=[], help="controllers to deactivate")
    parser.add_argument("--activate", nargs="*", metavar="NAME", default=[], help="controllers to activate")
    strictness = parser.add_mutually_exclusive_group()
    strictness.add_argument("--strict", action="store_true", help="switch all or none")
    strictness.add_argument("--best-effort", action="store_true", help="switch those that can be (default)")
    parser.add_argument("--activate-asap", action="store_true", help="has no effect: all are switched at one step")
    parser.add_argument("--switch-timeout", metavar="S", type=positive, default=5.0, help="has no effect, likewise")
    _add_manager(parser)


def _switch(client: "Client", options: argparse.Namespace) -> int:
    if not options.activate and not options.deactivate:
        raise InputError("name the controllers: --activate NAME … or --deactivate NAME …")
    request = {
        "activate_controllers": options.activate,
        "deactivate_controllers": options.deactivate,
        "strictness": _STRICT if options.strict else _BEST_EFFORT,
        "activate_asap": options.activate_asap,
        "timeout": options.switch_timeout,
    }
    response = client.call(f"{_manager(client, options)}/switch_controller", request)
    print(response.message, file=sys.stdout if response.ok else sys.stderr)
    return 0 if response.ok else 1


def _add_interfaces(parser: ArgumentParser) -> None:
    parser.add_argument("-v", "--verbose", action="store_true", help="show their data types, too")
    _add_manager(parser)


def _interfaces(client: "Client", options: argparse.Namespace) -> int:
    for manager in _headed(_managers(client, options.controller_manager)):
        found = client.call(f"{manager}/list_hardware_interfaces")
        print("command interfaces")
        for item in sorted(found.command_interfaces, key=lambda item: item.name):
            available = "available" if item.is_available else "unavailable"
            claimed = "claimed" if item.is_claimed else "unclaimed"
            print(f"\t{item.name}{_data_type(item, options)} [{available}] [{claimed}]")
        print("state interfaces")
        for item in sorted(found.state_interfaces, key=lambda item: item.name):
            print(f"\t{item.name}{_data_type(item, options)}")
    return 0


def _data_type(item: Any, options: argparse.Namespace) -> str:
    return f" [{item.data_type}]" if options.verbose else ""


def _types(client: "Client", options: argparse.Namespace) -> int:
    for manager in _headed(_managers(client, options.controller_manager)):
        found = client.call(f"{manager}/list_controller_types")
        for its, base in zip(found.types, found.base_classes, strict=True):
            print(f"{its:70s} {base}")
    return 0


def _components(client: "Client", options: argparse.Namespace) -> int:
    for manager in _headed(_managers(client, options.controller_manager)):
        for number, item in enumerate(client.call(f"{manager}/list_hardware_components").component, 1):
            print(f"Hardware Component {number}\n\tname: {item.name}\n\ttype: {item.type}")
            print(f"\tplugin name: {item.plugin_name}\n\tstate: id={item.state.id} label={item.state.label}")
            print(f"\tread/write rate: {item.rw_rate} Hz\n\tis_async: {item.is_async}\n\tcommand interfaces")
            for its in item.command_interfaces:
                print(f"\t\t{_available(its, options)} [{'claimed' if its.is_claimed else 'unclaimed'}]")
            if options.verbose:
                print(
                    "\n".join(
                        ["\tstate interfaces", *(f"\t\t{_available(its, options)}" for its in item.state_interfaces)]
                    )
                )
    return 0


def _available(item: Any, options: argparse.Namespace) -> str:
    return f"{item.name}{_data_type(item, options)} [{'available' if item.is_available else 'unavailable'}]"


def _add_controller(parser: ArgumentParser) -> None:
    parser.add_argument("controller_name", metavar="NAME", help="the controller")
    _add_manager(parser)


def _add_load(parser: ArgumentParser) -> None:
    _add_controller(parser)
    parser.add_argument("--set-state", choices=("inactive", "active"), help="configure it, and activate it")


def _load(client: "Client", options: argparse.Namespace) -> int:
    manager, name = _manager(client, options), options.controller_name
    if any(item.name == name for item in client.call(manager + _LIST).controller):
        print(f"Controller : {name} already loaded, skipping load_controller!")
    elif not client.call(f"{manager}/load_controller", {"name": name}).ok:
        print(f"Failed loading controller {name} check controller_manager logs")
        return 1
    else:
        print(f"Successfully loaded controller {name}")
    if options.set_state is not None:
        if not client.call(f"{manager}/configure_controller", {"name": name}).ok:
            print(f"Error configuring controller : {name}")
            return 1
        if options.set_state == "active" and not _set_active(client, manager, name, is_active=True):
            print(f"Error activating controller : {name}, check controller_manager logs")
            return 1
        print(f"Successfully loaded controller {name} into state {options.set_state}")
    return 0


def _unload(client: "Client", options: argparse.Namespace) -> int:
    name = options.controller_name
    if not client.call(f"{_manager(client, options)}/unload_controller", {"name": name}).ok:
        print(f"Error unloading controller {name}, check controller_manager logs")
        return 1
    print(f"Successfully unloaded controller {name}")
    return 0


def _set_active(client: "Client", manager: str, name: str, *, is_active: bool) -> bool:
    names = {"activate_controllers" if is_active else "deactivate_controllers": [name]}
    request = {**names, "strictness": _STRICT, "activate_asap": True, "timeout": 5.0}
    return bool(client.call(f"{manager}/switch_controller", request).ok)


def _add_state(parser: ArgumentParser) -> None:
    parser.add_argument("controller_name", metavar="NAME", help="the controller")
    parser.add_argument("state", choices=("inactive", "active"), help="the state that it is to have")
    _add_manager(parser)


def _set_state(client: "Client", options: argparse.Namespace) -> int:
    manager, name, state = _manager(client, options), options.controller_name, options.state
    found = [item.state for item in client.call(manager + _LIST).controller if item.name == name]
    if not found:
        print(f"controller {name} does not seem to be loaded", file=sys.stderr)
        return 1
    now = found[0]
    if state == "inactive" and now == "unconfigured":
        doing, done = "configuring", "configured"
        is_done = client.call(f"{manager}/configure_controller", {"name": name}).ok
    elif (state, now) in (("inactive", "active"), ("active", "inactive")):
        doing, done = ("activating", "activated") if state == "active" else ("stopping", "deactivated")
        is_done = _set_active(client, manager, name, is_active=state == "active")
    else:
        refused = f"cannot activate {name}" if state == "active" else f"cannot put {name} in 'inactive' state"
        print(f"{refused} from its current state {now}", file=sys.stderr)
        return 1
    if not is_done:
        print(f"Error {doing} controller, check controller_manager logs", file=sys.stderr)
        return 1
    print(f"Successfully {done} {name}")
    return 0


VERBS = {
    "list_controllers": Verb("list the loaded controllers", _add_list, _list),
    "list_controller_types": Verb("list the types of controllers that there are", _add_manager, _types),
    "load_controller": Verb("load a controller, and configure and activate it if asked for", _add_load, _load),
    "unload_controller": Verb("unload a controller", _add_controller, _unload),
    "set_controller_state": Verb("configure, activate or deactivate a controller", _add_state, _set_state),
    "switch_controllers": Verb("activate and deactivate controllers", _add_switch, _switch),
    "list_hardware_components": Verb("list the hardware with its state and interfaces", _add_interfaces, _components),
    "list_hardware_interfaces": Verb("list the command and state interfaces", _add_interfaces, _interfaces),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verbs("control", VERBS, arguments)


if __name__ == "__main__":
    sys.exit(main())
