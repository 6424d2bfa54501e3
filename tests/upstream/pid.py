"""What the tests of pid_controller's two files share: a controller of the robot with a finger and a thumb."""

from typing import Any

import numpy as np
from device_harness import Running, setup_of

from drake_twin import messages
from drake_twin.controllers.base_controller import Upstream
from drake_twin.controllers.pid_controller import PidController
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters

NAN = float("nan")


def pid(state: list[float], chained: bool = False, **given: Any) -> Running:
    """Return an active controller; ``state`` holds the positions of finger and thumb, then their velocities."""
    parameters = ControllerParameters("test_pid_controller", "pid_controller/PidController", given)
    values, _ = read_parameters(PidController.Parameters, parameters)
    size = len(values.dof_names) * len(values.reference_and_state_interfaces)
    upstream = {"above": Upstream(size, tuple(range(size)))} if chained else {}
    ports = {"above": [NAN] * size} if chained else {}
    return Running(PidController(setup_of(PidController, values, upstream=upstream)), state=state, **ports)


def reference(*values: float) -> Any:
    return messages.MultiDOFCommand(dof_names=[], values=np.array(values, dtype=float), values_dot=np.array([]))
