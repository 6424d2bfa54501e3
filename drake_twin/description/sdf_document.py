"""An SDF document: its text as Gazebo's reader accepts it, its version, and what its elements have in common."""

import re
from collections.abc import Collection, Sequence
from pathlib import Path

from lxml import etree

from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Place
from drake_twin.values import is_true, number_or_none

_VERSION = re.compile(r"\d+(\.\d+)*")
_PREFIX = re.compile(r"(?:</?|\s)([A-Za-z_][\w.-]*):[A-Za-z_][\w.-]*(?=[\s=/>])")


def read_sdf(text: str, file: Path | None, places: Sequence[Place] | None = None) -> XmlReader:
    """Read an SDF document, with what Gazebo's reader lets pass.

    That is blank lines before the XML declaration, prefixes that nothing declares, and ``--`` inside a comment.

    Raises:
        InputError: If it is not well-formed all the same, or its version is not numbers.
    """
    text = re.sub(r"<!--.*?-->", lambda comment: "\n" * comment[0].count("\n"), text, flags=re.DOTALL)
    text = re.sub(r"(</?[A-Za-z_]\w*)::(?=\w)", r"\1:", text)
    head = re.match(r"\s*<\?xml.*?\?>", text, re.DOTALL)
    if head is not None:
        text = "\n" * head[0].count("\n") + text[head.end() :]
    declared = set(re.findall(r"\bxmlns:([\w.-]+)\s*=", text)) | {"xml", "xmlns"}
    unknown = sorted(set(_PREFIX.findall(text)) - declared)
    if unknown:
        declarations = "".join(f' xmlns:{prefix}="{prefix}"' for prefix in unknown)
        text = re.sub(r"<sdf\b", lambda tag: tag[0] + declarations, text, count=1)
    reader = XmlReader(text, file, places=places)
    check_version(reader)
    return reader


def check_version(reader: XmlReader) -> None:
    """Check that the version of an SDF document is one.

    Raises:
        InputError: If it is not numbers.
    """
    version = reader.root.get("version")
    if reader.root.tag == "sdf" and version is not None and _VERSION.fullmatch(version.strip()) is None:
        raise reader.error(reader.root, f"the version is {version!r}, which is not numbers such as 1.9")


def sdf_version(root: etree._Element) -> tuple[int, ...]:
    """Return the version of an SDF document as numbers; the newest where it gives none."""
    text = (root.get("version") or "").strip()
    return tuple(int(part) for part in text.split(".")) if _VERSION.fullmatch(text) else (1, 11)


def modernize(model: etree._Element) -> None:
    """Rewrite what had another meaning before SDF 1.7, so that a model can stand inside a newer one."""
    for axis in [*model.iter("axis"), *model.iter("axis2")]:
        for old in axis.findall("use_parent_model_frame"):
            xyz = axis.find("xyz")
            if xyz is not None and is_true(old.text):
                xyz.set("expressed_in", "__model__")
            axis.remove(old)


def free_name(name: str, taken: Collection[str]) -> str:
    """Return a name, with the lowest number that makes it unique among those taken."""
    candidate, number = name, 0
    while candidate in taken:
        candidate, number = f"{name}_{number}", number + 1
    return candidate


def is_static(model: etree._Element) -> bool:
    """Tell whether ``<static>`` says that a model does not move, or so says every model in one without own links."""
    static = model.find("static")
    if static is not None and is_true(static.text):
        return True
    nested = model.findall("model")
    return bool(nested) and model.find("link") is None and all(map(is_static, nested))


def is_within_static(element: etree._Element) -> bool:
    """Tell whether an element belongs to a model that does not move."""
    return any(is_static(model) for model in element.iterancestors("model"))


def has_weight(link: etree._Element) -> bool:
    """Tell whether gravity acts on a link: its ``<gravity>`` is true where it is missing or empty."""
    return is_true(link.findtext("gravity") or "true")


def number_in(element: etree._Element | None) -> float | None:
    """Read an element's text as a number, which may be infinite; None for anything else."""
    return None if element is None else number_or_none((element.text or "").strip())


def numbers_in(text: str | None) -> list[float | None]:
    """Read each word of a text as a number, which may be infinite; None for anything else."""
    return [number_or_none(part) for part in (text or "").split()]
