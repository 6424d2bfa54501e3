"""Stand-in for ``rclpy.wait_for_message``."""

from typing import Any

from drake_twin.nodes.rclpy.task import Future
from drake_twin.nodes.simulated_time import wait_until
from drake_twin.nodes.task import present_task


def wait_for_message(
    msg_type: Any, node: Any, topic: str, *, qos_profile: Any = 1, time_to_wait: float = -1
) -> tuple[bool, Any]:
    """Wait for the next message of a topic, at most for some simulation time (s)."""
    future = Future()
    subscription = node.create_subscription(msg_type, topic, future.set_result, qos_profile)
    try:
        if not wait_until(present_task(), subscription._is_ready, None if time_to_wait < 0 else time_to_wait):
            return False, None
        subscription._execute()
        return True, future.result()
    finally:
        node.destroy_subscription(subscription)
