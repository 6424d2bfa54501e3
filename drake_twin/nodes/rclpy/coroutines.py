"""Coroutines around callbacks."""

import inspect
from collections.abc import Callable, Coroutine
from typing import Any


async def await_or_execute(callback: Any, *args: Any) -> Any:
    """Await a coroutine function, or call another one; return what it returns."""
    return await callback(*args) if inspect.iscoroutinefunction(callback) else callback(*args)


async def result_of(coroutine: Coroutine[Any, Any, Any]) -> Any:
    """Await a coroutine, and return what it returns."""
    return await coroutine


async def followed(coroutine: Coroutine[Any, Any, Any], end: Callable[[], None]) -> Any:
    """Await what a callback returns, and call something at its end."""
    try:
        return await coroutine
    finally:
        end()
