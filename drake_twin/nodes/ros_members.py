"""The public members of ROS's Python packages, read from their sources: names and parameters only.

``python -m drake_twin.nodes.ros_members FOLDER... > drake_twin/nodes/ros_members.txt`` writes the list, where each
folder is the source of a Python package (``rclpy/rclpy``) or that of an installed one. A line is a member under the
shortest name by which it can be imported: ``rclpy.node.Node.create_publisher(msg_type, topic, ...)``.
"""

import ast
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

_NOT_FOR_USERS = ("Protocol", "TypedDict")  # classes for type checkers
Function = ast.FunctionDef | ast.AsyncFunctionDef


def parameters(function: Function) -> list[str]:
    """Return the names of a function's parameters, without ``self``; ``*rest`` and ``**rest`` with their stars."""
    given = function.args
    names = [item.arg for item in (*given.posonlyargs, *given.args)]
    names = names[1:] if names[:1] in (["self"], ["cls"]) else names
    names += ["*" + given.vararg.arg] if given.vararg else []
    names += [item.arg for item in given.kwonlyargs]
    return names + (["**" + given.kwarg.arg] if given.kwarg else [])


def statements(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield the statements of a module or a class, those of its conditions too, without those for type checkers."""
    for item in body:
        if isinstance(item, ast.If):
            if "TYPE_CHECKING" not in ast.unparse(item.test):
                yield from statements(item.body)
            yield from statements(item.orelse)
        elif isinstance(item, ast.Try):
            yield from statements((*item.body, *item.orelse))
            yield from statements(statement for handler in item.handlers for statement in handler.body)
        else:
            yield item


def assigned(item: ast.stmt) -> list[str]:
    """Return the names that a statement of a module or a class assigns to."""
    targets = item.targets if isinstance(item, ast.Assign) else [item.target] if isinstance(item, ast.AnnAssign) else []
    if isinstance(item, ast.Assign | ast.AnnAssign) and _called(item.value) == "TypeVar":
        return []
    return [name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)]


def attributes(function: Function) -> list[str]:
    """Return the attributes of ``self`` that a method assigns to."""
    return [
        item.attr
        for item in ast.walk(function)
        if isinstance(item, ast.Attribute)
        and isinstance(item.ctx, ast.Store)
        and isinstance(item.value, ast.Name)
        and item.value.id == "self"
    ]


def members_of_class(node: ast.ClassDef) -> dict[str, list[str] | None]:
    """Return a class's own public members, each with its parameters; None for one that is not called."""
    found: dict[str, list[str] | None] = {}
    for item in statements(node.body):
        if isinstance(item, Function):
            decorators = " ".join(map(ast.unparse, item.decorator_list))
            if "overload" in decorators:
                continue
            if item.name == "__init__":
                found |= {name: found.get(name) for name in attributes(item)}
            is_property = "property" in decorators or "setter" in decorators
            found.setdefault(item.name, None if is_property else parameters(item))
        elif isinstance(item, ast.ClassDef):
            found[item.name] = None
            found |= {f"{item.name}.{name}": given for name, given in members_of_class(item).items()}
        else:
            found |= dict.fromkeys(assigned(item))
    return {name: given for name, given in found.items() if not any(one.startswith("_") for one in name.split("."))}


def constructor(node: ast.ClassDef) -> list[str] | None:
    """Return the parameters of a class's own constructor; None without one."""
    found = [item for item in node.body if isinstance(item, Function) and item.name == "__init__"]
    return parameters(found[-1]) if found else None


def members(folder: Path) -> dict[str, list[str] | None]:
    """Return the public members of a package, each with its parameters; None for one that is not called."""
    exports: dict[str, str] = {}  # a definition's own name → the shortest by which it is exported
    trees = {
        _module(folder, file): ast.parse(file.read_text())
        for file in sorted(folder.rglob("*.py"))
        if file.stem != "conftest"
    }
    for module, tree in trees.items():
        if (folder.parent / module.replace(".", "/") / "__init__.py").is_file():
            for item in statements(tree.body):
                if isinstance(item, ast.ImportFrom):
                    source = f"{module}.{item.module}".rstrip(".") if item.level else str(item.module)
                    for alias in item.names:
                        full, name = f"{source}.{alias.name}", f"{module}.{alias.asname or alias.name}"
                        if full not in exports or len(name) < len(exports[full]):
                            exports[full] = name
    found: dict[str, list[str] | None] = {}
    for module, tree in trees.items():
        for item in statements(tree.body):
            if isinstance(item, ast.ClassDef) and not {*map(ast.unparse, item.bases)} & {*_NOT_FOR_USERS}:
                full = exports.get(f"{module}.{item.name}", f"{module}.{item.name}")
                found[full] = constructor(item)
                found |= {f"{full}.{name}": given for name, given in members_of_class(item).items()}
            elif isinstance(item, Function):
                found[exports.get(f"{module}.{item.name}", f"{module}.{item.name}")] = parameters(item)
            else:
                for name in assigned(item):
                    found[exports.get(f"{module}.{name}", f"{module}.{name}")] = None
    return {name: found[name] for name in sorted(found) if not any(part.startswith("_") for part in name.split("."))}


def lines(folders: Iterable[Path]) -> Iterator[str]:
    """Yield the list's lines."""
    for folder in folders:
        for name, given in members(folder).items():
            yield name if given is None else f"{name}({', '.join(given)})"


def read_members(text: str) -> dict[str, list[str] | None]:
    """Return what `lines` has written."""
    found: dict[str, list[str] | None] = {}
    for line in text.splitlines():
        name, bracket, rest = line.partition("(")
        found[name] = [one for one in rest.rstrip(")").split(", ") if one] if bracket else None
    return found


def _module(folder: Path, file: Path) -> str:
    parts = file.relative_to(folder.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _called(value: ast.expr | None) -> str:
    return ast.unparse(value.func).rpartition(".")[2] if isinstance(value, ast.Call) else ""


if __name__ == "__main__":
    print("\n".join(lines(map(Path, sys.argv[1:]))))
