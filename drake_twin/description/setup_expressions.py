"""The statements and expressions of setup.py files that name what is installed, evaluated without running Python.

The usual ways to write them are understood: strings joined with ``+``, ``os.path.join``, f-strings and ``format``,
``glob``, lists that are added and appended to, ``os.walk`` in a loop. Any other value is left out: a folder that is
installed as it is can be found in the source all the same.
"""

import ast
import os
from collections.abc import Iterator, Mapping
from configparser import Error as ConfigError
from configparser import RawConfigParser
from contextlib import suppress
from pathlib import Path
from typing import Any

from drake_twin.description.source_file import file_text

MOST_FILES = 10_000
_MOST_STATEMENTS = 100_000  # with loops unrolled
_LONGEST = 100_000  # characters of a string


def read_setup_py(package: Path) -> "SetupReader":
    """Return what a package's setup.py says; nothing, if it has none or it cannot be parsed."""
    reader = SetupReader(package)
    try:
        tree = ast.parse(file_text(package / "setup.py", errors="replace"))
    except (OSError, SyntaxError, ValueError, RecursionError):
        return reader
    reader.run(tree.body)
    return reader


def read_setup_cfg(package: Path) -> RawConfigParser:
    """Return a package's setup.cfg, where options keep their case; an empty one, if it has none or cannot be read."""
    parser = RawConfigParser()
    parser.optionxform = str  # type: ignore[assignment, method-assign]
    try:
        parser.read(package / "setup.cfg", encoding="utf-8")
    except (ConfigError, UnicodeDecodeError):
        parser.clear()
    return parser


class _Unknown(Exception):  # noqa: N818  # not an error: the value is simply not known
    """Raised for an expression that is not understood."""


