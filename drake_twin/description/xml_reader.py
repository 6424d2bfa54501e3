"""XML elements read with checks: a wrong value raises an error that names file, line, element and value."""

from collections.abc import Sequence
from copy import copy, deepcopy
from pathlib import Path
from typing import Any, cast

from lxml import etree

from drake_twin.description.source_file import without_default_namespace
from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.values import needed, parse_number

# No network, no external entities, and libxml2's own bound on how far entities may expand.
_PARSER = etree.XMLParser(
    resolve_entities="internal",  # type: ignore[arg-type]  # newer than the stubs
    no_network=True,
    huge_tree=False,
    remove_comments=True,
)


_MOST_LINES = 65535  # libxml2's bound


class XmlReader:
    """Reads values out of one XML document.

    Args:
        text: The document.
        file: The file it came from, for error messages.
        places: Where each element was written, in the order of the document, for text that was made of other files;
            None when the text is the file's own.

    Raises:
        InputError: If the text is not well-formed.
    """

    def __init__(self, text: str, file: Path | None = None, *, places: Sequence[Place] | None = None):
        self.file = file
        self._places: list[Place] | None = None if places is None else list(dict.fromkeys(places))
        try:
            self.root = etree.fromstring(without_default_namespace(text).encode(), _PARSER)
        except etree.XMLSyntaxError as error:
            line = error.lineno if places is None else None
            reason = " ".join(str(error.msg).split())
            raise InputError(f"this is not well-formed XML: {reason}", file=file, line=line) from None

        if places is not None and self._places is not None:
            numbers = {place: number for number, place in enumerate(self._places, start=1)}
            for element, place in zip(self.root.iter(etree.Element), places, strict=True):
                number = numbers[place]
                element.sourceline = number if number <= _MOST_LINES else 0  # copies of the element keep it

    def copy(self) -> "XmlReader":
        """Return a copy of the document, to be changed independently."""
        copied = copy(self)
        copied.root = deepcopy(self.root)
        return copied

    def place(self, element: etree._Element) -> Place:
        """Return where an element was written."""
        line: int | None = cast(Any, element).sourceline  # the stubs give another type
        if self._places is not None:
            known = line is not None and 0 < line <= len(self._places)
            return self._places[line - 1] if line is not None and known else Place(str(self.file or ""))
        return Place(str(self.file or ""), line if line and line < _MOST_LINES else None)

    def error(self, element: etree._Element, message: str, **more: Any) -> InputError:
        """Return an error that points at an element; more arguments are those of `InputError`."""
        place = self.place(element)
        return InputError(f"{described(element)}: {message}", file=place.file or None, line=place.line, **more)

    def text(self, element: etree._Element, attribute: str, default: str | None = None) -> str:
        """Read a required (or defaulted) attribute."""
        value = element.get(attribute, default)
        value = None if value is None else value.strip()
        if value is None or (value == "" and default is None):
            raise self.error(element, f"the attribute {attribute!r} is missing")
        return value

    def number(self, element: etree._Element, attribute: str, default: float) -> float:
        """Read an attribute as a finite number."""
        text = element.get(attribute)
        return default if text is None else self.parse_number(element, text, attribute)

    def parse_number(self, element: etree._Element, text: str, what: str) -> float:
        """Read text as a finite number; ``what`` names it in the error."""
        try:
            return parse_number(text)
        except ValueError as error:
            raise self.error(element, f"{what} is {text!r}, which is {error}") from None

    def parse_numbers(self, element: etree._Element, text: str, what: str, count: int) -> tuple[float, ...]:
        """Read text as so many finite numbers; ``what`` names it in the error."""
        values = tuple(self.parse_number(element, part, what) for part in text.split())
        if len(values) != count:
            raise self.error(element, f"{what} is {text!r}, where {needed(count)}")
        return values

    def vector3(
        self, element: etree._Element, attribute: str, default: tuple[float, float, float]
    ) -> tuple[float, float, float]:
        """Read an attribute as three finite numbers."""
        text = element.get(attribute)
        if text is None:
            return default
        x, y, z = self.parse_numbers(element, text, attribute, 3)
        return x, y, z


def described(element: etree._Element) -> str:
    """Describe an element for a message: ``<limit> of <joint name="elbow">``."""
    text = f"<{etree.QName(element).localname}"
    name = element.get("name") or element.get("reference")
    text += f' name="{name}">' if name else ">"
    parent = element.getparent()
    if name is None and parent is not None and parent.getparent() is not None:
        text += f" of {described(parent)}"
    return text


def parameters_of(element: etree._Element) -> dict[str, str]:
    """Return the ``<param>`` values of an element of ``<ros2_control>``."""
    return {item.get("name", ""): (item.text or "").strip() for item in element.iterfind("param")}
