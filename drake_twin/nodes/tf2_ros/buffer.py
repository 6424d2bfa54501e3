"""Stand-in for ``tf2_ros.buffer``."""

from collections.abc import Callable
from functools import partial
from typing import Any

from drake_twin.nodes.message_classes import service_class
from drake_twin.nodes.rclpy.clock import Clock, JumpThreshold
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.logging import get_logger
from drake_twin.nodes.rclpy.task import Future
from drake_twin.nodes.tf2_py.buffer_core import BufferCore, nanoseconds
from drake_twin.nodes.tf2_ros.buffer_interface import BufferInterface
from drake_twin.nodes.tf2_ros.waiting import wait

__all__ = ["Buffer"]

_Check = Callable[[], tuple[int, str]]


class Buffer(BufferCore, BufferInterface):
    """Stores transforms, and looks up others between them.

    Args:
        cache_time: How long transforms are kept (a ``Duration``); 10 s by default.
        node: Offers its service ``tf2_frames``.
    """

    def __init__(self, cache_time: Any = None, node: Any = None):
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        self._new_data_callbacks: list[Callable[[], None]] = []
        if node is not None:
            self.srv = node.create_service(service_class("tf2_msgs/srv/FrameGraph"), "tf2_frames", self._tell_frames)
        self.clock = Clock() if node is None else node.get_clock()
        back = JumpThreshold(min_forward=None, min_backward=Duration(seconds=-1), on_clock_change=True)
        self.jump_handle = self.clock.create_jump_callback(back, post_callback=self.time_jump_callback)

    def time_jump_callback(self, time_jump: Any) -> None:
        """Forget all transforms after a jump back in time."""
        get_logger("tf2_buffer").warning("Detected jump back in time. Clearing tf buffer.")
        self.clear()

    def lookup_transform(self, target_frame: str, source_frame: str, time: Any, timeout: Any = None) -> Any:
        """Return the ``TransformStamped`` that takes data of the source frame into the target frame.

        Args:
            target_frame: The frame to transform into.
            source_frame: The frame of the data.
            time: The time; zero is the latest time that all transforms between them have.
            timeout: How long (simulation time) it waits for the transform.

        Raises:
            TransformException: If it cannot be computed.
        """
        self.can_transform(target_frame, source_frame, time, timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = None,
    ) -> Any:
        """Return the transform from one frame at one time to another at another, by way of a fixed frame.

        Raises:
            TransformException: If it cannot be computed.
        """
        where = (target_frame, target_time, source_frame, source_time, fixed_frame)
        self.can_transform_full(*where, timeout)
        return self.lookup_transform_full_core(*where)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any = None,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether there is a transform, and on request why not."""
        found = _awaited(partial(self.can_transform_core, target_frame, source_frame, time), timeout)
        return found if return_debug_tuple else found[0]

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = None,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether there is a transform between two times, and on request why not."""
        where = (target_frame, target_time, source_frame, source_time, fixed_frame)
        found = _awaited(partial(self.can_transform_full_core, *where), timeout)
        return found if return_debug_tuple else found[0]

    async def lookup_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """Return the transform when there is one."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform_core(target_frame, source_frame, time)

    async def lookup_transform_full_async(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Any:
        """Return the transform between two times when there is one."""
        where = (target_frame, target_time, source_frame, source_time, fixed_frame)
        await self.wait_for_transform_full_async(*where)
        return self.lookup_transform_full_core(*where)

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Future:
        """Return a future that has the transform as its result when there is one."""
        where = (target_frame, source_frame, time)
        return self._future(partial(self.can_transform_core, *where), partial(self.lookup_transform_core, *where))

    def wait_for_transform_full_async(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Future:
        """Return a future that has the transform between two times as its result when there is one."""
        where = (target_frame, target_time, source_frame, source_time, fixed_frame)
        return self._future(
            partial(self.can_transform_full_core, *where), partial(self.lookup_transform_full_core, *where)
        )

    def _future(self, check: _Check, look_up: Callable[[], Any]) -> Future:
        future = Future()

        def look() -> None:
            if not check()[0]:
                return
            if look in self._new_data_callbacks:
                self._new_data_callbacks.remove(look)
            if not future.done():
                future.set_result(look_up())

        self._new_data_callbacks.append(look)
        look()
        return future

    def _insert(self, transform: Any, authority: str, *, is_static: bool) -> None:
        super()._insert(transform, authority, is_static=is_static)
        for callback in tuple(self._new_data_callbacks):
            callback()

    def _tell_frames(self, request: Any, response: Any) -> Any:
        response.frame_yaml = self.all_frames_as_yaml()
        return response


def _awaited(check: _Check, timeout: Any) -> tuple[int, str]:
    """Return what a check finds, at the latest after a time-out."""
    if timeout is not None:
        wait(lambda: bool(check()[0]), nanoseconds(timeout, "duration"))
    return check()
