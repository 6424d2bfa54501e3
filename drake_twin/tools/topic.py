"""``drake-twin topic``: the topics of a running twin, as ``ros2 topic`` has them."""

import argparse
import math
import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.stamps import set_times, without_words
from drake_twin.tools.topic_echo import add_echo, echo
from drake_twin.tools.topic_meters import add_bw, add_delay, add_hz, bw, delay, hz
from drake_twin.tools.typed_names import typed_names
from drake_twin.tools.verb import Now, Verb, positive, run_verbs, yaml_values

if TYPE_CHECKING:
    from drake_twin.client import Client
    from drake_twin.wires.rmw_zenoh_format import GraphEntity

_POLL = 0.1  # s between two counts of the subscribers


def _details(client: "Client", topics: Mapping[str, str]) -> str:
    """Return topics with the numbers of their publishers and subscribers."""
    from drake_twin.wires.rmw_zenoh_format import PUBLISHER, SUBSCRIPTION

    counts = Counter((item.kind, item.name) for item in client.entities())
    lines = []
    for kind, title, one in ((PUBLISHER, "Published", "publisher"), (SUBSCRIPTION, "Subscribed", "subscriber")):
        lines.append(f"{title} topics:")
        for name, its in topics.items():
            if count := counts[kind, name]:
                lines.append(f" * {name} [{its}] {count} {one}{'s' if count > 1 else ''}")
        lines.append("")
    return "\n".join(lines)


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
            print(_endpoint_text(item, what), end=end)
    return 0


def _endpoint_text(item: "GraphEntity", what: str) -> str:
    """Return what rclpy's ``TopicEndpointInfo`` prints of an endpoint."""
    namespace, _, node = item.node.rpartition("/")
    deadline, lifespan, lease = (
        "Infinite" if time is None else f"{time} nanoseconds"
        for time in (item.qos.deadline, item.qos.lifespan, item.qos.lease)
    )
    lines = (
        f"Node name: {node}",
        f"Node namespace: {namespace or '/'}",
        f"Topic type: {item.type}",
        f"Topic type hash: {item.hash}",
        f"Endpoint type: {what.upper()}",
        f"GID: {item.gid.hex('.')}",
        "QoS profile:",
        f"  Reliability: {'RELIABLE' if item.qos.is_reliable else 'BEST_EFFORT'}",
        f"  History (Depth): {f'KEEP_LAST ({item.qos.depth})' if item.qos.depth else 'KEEP_ALL'}",
        f"  Durability: {'TRANSIENT_LOCAL' if item.latched else 'VOLATILE'}",
        f"  Lifespan: {lifespan}",
        f"  Deadline: {deadline}",
        f"  Liveliness: {'MANUAL_BY_TOPIC' if item.qos.is_manual else 'AUTOMATIC'}",
        f"  Liveliness lease duration: {lease}",
    )
    return "\n".join(lines)


def _add_pub(parser: ArgumentParser) -> None:
    parser.add_argument("topic_name", metavar="TOPIC", help="the topic")
    parser.add_argument("message_type", metavar="TYPE", help="its type, for example std_msgs/msg/Float64MultiArray")
    words = "'auto' for a header and 'now' for a time are the time at which it is published"
    parser.add_argument(
        "values", metavar="VALUES", nargs="?", default="{}", help=f"the fields as YAML, '{{data: [1, 2]}}'; {words}"
    )
    parser.add_argument("--stdin", action="store_true", help="read them from the standard input")
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
    parser.add_argument("--max-wait-time-secs", metavar="S", type=positive, help="wait no longer (default: for ever)")
    Now.add_argument(parser)
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
    values = yaml_values(sys.stdin.read() if options.stdin else options.values)
    publisher = client.publisher(options.topic_name, options.message_type, must_exist=wanted > 0)
    values, stamps = without_words(publisher.type, values)
    message, now = made(publisher.topic, publisher.type, values), Now(client, options)

    def subscribers() -> int:
        return sum(item.kind == SUBSCRIPTION and item.name == publisher.topic for item in client.entities())

    try:
        if wanted and subscribers() < wanted:
            print(f"Waiting for at least {wanted} matching subscription(s)...", flush=True)
        end = time.monotonic() + (options.max_wait_time_secs or math.inf)
        while wanted and not (publisher.wait_for_subscriber(_POLL) and subscribers() >= wanted):
            if time.monotonic() > end:
                only = f"Expected {wanted} subcribers but only got {subscribers()} subscribers"
                print(f"Timed out waiting for subscribers: {only}", file=sys.stderr)
                return 1
            time.sleep(_POLL)
        print("publisher: beginning loop")
        count, due = 0, time.monotonic()
        while not times or count < times:
            time.sleep(max(0.0, due - time.monotonic()))
            count, due = count + 1, due + 1 / options.rate
            set_times(message, stamps, now())
            if options.print and count % options.print == 0:
                print(f"publishing #{count}: {call_text(message)}\n", flush=True)
            publisher.publish(message)
        time.sleep(options.keep_alive)
    except KeyboardInterrupt:
        pass
    return 0


VERBS = {
    **typed_names("topics", lambda client: client.topics(), details=_details),
    "info": Verb("print the type of a topic and who publishes and hears it", _add_info, _info),
    "echo": Verb("print the messages of a topic; Ctrl-C ends it", add_echo, echo),
    "hz": Verb("print how often messages arrive, by the wall clock; Ctrl-C ends it", add_hz, hz),
    "bw": Verb("print how many bytes arrive; Ctrl-C ends it", add_bw, bw),
    "delay": Verb("print how old messages with a stamp are; Ctrl-C ends it", add_delay, delay),
    "pub": Verb("publish messages on a topic; Ctrl-C ends it", _add_pub, _pub),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verbs("topic", VERBS, arguments)


if __name__ == "__main__":
    sys.exit(main())
