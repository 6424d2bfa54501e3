"""The ROS 2 graph, over Zenoh or DDS."""

import argparse
import sys
from typing import TYPE_CHECKING, cast

from drake_twin.errors import InputError
from drake_twin.program import say
from drake_twin.wires.registry import Asset, WireKind, wire_kind

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin
    from drake_twin.wires.wire import Wire

_TRANSPORTS = ("zenoh", "dds")
_OF_ZENOH = ("ros_port", "ros_router", "lockstep")
_OF_ANY = ("ros_host", "ros_domain", "ros_namespace")
_PORT = 7447


@wire_kind
class RosKind(WireKind):
    """``--ros NAME``."""

    name = "ros"

    def add_options(self, group: argparse._ArgumentGroup) -> None:
        """Add its options."""
        group.add_argument(
            "--ros",
            choices=_TRANSPORTS,
            metavar="NAME",
            help="put the twin on the ROS 2 graph, over zenoh or dds (services and actions: rmw_cyclonedds_cpp only)",
        )
        group.add_argument(
            "--ros-host",
            metavar="ADDRESS",
            help="the address to be a Zenoh router on, where none runs on this machine, or of DDS's network interface"
            " (default: 127.0.0.1)",
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
            "--lockstep",
            action="store_true",
            help="advance only when the services StepSimulation or SimulateSteps say so",
        )

    def check(self, options: argparse.Namespace) -> None:
        """Check its options."""
        unused = {None: (*_OF_ANY, *_OF_ZENOH), "dds": _OF_ZENOH}.get(options.ros, ())
        for name in unused:
            value = getattr(options, name)
            if value not in (None, "") and value is not False:
                graph = "the ROS 2 graph" if options.ros is None else "the ROS 2 graph over Zenoh"
                raise InputError(f"--{name.replace('_', '-')} is about {graph}: it needs --ros zenoh")
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

    def is_wanted(self, options: argparse.Namespace) -> bool:
        """Tell whether the options ask for it."""
        return options.ros is not None

    def open(self, options: argparse.Namespace, asset: Asset, *, is_first: bool) -> "Wire":
        """Open it, and say where."""
        wire = (_open_dds if options.ros == "dds" else _open_zenoh)(options, is_first)
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


def _open_zenoh(options: argparse.Namespace, is_first: bool) -> "Wire":
    from drake_twin.wires.zenoh_wire import ZenohWire

    host, port = options.ros_host or "127.0.0.1", options.ros_port or _PORT
    wire = ZenohWire(options.ros_domain, host, port, options.ros_router)
    if is_first:
        say(f"ros: domain {wire.domain} over Zenoh (RMW_IMPLEMENTATION=rmw_zenoh_cpp), {wire.place}")
        _say_that_it_is_open("port")
    return wire


def _open_dds(options: argparse.Namespace, is_first: bool) -> "Wire":
    from drake_twin.wires.dds_wire import LOOPBACK, DdsWire

    wire = DdsWire(options.ros_domain, options.ros_host or LOOPBACK)
    if is_first:
        say(f"ros: domain {wire.domain} over DDS (RMW_IMPLEMENTATION=rmw_cyclonedds_cpp), {wire.place}")
        say("ros: other middlewares over DDS have the topics; services, actions and parameters are not for them")
        _say_that_it_is_open("participant")
    return wire


def _say_that_it_is_open(what: str) -> None:
    say(f"ros: this protocol has no token: every program that reaches the {what} commands the robots", sys.stderr)
