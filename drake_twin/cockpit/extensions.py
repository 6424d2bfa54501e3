"""The registries of what a page can have several of, by the names that the page and the twin exchange."""

import logging
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from drake_twin.errors import InputError
from drake_twin.extensions import Registry

_K = TypeVar("_K")


class PageRegistry(Registry[_K]):
    """Parts of the page; a package that cannot be imported does not keep the page from opening.

    Args:
        noun: What a part is called, and its decorator's name.
        packages: The packages with the twin's own.
        first: Those of its modules whose parts come first.
    """

    def __init__(self, noun: str, packages: Sequence[str], first: Sequence[str]):
        warn = logging.getLogger(__name__).warning
        super().__init__(noun, noun, "drake_twin.page_panels", packages, first, failed=warn)

    def add(self, name: str, kind: _K, code: Callable[..., Any], *, replace: bool = False) -> None:
        """Register a part.

        Raises:
            InputError: If the name is not an identifier, or belongs to other code.
        """
        if not name.isidentifier():
            raise InputError(f"{name!r} cannot name a part of the page: an identifier is needed")
        super().add(name, kind, code, replace=replace)
