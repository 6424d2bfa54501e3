"""Poses of robots from the command line."""

import sys

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError


class ParseMultiRobotPose:
    """Poses of robots from a command-line argument: ``robots:="r1={x: 1.0, y: 2.0}; r2={x: 3.0}"``."""

    def __init__(self, target_argument: str):
        prefix = f"{target_argument}:="
        self._text = next((word[len(prefix) :] for word in sys.argv if word.startswith(prefix)), "")

    def value(self) -> dict[str, dict[str, float]]:
        """Return robot → x, y, z, roll, pitch, yaw (m, rad).

        Raises:
            InputError: If the argument is not a list of poses.
        """
        robots: dict[str, dict[str, float]] = {}
        for part in self._text.split(";"):
            name, equals, pose = part.partition("=")
            if equals:
                given = load_yaml(pose)
                if not isinstance(given, dict):
                    raise InputError(f"{part.strip()!r} is not a robot's name and pose such as r1={{x: 1.0, y: 2.0}}")
                known = {"x": 0.0, "y": 0.0, "z": 0.0, "roll": 0.0, "pitch": 0.0, "yaw": 0.0}
                robots[name.strip()] = known | {key: float(value) for key, value in given.items()}
        return robots
