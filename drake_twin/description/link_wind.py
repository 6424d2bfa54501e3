"""The links that the wind of gz-sim's WindEffects pushes: those with ``<enable_wind>``, or in a model with it."""

from collections.abc import Iterator

from lxml import etree

from drake_twin.description.fixed_joint_lumping import lumped_links
from drake_twin.description.gazebo_tag import text_or_value
from drake_twin.values import is_true

_TAG = "enable_wind"


def windy_links_of_urdf(root: etree._Element) -> tuple[str, ...]:
    """Return the names of a URDF's windy links; what Gazebo folds together is windy where one of it is."""
    links = [link.get("name", "").strip() for link in root.iterfind("link")]
    tags = [element for element in root.iterfind("gazebo") if is_true(text_or_value(element, _TAG))]
    if not tags:
        return ()
    if any(element.get("reference") is None for element in tags):
        return tuple(links)
    into = lumped_links(root)
    windy = {into.get(name, name) for name in ((element.get("reference") or "").strip() for element in tags)}
    return tuple(link for link in links if into.get(link, link) in windy)


def windy_links_of_sdf(model: etree._Element) -> Iterator[str]:
    """Yield the windy links of an SDF model and of those inside it, as ``INNER::LINK``; a model's flag is its own."""
    if model.find(f".//{_TAG}") is None:
        return
    of_model = is_true(model.findtext(_TAG))
    for link in model.iterfind("link"):
        if of_model or is_true(link.findtext(_TAG)):
            yield link.get("name", "")
    for nested in model.iterfind("model"):
        yield from (f"{nested.get('name', '')}::{link}" for link in windy_links_of_sdf(nested))
