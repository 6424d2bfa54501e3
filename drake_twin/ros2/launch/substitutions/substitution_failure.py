"""A substitution that cannot be performed."""

from drake_twin.errors import InputError
from drake_twin.ros2.packages import AbsentError


class SubstitutionFailure(InputError, RuntimeError):  # noqa: N818  # ROS's own name
    """Raised for a substitution that cannot be performed; launch files catch it."""


class AbsentFailure(AbsentError, SubstitutionFailure):  # noqa: N818  # as ROS's own name
    """Raised for a substitution that needs what this machine does not have."""
