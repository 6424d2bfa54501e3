"""``drake-twin service list|type|find|info|call``: the services of a running twin, as ``ros2 service`` has them."""

import argparse
import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.typed_names import typed_names
from drake_twin.tools.verb import Verb, positive, run_verbs, yaml_values

if TYPE_CHECKING:
    from drake_twin.client import Client


def _add_info(parser: ArgumentParser) -> None:
    parser.add_argument("service_name", metavar="SERVICE", help="the service")


def _info(client: "Client", options: argparse.Namespace) -> int:
    from drake_twin.wires.rmw_zenoh_format import CLIENT, SERVICE

    name, services = options.service_name, client.services()
    if name not in services:
        raise InputError(f"Unknown service {name!r}", value=name, valid=services)
    print(f"Type: {services[name]}")
    for kind, what in ((CLIENT, "Clients"), (SERVICE, "Services")):
        print(f"{what} count: {sum(item.kind == kind and item.name == name for item in client.entities())}")
    return 0


def _add_call(parser: ArgumentParser) -> None:
    parser.add_argument("service_name", metavar="SERVICE", help="the service")
    parser.add_argument("service_type", metavar="TYPE", help="its type, for example std_srvs/srv/Empty")
    parser.add_argument("values", metavar="VALUES", nargs="?", default="{}", help="the request as YAML, '{steps: 10}'")
    parser.add_argument("-r", "--rate", metavar="N", type=positive, help="repeat the call N times a second")


def _call(client: "Client", options: argparse.Namespace) -> int:
    from drake_twin.client import full_name, made
    from drake_twin.messages.text import call_text

    values, name = yaml_values(options.values), full_name(options.service_name)
    kind = client.service_type(name, options.service_type)
    request = made(name, f"{kind}_Request", values or {})
    while True:
        begin = time.monotonic()
        print(f"requester: making request: {call_text(request)}\n", flush=True)
        print(f"response:\n{call_text(client.call(name, request, kind))}\n", flush=True)
        if options.rate is None:
            return 0
        try:
            time.sleep(max(0.0, begin + 1 / options.rate - time.monotonic()))
        except KeyboardInterrupt:
            return 0


VERBS = {
    **typed_names("services", lambda client: client.services()),
    "info": Verb("print the type of a service and how many serve and call it", _add_info, _info),
    "call": Verb("call a service and print its response", _add_call, _call),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verbs("service", VERBS, arguments)


if __name__ == "__main__":
    sys.exit(main())
