"""The ``<gpio>`` tags of ``<ros2_control>``: inputs and outputs without a joint, such as a gripper's valve."""

from collections.abc import Iterator, Mapping
from math import nan

from lxml import etree

from drake_twin.description.robot_description import Gpio
from drake_twin.description.xml_reader import XmlReader, parameters_of
from drake_twin.values import is_true


def hardware_gpios(reader: XmlReader, system: etree._Element, parameters: Mapping[str, str]) -> Iterator[Gpio]:
    """Read the GPIOs of a ``<ros2_control>`` tag, with the initial values that ros2_control gives their interfaces.

    With the hardware parameter ``mock_gpio_commands`` every state can be commanded, as in ``mock_components``.

    Args:
        reader: The document.
        system: The tag.
        parameters: Its ``<hardware><param>`` values.

    Raises:
        InputError: If a name is missing, or an initial value is invalid.
    """
    for element in system.iterfind("gpio"):
        commands = dict(_interfaces(reader, element, "command_interface"))
        states = dict(_interfaces(reader, element, "state_interface"))
        if is_true(parameters.get("mock_gpio_commands", "false")):
            commands = {**states, **commands}
        yield Gpio(reader.text(element, "name"), commands, states)


def _interfaces(reader: XmlReader, gpio: etree._Element, tag: str) -> Iterator[tuple[str, float]]:
    """Yield the name and the initial value of each interface; a ``bool`` starts as false, a number as NaN."""
    for element in gpio.iterfind(tag):
        initial = parameters_of(element).get("initial_value", "")
        if element.get("data_type", "double").strip() == "bool":
            value = float(is_true(initial or "false"))
        else:
            value = reader.parse_number(element, initial, "initial_value") if initial else nan
        yield reader.text(element, "name"), value
