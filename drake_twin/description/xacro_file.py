"""xacro files, expanded with the twin's own package index, so that ``$(find pkg)`` needs no ROS."""

import contextlib
import hashlib
import importlib.machinery
import importlib.util
import io
import os
import re
import sys
import sysconfig
import threading
import traceback
from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any, TypeVar
from xml.parsers.expat import ExpatError

from lxml import etree

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.source_file import file_bytes
from drake_twin.description.xacro_cache import Answers, Expanded, keep_expansion, kept_expansion
from drake_twin.description.xacro_surroundings import XacroSurroundings
from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.progress import tell

_XACRO_NAMESPACES = ("http://www.ros.org/wiki/xacro", "http://ros.org/wiki/xacro", "http://wiki.ros.org/xacro")

# xacro keeps its state (file stack, symbols, the lookup of packages) in module globals.
_XACRO_LOCK = threading.Lock()


_MOST_KNOWN = 256  # expansions, and texts whose places are remembered
_known_places: dict[bytes, tuple[Place, ...]] = {}

_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


# What was expanded, in which folder and by which xacro → what that asked of its surroundings, and its result.
_known_expansions: dict[tuple[str, ...], tuple[Answers, Expanded]] = {}


def expand_xacro(file: Path, arguments: Mapping[str, str], packages: PackageIndex) -> Expanded:
    """Expand a xacro file to URDF text, as the ``xacro`` command does.

    The same command is expanded once, unless a file, a package or an environment variable that it read has changed.

    Args:
        file: The xacro file.
        arguments: Values for its ``<xacro:arg>``s.
        packages: Resolves ``$(find pkg)``.

    Raises:
        InputError: If xacro refuses the file; the text holds xacro's reason and its chain of files.
    """
    command = (os.getcwd(), str(file), repr(sorted(arguments.items())), _version_of_xacro())
    with _XACRO_LOCK:
        surroundings = XacroSurroundings(packages, file)
        answers, expanded = _known_expansions.get(command) or kept_expansion(command) or ({}, None)
        if expanded is None or not surroundings.confirm(answers):
            surroundings = XacroSurroundings(packages, file)
            expanded = _expand(file, arguments, surroundings)
            keep_expansion(command, surroundings.answers, expanded)
        _remember(_known_expansions, command, (surroundings.answers, expanded))
    _remember(_known_places, _digest(expanded.text), expanded.places)
    return expanded


def _expand(file: Path, arguments: Mapping[str, str], surroundings: XacroSurroundings) -> Expanded:
    from drake_twin.description.xacro_expressions import bounded_expressions, quick_yaml

    xacro = installed_xacro()
    tell(f"expanding {file.name}")
    with contextlib.redirect_stderr(io.StringIO()) as printed:
        try:
            with (
                bounded_expressions(xacro),
                quick_yaml(),
                tags_with_places(xacro),
                surroundings.answering(xacro),
            ):
                document = xacro.process_file(str(file), mappings=dict(arguments))
        except Exception as error:  # expressions in the file are Python and raise anything
            raise xacro_error(error, file) from None
    # xacro's warnings are followed by lines with the chain of files.
    warnings = re.split(r"^warning: ", printed.getvalue(), flags=re.MULTILINE)
    text = document.toxml()
    places = tuple(_place(element, file) for element in document.getElementsByTagName("*"))
    document.unlink()  # its nodes refer to each other: without this they stay until a full garbage collection
    warnings = [", ".join(warning.split("\n")).strip(", ") for warning in warnings if warning.strip()]
    return Expanded(text, places, tuple(warnings))


def _remember(known: dict[_Key, _Value], key: _Key, value: _Value) -> None:
    known.pop(key, None)  # the latest ones are kept
    known[key] = value
    while len(known) > _MOST_KNOWN:
        known.pop(next(iter(known)))


def places_of_expanded(text: str) -> tuple[Place, ...] | None:
    """Return where each element was written of a text that xacro has made in this process.

    A launch file hands such a text on without its file. For any other text, return None.
    """
    return _known_places.get(_digest(text))


def _digest(text: str) -> bytes:
    return hashlib.sha256(text.strip().encode()).digest()


def installed_xacro() -> Any:
    """Return the xacro that was installed with the twin, also if another one is on the path (of a sourced ROS, say)."""
    known = sys.modules.get("xacro")
    if known is not None and str(known.__file__).startswith(_folders_of_packages()):
        return known
    spec = _spec_of_xacro()
    if spec is None or spec.loader is None:  # installed elsewhere, in a user's own folder say
        return importlib.import_module("xacro")
    for name in [name for name in sys.modules if name.partition(".")[0] == "xacro"]:
        del sys.modules[name]
    module = importlib.util.module_from_spec(spec)
    sys.modules["xacro"] = module
    spec.loader.exec_module(module)
    return module


@cache
def _folders_of_packages() -> tuple[str, ...]:
    paths = sysconfig.get_paths()
    return tuple(dict.fromkeys((paths["purelib"], paths["platlib"])))


def _spec_of_xacro() -> importlib.machinery.ModuleSpec | None:
    return importlib.machinery.PathFinder.find_spec("xacro", _folders_of_packages())


@cache
def _version_of_xacro() -> str:
    """Return what another xacro differs in, without importing it."""
    spec = _spec_of_xacro() or importlib.util.find_spec("xacro")
    if spec is None or spec.origin is None:
        return ""
    status = os.stat(spec.origin)
    return f"{spec.origin} {status.st_size} {status.st_mtime_ns}"


