"""The page of ROS's Python packages and what the twin has of them, generated from both.

Generate it by ``python -m drake_twin.nodes.docs > drake_twin/docs/ros_members.md``; a test compares the two.
"""

import ast
import inspect
import textwrap
from collections.abc import Iterator, Mapping
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any

from drake_twin.nodes.ros_members import attributes, parameters, read_members
from drake_twin.nodes.stand_ins import ROOTS
from drake_twin.nodes.stand_ins import stand_in as module_of_nodes
from drake_twin.ros2.stand_in_modules import stand_in as name_of_launch_files
from drake_twin.ros2.without_effect import AS_FINDINGS, WITHOUT_EFFECT

_MEMBERS = Path(__file__).parent / "ros_members.txt"
_PACKAGES = {"rclpy": "7.1.3", "launch": "3.4.3", "launch_ros": "0.26.6"}
_INTRODUCTION = """\
# ROS's Python packages

Nodes import `rclpy`, and launch files `launch` and `launch_ros`; in the twin they get stand-ins for them. These tables
have every public member of the packages of ROS 2 Jazzy ({versions}).

- *supported*: it does what ROS's does; what has a star accepts something
  [without an effect](#without-an-effect), and the reason is there;
- *a finding*: it raises `NotImplementedError`, which ends the node with its file and line, or the run says that it is
  ignored, with the file and line that ask for it;
- *absent*: an `ImportError` or `AttributeError`, which ends the node or the launch file with its file and line.

{numbers}

A test fails for a member that does nothing, and for a parameter that nothing reads, where the list of what is accepted
without an effect does not have them.

This page is written by `python -m drake_twin.nodes.docs`; a row is a class, or the functions and constants of a module.
"""


class Support(StrEnum):
    """What the twin has of a member."""

    SUPPORTED = "supported"
    FINDING = "a finding"
    ABSENT = "absent"


ATTRIBUTE = object()  # stands for a member that only objects have


@cache
def upstream() -> Mapping[str, list[str] | None]:
    """Return the members of ROS's packages, each with its parameters; None for one that is not called."""
    return read_members(_MEMBERS.read_text(encoding="utf-8"))


@cache
def ours(member: str) -> Any:
    """Return what stands for a member of ROS's packages; None where nothing does."""
    parts = member.split(".")
    for count in range(len(parts) - 1, 0, -1):
        try:
            found = _name(".".join(parts[:count]), parts[count])
        except (ModuleNotFoundError, AttributeError):
            continue
        for name in parts[count + 1 :]:
            found = _member(found, name)
        return found
    return None


def support(member: str) -> Support:
    """Return what the twin has of a member."""
    found = ours(member)
    if found is None:
        return Support.ABSENT
    function = function_of(found)
    return Support.FINDING if function is not None and _refuses(function) else Support.SUPPORTED


def function_of(found: Any) -> Any:
    """Return the function that is called with a member: of a class its own constructor; None without one."""
    if isinstance(found, type):
        found = found.__dict__.get("__init__")
    is_written = inspect.isfunction(found) and not found.__code__.co_filename.startswith("<")  # not a dataclass's
    return found if is_written else None


def does_nothing(function: Any) -> bool:
    """Return whether a function's body is empty, or only returns nothing, true or false."""
    body = [item for item in _tree(function).body if not _is_text(item)]
    return all(isinstance(item, ast.Pass) or (isinstance(item, ast.Return) and _is_plain(item.value)) for item in body)


def unread_parameters(function: Any) -> list[str]:
    """Return the parameters of a function that nothing in it reads; none of one that only raises an error."""
    tree = _tree(function)
    if isinstance(tree.body[-1], ast.Raise) and all(_is_text(item) for item in tree.body[:-1]):
        return []
    read = {item.id for item in ast.walk(tree) if isinstance(item, ast.Name) and isinstance(item.ctx, ast.Load)}
    return [name for name in (item.lstrip("*") for item in parameters(tree)) if name not in read]