class SetupReader:
    """Evaluates the few kinds of expressions in setup.py files, on the package's folder.

    Args:
        package: The folder with the setup.py.

    Attributes:
        data_files: The entries of ``data_files`` that were found.
        entry_points: The group of each entry point → its entries.
        package_dir: The Python packages whose folders have another name → those folders; "" for all others.
        packages: The Python packages that are named one by one.
        py_modules: The modules outside of Python packages.
    """

    def __init__(self, package: Path):
        self._package = package
        self._values: dict[str, Any] = {"__file__": str(package / "setup.py"), "__name__": "__main__"}
        self._functions: dict[str, ast.FunctionDef] = {}
        self._count = 0
        self._depth = 0
        self.data_files: list[Any] = []
        self.entry_points: dict[str, Any] = {}
        self.package_dir: dict[str, str] = {}
        self.packages: list[str] = []
        self.py_modules: list[str] = []

    def run(self, body: list[ast.stmt]) -> Any:
        """Evaluate statements; return the value of a ``return`` among them."""
        for statement in body:
            self._count += 1
            if self._count > _MOST_STATEMENTS:
                return None
            try:
                found = self._statement(statement)
            except _Unknown:
                continue
            if found is not None:
                return found
        return None

    def _statement(self, statement: ast.stmt) -> Any:
        if isinstance(statement, ast.Assign):
            value = self._value(statement.value)
            for target in statement.targets:
                self._assign(target, value)
        elif isinstance(statement, ast.AnnAssign) and statement.value is not None:
            self._assign(statement.target, self._value(statement.value))
        elif isinstance(statement, ast.AugAssign) and isinstance(statement.target, ast.Name):
            name = statement.target.id
            added = self._value(statement.value)
            self._values[name] = _sum(self._values.get(name, [] if isinstance(added, list) else ""), added)
        elif isinstance(statement, ast.For):
            for item in self._items(statement.iter):
                self._assign(statement.target, item)
                self.run(statement.body)
        elif isinstance(statement, ast.FunctionDef):
            self._functions[statement.name] = statement
        elif isinstance(statement, ast.If):
            return self.run(statement.body)  # mostly "if there is such a folder"
        elif isinstance(statement, ast.With | ast.Try):
            return self.run(statement.body)
        elif isinstance(statement, ast.Return) and statement.value is not None:
            return self._value(statement.value)
        elif isinstance(statement, ast.Expr):
            self._value(statement.value)
        return None

    def _assign(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self._values[target.id] = value
        elif isinstance(target, ast.Tuple) and isinstance(value, tuple | list) and len(target.elts) == len(value):
            for part, item in zip(target.elts, value, strict=True):
                self._assign(part, item)
        elif isinstance(target, ast.Subscript):
            place = self._value(target.value)
            if isinstance(place, dict):
                place[self._value(target.slice)] = value

    def _value(self, node: ast.expr) -> Any:
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.Name):
            if node.id in self._values:
                return self._values[node.id]
            raise _Unknown
        if isinstance(node, ast.JoinedStr):
            return "".join(
                str(self._value(part.value)) if isinstance(part, ast.FormattedValue) else str(self._value(part))
                for part in node.values
            )
        if isinstance(node, ast.List | ast.Tuple):
            return self._sequence(node)
        if isinstance(node, ast.Dict):
            keys = [self._value(key) for key in node.keys if key is not None]
            return dict(zip(keys, map(self._value, node.values), strict=False))
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            return self._added(node)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
            return f"{self._text(node.left)}/{self._text(node.right)}"  # pathlib
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod):
            return _percent(self._text(node.left), self._value(node.right))
        if isinstance(node, ast.IfExp):
            return self._value(node.body)
        if isinstance(node, ast.ListComp | ast.GeneratorExp):
            return list(self._comprehended(node))
        if isinstance(node, ast.Subscript):
            place = self._value(node.value)
            if isinstance(place, dict | list | tuple | str):
                try:
                    return place[self._value(node.slice)]
                except (KeyError, IndexError, TypeError):
                    raise _Unknown from None
        if isinstance(node, ast.Call):
            return self._called(node)
        raise _Unknown

    def _sequence(self, node: ast.List | ast.Tuple) -> Any:
        items: list[Any] = []
        for element in node.elts:
            try:
                if isinstance(element, ast.Starred):
                    items += self._items(element.value)
                else:
                    items.append(self._value(element))
            except _Unknown:
                if isinstance(node, ast.Tuple):
                    raise
        return items if isinstance(node, ast.List) else tuple(items)

    def _added(self, node: ast.BinOp) -> Any:
        """Evaluate a sum; where one of two lists is unknown, return the other."""
        sides = []
        for side in (node.left, node.right):
            try:
                sides.append(self._value(side))
            except _Unknown:
                continue
        if len(sides) == 2:
            return _sum(*sides)
        if sides and isinstance(sides[0], list):
            return sides[0]
        raise _Unknown

    def _comprehended(self, node: ast.ListComp | ast.GeneratorExp) -> Iterator[Any]:
        generator, *more = node.generators
        for item in self._items(generator.iter):
            self._assign(generator.target, item)
            if more:
                yield from self._comprehended(ast.ListComp(elt=node.elt, generators=more))
            else:
                try:
                    yield self._value(node.elt)
                except _Unknown:
                    continue

    def _items(self, node: ast.expr) -> list[Any]:
        value = self._value(node)
        if isinstance(value, dict):
            return list(value)
        if isinstance(value, list | tuple) and len(value) <= MOST_FILES:
            return list(value)
        raise _Unknown

    def _text(self, node: ast.expr) -> str:
        value = self._value(node)
        if isinstance(value, str):
            return value
        raise _Unknown

    def _called(self, node: ast.Call) -> Any:
        name = ast.unparse(node.func)
        last = name.rpartition(".")[2]
        if last == "setup":
            for keyword in sorted(node.keywords, key=lambda item: item.arg != "entry_points"):
                with suppress(_Unknown):
                    self._keyword(keyword)
            return None
        if isinstance(node.func, ast.Name) and name in self._functions:
            return self._own_function(self._functions[name], node)
        if last == "join" and name.endswith("path.join"):
            return os.path.join(*[self._text(argument) for argument in node.args])
        if last in ("glob", "iglob") and name in ("glob", "iglob", "glob.glob", "glob.iglob"):
            options = {keyword.arg: self._value(keyword.value) for keyword in node.keywords}
            return glob_in(self._package, self._text(node.args[0]), recursive=options.get("recursive") is True)
        if name == "os.walk":
            return _walk(self._package, self._text(node.args[0]))
        if name == "os.listdir":
            return sorted(entry.name for entry in _inside(self._package, self._text(node.args[0])).iterdir())
        if last in ("str", "Path", "PurePath", "normpath", "list", "sorted", "abspath") and node.args:
            return self._value(node.args[0])
        if isinstance(node.func, ast.Attribute):
            return self._method(self._value(node.func.value), node)
        raise _Unknown

    def _keyword(self, keyword: ast.keyword) -> None:
        """Take a keyword of ``setup()``."""
        if keyword.arg == "data_files":
            self.data_files += self._items(keyword.value)
        elif keyword.arg in ("packages", "py_modules"):
            getattr(self, keyword.arg).extend(item for item in self._items(keyword.value) if isinstance(item, str))
        elif keyword.arg in ("entry_points", "package_dir") and isinstance(found := self._value(keyword.value), dict):
            getattr(self, keyword.arg).update(found)

    def _method(self, of: Any, node: ast.Call) -> Any:
        assert isinstance(node.func, ast.Attribute)
        method, arguments = node.func.attr, [self._value(argument) for argument in node.args]
        if isinstance(of, list) and method in ("append", "extend") and len(arguments) == 1 and len(of) < MOST_FILES:
            of.extend(arguments if method == "append" else arguments[0])
            return None
        if isinstance(of, dict) and method in ("items", "keys", "values"):
            return [*{"items": of.items, "keys": of.keys, "values": of.values}[method]()]
        if isinstance(of, dict) and method == "setdefault" and len(arguments) == 2:
            return of.setdefault(*arguments)
        if isinstance(of, str) and method in ("format", "strip", "rstrip", "lstrip", "replace", "as_posix"):
            if method in ("format", "as_posix"):
                return _filled(of, arguments, {str(item.arg): self._value(item.value) for item in node.keywords})
            if all(isinstance(argument, str) for argument in arguments):
                return getattr(of, method)(*arguments)[:_LONGEST]
        raise _Unknown

    def _own_function(self, function: ast.FunctionDef, node: ast.Call) -> Any:
        if self._depth > 4:
            raise _Unknown
        outer, self._depth = dict(self._values), self._depth + 1
        names = [argument.arg for argument in function.args.args]
        given: dict[str, Any] = dict(zip(names, map(self._value, node.args), strict=False))
        defaults = function.args.defaults
        for name, default in zip(names[len(names) - len(defaults) :], defaults, strict=True):
            given.setdefault(name, self._value(default))
        given |= {keyword.arg: self._value(keyword.value) for keyword in node.keywords if keyword.arg is not None}
        self._values.update(given)
        try:
            return self.run(function.body)
        finally:
            self._values, self._depth = outer, self._depth - 1


