"""Stand-ins for ``launch.some_entities_type``, which launch files use in annotations."""

from typing import Any

__all__ = ["SomeActionsType", "SomeEntitiesType"]

SomeEntitiesType = Any
SomeActionsType = Any
