"""``drake-twin action list|info|type|send_goal``: the actions of a running twin, as ``ros2 action`` has them."""

import argparse
import sys
import threading
import uuid
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.typed_names import typed_names
from drake_twin.tools.verb import Verb, run_verbs, yaml_values

if TYPE_CHECKING:
    from drake_twin.client import Client

_GOAL = "/_action/send_goal"
_STATUS = {1: "ACCEPTED", 2: "EXECUTING", 3: "CANCELING", 4: "SUCCEEDED", 5: "CANCELED", 6: "ABORTED"}


def _actions(client: "Client") -> dict[str, str]:
    """Return the actions, with their types."""
    return {
        name.removesuffix(_GOAL): kind.removesuffix("_SendGoal")
        for name, kind in client.services().items()
        if name.endswith(_GOAL)
    }


def _add_action(parser: ArgumentParser) -> None:
    parser.add_argument("action_name", metavar="ACTION", help="the action")


def _add_info(parser: ArgumentParser) -> None:
    _add_action(parser)
    parser.add_argument("-t", "--show-types", action="store_true", help="show the types, too")
    parser.add_argument("-c", "--count", action="store_true", help="print only how many there are")


def _info(client: "Client", options: argparse.Namespace) -> int:
    from drake_twin.wires.rmw_zenoh_format import CLIENT, SERVICE

    name = options.action_name
    print(f"Action: {name}")
    for kind, what in ((CLIENT, "clients"), (SERVICE, "servers")):
        found = {
            item.node: item.type.removesuffix("_SendGoal")
            for item in client.entities()
            if item.kind == kind and item.name == name + _GOAL
        }
        print(f"Action {what}: {len(found)}")
        for node, its in found.items() if not options.count else ():
            print(f"    {node} [{its}]" if options.show_types else f"    {node}")
    return 0


def _add_send_goal(parser: ArgumentParser) -> None:
    _add_action(parser)
    parser.add_argument("action_type", metavar="TYPE", help="its type, for example control_msgs/action/GripperCommand")
    parser.add_argument("goal", metavar="GOAL", nargs="?", default="{}", help="the goal as YAML, '{order: 5}'")
    parser.add_argument("--stdin", action="store_true", help="read it from the standard input")
    parser.add_argument("-f", "--feedback", action="store_true", help="print its feedback, too")


def _send_goal(client: "Client", options: argparse.Namespace) -> int:
    from drake_twin.client import full_name, made

    name, known = full_name(options.action_name), _actions(client)
    if name not in known:
        raise InputError(f"unknown action {name!r}", value=name, valid=known)
    kind = known[name]
    if options.action_type not in (kind, kind.replace("/action/", "/")):
        raise InputError(f"{name} is a {kind}, not a {options.action_type}", value=options.action_type, valid=[kind])
    goal = made(name, f"{kind}_Goal", yaml_values(sys.stdin.read() if options.stdin else options.goal) or {})
    print("Waiting for an action server to become available...")
    print(f"Sending goal:\n     {_text(goal)}")
    number = uuid.uuid4()
    goal_id = {"uuid": [*number.bytes]}

    early: list[str] = []  # what comes before the response is printed after it
    printing, is_accepted = threading.Lock(), False

    def feedback(message: Any) -> None:
        if bytes(message.goal_id.uuid) == number.bytes:
            text = f"Feedback:\n    {_text(message.feedback)}"
            with printing:
                if is_accepted:
                    print(text, flush=True)
                else:
                    early.append(text)

    if options.feedback:
        client.subscribe(f"{name}/_action/feedback", feedback)
    if not client.call(f"{name}/_action/send_goal", {"goal_id": goal_id, "goal": goal}).accepted:
        print("Goal was rejected.")
        return 0
    with printing:
        is_accepted = True
        print(f"Goal accepted with ID: {number.hex}\n", *early, sep="\n", flush=True)
    try:
        response = client.call(f"{name}/_action/get_result", {"goal_id": goal_id})
    except KeyboardInterrupt:
        print("Canceling goal...")
        cancelled = client.call(f"{name}/_action/cancel_goal", {"goal_info": {"goal_id": goal_id}})
        if not cancelled.goals_canceling:
            raise InputError(f"{name}: the goal cannot be cancelled") from None
        print("Goal canceled.")
        return 0
    print(f"Result:\n    {_text(response.result)}")
    print(f"Goal finished with status: {_STATUS.get(response.status, 'UNKNOWN')}")
    return 0


def _text(message: Any) -> str:
    from drake_twin.messages.text import message_text

    return message_text(message, None).removesuffix("---")


VERBS = {
    **typed_names("actions", _actions, have_hidden=False),
    "info": Verb("print who serves and calls an action", _add_info, _info),
    "send_goal": Verb("send a goal and wait for its result; Ctrl-C cancels it", _add_send_goal, _send_goal),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verbs("action", VERBS, arguments)


if __name__ == "__main__":
    sys.exit(main())
