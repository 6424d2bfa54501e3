"""Small faults sown at random, room by room, and whether the tests that belong there see them.

    python tests/sampled_mutants.py ROOM [ROOM ...] [--count 20] [--seed 1] [--only FILE] [--list]

A fault is one changed operator, comparison, number, flag, condition or statement. Its tests are those that are named
after the module or that `mutant_list` names for it, then those of the modules of its room that import it, and others
that name what the module defines. One line a fault: what became of it, where it stood and what was changed. The exit
code is 1 when a room catches fewer than 85 % of its sample.
"""

import argparse
import ast
import random
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mutant_list import MUTANTS
from mutants import CAUGHT, PACKAGE, ROOT, SURVIVED, MutantError, copied_package, run_tests, written

LEAST_CAUGHT = 0.85
MOST_FILES = 8  # of tests for one fault
TIME_LIMIT = 240.0  # s for the tests of one fault

OTHER: dict[type, tuple[str, str]] = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}


@dataclass(frozen=True)
class Fault:
    """One change of a module's text.

    Attributes:
        file: The module, below the package.
        line: The line that changes.
        start: The first byte that is replaced.
        end: The byte behind the last one.
        replacement: What stands there instead.
        was: What stood there.
    """

    file: str
    line: int
    start: int
    end: int
    replacement: str
    was: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {' '.join(self.was.split())[:60]!r} → {self.replacement!r}"

    def text(self, original: str) -> str:
        """Return the module's text with the fault in it."""
        data = original.encode()
        return (data[: self.start] + self.replacement.encode() + data[self.end :]).decode()


