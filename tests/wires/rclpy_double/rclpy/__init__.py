"""A double of rclpy: what the twin uses of it, as the real one did it (``../rclpy_recorded.json``).

Its graph is this process's, and another one's at ``RCLPY_DOUBLE``, the address of a socket (`wires.rclpy_network`).
"""

import os
import sys

import rclpy.types  # noqa: F401  # the message packages
from rclpy.graph import GRAPH, Context, Node, RCLError, UnknownROSArgsError

__all__ = ["Context", "Node", "Parameter", "create_node", "get_rmw_implementation_identifier", "init", "shutdown"]

if (middleware := os.environ.get("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")) != "rmw_cyclonedds_cpp":
    said = f"Expected RMW implementation identifier of '{middleware}' but instead found 'rmw_cyclonedds_cpp'"
    print(f"[ERROR] [1795724785.467556349] [rcl]: {said}, exiting with 102., at /src/check.c:154\n", file=sys.stderr)
    os._exit(102)


class Parameter:
    """A parameter's name and value."""

    def __init__(self, name, type_=None, value=None):
        self.name, self.value = name, value


def init(*, args=None, context=None, domain_id=None):
    """Parse the arguments as rcl does, as far as the twin's tests have them."""
    words = iter(args[args.index("--ros-args") + 1 :] if "--ros-args" in args else [])
    for word in words:
        if word not in ("-r", "--remap", "-p", "-e", "--enclave", "--log-level"):
            raise UnknownROSArgsError([word])
        value = next(words)
        if word in ("-r", "--remap"):
            old, separator, new = value.partition(":=")
            if not separator:
                place = "at /src/rcl/lexer_lookahead.c:239, at /src/rcl/arguments.c:380"
                raise RCLError(f"failed to initialize rcl: Couldn't parse remap rule: '-r {value}', {place}")
            context.remappings[old] = new
    context.is_valid = True


def create_node(name, *, namespace="/", context=None, enable_rosout=True, **_):
    """Return a new node."""
    if os.environ.get("CYCLONEDDS_URI") == "<nonsense":
        reason = "parser error expecting '/>' or '>' () at line 1 (line 1)"
        print(f"1795774557.250770 [81]     python: config: //CycloneDDS/Domain/#text: {reason}", file=sys.stderr)
        raise RCLError("error creating node: error not set, at /src/rcl/node.c:252")
    return Node(name, namespace, context, enable_rosout=enable_rosout)


def get_rmw_implementation_identifier():
    """Return the middleware."""
    return "rmw_cyclonedds_cpp"


def shutdown(*, context):
    """End a context."""
    context.is_valid = False
    GRAPH.close()
