"""The ROS 2 graph: the machine's own rclpy, Zenoh or DDS."""

import argparse
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from drake_twin.errors import InputError
from drake_twin.program import say
from drake_twin.wires.registry import Asset, WireKind, wire_kind

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin
    from drake_twin.wires.wire import Wire

_TRANSPORTS = ("rclpy", "zenoh", "dds")
_ANY = "any"  # of them, which the twin chooses
# Option → the transports that it is for.
_FOR = {
    "ros_host": ("zenoh", "dds"),
    "ros_domain": _TRANSPORTS,
    "ros_namespace": _TRANSPORTS,
    "ros_port": ("zenoh",),
    "ros_router": ("zenoh",),
    "ros_args": ("rclpy",),
    "lockstep": ("zenoh", "rclpy"),
}
_PORT = 7447
_LOCAL = "127.0.0.1"


@wire_kind
class RosKind(WireKind):
    """``--ros NAME``."""

    name = "ros"

    def add_options(self, group: argparse._ArgumentGroup) -> None:
        """Add its options."""
        group.add_argument(
            "--ros",
            nargs="?",
            const=_ANY,
            choices=(*_TRANSPORTS, _ANY),
            metavar="NAME",
            help="put the twin on the ROS 2 graph: through the rclpy of the ROS 2 that is sourced, or over zenoh or dds"
            " without one (services and actions of dds: rmw_cyclonedds_cpp only); without NAME, the first of them that"
            " is there",
        )
        group.add_argument(
            "--ros-host",
            metavar="ADDRESS",
            help="the address to be a Zenoh router on, where none runs on this machine, or of DDS's network interface"
            f" (default: {_LOCAL})",
        )
        group.add_argument("--ros-port", type=int, metavar="PORT", help=f"the router's port (default: {_PORT})")
        group.add_argument("--ros-router", metavar="HOST", help="connect to the Zenoh router on HOST or HOST:PORT")
        group.add_argument("--ros-domain", type=int, metavar="N", help="the ROS domain (default: ROS_DOMAIN_ID, or 0)")
        group.add_argument(
            "--ros-namespace",
            metavar="NAME",
            help="put a namespace before all topics, services and nodes, so that two twins can be on one domain",
        )
        group.add_argument(
            "--ros-args",
            nargs="*",
            default=[],
            metavar="ARGUMENT",
            help="arguments of ROS, up to -- or the end, for --ros rclpy: -r OLD:=NEW, --enclave PATH",
        )
        group.add_argument(
            "--lockstep",
            action="store_true",
            help="advance only when the services StepSimulation or SimulateSteps say so",
        )

    def check(self, options: argparse.Namespace) -> None:
        """Check its options."""
        for name in _given(options):
            option = f"--{name.replace('_', '-')}"
            if options.ros is None:
                needed = "" if _FOR[name] == _TRANSPORTS else f" {_FOR[name][0]}"
                raise InputError(f"{option} is about the ROS 2 graph: it needs --ros{needed}")
            if options.ros not in (*_FOR[name], _ANY):
                raise InputError(f"{option} is not for --ros {options.ros}: it needs --ros {' or '.join(_FOR[name])}")
        if options.ros_port is not None and not 1024 <= options.ros_port <= 65535:
            raise InputError(f"--ros-port {options.ros_port}: the router's port must be from 1024 to 65535")
        if options.ros_router is not None and options.ros_host is not None:
            raise InputError("--ros-router connects to a router, and --ros-host makes the twin one: give one of them")
        if options.ros is not None:
            from drake_twin.wires.ros_names import LARGEST_DOMAIN, domain_of_environment, is_name

            if options.ros_domain is None:
                domain_of_environment()
            elif not 0 <= options.ros_domain <= LARGEST_DOMAIN:
                raise InputError(f"--ros-domain {options.ros_domain}: a ROS domain is from 0 to {LARGEST_DOMAIN}")
            if options.ros_namespace is not None and not is_name(_namespace(options)):
                what = "it is not a namespace: use letters, digits and '_', with '/' between names"
                raise InputError(f"--ros-namespace {options.ros_namespace}: {what}")
            if options.ros_args:
                _check_arguments(options.ros_args)

    def is_wanted(self, options: argparse.Namespace) -> bool:
        """Tell whether the options ask for it."""
        return options.ros is not None

    def open(self, options: argparse.Namespace, asset: Asset, *, is_first: bool) -> "Wire":
        """Open it, and say where."""
        wire = _open_any(options) if options.ros == _ANY else _OPEN[options.ros](options, is_first)
        if options.ros_namespace is None:
            return wire
        from drake_twin.wires.namespaced_wire import NamespacedWire

        return NamespacedWire(wire, _namespace(options))

    def look_around(self, wire: "Wire", twin: "Twin") -> None:
        """Refuse a second twin with the same topics."""
        from drake_twin.twin.endpoints import PUBLISHED
        from drake_twin.wires.other_twins import SeesGraph, refuse_other_twin

        names = [item.name for item in twin.graph.endpoints if item.kind == PUBLISHED]
        refuse_other_twin(cast(SeesGraph, wire), names)

    def connected(self, options: argparse.Namespace, twin: "Twin") -> None:
        """Let time wait for requests of steps, if that is asked for."""
        twin.frames.lockstep = options.lockstep