class _Places(ast.NodeVisitor):
    """Collects the faults that a module may have."""

    def __init__(self, file: str, text: str) -> None:
        self.file, self.data, self.faults = file, text.encode(), list[Fault]()
        lines = text.split("\n")
        self._starts = [0]
        for line in lines:
            self._starts.append(self._starts[-1] + len(line.encode()) + 1)

    def _span(self, node: ast.AST) -> tuple[int, int]:
        start = self._starts[node.lineno - 1] + node.col_offset  # type: ignore[attr-defined]
        return start, self._starts[node.end_lineno - 1] + node.end_col_offset  # type: ignore[attr-defined]

    def _add(self, node: ast.AST, start: int, end: int, replacement: str) -> None:
        was = self.data[start:end].decode()
        self.faults.append(Fault(self.file, node.lineno, start, end, replacement, was))  # type: ignore[attr-defined]

    def _between(self, node: ast.AST, before: ast.AST, after: ast.AST, kind: type) -> None:
        """Change the operator that stands between two parts of an expression."""
        if kind not in OTHER:
            return
        start, end = self._span(before)[1], self._span(after)[0]
        word, other = OTHER[kind]
        pattern = word.replace(" ", r"\s+") if word[0] not in "+*" else re.escape(word)
        found = re.search(rb"(?<![=<>!*/\w])" + pattern.encode() + rb"(?![=\w*/])", self.data[start:end])
        if found is not None:
            self._add(node, start + found.start(), start + found.end(), other)

    def visit_Compare(self, node: ast.Compare) -> None:
        parts = [node.left, *node.comparators]
        for before, after, kind in zip(parts, parts[1:], node.ops, strict=False):
            self._between(node, before, after, type(kind))
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        text = any(isinstance(part, ast.JoinedStr | ast.List | ast.Tuple) for part in (node.left, node.right))
        if not text and not _is_text(node.left) and not _is_text(node.right):
            self._between(node, node.left, node.right, type(node.op))
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        for before, after in zip(node.values, node.values[1:], strict=False):
            self._between(node, before, after, type(node.op))
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        start, _ = self._span(node)
        if isinstance(node.op, ast.Not | ast.USub):
            self._add(node, start, self._span(node.operand)[0], "")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, bool):
            self._add(node, *self._span(node), str(not node.value))
        elif isinstance(node.value, int | float):
            self._add(node, *self._span(node), repr(node.value + 1) if node.value in (0, 1) else repr(node.value * 2))

    def visit_If(self, node: ast.If) -> None:
        start, end = self._span(node.test)
        self._add(node, start, end, f"not ({self.data[start:end].decode()})")
        self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Call):
            self._add(node, *self._span(node), "pass")
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self._between(node, node.target, node.value, type(node.op))
        self._add(node, *self._span(node), "pass")
        self.generic_visit(node)

    def visit_Return(self, node: ast.Return) -> None:
        if node.value is not None and not (isinstance(node.value, ast.Constant) and node.value.value is None):
            self._add(node, *self._span(node.value), "None")
        self.generic_visit(node)

    def visit_Continue(self, node: ast.Continue) -> None:
        self._add(node, *self._span(node), "break")

    def visit_Break(self, node: ast.Break) -> None:
        self._add(node, *self._span(node), "continue")

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Leave texts alone: what a sentence says is not what this asks."""

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        """Leave decorators alone: a dataclass that is frozen does nothing else."""
        for part in node.body:
            self.visit(part)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        for part in (*node.args.defaults, *(item for item in node.args.kw_defaults if item is not None), *node.body):
            self.visit(part)


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def faults_of(file: Path, package: Path) -> list[Fault]:
    """Return all faults that may be sown in a module."""
    text = file.read_text(encoding="utf-8")
    places = _Places(str(file.relative_to(package)), text)
    places.visit(ast.parse(text))
    return [fault for fault in places.faults if _compiles(fault, text)]


def _compiles(fault: Fault, text: str) -> bool:
    try:
        compile(fault.text(text), fault.file, "exec")
    except SyntaxError:
        return False
    return True


def sample(room: str, count: int, seed: int, only: str = "") -> list[Fault]:
    """Return faults in different places of a room: modules are drawn by their number of lines."""
    package = ROOT / PACKAGE
    files = [package / room] if room.endswith(".py") else sorted((package / room).rglob("*.py"))
    found = [fault for file in files for fault in faults_of(file, package) if only in fault.file]
    drawn = random.Random(f"{room} {seed}").sample(found, len(found))
    lines: dict[tuple[str, int], Fault] = {}
    for fault in drawn:
        lines.setdefault((fault.file, fault.line), fault)
    return list(lines.values())[:count]


def related_tests(file: str) -> list[str]:
    """Return the test files that may notice a fault in a module, those that are named after it first."""
    module = Path(file)
    room = module.parts[0] if len(module.parts) > 1 else ""
    tree = ast.parse((ROOT / PACKAGE / module).read_text(encoding="utf-8"))
    kinds = (ast.ClassDef, ast.FunctionDef)
    names = [node.name for node in tree.body if isinstance(node, kinds) and not node.name.startswith("_")]
    names = [name for name in names if name != "main"]  # every program has one
    dotted = ".".join((PACKAGE, *module.with_suffix("").parts))
    stand_in = ".".join(module.with_suffix("").parts[1:]) if len(module.parts) > 2 else dotted  # as `rclpy.qos`
    word = re.compile(rf"\b({'|'.join([re.escape(dotted), re.escape(stand_in), *names])})\b")
    imported = re.compile(rf"^from {re.escape(dotted.rpartition('.')[0])} import .*\b{module.stem}\b", re.MULTILINE)
    users = _users(module, dotted) if room else set()
    listed = {test for mutant in MUTANTS if mutant.files == module.as_posix() for test in mutant.tests}
    points: dict[str, float] = {}
    for path in sorted((ROOT / "tests").rglob("test_*.py")):
        test = path.relative_to(ROOT).as_posix()
        text = path.read_text(encoding="utf-8")
        count = len(word.findall(text))
        name = path.stem.removeprefix("test_")
        named = (module.stem in name) + (module.stem == name)
        in_room = room != "" and (f"tests/{room}/" in test or test == f"tests/test_{room}.py")
        is_users = in_room and name in users
        value = 100 * named * (1 + in_room) + 10 * min(count, 10) + 5 * in_room + 50 * is_users
        value += 150 * (test in listed) + 150 * (imported.search(text) is not None)
        if value > 5 or (in_room and value):
            points[test] = value
    return sorted(points, key=lambda test: (-points[test], test))[:MOST_FILES]


def _users(module: Path, dotted: str) -> set[str]:
    """Return the modules of the same room that import a module."""
    imports = re.compile(rf"^ *(from|import) {re.escape(dotted)}\b", re.MULTILINE)
    room = (ROOT / PACKAGE / module).parent
    return {file.stem for file in room.glob("*.py") if imports.search(file.read_text(encoding="utf-8"))}


def try_fault(fault: Fault, package: Path) -> str:
    """Sow a fault in a copy of the package, and return what became of it."""
    file = package / fault.file
    with written(file, fault.text(file.read_text(encoding="utf-8"))):
        return run_tests(package, related_tests(fault.file), TIME_LIMIT)


def try_room(room: str, count: int, seed: int, only: str) -> Iterator[tuple[Fault, str]]:
    """Sow a room's sample, one fault after the other.

    Raises:
        MutantError: If a fault's tests do not pass without it, as then it would count as caught.
    """
    passing: set[str] = set()
    with copied_package() as package:
        for fault in sample(room, count, seed, only):
            new = [test for test in related_tests(fault.file) if test not in passing]
            if new and run_tests(package, new, len(new) * TIME_LIMIT) != SURVIVED:
                raise MutantError(f"without a fault, these tests do not pass: {', '.join(new)}")
            passing.update(new)
            yield fault, try_fault(fault, package)


def main(arguments: Sequence[str] | None = None) -> int:
    """Sow faults, and print what became of each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rooms", metavar="ROOM", nargs="+", help="a folder or a module of the package")
    parser.add_argument("--count", type=int, default=20, help="faults in a room")
    parser.add_argument("--seed", type=int, default=1, help="which sample")
    parser.add_argument("--only", metavar="FILE", default="", help="only modules whose path has this")
    parser.add_argument("--list", action="store_true", help="print the sample, and try nothing")
    options = parser.parse_args(arguments)
    if options.list:
        for room in options.rooms:
            print(*sample(room, options.count, options.seed, options.only), sep="\n")
        return 0
    is_enough = True
    for room in options.rooms:
        results = []
        for fault, result in try_room(room, options.count, options.seed, options.only):
            results.append(result)
            print(f"{result:<9}{fault}", flush=True)
        caught = sum(result != SURVIVED for result in results)
        is_enough &= caught >= LEAST_CAUGHT * len(results)
        print(f"{room}: {caught} of {len(results)} {CAUGHT}", flush=True)
    return 0 if is_enough else 1


if __name__ == "__main__":
    sys.exit(main())
