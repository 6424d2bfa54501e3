"""A picture of a robot that is not in the twin yet, drawn in a process of its own."""

import base64
import io
import json
import sys
from collections.abc import Mapping, Sequence

from drake_twin.cockpit.limited_process import LimitedProcess
from drake_twin.errors import RunError, TwinError
from drake_twin.python_process import die_with

LONGEST = 30.0  # s of wall time
_SIZE = (320, 240)
_FOV = 0.8  # rad, of the picture's height
_FROM = (0.75, -0.65, 0.5)  # from where the camera looks, in the robot's frame


class RobotPicture(LimitedProcess):
    """A picture that is drawn; `output` is a PNG in Base64.

    Args:
        file: The robot's file.
        arguments: Its xacro arguments.
        folders: The folders of packages to search first.
    """

    def __init__(self, file: str, arguments: Mapping[str, str], folders: Sequence[str]):
        given = [file, json.dumps([dict(arguments), list(folders)])]
        super().__init__(__name__, given, "the robot takes longer than {longest} s to draw", LONGEST)


def png(file: str, arguments: Mapping[str, str], folders: Sequence[str]) -> bytes:
    """Return a picture of a robot at its start positions, on the ground.

    Raises:
        InputError: If the robot's files cannot be used.
        RunError: If pictures cannot be drawn on this machine.
    """
    import numpy as np
    from PIL import Image
    from pydrake.math import RigidTransform, RotationMatrix
    from pydrake.systems.framework import DiagramBuilder

    from drake_twin.description.package_index import PackageIndex
    from drake_twin.description.surroundings import Surroundings
    from drake_twin.diagram.footprint import footprint
    from drake_twin.diagram.plant import add_plant
    from drake_twin.planning.plan_robot import plan_robot
    from drake_twin.scenario import POINT, Robot, Scenario, World
    from drake_twin.sensors.cameras.picture import COLOR, View
    from drake_twin.sensors.cameras.render_process import NoOpenGLError, Painter
    from drake_twin.sensors.cameras.scene import seen_scene

    robot = Robot("robot", file, xacro_args=arguments, contact=POINT)  # Drake makes no meshes for these
    plan = plan_robot(robot, PackageIndex(folders))
    box = footprint(plan)
    lower, upper = np.array(box.lower), np.array(box.upper)
    builder = DiagramBuilder()
    scenario = Scenario(robots=(robot,), world=World(ground=False), package_paths=tuple(folders))
    parts = add_plant(builder, scenario, [plan])
    diagram = builder.Build()
    context = parts.plant.GetMyContextFromRoot(diagram.CreateDefaultContext())
    scene = seen_scene(parts.plant, parts.scene_graph.model_inspector(), Surroundings())
    poses = scene.poses(parts.plant.get_body_poses_output_port().Eval(context))
    root = parts.plant.GetBodyByName(plan.model.root_body, parts.robots[plan.name].instance)
    X_WR = parts.plant.EvalBodyPoseInWorld(context, root)
    radius = max(float(np.linalg.norm(upper - lower)) / 2.0, 0.05)
    back = np.array(_FROM) / np.linalg.norm(_FROM)
    distance = 1.05 * radius / np.sin(_FOV / 2.0)
    center = (lower + upper) / 2.0
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    R_RC = RotationMatrix(np.column_stack([right, np.cross(-back, right), -back]))
    X_WC = X_WR @ RigidTransform(R_RC, center + distance * back)
    width, height = _SIZE
    focal = height / 2.0 / np.tan(_FOV / 2.0)
    intrinsics = (focal, focal, (width - 1) / 2.0, (height - 1) / 2.0)
    view = View(COLOR, width, height, intrinsics, 0.01 * radius, 10.0 * distance)
    try:
        picture = Painter(scene).draw(view, np.concatenate([poses, X_WC.GetAsMatrix34()[np.newaxis]]))
    except NoOpenGLError as error:
        raise RunError(f"pictures need OpenGL (for example Mesa's libegl1): {error}") from None
    file_of_picture = io.BytesIO()
    Image.fromarray(picture).save(file_of_picture, "png")
    return file_of_picture.getvalue()


def main(parent: str, file: str, data: str) -> int:
    """Print a robot's picture, or what is wrong with it."""
    die_with(int(parent))
    arguments, folders = json.loads(data)
    try:
        print(base64.b64encode(png(file, arguments, folders)).decode())
    except (TwinError, RuntimeError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