def _namespace(options: argparse.Namespace) -> str:
    return f"/{options.ros_namespace.strip('/')}"


def _given(options: argparse.Namespace) -> list[str]:
    """Return which options are given beside ``--ros``."""
    values = ((name, getattr(options, name)) for name in _FOR)
    return [name for name, value in values if value not in (None, "", []) and value is not False]


def _check_arguments(words: list[str]) -> None:
    """Check arguments of ROS as far as they are about all nodes; ROS checks the others.

    Raises:
        InputError: If they would give all nodes of the twin one name or one namespace.
    """
    from drake_twin.ros2.ros_arguments import split_ros_arguments

    arguments = split_ros_arguments(words)
    if arguments.name is not None:
        what = f"--ros-args -r __node:={arguments.name} would give all nodes of the twin one name"
        raise InputError(f"{what}: write -r NODE:__node:={arguments.name} for one of them")
    if arguments.namespace is not None:
        what = f"--ros-args -r __ns:={arguments.namespace} would put all nodes of the twin into one namespace"
        raise InputError(f"{what}: --ros-namespace {arguments.namespace.strip('/')} goes before those that they have")
    if arguments.parameters:
        what = "the nodes have the parameters of the launch file and of the robots"
        say(f"warning: --ros-args: -p and --params-file have no effect on the twin: {what}", sys.stderr)


def _open_any(options: argparse.Namespace) -> "Wire":
    """Open the first wire of which there is what it needs, and say why it is this one; later it is the same one.

    Raises:
        InputError: If none of them takes the options, or the last of them cannot be opened.
    """
    given = _given(options)
    names = [name for name in _TRANSPORTS if all(name in _FOR[option] for option in given)]
    if not names:
        listed = ", ".join(f"--{name.replace('_', '-')}" for name in given)
        raise InputError(f"no way onto the ROS 2 graph takes {listed} together: leave one out")
    reasons: list[str] = []
    for name in names:
        is_there, reason = _is_there(name, options)
        is_last = name == names[-1]
        if is_there or is_last:
            say(f"ros: {name} is chosen, for {' and '.join(filter(None, (*reasons, reason)))}")
            try:
                wire = _OPEN[name](options, True)
            except InputError as error:
                if is_last:
                    raise
                say(f"ros: {error}", sys.stderr)
                reason = f"{name} cannot be used"
            else:
                options.ros = name
                break
        reasons.append(reason)
    return wire


def _is_there(name: str, options: argparse.Namespace) -> tuple[bool, str]:
    """Return whether a transport has what it needs, and the reason in words."""
    if name == "rclpy":
        from drake_twin.wires.rclpy_process import find_rclpy, sourced

        is_there = find_rclpy() is not None
        return is_there, f"ROS 2 {sourced()} is sourced" if is_there else "no ROS 2 with rclpy is sourced"
    if name == "zenoh":
        from drake_twin.wires.zenoh_session import router_answers

        if options.ros_router is not None:
            return True, "--ros-router is given"
        port = options.ros_port or _PORT
        is_there = router_answers(port)
        return is_there, f"{'a' if is_there else 'no'} Zenoh router answers at {_LOCAL}:{port}"
    return True, ""


def _open_zenoh(options: argparse.Namespace, is_first: bool) -> "Wire":
    from drake_twin.wires.zenoh_wire import ZenohWire

    host, port = options.ros_host or _LOCAL, options.ros_port or _PORT
    wire = ZenohWire(options.ros_domain, host, port, options.ros_router)
    if is_first:
        say(f"ros: domain {wire.domain} over Zenoh (RMW_IMPLEMENTATION=rmw_zenoh_cpp), {wire.place}")
        _say_that_it_is_open("port")
    return wire


def _open_dds(options: argparse.Namespace, is_first: bool) -> "Wire":
    from drake_twin.wires.dds_wire import DdsWire

    wire = DdsWire(options.ros_domain, options.ros_host or _LOCAL)
    if is_first:
        say(f"ros: domain {wire.domain} over DDS (RMW_IMPLEMENTATION=rmw_cyclonedds_cpp), {wire.place}")
        say("ros: other middlewares over DDS have the topics; services, actions and parameters are not for them")
        _say_that_it_is_open("participant")
    return wire


def _open_rclpy(options: argparse.Namespace, is_first: bool) -> "Wire":
    from drake_twin.wires.rclpy_wire import RclpyWire

    wire = RclpyWire(options.ros_domain, options.ros_args)
    if is_first:
        say(f"ros: domain {wire.domain} in {wire.place}")
        say("ros: every program that this ROS 2 lets onto the domain commands the robots", sys.stderr)
    return wire


def _say_that_it_is_open(what: str) -> None:
    say(f"ros: this protocol has no token: every program that reaches the {what} commands the robots", sys.stderr)


_OPEN: dict[str, Callable[[argparse.Namespace, bool], "Wire"]] = {
    "rclpy": _open_rclpy,
    "zenoh": _open_zenoh,
    "dds": _open_dds,
}
