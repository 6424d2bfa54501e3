"""``drake-twin topic list|echo|hz|info|pub``: the topics of a running twin, as ``ros2 topic`` has them."""

import argparse
import math
import sys
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import is_dataclass
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.verb import Arrivals, Verb, listing, positive, run_verbs, yaml_values

if TYPE_CHECKING:
    from drake_twin.client import Client

_PERIOD = 1.0  # s between two lines of `hz`
_LONGEST = 128  # as `ros2 topic echo` cuts sequences and texts
_POLL = 0.1  # s between two counts of the subscribers


def _add_info(parser: ArgumentParser) -> None:
    parser.add_argument("topic_name", metavar="TOPIC", help="the topic")
    parser.add_argument("-v", "--verbose", action="store_true", help="show the nodes, type hashes and QoS, too")


def _info(client: "Client", options: argparse.Namespace) -> int:
    from drake_twin.client import full_name
    from drake_twin.wires.rmw_zenoh_format import PUBLISHER, SUBSCRIPTION

    name, topics, end = full_name(options.topic_name), client.topics(), "\n\n" if options.verbose else "\n"
    if name not in topics:
        raise InputError(f"unknown topic {name!r}", value=name, valid=topics)
    print(f"Type: {topics[name]}", end=end)
    for kind, what in ((PUBLISHER, "Publisher"), (SUBSCRIPTION, "Subscription")):
        entities = [item for item in client.entities() if item.kind == kind and item.name == name]
        print(f"{what} count: {len(entities)}", end=end)
        for item in entities if options.verbose else ():
            namespace, _, node = item.node.rpartition("/")
            durability = "TRANSIENT_LOCAL" if item.latched else "VOLATILE"
            print(f"Node name: {node}\nNode namespace: {namespace or '/'}\nTopic type: {item.type}")
            print(f"Topic type hash: {item.hash}\nEndpoint type: {what.upper()}", end="\n")
            print(f"QoS profile:\n  Durability: {durability}", end=end)
    return 0


def _add_echo(parser: ArgumentParser) -> None:
    parser.add_argument("topic_name", metavar="TOPIC", help="the topic")
    parser.add_argument("message_type", metavar="TYPE", nargs="?", help="its type; by default what the graph says")
    parser.add_argument("--once", action="store_true", help="end after the first message")
    parser.add_argument("--field", help="print only this field, for example pose.pose.position")
    parser.add_argument("-f", "--full-length", action="store_true", help="do not cut long arrays and texts")
    parser.add_argument(
        "-l", "--truncate-length", type=int, metavar="N", default=_LONGEST, help="where to cut them (default: 128)"
    )
    parser.add_argument("--flow-style", action="store_true", help="print a message on one line")


def _echo(client: "Client", options: argparse.Namespace) -> int:
    from drake_twin.messages.text import message_text

    if options.truncate_length < 0:
        raise InputError(f"--truncate-length {options.truncate_length} is negative")
    longest = None if options.full_length else options.truncate_length
    arrivals, lost = Arrivals(), 0
    client.subscribe(options.topic_name, arrivals.put, options.message_type)
    try:
        for message in arrivals:
            if arrivals.lost > lost:
                change, lost = arrivals.lost - lost, arrivals.lost
                text = f"A message was lost!!!\n\ttotal count change:{change}\n\ttotal count: {lost}\n---"
                print(text, file=sys.stderr)
            chosen = message if options.field is None else _field(message, options.field)
            print(message_text(chosen, longest, flow_style=options.flow_style), flush=True)
            if options.once:
                break
    except KeyboardInterrupt:
        pass
    return 0


def _field(message: Any, path: str) -> Any:
    from drake_twin.messages.text import field_names

    for name in filter(None, path.split(".")):
        known = field_names(message) if is_dataclass(message) else []
        if name not in known:
            raise InputError(f"--field {path}: unknown field {name!r}", value=name, valid=known)
        message = getattr(message, name)
    return message


def _add_hz(parser: ArgumentParser) -> None:
    parser.add_argument("topic_name", metavar="TOPIC", help="the topic")
    parser.add_argument(
        "-w", "--window", type=int, metavar="N", default=10_000, help="average over so many (default: 10000)"
    )


