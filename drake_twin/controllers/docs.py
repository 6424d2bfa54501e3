"""The page of all controllers and their parameters, generated from the parameters' classes.

Generate it by ``python -m drake_twin.controllers.docs > drake_twin/docs/controllers.md``; a test compares the two.
"""

import dataclasses
import typing
from collections.abc import Mapping
from math import inf, isnan
from typing import Any

from drake_twin.controllers.deviations import DEVIATIONS
from drake_twin.controllers.registry import controller_class, controller_types
from drake_twin.description.declared_parameters import parameter_text
from drake_twin.description.parameters import parameter_names

_INTRODUCTION = """\
# Controllers and their parameters

These are the twin's controller types, with the names and defaults of ROS 2 Jazzy; the docstring of a controller's class
describes what it does. A parameter that is not listed is ignored with a warning, and so is a value other than the
default where the table says *ignored*. `<joint>` stands for the name of a joint, or of another item of a list.

This page is written by `python -m drake_twin.controllers.docs`.
"""

_TYPE_NAMES = {bool: "true or false", int: "whole number", float: "number", str: "text"}
_LIST_NAMES = {
    bool: "list of true or false",
    int: "list of whole numbers",
    float: "list of numbers",
    str: "list of texts",
}


def controllers_page() -> str:
    """Return the page as Markdown."""
    sections = [_INTRODUCTION, _deviations()]
    for parameters, types in _types_by_parameters().items():
        sections.append("## " + ", ".join(f"`{name}`" for name in types) + "\n")
        if any(parameters in getattr(other, "dialects", ()) for other in _types_by_parameters()):
            sections.append(f"{(parameters.__doc__ or '').partition(chr(10))[0]}\n")
        rows = [
            f"| `{name}` | {_type_name(annotation)} | {_default(item)} | {_meaning(parameters, name, item)} |"
            for name, item, annotation in parameter_names(parameters)
        ]
        sections.append("\n".join(["| parameter | type | default | meaning |", "|---|---|---|---|", *rows, ""]))
    return "\n".join(sections)


def _deviations() -> str:
    rows = [f"| {item.of} | {item.behavior} | {item.upstream} | {item.twin} | {item.why} |" for item in DEVIATIONS]
    header = ["| of | behavior | in ROS 2 Jazzy | in the twin | why |", "|---|---|---|---|---|"]
    return "\n".join(["## What differs from ROS 2 on purpose\n", *header, *rows, ""])


def _types_by_parameters() -> dict[type, list[str]]:
    """Return the controller types that have each parameters class."""
    found: dict[type, list[str]] = {}
    for name in controller_types():
        controller = controller_class(name)
        assert controller is not None
        if not controller.__module__.startswith(f"{__package__}."):
            continue  # a third party's
        for parameters in (controller.Parameters, *getattr(controller.Parameters, "dialects", ())):
            found.setdefault(parameters, []).append(name)
    return found


def _type_name(annotation: Any) -> str:
    if typing.get_origin(annotation) is tuple:
        return _LIST_NAMES[typing.get_args(annotation)[0]]
    if typing.get_origin(annotation) is Mapping:
        return f"{_TYPE_NAMES[typing.get_args(annotation)[1]]} for each name"
    return _TYPE_NAMES[annotation]


def _default(item: "dataclasses.Field[Any]") -> str:
    if item.default_factory is not dataclasses.MISSING:
        return f"`{_yaml(item.default_factory())}`"
    return "required" if item.default is dataclasses.MISSING else f"`{_yaml(item.default)}`"


def _yaml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(map(_yaml, value))}]"
    if isinstance(value, Mapping):
        return "{}"
    if isinstance(value, float) and (isnan(value) or value in (inf, -inf)):
        return ".nan" if isnan(value) else ".inf" if value > 0 else "-.inf"
    return repr(value) if isinstance(value, float) else str(value) or '""'


def _meaning(parameters: type, name: str, item: "dataclasses.Field[Any]") -> str:
    """Return the docstrings of a parameter and its parents, its bounds, and why it is ignored."""
    said = [text] if (text := parameter_text(parameters, name)) else []
    lower, upper, choices = (item.metadata.get(key) for key in ("lower", "upper", "choices"))
    if choices is not None:
        said.append("one of " + ", ".join(f"`{choice}`" for choice in choices))
    if lower is not None:
        said.append(f"at least {lower:g}")
    if upper is not None:
        said.append(f"at most {upper:g}")
    if "unsupported" in item.metadata:
        said.append(f"*ignored*: {item.metadata['unsupported']}")
    return "; ".join(text.rstrip(".") for text in said).replace("``", "`").replace("|", "\\|")


if __name__ == "__main__":
    print(controllers_page(), end="")
