"""The message packages of the double: the types of which the fields were recorded, as rosidl's Python classes are."""

import importlib.abc
import importlib.machinery
import json
import sys
import types
from pathlib import Path

FIELDS = json.loads((Path(__file__).parents[1] / "recorded_fields.json").read_text("utf-8"))
PACKAGES = {name.partition("/")[0] for name in FIELDS}


class Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds the packages and their modules ``msg``, ``srv`` and ``action``."""

    def find_spec(self, name, path, target=None):
        """Return a spec of a module."""
        package, _, kind = name.partition(".")
        is_there = package in PACKAGES and (not kind or any(one.startswith(f"{package}/{kind}/") for one in FIELDS))
        return importlib.machinery.ModuleSpec(name, self, is_package=not kind) if is_there else None

    def create_module(self, spec):
        """Return a new module with its classes."""
        module = types.ModuleType(spec.name)
        start = spec.name.replace(".", "/") + "/"
        for name in FIELDS:
            if "." in spec.name and name.startswith(start):
                _add(module, name, name.removeprefix(start).split("_"))
        return module

    def exec_module(self, module):
        """Nothing is left to do."""


def _add(place, name, parts):
    """Add a message's class, ``X``, or that of a part of a service or action, such as ``X_SendGoal_Request``."""
    if len(parts) == 1 or (place_of := _PARTS.get(parts[1])) is None:
        own = parts[-1] if len(parts) > 1 else parts[0]
        holder = place if len(parts) == 1 else _class(place, parts[0], name.rpartition("_")[0])
        vars_of = {"TYPE": name, "get_fields_and_field_types": classmethod(lambda cls: dict(FIELDS[name]))}
        setattr(holder, own, type(own, (_Message,), vars_of))
        return
    action = _class(place, parts[0], name.split("_")[0])
    impl = _class(action, "Impl", "")
    _add(impl, name, [place_of, *parts[2:]])


_PARTS = {"SendGoal": "SendGoalService", "GetResult": "GetResultService", "FeedbackMessage": "FeedbackMessage"}


def _class(place, name, kind):
    if not hasattr(place, name):
        setattr(place, name, type(name, (), {"TYPE": kind}))
    return getattr(place, name)


class _Message:
    """A message of the double, which is its bytes."""

    def __init__(self, data=b""):
        self.data = data


sys.meta_path.append(Finder())
