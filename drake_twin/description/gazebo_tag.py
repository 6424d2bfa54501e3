"""Values below a URDF's ``<gazebo>``, as Gazebo's reader takes them (libsdformat's src/parser_urdf.cc)."""

from lxml import etree

# The flags that the reader converts; the others are SDF's own, where a yes does not count.
GRAVITY_OFF = "turnGravityOff"
CONVERTED_FLAGS = ("static", "selfCollide", "preserveFixedJoint", "disableFixedJointLumping", GRAVITY_OFF)
YES, NO = ("1", "true", "yes"), ("0", "false", "no")


def text_or_value(element: etree._Element, tag: str) -> str | None:
    """Read ``<mu1>0.9</mu1>`` or ``<mu1 value="0.9"/>``: both are in use."""
    child = element.find(tag)
    if child is None:
        return None
    return child.get("value") or (child.text or "").strip() or None


def is_yes(text: str | None) -> bool:
    """Tell whether a flag that the reader converts is set."""
    return (text or "").strip().lower() in YES


def turns_gravity_off(element: etree._Element) -> bool:
    """Tell whether a ``<gazebo>`` turns gravity off: by any word that is not a no."""
    text = text_or_value(element, GRAVITY_OFF)
    return text is not None and text.strip().lower() not in NO
