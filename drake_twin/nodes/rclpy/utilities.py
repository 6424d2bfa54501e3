"""Stand-in for ``rclpy.utilities``."""

import sys
from typing import Any

from drake_twin.nodes.rclpy.context import default_context
from drake_twin.ros2.ros_arguments import split_ros_arguments


def get_default_context(*, shutting_down: bool = False) -> Any:
    return default_context(shutting_down=shutting_down)


def remove_ros_args(args: list[str] | None = None) -> list[str]:
    return list(split_ros_arguments(list(sys.argv if args is None else args)).arguments)


def ok(*, context: Any = None) -> bool:
    return bool((context or default_context()).ok())


def shutdown(*, context: Any = None) -> None:
    (context or default_context(shutting_down=True)).shutdown()


def try_shutdown(*, context: Any = None) -> None:
    (context or default_context(shutting_down=True)).try_shutdown()


def get_rmw_implementation_identifier() -> str:
    return "drake_twin"


def get_available_rmw_implementations() -> set[str]:
    return {"drake_twin"}


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    return -1 if timeout_sec is None or timeout_sec < 0 else int(timeout_sec * 1e9)
