"""Bounds on the Python expressions in xacro and launch files: ``${9**9**9}`` would block a twin for ever."""

import ast
import contextlib
import ctypes
import itertools
import operator
import threading
from collections.abc import Callable, Iterator
from functools import lru_cache
from types import CodeType
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import LOADER
from drake_twin.description.source_file import regular_open

_LONGEST = 30.0  # s for one file; the largest public robots take two
_MOST_EVALUATED = 50_000  # expressions of one file, which take some 10 s; the largest of 40 public robots has 965
_MOST_BITS = 1 << 16
_MOST_ITEMS = 1 << 24


class TooLongError(Exception):
    """Raised when the expressions of a file take too long."""

    def __str__(self) -> str:
        return f"its expressions and macros take longer than {_LONGEST:g} s"


class _Bounded(ast.NodeTransformer):
    """Replaces operators without a bound by functions with one."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        name = _OPERATORS.get(type(node.op))
        if name is None:
            return node
        call = ast.Call(ast.Name(name, ast.Load()), [node.left, node.right], [])
        return ast.copy_location(call, node)


def _power(base: Any, exponent: Any) -> Any:
    if isinstance(base, int) and isinstance(exponent, int) and base.bit_length() * abs(exponent) > _MOST_BITS:
        raise OverflowError(f"{base} ** {exponent} has too many digits")
    return base**exponent


def _shifted(value: Any, places: Any) -> Any:
    if isinstance(places, int) and places > _MOST_BITS:
        raise OverflowError(f"{value} << {places} has too many digits")
    return operator.lshift(value, places)


def _times(one: Any, other: Any) -> Any:
    for items, count in ((one, other), (other, one)):
        is_sequence = isinstance(items, str | bytes | list | tuple) and isinstance(count, int)
        if is_sequence and len(items) * count > _MOST_ITEMS:
            raise OverflowError(f"{count} times {len(items)} items are too many")
    return one * other


_OPERATORS = {ast.Pow: "xacro_power", ast.LShift: "xacro_shifted", ast.Mult: "xacro_times"}
_FUNCTIONS = {"xacro_power": _power, "xacro_shifted": _shifted, "xacro_times": _times}


@lru_cache(maxsize=8192)
def compile_bounded(text: str) -> tuple[CodeType, dict[str, Any]]:
    """Compile an expression whose results are bounded: ``9**9**9`` raises an OverflowError.

    Returns:
        The code, and the functions that replace operators in it, to be copied into its globals.
    """
    if not any(mark in text for mark in ("*", "<<")):
        return compile(text, "<expression>", "eval"), {}
    tree = ast.fix_missing_locations(_Bounded().visit(ast.parse(text, "<expression>", "eval")))
    return compile(tree, "<expression>", "eval"), _FUNCTIONS


def _quickly_loaded(stream: Any) -> Any:
    loader: Any = type("QuickLoader", (LOADER,), {"yaml_constructors": yaml.SafeLoader.yaml_constructors})
    return yaml.load(stream, Loader=loader)  # with the constructors that xacro has added


@contextlib.contextmanager
def quick_yaml() -> Iterator[None]:
    """Let xacro's ``load_yaml`` read with libyaml, which takes a tenth of the time."""
    plain = yaml.safe_load
    yaml.safe_load = _quickly_loaded
    try:
        yield
    finally:
        yaml.safe_load = plain


@contextlib.contextmanager
def bounded_expressions(xacro: Any) -> Iterator[None]:
    """Let xacro evaluate expressions with bounds on their size and their time.

    Args:
        xacro: Its module.

    Raises:
        TooLongError: If the expansion takes too long; raised in the thread that expands.
    """
    plain: Callable[..., Any] = xacro.safe_eval
    evaluated = itertools.count(1)

    def safe_eval(expr: str, globals: Any, locals: Any = None) -> Any:
        if next(evaluated) > _MOST_EVALUATED:
            raise xacro.XacroException(f"its macros evaluate more than {_MOST_EVALUATED:,} expressions")
        code, functions = compile_bounded(expr.strip())
        if invalid := [name for name in code.co_names if name.startswith("__")]:
            raise xacro.XacroException("Use of invalid name(s): ", ", ".join(invalid))
        globals.update(__builtins__=dict(functions))  # xacro gives no others
        return eval(code, globals, locals)

    thread, is_over = threading.get_ident(), threading.Lock()

    def interrupt() -> None:
        with is_over:
            if xacro.safe_eval is safe_eval:
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(TooLongError))

    xacro.open = regular_open  # a pipe would be waited for, which no time limit ends
    timer = threading.Timer(_LONGEST, interrupt)
    timer.daemon = True
    xacro.safe_eval = safe_eval
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        with is_over:
            xacro.safe_eval = plain
