"""``irobot_create_nodes/ui_mgr``: the lights, sounds and buttons of a Create 3, which can be neither seen nor heard.

Source: iRobotEducation/create3_sim, irobot_create_nodes/src/ui_mgr.cpp.
"""

from collections.abc import Callable
from typing import Any

import rclpy
from irobot_create_msgs.action import AudioNoteSequence, LedAnimation
from irobot_create_msgs.msg import AudioNoteVector, InterfaceButtons, LightringLeds
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.task import Future


class UserInterface(Node):
    """Accepts lights and notes; its actions last as long as they are asked to."""

    def __init__(self) -> None:
        super().__init__("ui_mgr")
        gazebo = self.declare_parameter("gazebo", "classic").value
        buttons = self.declare_parameter("button_topic", "interface_buttons").value
        lights = self.declare_parameter("lightring_topic", "cmd_lightring").value
        sounds = self.declare_parameter("audio_topic", "cmd_audio").value
        rate = self.declare_parameter("buttons_publish_rate", 1.0).value
        self.create_subscription(LightringLeds, lights, lambda message: None, qos_profile_sensor_data)
        self.create_subscription(AudioNoteVector, sounds, lambda message: None, qos_profile_sensor_data)
        if gazebo != "ignition":
            self._buttons = self.create_publisher(InterfaceButtons, buttons, 10)
            self.create_timer(1.0 / rate, self._publish_buttons)
        group = ReentrantCallbackGroup()
        for kind, name, run in (
            (LedAnimation, "led_animation", self._animate),
            (AudioNoteSequence, "audio_note_sequence", self._play),
        ):
            ActionServer(
                self, kind, name, run, callback_group=group, cancel_callback=lambda goal: CancelResponse.ACCEPT
            )

    def _publish_buttons(self) -> None:
        message = InterfaceButtons()
        message.header.frame_id, now = "base_link", self.get_clock().now().to_msg()
        message.header.stamp = now
        for name in ("button_1", "button_power", "button_2"):
            button = getattr(message, name)
            button.header.stamp, button.header.frame_id = now, name
        self._buttons.publish(message)

    async def _animate(self, goal: Any) -> Any:
        longest = Duration.from_msg(goal.request.max_runtime).nanoseconds
        gone = await self._last(
            goal, longest, lambda gone: LedAnimation.Feedback(remaining_runtime=_message(longest - gone))
        )
        return LedAnimation.Result(runtime=_message(gone))

    async def _play(self, goal: Any) -> Any:
        notes = [Duration.from_msg(note.max_runtime).nanoseconds for note in goal.request.note_sequence.notes]
        once, times = max(sum(notes), 1), goal.request.iterations
        longest = once * times if times >= 0 else 2**62

        def told(gone: int) -> Any:
            return AudioNoteSequence.Feedback(iterations_played=gone // once, current_runtime=_message(gone))

        gone = await self._last(goal, longest, told)
        played = times if gone >= longest else gone // once
        return AudioNoteSequence.Result(complete=gone >= longest, iterations_played=played, runtime=_message(gone))

    async def _last(self, goal: Any, longest: int, told: Callable[[int], Any]) -> int:
        """Let a goal last for a time (ns), or until it is canceled; return how long that was."""
        start, end = self.get_clock().now(), Future()

        def look() -> None:
            gone = (self.get_clock().now() - start).nanoseconds
            if (gone >= longest or goal.is_cancel_requested) and not end.done():
                end.set_result(gone)
            elif not end.done():
                goal.publish_feedback(told(gone))

        timer = self.create_timer(0.1, look)
        gone: int = await end
        self.destroy_timer(timer)
        if gone < longest:
            goal.canceled()
        else:
            goal.succeed()
        return gone


def _message(nanoseconds: int) -> Any:
    return Duration(nanoseconds=nanoseconds).to_msg()


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(UserInterface())
