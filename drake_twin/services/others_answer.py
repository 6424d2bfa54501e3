"""Services that other packages answer: one that fails is refused from then on, and the twin continues."""

from collections.abc import Callable, Generator
from functools import partial
from typing import Any

from drake_twin.messages.interface_types import make_response
from drake_twin.services.registry import Fields, Later, Service
from drake_twin.twin.others_code import OthersCode
from drake_twin.twin.twin import Twin


def others_answer(twin: Twin, service: Service) -> Callable[..., Fields | Later]:
    """Return the answer of a service of another package, guarded.

    Args:
        twin: The twin.
        service: The service, whose answer takes the twin before the request.
    """
    code = OthersCode.of(twin, f"service {service.name}")
    return partial(_answer, code, service)


def _answer(code: OthersCode, service: Service, *arguments: Any) -> Fields | Later:
    answer = code.call(service.answer, *arguments)
    return _later(code, service, answer) if isinstance(answer, Generator) else _checked(code, service, answer)


def _later(code: OthersCode, service: Service, answer: Later) -> Later:
    def proceed() -> tuple[bool, Any]:
        try:
            return False, next(answer)
        except StopIteration as end:
            return True, end.value

    while True:
        has_ended, value = code.call(proceed)
        if has_ended:
            return _checked(code, service, value)
        yield value


def _checked(code: OthersCode, service: Service, fields: Any) -> Fields:
    code.call(make_response, service.type, fields)
    return fields  # type: ignore[no-any-return]
