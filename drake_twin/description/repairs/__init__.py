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

from drake_twin.description.repairs.registry import (
    REPAIRS,
    Mended,
    Repair,
    check_repair_names,
    repair,
    repair_urdf,
)

__all__ = ["REPAIRS", "Mended", "Repair", "check_repair_names", "repair", "repair_urdf"]
