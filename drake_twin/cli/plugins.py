"""The options ``--plugin`` and ``--panel``: modules that register controllers, sensors, … or panels of the page."""

import sys
import traceback
from argparse import ArgumentParser
from collections.abc import Iterable
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from zlib import crc32

from drake_twin.errors import InputError
from drake_twin.extensions import MODULES_OF_OTHERS
from drake_twin.program import add_repeated


def add_plugin(parser: ArgumentParser) -> None:
    """Add ``--plugin MODULE``, whose values `load_plugins` takes."""
    what = "import a module (a.b.c, or a .py file) that registers controllers, sensors, …"
    add_repeated(parser, "--plugin", "MODULE", what)


def load_panels(files: Iterable[str]) -> None:
    """Import the files of ``--panel``, as `load_plugins` does.

    Raises:
        InputError: If a file does not exist, raises an error while it is imported, or adds no panel to the page.
    """
    for file in files:
        from drake_twin.cockpit.page_panel import PAGE_PANELS

        load_plugins([file], "--panel")
        if file.endswith(".py") and _module_name(_file_of(file)) not in PAGE_PANELS.modules:
            raise InputError(
                f"--panel {file}: it adds no panel to the page. A function with @page_panel('TITLE'), of"
                " drake_twin.cockpit.page_panel, is called with an empty panel and the twin;"
                " `python -m pydoc drake_twin.cockpit.page_panel.page_panel` shows an example"
            )


def load_plugins(names: Iterable[str], option: str = "--plugin") -> None:
    """Import modules, each once, so that what they register is known.

    Args:
        names: Dotted names, or paths that end in ``.py``.
        option: The option that named them, for errors.

    Raises:
        InputError: If a module does not exist, or raises an error while it is imported.
    """
    for name in names:
        MODULES_OF_OTHERS.add(name if not name.endswith(".py") else _module_name(_file_of(name)))
        if name.endswith(".py"):
            _import_file(name, option)
        else:
            _import_module(name, option)


def _import_file(name: str, option: str) -> None:
    file = _file_of(name)
    if not file.is_file():
        raise InputError(f"{option} {name}: no such file")
    module_name = _module_name(file)
    if module_name in sys.modules:
        return
    spec = spec_from_file_location(module_name, file)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[module_name] = module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[module_name]
        raise _failure(f"{option} {name}", error) from error


def _file_of(name: str) -> Path:
    return Path(name).expanduser().resolve()


def _module_name(file: Path) -> str:
    """Return the name of a file's module, which is unique, so that it replaces no other module."""
    return f"{file.stem}_{crc32(str(file).encode()):08x}"


def _import_module(name: str, option: str) -> None:
    if "" not in sys.path and str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))  # where python -m looks, too
    try:
        import_module(name)
    except (Exception, SystemExit) as error:
        if isinstance(error, ModuleNotFoundError) and f"{name}.".startswith(f"{error.name}."):
            raise InputError(
                f"{option} {name}: no module named {error.name!r}; a file is named by its path, which ends in .py"
            ) from error
        raise _failure(f"{option} {name}", error) from error


def _failure(what: str, error: BaseException) -> InputError:
    """Return what a plugin raised, with the line of the plugin, or of what it imports, that raised it."""
    text = f"{what}: {type(error).__name__}: {' '.join(str(error).split())}"
    if isinstance(error, SyntaxError):
        return InputError(text, file=error.filename, line=error.lineno)
    frames = [item for item in traceback.extract_tb(error.__traceback__) if not item.filename.startswith("<frozen")]
    return InputError(text, file=frames[-1].filename, line=frames[-1].lineno)
