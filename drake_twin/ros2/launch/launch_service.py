"""ROS's own runner of launch descriptions."""

from typing import Any

from drake_twin.errors import InputError


class LaunchService:
    """ROS's own runner of launch descriptions, which a launch file may import but not use here."""

    def __init__(self, *args: Any, **kwargs: Any):
        raise InputError("the launch file starts a launch service of its own, where it should only describe the launch")
