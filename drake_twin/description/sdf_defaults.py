"""Elements of SDF that ask for nothing: they hold SDF's own default, as all elements do in a file that Gazebo saved."""

from collections.abc import Mapping

from lxml import etree

from drake_twin.description.unused_contact import is_unused
from drake_twin.values import number_or_none

# Element that the twin does not use → the values with which it asks for nothing, by SDF 1.9; true is 1 and false 0.
_DEFAULTS: Mapping[str, tuple[str, ...]] = {
    # of models and links
    **dict.fromkeys(("kinematic", "must_be_base_link", "self_collide"), ("0",)),
    "allow_auto_disable": ("1",),
    **dict.fromkeys(("linear", "angular"), ("0",)),  # decay of a link's velocity
    # of joints
    "stiffness": ("1e8",),  # of a joint's limits, as the next
    "dissipation": ("1",),
    **dict.fromkeys(("cfm", "fudge_factor", "bounce", "max_force", "velocity"), ("0",)),
    "erp": ("0.2",),
    **dict.fromkeys(("cfm_damping", "implicit_spring_damper", "provide_feedback"), ("0",)),
    # of collisions: the radii of a patch, the bitmasks and the ratio of restitution are `unused_contact`'s
    "laser_retro": ("0",),
    "max_contacts": ("10", "20"),
    "threshold": ("100000", "1000000"),
    "coefficient": ("1",),
    "use_patch_radius": ("1",),
    "slip": ("0",),
    "collide_without_contact_bitmask": ("1",),
    "split_impulse": ("1",),
    "split_impulse_penetration_threshold": ("-0.01",),
    # of visuals
    **dict.fromkeys(("cast_shadows", "lighting"), ("1",)),
    **dict.fromkeys(("transparency", "layer", "render_order", "double_sided"), ("0",)),
    "visibility_flags": ("4294967295",),
    **dict.fromkeys(("emissive", "specular"), ("0 0 0 1", "0 0 0 0")),
    "normal_map": ("__default__",),
}
_WORDS = {"true": "1", "false": "0"}


def asks_for_nothing(element: etree._Element) -> bool:
    """Tell whether an element and all in it hold SDF's defaults, or contact parameters that have their own findings."""
    if is_unused(element):
        return True
    children = [*element.iterchildren(etree.Element)]
    if children:
        return all(map(asks_for_nothing, children))
    defaults = _DEFAULTS.get(str(element.tag), ())
    text = element.get("value") or element.text or ""
    return any(_numbers(text) == _numbers(default) for default in defaults)


def _numbers(text: str) -> tuple[float | str, ...]:
    words = [_WORDS.get(word, word) for word in text.lower().split()]
    return tuple(word if (number := number_or_none(word)) is None else number for word in words)
