"""Stand-ins for ``launch_ros.remap_rule_type``, which launch files use in annotations."""

from typing import Any

__all__ = ["SomeRemapRule", "SomeRemapRules"]

SomeRemapRule = Any
SomeRemapRules = Any
