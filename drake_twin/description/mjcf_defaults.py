"""The default classes of an MJCF file: what an element has that it does not say itself."""

from collections.abc import Iterator, Mapping

from lxml import etree

_MAIN = "main"  # MuJoCo's name of the outermost class
_ACTUATORS = ("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion")
# Values of an actuator that do not depend on its kind: a class that has them for one has them for all.
_OF_ALL = ("gear", "ctrlrange", "ctrllimited", "forcerange", "forcelimited")


class MjcfDefaults:
    """The values of MJCF elements, with those of their default classes.

    https://mujoco.readthedocs.io/en/stable/modeling.html#default-settings
    """

    def __init__(self, root: etree._Element):
        self._classes: dict[str, dict[str, dict[str, str]]] = {}
        for default in root.findall("default"):
            self._read(default, default.get("class", _MAIN), {})

    def _read(self, default: etree._Element, name: str, above: Mapping[str, Mapping[str, str]]) -> None:
        own = {tag: dict(values) for tag, values in above.items()}
        for element in default:
            if isinstance(element.tag, str) and element.tag != "default":
                values = _attributes(element)
                own.setdefault(element.tag, {}).update(values)
                for tag in _ACTUATORS if element.tag in _ACTUATORS else ():
                    own.setdefault(tag, {}).update({key: values[key] for key in _OF_ALL if key in values})
        self._classes[name] = {**self._classes.get(name, {}), **own}
        for nested in default.findall("default"):
            self._read(nested, nested.get("class", ""), own)

    def of_actuator(self, element: etree._Element) -> dict[str, str]:
        """Return the values of an actuator."""
        return self._values(element, element.get("class", _MAIN))

    def of_joint(self, element: etree._Element) -> dict[str, str]:
        """Return the values of a joint: of its class, or the ``childclass`` of the bodies around it."""
        around: Iterator[str | None] = (body.get("childclass") for body in element.iterancestors("body"))
        return self._values(element, element.get("class") or next(filter(None, around), _MAIN))

    def _values(self, element: etree._Element, name: str) -> dict[str, str]:
        return {**self._classes.get(name, {}).get(str(element.tag), {}), **_attributes(element)}


def _attributes(element: etree._Element) -> dict[str, str]:
    return {str(name): str(value) for name, value in element.attrib.items()}
