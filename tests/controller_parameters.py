"""The parameters of a controller as its YAML gives them."""

from typing import Any

from drake_twin.controllers.registry import controller_class
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters


def parameters_of(kind: str, **given: Any) -> Any:
    """The parameters of a controller type; none of them may be unknown or ignored."""
    parameters, findings = read_parameters(controller_class(kind).Parameters, ControllerParameters("dut", kind, given))
    assert findings == ()
    return parameters