def page() -> str:
    """Return the page as Markdown."""
    versions = ", ".join(f"{name} {version}" for name, version in _PACKAGES.items())
    sections = [_INTRODUCTION.format(versions=versions, numbers="\n".join(_numbers()))]
    for module, rows in _modules().items():
        sections.append(f"## `{module}`\n")
        sections.append("\n".join(["| | supported | a finding | absent |", "|---|---|---|---|", *_rows(rows), ""]))
    sections.append("## Without an effect\n")
    reasons: dict[str, list[str]] = {}
    for name, reason in WITHOUT_EFFECT.items():
        reasons.setdefault(reason, []).append(f"`{name}`")
    table = [f"| {', '.join(names)} | {reason} |" for reason, names in reasons.items()]
    sections.append("\n".join(["| accepted | why it does nothing |", "|---|---|", *table, ""]))
    return "\n".join(sections)


def _name(module: str, name: str) -> Any:
    if module.partition(".")[0] in ROOTS:
        return getattr(module_of_nodes(module), name)
    return name_of_launch_files(module, name)


def _member(found: Any, name: str) -> Any:
    try:
        value = inspect.getattr_static(found, name)
    except AttributeError:
        return ATTRIBUTE if isinstance(found, type) and name in _attributes(found) else None
    return value.__func__ if isinstance(value, staticmethod | classmethod) else value


@cache
def _attributes(kind: type) -> frozenset[str]:
    """Return the attributes that the methods of a class and of its bases assign to, and those that are declared."""
    found: set[str] = set()
    for each in kind.__mro__:
        found |= set(inspect.get_annotations(each))
        if each.__module__.startswith("drake_twin."):
            tree = ast.parse(textwrap.dedent(inspect.getsource(each)))
            found |= {name for item in ast.walk(tree) if isinstance(item, ast.FunctionDef) for name in attributes(item)}
    return frozenset(found)


@cache
def _tree(function: Any) -> ast.FunctionDef | ast.AsyncFunctionDef:
    (tree,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
    assert isinstance(tree, ast.FunctionDef | ast.AsyncFunctionDef)
    return tree


def _refuses(function: Any) -> bool:
    """Return whether a function only raises an error that says why; one without a text is for subclasses."""
    body = [item for item in _tree(function).body if not _is_text(item)]
    return len(body) == 1 and isinstance(body[0], ast.Raise) and isinstance(body[0].exc, ast.Call)


def _is_plain(value: ast.expr | None) -> bool:
    return value is None or (isinstance(value, ast.Constant) and value.value in (None, True, False))


def _is_text(item: ast.stmt) -> bool:
    return isinstance(item, ast.Expr) and isinstance(item.value, ast.Constant)


def _modules() -> dict[str, dict[str, list[str]]]:
    """Return the members by module and class; those of the module itself have the class ``""``."""
    found: dict[str, dict[str, list[str]]] = {}
    for member in upstream():
        parts = member.split(".")
        classes = [index for index, part in enumerate(parts) if part.strip("_")[:1].isupper() and index]
        begin = classes[0] if classes and len(parts) > classes[0] + 1 else len(parts) - 1
        is_class = begin < len(parts) - 1 or any(other.startswith(f"{member}.") for other in upstream())
        rows = found.setdefault(".".join(parts[:begin]), {})
        rows.setdefault(parts[begin] if is_class else "", []).append(member)
    return found


def _rows(rows: Mapping[str, list[str]]) -> Iterator[str]:
    for name, found in rows.items():
        by_support: dict[Support, list[str]] = {kind: [] for kind in Support}
        for member in found:
            own = member.rpartition(f".{name}.")[2] if name and not member.endswith(f".{name}") else ""
            shown = own or (f"{name}()" if name else member.rpartition(".")[2])
            start = f"{member}("
            mark = "\\*" if any(item == member or item.startswith(start) for item in WITHOUT_EFFECT) else ""
            by_support[support(member)].append(f"`{shown}`{mark}")
            by_support[Support.FINDING] += [
                f"`{shown.rstrip('()')}({item[len(start) :]}`" for item in AS_FINDINGS if item.startswith(start)
            ]
        cells = " | ".join(", ".join(by_support[kind]) for kind in Support)
        yield f"| {f'`{name}`' if name else ''} | {cells} |"


def _numbers() -> Iterator[str]:
    yield from ("| package | members | supported | a finding | absent |", "|---|---|---|---|---|")
    for package in _PACKAGES:
        kinds = [support(name) for name in upstream() if name.startswith(f"{package}.")]
        yield f"| `{package}` | {len(kinds)} | {' | '.join(str(kinds.count(kind)) for kind in Support)} |"


if __name__ == "__main__":
    print(page(), end="")
