"""What xacro asks of its surroundings while it expands a file: as long as the answers stay, so does the result."""

import contextlib
import glob
import hashlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.source_file import file_bytes
from drake_twin.description.xacro_cache import Answers
from drake_twin.errors import InputError


class XacroSurroundings:
    """Answer what an expansion asks, and remember the answers.

    Args:
        packages: Resolves ``$(find pkg)``.
        file: The file that is expanded.

    Attributes:
        answers: The answers so far.
    """

    def __init__(self, packages: PackageIndex, file: Path):
        self.answers: dict[tuple[str, tuple[str, ...]], Any] = {}
        self._file = file
        self._kinds: dict[str, Callable[..., Any]] = {
            "package": lambda name: str(packages.find(name, file)),
            "files": glob.glob,
            "environment": os.environ.get,
            "content": _content,
        }

    def ask(self, kind: str, *words: str) -> Any:
        """Return the answer to a question."""
        answer = self.answers[kind, words] = self._kinds[kind](*words)
        return answer

    def confirm(self, answers: Answers) -> bool:
        """Return whether each question has the same answer as before."""
        with contextlib.suppress(InputError):  # a package is no longer found
            return all(self.ask(kind, *words) == answer for (kind, words), answer in answers.items())
        return False

    @contextlib.contextmanager
    def answering(self, xacro: Any) -> Iterator[None]:
        """Let xacro ask here.

        Args:
            xacro: Its module.
        """
        from xacro import substitution_args

        finds, env, optenv = substitution_args._eval_find, substitution_args._eval_env, substitution_args._eval_optenv
        included = len(xacro.all_includes)

        def noted(evaluate: Callable[..., str]) -> Callable[..., str]:
            def evaluated(name: str, **more: str) -> str:
                self.ask("environment", name)
                return evaluate(name, **more)

            return evaluated

        substitution_args._eval_find = lambda package: self.ask("package", package)
        substitution_args._eval_env, substitution_args._eval_optenv = noted(env), noted(optenv)
        xacro.glob = SimpleNamespace(glob=lambda names: self.ask("files", names))
        try:
            yield
            for name in (self._file, *xacro.all_includes[included:]):
                self.ask("content", str(name))
        finally:
            substitution_args._eval_find, substitution_args._eval_env = finds, env
            substitution_args._eval_optenv, xacro.glob = optenv, glob


def _content(name: str) -> str | None:
    """Return a digest of a file's content; None without a file."""
    with contextlib.suppress(OSError):
        return hashlib.sha256(file_bytes(name)).hexdigest()
    return None