def _sum(left: Any, right: Any) -> Any:
    if isinstance(left, list) and isinstance(right, list):
        return [*left, *right][:MOST_FILES]
    if isinstance(left, str) and isinstance(right, str):
        return (left + right)[:_LONGEST]
    raise _Unknown


def _percent(text: str, values: Any) -> str:
    try:
        return text % values if len(text) < _LONGEST and "*" not in text and text.count("%") < 10 else text
    except (TypeError, ValueError, KeyError):
        raise _Unknown from None


def _filled(text: str, arguments: list[Any], named: Mapping[str, Any]) -> str:
    """Format a string with plain ``{}``, ``{0}`` and ``{name}`` only."""
    for index, argument in enumerate(arguments):
        text = text.replace("{}", str(argument), 1).replace(f"{{{index}}}", str(argument))
    for name, value in named.items():
        text = text.replace(f"{{{name}}}", str(value))
    return text[:_LONGEST]


def _inside(package: Path, name: str) -> Path:
    """Return a folder of the package; any other is unknown."""
    path = Path(os.path.normpath(package / name))
    if not path.is_relative_to(package) or not path.is_dir():
        raise _Unknown
    return path


def glob_in(package: Path, pattern: str, *, recursive: bool) -> list[str]:
    """List the files of a package that match a pattern, relative to the package; hidden ones are left out."""
    below = Path(os.path.normpath(pattern))
    if below.is_absolute():
        if not below.is_relative_to(package):
            return []
        below = below.relative_to(package)
    if not below.parts or ".." in below.parts:
        return []
    text = str(below) if recursive else str(below).replace("**", "*")
    try:
        found = sorted(package.glob(text))
    except (ValueError, OSError):
        return []
    return [str(path.relative_to(package)) for path in found if not path.name.startswith(".")][:MOST_FILES]


def _walk(package: Path, folder: str) -> list[tuple[str, list[str], list[str]]]:
    found = []
    for path, folders, files in os.walk(_inside(package, folder)):
        found.append((os.path.relpath(path, package), sorted(folders), sorted(files)))
        if len(found) > MOST_FILES:
            break
    return found
