"""The options that put a twin on the ROS 2 graph and into Foxglove, and its topics into a bag."""

import argparse
from pathlib import Path

from drake_twin.errors import InputError

WIRES = ("zenoh", "dds")
_PORT = 7447


def add_wires(group: argparse._ArgumentGroup) -> None:
    """Add the options."""
    group.add_argument(
        "--ros",
        choices=WIRES,
        metavar="NAME",
        help="put the twin on the ROS 2 graph, over zenoh (topics, services, actions) or dds (topics)",
    )
    group.add_argument(
        "--ros-host",
        metavar="ADDRESS",
        help="the address to be a Zenoh router on, where none runs on this machine, or of DDS's network interface"
        " (default: 127.0.0.1)",
    )
    group.add_argument("--ros-port", type=int, metavar="PORT", help=f"the router's port (default: {_PORT})")
    group.add_argument("--ros-router", metavar="HOST", help="connect to the Zenoh router on HOST or HOST:PORT")
    group.add_argument(
        "--lockstep", action="store_true", help="advance only when the services StepSimulation or SimulateSteps say so"
    )
    group.add_argument("--foxglove", action="store_true", help="serve the topics to Foxglove, on this machine only")
    group.add_argument(
        "--foxglove-control", action="store_true", help="let clients of Foxglove command and call services, too"
    )
    group.add_argument("--foxglove-host", metavar="ADDRESS", help="the address to listen on (default: 127.0.0.1)")
    group.add_argument("--foxglove-port", type=int, metavar="PORT", help="the port (default: 8765)")
    group.add_argument("--bag", type=Path, metavar="FOLDER", help="write the topics into a rosbag2 bag (MCAP)")
    group.add_argument(
        "--bag-topic", action="append", metavar="TOPIC", help="write only this topic into the bag (can be repeated)"
    )


def check_wires(options: argparse.Namespace) -> None:
    """Check the options.

    Raises:
        InputError: If a value is invalid, an option needs another one, or ``ROS_DOMAIN_ID`` is not a domain.
    """
    if options.bag_topic and options.bag is None:
        raise InputError("--bag-topic is about a bag: it needs --bag FOLDER")
    if options.bag is not None and options.watch:
        raise InputError("--bag writes one run into one folder, and --watch makes many: give one of them")
    for name in ("foxglove_control", "foxglove_host", "foxglove_port"):
        if getattr(options, name) and not options.foxglove:
            raise InputError(f"--{name.replace('_', '-')} is about Foxglove: it needs --foxglove")
    if options.foxglove_port is not None and not 1024 <= options.foxglove_port <= 65535:
        raise InputError(f"--foxglove-port {options.foxglove_port}: the port must be from 1024 to 65535")
    if options.ros is None:
        for name in ("ros_host", "ros_port", "ros_router", "lockstep"):
            if getattr(options, name):
                raise InputError(f"--{name.replace('_', '-')} is about the ROS 2 graph: it needs --ros zenoh")
        return
    if options.ros == "dds":
        for name in ("ros_port", "ros_router", "lockstep"):
            if getattr(options, name):
                raise InputError(
                    f"--{name.replace('_', '-')} is about the ROS 2 graph over Zenoh: it needs --ros zenoh"
                )
    if options.ros_port is not None and not 1024 <= options.ros_port <= 65535:
        raise InputError(f"--ros-port {options.ros_port}: the router's port must be from 1024 to 65535")
    if options.ros_router is not None and options.ros_host is not None:
        raise InputError("--ros-router connects to a router, and --ros-host makes the twin one: give one of them")
    from drake_twin.wires.ros_names import domain_of_environment

    domain_of_environment()
