"""Drake's Meshcat page, set up for robots on a ground."""

import socket

import numpy as np
from pydrake.geometry import Box, Meshcat, MeshcatParams, Rgba
from pydrake.math import RigidTransform

from drake_twin.errors import InputError
from drake_twin.twin import Twin

_GROUND = Rgba(0.74, 0.77, 0.74, 1.0)
# Even light: Meshcat's point lights, a few metres up, would leave two bright spots on the ground.
_LIGHTS = {"AmbientLight": 1.8, "FillLight": 2.0, "PointLightNegativeX": 0.0, "PointLightPositiveX": 0.0}
_SKY_TOP, _SKY_BOTTOM = [0.55, 0.70, 0.86], [0.93, 0.95, 0.97]


def open_meshcat(port: int | None = None, host: str = "127.0.0.1") -> Meshcat:
    """Starts a Meshcat server.

    Args:
        port: its port; by default the first free one from 7000 on.
        host: the address to listen at; Drake's own default would be every interface of the machine.

    Raises:
        InputError: the port is taken or may not be used.
    """
    try:
        with socket.socket() as probe:  # Drake waits for ever for an address that this machine does not have
            probe.bind((host, 0))
    except (OSError, UnicodeError):
        raise InputError(f"no page can be served at {host!r}: it is no address of this machine") from None
    try:
        return Meshcat(MeshcatParams(host=host, port=port, show_stats_plot=False))
    except RuntimeError as error:
        if port is None:
            raise InputError(f"no page can be served at {host}: {error}") from None
        raise InputError(
            f"port {port} of {host} cannot be used: another program has it, or it is not allowed. Choose another with"
            " --port, or leave --port out for the first free one"
        ) from None


def set_scene(meshcat: Meshcat, twin: Twin) -> None:
    """Draws ground and sky, and looks at all robots from the front left."""
    positions = np.array([twin.robot_state(robot).base_pose[:3] for robot in twin.robots])
    center = positions.mean(axis=0)
    reach = float(np.max(np.linalg.norm(positions - center, axis=1))) + 1.0
    if twin.scenario.world.has_own_ground:
        side = max(20.0, 4.0 * reach)
        thickness = 0.01
        meshcat.SetObject("/ground/plane", Box(side, side, thickness), _GROUND)
        # Just below zero, where Meshcat draws its grid.
        meshcat.SetTransform("/ground/plane", RigidTransform([center[0], center[1], -thickness / 2 - 0.004]))
    meshcat.SetProperty("/Background/<object>", "top_color", _SKY_TOP)
    meshcat.SetProperty("/Background/<object>", "bottom_color", _SKY_BOTTOM)
    meshcat.SetProperty("/Axes/<object>", "visible", False)
    for light, intensity in _LIGHTS.items():
        meshcat.SetProperty(f"/Lights/{light}/<object>", "intensity", intensity)
    meshcat.SetCameraPose(center + reach * np.array([0.75, -0.65, 0.65]), center)
