"""A substitution that cannot be performed."""


class SubstitutionFailure(RuntimeError):  # noqa: N818  # ROS's own name
    """A substitution that cannot be performed."""
