"""Repairs of what is wrong in so many URDF files: each is one function, registered under a rule's name.

A repair changes the parsed XML and says what it did. Each can be switched off by its name (``without_repairs`` of a
scenario's robot); then the file is used as it is, or refused. ``docs/repairs.md`` lists them for users. Other packages
add repairs with the same decorator::

    from drake_twin.description.repairs import repair

    @repair("wheel_without_friction")
    def wheel_without_friction(reader):
        for element in reader.root.iterfind(...):
            ...
            yield element, "the wheel has no coefficient of friction: 1 is used"

in a module that a program imports, or that the entry-point group ``drake_twin.repairs`` names.
"""

from collections.abc import Callable, Collection, Iterator
from typing import TypeAlias

from lxml import etree

from drake_twin.description.used_elements import weight_of
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import TwinError, described
from drake_twin.extensions import Registry
from drake_twin.findings import Finding, Kind

Mended: TypeAlias = Iterator[tuple[etree._Element, str]]
Repair: TypeAlias = Callable[[XmlReader], Mended]

# In the order in which they are applied: a joint that becomes fixed needs no mass, for example.
REPAIRS: Registry[Repair] = Registry(
    "repair", "repair", "drake_twin.repairs", ["drake_twin.description.repairs"], first=["joints", "shapes", "masses"]
)


def repair(name: str) -> Callable[[Repair], Repair]:
    """Register a function that repairs the tree of a URDF.

    The function is given the document, changes its tree, and yields each element that it changed with what it did.

    Args:
        name: The rule's name, under which users switch the repair off.

    Raises:
        InputError: If another repair has the name.
    """

    def register(function: Repair) -> Repair:
        REPAIRS.add(name, function, function)
        return function

    return register


def repair_urdf(reader: XmlReader, without: Collection[str] = ()) -> list[Finding]:
    """Apply the repairs to a URDF's tree.

    Args:
        reader: The document; its tree is changed.
        without: Names of repairs to leave out.

    Returns:
        What was repaired, in order; and the repairs of other packages that have failed.
    """
    findings: list[Finding] = []
    for name, function in REPAIRS.items():
        if name in without:
            continue
        try:
            for element, what in function(reader):
                findings.append(Finding.at(Kind.MENDED, what, reader.place(element), name, weight=weight_of(element)))
        except TwinError:
            raise
        except Exception as error:
            if not REPAIRS.is_of_others(name):
                raise
            findings.append(Finding(Kind.FAILED, f"repair {name}: {described(error)}"))
    return findings


def check_repair_names(names: Collection[str], others: Collection[str] = ()) -> None:
    """Check names of repairs.

    Args:
        names: The names to check.
        others: Names of repairs that are not in the registry.

    Raises:
        InputError: If a name is unknown.
    """
    for name in names:
        if name not in others and name not in REPAIRS:
            raise REPAIRS.unknown(name, others)
