"""Marks the start of tests."""

from drake_twin.ros2.launch.action import Action


class ReadyToTest(Action):
    """Tells launch_testing that the tests may begin; does nothing here."""
