"""Loops of node programs that look again and again whether something has changed: ``while not self.done: pass``.

On a robot such a thread lets others run now and then; here it has the baton until it waits. So an iteration that has
only looked, and done nothing, ends with a wait: the next one would find the same until another thread has run, or time
has passed. Which iterations these are is seen in the program's text, so that a run repeats.
"""

import ast
import re
from importlib.machinery import ModuleSpec, SourceFileLoader
from math import inf
from types import CodeType, ModuleType
from typing import TypeGuard

from drake_twin.description.source_file import file_bytes
from drake_twin.nodes.task import Abandoned, here

_WAIT = "__wait_for_change__"
_LOOP = re.compile(rb"^[ \t]*while\b", re.MULTILINE)

# What changes nothing. A program's own `done()` might, so that after it the wait is until the next step at most.
_FUNCTIONS = frozenset(("abs", "all", "any", "bool", "callable", "float", "getattr", "hasattr", "int", "isinstance"))
_FUNCTIONS |= {"Duration", "enumerate", "len", "max", "min", "print", "range", "reversed", "sorted", "str", "zip"}
_METHODS = frozenset(("cancelled", "done", "empty", "full", "is_alive", "is_set", "locked", "ok", "poll", "qsize"))
_METHODS |= {"get_logger", "debug", "info", "warn", "warning", "error"}
_METHODS |= {"get_clock", "now", "time", "monotonic", "perf_counter", "Duration"}
_METHODS |= {"items", "keys", "values"}
_METHODS |= {"get_subscription_count", "count_publishers", "count_subscribers", "service_is_ready", "server_is_ready"}
_OPERATORS = (ast.boolop, ast.cmpop, ast.expr_context, ast.operator, ast.unaryop)
_PLAIN = (ast.BoolOp, ast.Compare, ast.Constant, ast.Name, ast.UnaryOp, *_OPERATORS)
_LOOKING = (
    *(*_PLAIN, ast.Attribute, ast.BinOp, ast.FormattedValue, ast.IfExp, ast.JoinedStr, ast.Slice, ast.Subscript),
    *(ast.Tuple, ast.keyword),
)


def compiled(source: bytes, file: str) -> CodeType:
    """Compile a module of a program, with waits in its loops that only look; see `prepare`.

    Raises:
        SyntaxError: If it is not Python.
        ValueError: If it has null bytes.
    """
    tree: ast.Module | bytes = source
    if _LOOP.search(source) is not None:
        tree = ast.parse(source, file)
        _Waits().visit(tree)
    code: CodeType = compile(tree, file, "exec", dont_inherit=True)
    return code


def prepare(module: ModuleType) -> None:
    """Give a module what the code of `compiled` needs."""
    vars(module)[_WAIT] = _wait_for_change


def with_waits(spec: ModuleSpec) -> ModuleSpec:
    """Return a module's spec with a loader that puts waits into its loops that only look."""
    if type(spec.loader) is SourceFileLoader and _LOOP.search(file_bytes(spec.loader.path)) is not None:
        spec.loader = _Loader(spec.name, spec.loader.path)
    return spec


class _Loader(SourceFileLoader):
    """Loads a module from its source, and leaves no compiled file of it."""

    def get_code(self, fullname: str) -> CodeType:
        return compiled(self.get_data(self.path), self.path)

    def exec_module(self, module: ModuleType) -> None:
        prepare(module)
        super().exec_module(module)


class _Waits(ast.NodeTransformer):
    """Puts waits at the ends of iterations that have only looked."""

    def __init__(self) -> None:
        self._count = 0

    def visit_While(self, loop: ast.While) -> ast.While:
        _note_repeated(loop)
        falls, continues = _idle_ends(loop.body)
        if not _is_looking(loop.test) or not (falls or continues):
            self.generic_visit(loop)
            return loop
        assigns = [part for part in ast.walk(loop) if isinstance(part, ast.Assign)]
        tests = [loop.test, *(part.test for part in ast.walk(loop) if isinstance(part, ast.If | ast.IfExp))]
        tests += [
            *(part.value for part in assigns),
            *(part.iter for part in ast.walk(loop) if isinstance(part, ast.For)),
        ]
        is_plain = all(isinstance(part, _PLAIN) for test in tests for part in ast.walk(test))
        self._count += 1
        flag = f"__has_acted_{self._count}__"
        wait = f"{flag} or {_WAIT}({is_plain})"
        if assigns:  # which may have ended the loop
            wait = f"{flag} or ({ast.unparse(loop.test)}) and {_WAIT}({is_plain})"
        body = [*_made(f"{flag} = False", loop.body[0]), *self._block(loop.body, flag, wait)]
        loop.body = [*body, *_made(wait, loop.body[-1])]
        loop.orelse = [self.visit(part) for part in loop.orelse]
        return loop

    def _block(self, block: list[ast.stmt], flag: str, wait: str) -> list[ast.stmt]:
        """Return statements of a loop, which note where they act and wait before the next iteration."""
        found: list[ast.stmt] = []
        for part in block:
            if isinstance(part, ast.Continue):
                found += [*_made(wait, part), part]
            elif isinstance(part, ast.If) and _is_looking(part.test):
                part.body, part.orelse = (self._block(each, flag, wait) for each in (part.body, part.orelse))
                found.append(part)
            elif (isinstance(part, ast.With) and _is_of_locks(part)) or _is_looking_for(part):
                part.body = self._block(part.body, flag, wait)
                found.append(part)
            elif _is_simple(part):
                found.append(part)
            else:
                found += [*_made(f"{flag} = True", part), self.visit(part)]
        return found


