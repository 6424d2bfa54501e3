"""zenoh-ros2-sdk as a client of a running twin: a ROS 2 client over Zenoh that nobody here wrote."""

import contextlib
import threading
from collections.abc import Callable, Iterator
from typing import Any

from drake_twin.messages.interface_types import type_hash
from drake_twin.messages.store import type_store
from drake_twin.twin.twin import Twin


class RosClient:
    """A ROS 2 client on a router's port and in a domain."""

    def __init__(self, port: int, domain: int):
        self._where = {"router_port": port, "domain_id": domain}
        self._parts: list[Any] = []

    def subscribe(self, topic: str, kind: str, callback: Callable[[Any], None], **more: Any) -> Any:
        from zenoh_ros2_sdk import ROS2Subscriber

        self._know(kind)
        return self._add(ROS2Subscriber(topic, kind, callback, type_hash=type_hash(kind), **self._where, **more))

    def publisher(self, topic: str, kind: str) -> Any:
        from zenoh_ros2_sdk import ROS2Publisher

        self._know(kind)
        return self._add(ROS2Publisher(topic, kind, type_hash=type_hash(kind), **self._where))

    def service(self, name: str, kind: str) -> Any:
        from zenoh_ros2_sdk import ROS2ServiceClient

        self._know(f"{kind}_Request", f"{kind}_Response")
        return self._add(ROS2ServiceClient(name, kind, type_hash=type_hash(kind), timeout=60.0, **self._where))

    def serve(self, name: str, kind: str, answer: Callable[[Any], Any]) -> Any:
        from zenoh_ros2_sdk import ROS2ServiceServer

        self._know(f"{kind}_Request", f"{kind}_Response")
        return self._add(ROS2ServiceServer(name, kind, answer, type_hash=type_hash(kind), **self._where))

    def message(self, kind: str, **fields: Any) -> Any:
        from zenoh_ros2_sdk.session import ZenohSession

        return ZenohSession._instance.store.types[kind](**fields)

    def topics(self) -> dict[str, list[str]]:
        from zenoh_ros2_sdk.discovery import get_topic_names_and_types

        return dict(get_topic_names_and_types(**self._where))

    def close(self) -> None:
        from zenoh_ros2_sdk.session import ZenohSession

        for part in self._parts:
            part.close()
        if ZenohSession._instance is not None:
            ZenohSession._instance.close()

    def _add(self, part: Any) -> Any:
        self._parts.append(part)
        return part

    def _know(self, *kinds: str) -> None:
        """Give the client types that it would download otherwise."""
        from zenoh_ros2_sdk.session import ZenohSession

        session = ZenohSession.get_instance("127.0.0.1", self._where["router_port"])
        for kind in kinds:
            type_hash(kind)  # some are read only when they are asked for
        known = type_store().fielddefs
        session.store.register({name: fields for name, fields in known.items() if name not in session.store.fielddefs})
        session._registered_types |= {kind: kind for kind in kinds}


@contextlib.contextmanager
def ros_client(port: int, domain: int) -> Iterator[RosClient]:
    client = RosClient(port, domain)
    try:
        yield client
    finally:
        client.close()


def while_running(twin: Twin, work: Callable[[], Any], **run: Any) -> Any:
    """Run a twin until a thread beside it has done its work; return what that returns."""
    done: list[Any] = []

    def do() -> None:
        try:
            done.append(work())
        except BaseException as error:
            done.append(error)

    thread = threading.Thread(target=do)
    thread.start()
    twin.run(each_frame=thread.is_alive, **run)
    thread.join()
    if isinstance(done[0], BaseException):
        raise done[0]
    return done[0]