def _hz(client: "Client", options: argparse.Namespace) -> int:
    if options.window < 1:
        raise InputError(f"--window {options.window}: the average is of at least one period")
    arrivals, last = Arrivals(), 0
    periods: deque[int] = deque(maxlen=options.window)
    client.subscribe(options.topic_name, lambda message: arrivals.put(time.monotonic_ns()))
    printed, due = True, time.monotonic() + _PERIOD
    try:
        while True:
            arrived = arrivals.get(due - time.monotonic())
            if arrived is not None:
                if last:
                    periods.append(arrived - last)
                    printed = False
                last = arrived
            if time.monotonic() >= due:
                due += _PERIOD
                if not printed:
                    print(rate_text(periods), flush=True)
                printed = True
    except KeyboardInterrupt:
        if not printed:
            print(rate_text(periods), flush=True)
    return 0


def rate_text(periods: Sequence[int]) -> str:
    """Return what ``ros2 topic hz`` prints for the periods (ns) between messages."""
    mean = math.fsum(periods) / len(periods)
    deviation = math.sqrt(math.fsum((period - mean) ** 2 for period in periods) / len(periods))
    rate = 1e9 / mean if mean > 0 else 0.0
    shortest, longest = min(periods) * 1e-9, max(periods) * 1e-9
    return (
        f"average rate: {rate:.3f}\n"
        f"\tmin: {shortest:.3f}s max: {longest:.3f}s std dev: {deviation * 1e-9:.5f}s window: {len(periods)}"
    )


def _add_pub(parser: ArgumentParser) -> None:
    parser.add_argument("topic_name", metavar="TOPIC", help="the topic")
    parser.add_argument("message_type", metavar="TYPE", help="its type, for example std_msgs/msg/Float64MultiArray")
    parser.add_argument(
        "values", metavar="VALUES", nargs="?", default="{}", help="the fields as YAML, '{data: [1, 2]}'"
    )
    parser.add_argument("-r", "--rate", metavar="N", type=positive, default=1.0, help="messages a second (default: 1)")
    parser.add_argument("-p", "--print", metavar="N", type=int, default=1, help="print every N-th (default: 1)")
    times = parser.add_mutually_exclusive_group()
    times.add_argument("-1", "--once", action="store_true", help="publish one message and end")
    times.add_argument("-t", "--times", metavar="N", type=int, default=0, help="publish so many messages and end")
    parser.add_argument(
        "-w",
        "--wait-matching-subscriptions",
        metavar="N",
        type=int,
        default=1,
        help="wait for so many subscribers (default: 1); with 0, a topic without subscribers is published, too",
    )
    parser.add_argument(
        "--keep-alive", metavar="N", type=positive, default=0.1, help="stay so long after the last (s; default: 0.1)"
    )


def _pub(client: "Client", options: argparse.Namespace) -> int:
    from drake_twin.client import made
    from drake_twin.messages.text import call_text
    from drake_twin.wires.rmw_zenoh_format import SUBSCRIPTION

    if options.times < 0 or options.wait_matching_subscriptions < 0:
        raise InputError("--times and --wait-matching-subscriptions are whole numbers from 0")
    times, wanted = 1 if options.once else options.times, options.wait_matching_subscriptions
    values = yaml_values(options.values)
    publisher = client.publisher(options.topic_name, options.message_type, must_exist=wanted > 0)
    message = made(publisher.topic, publisher.type, values)

    def subscribers() -> int:
        return sum(item.kind == SUBSCRIPTION and item.name == publisher.topic for item in client.entities())

    try:
        if wanted and subscribers() < wanted:
            print(f"Waiting for at least {wanted} matching subscription(s)...", flush=True)
        while wanted and not (publisher.wait_for_subscriber(_POLL) and subscribers() >= wanted):
            time.sleep(_POLL)
        print("publisher: beginning loop")
        count, due = 0, time.monotonic()
        while not times or count < times:
            time.sleep(max(0.0, due - time.monotonic()))
            count, due = count + 1, due + 1 / options.rate
            if options.print and count % options.print == 0:
                print(f"publishing #{count}: {call_text(message)}\n", flush=True)
            publisher.publish(message)
        time.sleep(options.keep_alive)
    except KeyboardInterrupt:
        pass
    return 0


VERBS = {
    "list": listing("topics", lambda client: client.topics()),
    "echo": Verb("print the messages of a topic; Ctrl-C ends it", _add_echo, _echo),
    "hz": Verb("print how often messages arrive, by the wall clock; Ctrl-C ends it", _add_hz, _hz),
    "info": Verb("print the type of a topic and who publishes and hears it", _add_info, _info),
    "pub": Verb("publish messages on a topic; Ctrl-C ends it", _add_pub, _pub),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verbs("topic", VERBS, arguments)


if __name__ == "__main__":
    sys.exit(main())