def _idle_ends(block: list[ast.stmt]) -> tuple[bool, bool]:
    """Return whether statements of a loop may be run through without acting, and whether one so meets `continue`."""
    continues = False
    for part in block:
        if isinstance(part, ast.Continue):
            return False, True
        if isinstance(part, ast.If) and _is_looking(part.test):
            ends = [_idle_ends(part.body), _idle_ends(part.orelse)]
            continues = continues or ends[0][1] or ends[1][1]
            falls = ends[0][0] or ends[1][0]
        elif isinstance(part, ast.With) and _is_of_locks(part):
            falls = _idle_ends(part.body)[0]
        elif _is_looking_for(part):
            falls = True  # it may have nothing to go through
        else:
            falls = _is_simple(part)
        if not falls:
            return False, continues
    return True, continues


def _is_of_locks(part: ast.With) -> bool:
    """Return whether a block holds locks only, and ends where it ends: nobody waits with a lock."""
    held = all(
        isinstance(item.context_expr, ast.Name | ast.Attribute) and not item.optional_vars for item in part.items
    )
    return held and not any(isinstance(each, ast.Continue) for each in ast.walk(part))


def _is_looking_for(part: ast.stmt) -> TypeGuard[ast.For]:
    """Return whether a ``for`` goes through what is there, and each time to its end or to that of the loop."""
    ends = (ast.Continue, ast.While)
    if not isinstance(part, ast.For) or part.orelse or not _is_looking(part.iter):
        return False
    return not any(isinstance(each, ends) for each in ast.walk(part))


def _note_repeated(loop: ast.While) -> None:
    """Mark the assignments of a loop that would find the same again: none uses what the loop assigns later, or itself.

    So ``angle = goal - self.yaw`` only looks, and ``count = count + 1`` does not.
    """
    assigned = [each for each in ast.walk(loop) if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)]
    for part in ast.walk(loop):
        if isinstance(part, ast.Assign) and all(map(_is_local, part.targets)):
            begin = (part.lineno, part.col_offset)
            later = {name.id for name in assigned if (name.lineno, name.col_offset) >= begin}
            used = {each.id for each in ast.walk(part.value) if isinstance(each, ast.Name)}
            vars(part)["is_repeated"] = not later & used


def _is_local(target: ast.expr) -> bool:
    return isinstance(target, ast.Name) or (isinstance(target, ast.Tuple) and all(map(_is_local, target.elts)))


def _is_simple(part: ast.stmt) -> bool:
    if isinstance(part, ast.Assign):
        return bool(vars(part).get("is_repeated")) and _is_looking(part.value)
    return isinstance(part, ast.Pass) or (isinstance(part, ast.Expr) and _is_looking(part.value))


def _is_looking(expression: ast.expr) -> bool:
    """Return whether the value of an expression is found without changing anything."""
    called = {id(part.func) for part in ast.walk(expression) if isinstance(part, ast.Call)}
    for part in ast.walk(expression):
        if id(part) in called:
            is_known = isinstance(part, ast.Name) and part.id in _FUNCTIONS
            if not is_known and not (isinstance(part, ast.Attribute) and part.attr in _METHODS):
                return False
        elif not isinstance(part, (*_LOOKING, ast.Call)):
            return False
    return True


def _made(text: str, place: ast.stmt) -> list[ast.stmt]:
    """Return statements of a text at the place of another one, whose line tracebacks show."""
    made = ast.parse(text).body
    for part in made:
        for each in ast.walk(part):
            ast.copy_location(each, place)
    return made


def _wait_for_change(is_plain: bool) -> None:
    """Wait until another thread of the program has run.

    Args:
        is_plain: Whether only a thread of the program can have changed something; if not, the next step ends it, too.
    """
    if (task := here()) is None:
        return
    program = task.program
    others = [other for other in program.threads if other is not task and not other.has_ended]
    is_alone = is_plain and not any(other.is_outside for other in others)
    if is_alone and not others and not program.handlers:
        program.stop("it is in a loop without end, as it has no other thread that could end it, and is ended")
        raise Abandoned
    if task.is_outside:
        task.enter()
    turns = program.turns
    task.wait(lambda: program.turns != turns, inf if is_alone else task.after)