def xacro_arguments(file: Path, packages: PackageIndex) -> dict[str, str]:
    """Return the ``<xacro:arg>``s that a file and the files it includes declare: name → default, empty without one.

    Includes whose names need an expression other than ``$(find pkg)`` are left out.
    """
    arguments: dict[str, str] = {}
    seen: set[Path] = set()
    todo = [file.absolute()]
    while todo:
        current = todo.pop()
        if current in seen:
            continue
        seen.add(current)
        try:
            tree = etree.parse(io.BytesIO(file_bytes(current)))
        except (etree.XMLSyntaxError, OSError):
            continue  # expanding the file reports what is wrong with it
        for element in tree.iter(*(f"{{{namespace}}}*" for namespace in _XACRO_NAMESPACES)):
            kind = etree.QName(element).localname
            if kind == "arg":
                arguments.setdefault(element.get("name", ""), element.get("default", ""))
            elif kind == "include":
                todo.extend(_included(element.get("filename", ""), current, packages))
    return arguments


def _included(name: str, includer: Path, packages: PackageIndex) -> Iterator[Path]:
    if name.startswith("$(find "):
        package, _, inside = name[len("$(find ") :].partition(")")
        try:
            name = str(packages.find(package.strip(), includer)) + inside
        except InputError:
            return
    if "$" not in name:
        yield (includer.parent / name).absolute()


def _place(element: Any, file: Path) -> Place:
    """Return where an element was written: one that ``xacro:element`` names has the place of the one around it."""
    while element is not None and not isinstance(getattr(element, "tagName", None), _Tag):
        element = element.parentNode
    return Place(str(file)) if element is None else element.tagName.place


class _Tag(str):
    """An element's tag that knows where it was written; xacro's copies of the element keep it."""

    place: Place


@contextlib.contextmanager
def tags_with_places(xacro: Any) -> Iterator[None]:
    """Make xacro's parser record the line of each element, which its documents lack; texts made of these are known.

    See `places_of_expanded`.
    """
    original = xacro.parse
    if getattr(original, "records_places", False):
        yield
        return

    def parse(text: Any, filename: str | None = None) -> Any:
        document = original(text, filename)
        name = str(filename or getattr(text, "name", ""))
        with contextlib.suppress(etree.XMLSyntaxError, OSError):
            lines: list[Any] = [
                element.sourceline for element in etree.fromstring(file_bytes(name)).iter(etree.Element)
            ]
            for element, line in zip(document.getElementsByTagName("*"), lines, strict=False):
                element.tagName = element.nodeName = tag = _Tag(element.tagName)
                tag.place = Place(name, line)
            for method in ("toxml", "toprettyxml"):
                setattr(document, method, partial(_written, document, getattr(document, method), Path(name)))
        return document

    parse.records_places = True  # type: ignore[attr-defined]
    xacro.parse = parse
    try:
        yield
    finally:
        xacro.parse = original


def _written(document: Any, write: Callable[..., Any], file: Path, *arguments: Any, **more: Any) -> Any:
    """Write a document, and remember where the elements of its text come from."""
    text = write(*arguments, **more)
    if isinstance(text, str):
        places = tuple(_place(element, file) for element in document.getElementsByTagName("*"))
        _remember(_known_places, _digest(text), places)
    return text


def xacro_error(error: Exception, file: Path) -> InputError:
    """Return an exception of xacro as an error with the file and line at which xacro was.

    Args:
        error: The exception.
        file: The file that was expanded.
    """
    if isinstance(error, (ExpatError, etree.XMLSyntaxError)):
        return InputError(f"this is not well-formed XML: {error}", file=_file_at_fault(file), line=error.lineno)
    place = _place_at_fault(error, file)
    if isinstance(error, OSError):
        what = f"xacro cannot read {error.filename or file} ({error.strerror})"
    else:
        what = f"xacro: {_reason(error)}{_chain()}"
    return InputError(what, file=place.file, line=place.line)


def _place_at_fault(error: Exception, file: Path) -> Place:
    """Return the place of the last element that a function of xacro had in its hands; else the file alone."""
    for frame, _ in reversed([*traceback.walk_tb(error.__traceback__)]):
        tags = (getattr(frame.f_locals.get(name), "tagName", None) for name in ("node", "elt", "tag"))
        place = next((tag.place for tag in tags if isinstance(tag, _Tag)), None)
        if place is not None:
            return place
    return Place(str(_file_at_fault(file)))


def _reason(error: Exception) -> str:
    cause = getattr(error, "exc", None)  # of a XacroException, whose own text would give the cause twice
    if isinstance(cause, InputError):
        return str(cause).rstrip(".")
    if isinstance(cause, OSError):
        return f"{cause.strerror}: {cause.filename}"
    text = " ".join(str(error).split())
    return text if text else type(error).__name__


def _file_at_fault(file: Path) -> Path:
    xacro = installed_xacro()
    return Path(xacro.filestack[-1]) if xacro.filestack else file


def _chain() -> str:
    xacro = installed_xacro()
    includers = dict.fromkeys(str(name) for name in reversed((xacro.filestack or [])[:-1]))
    return f" (included from {', '.join(includers)})" if includers else ""
