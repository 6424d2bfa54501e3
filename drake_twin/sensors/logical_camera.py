"""A logical camera: which models are before it."""

from collections.abc import Iterator
from math import pi, tan

from pydrake.common.value import AbstractValue
from pydrake.math import RigidTransform
from pydrake.multibody.tree import ModelInstanceIndex, default_model_instance, world_model_instance
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.model_frames import MODEL_FRAME, model_frames
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem

_STATIC = "poses of static models"  # of `SensorHost.shared`
_POSSIBLE = 1e-9  # of lengths, angles and ratios that are above zero


@dataclass(frozen=True)
class LogicalCameraSettings:
    """What a logical camera reads of its element.

    Attributes:
        near: What is nearer is not seen (m).
        far: What is farther is not seen (m).
        across: Half the width of what is seen at 1 m (m).
        up: Half its height (m).
    """

    near: float
    far: float
    across: float
    up: float


@sensor("logical_camera")
class LogicalCamera(SensorSystem):
    """List the models whose origins are in its frustum, behind others or not (gz-sensors, src/LogicalCameraSensor.cc).

    Models are robots, models of the world and models inside these, each under its own name; of several with one name
    the last is listed (gz-sim, src/systems/logical_camera/LogicalCamera.cc).

    .. pydrake_system::

        name: LogicalCamera
        input_ports:
        - body_poses
        output_ports:
        - message

    - ``body_poses``: the plant's port of this name.
    - ``message``: ``ros_gz_interfaces/msg/LogicalCameraImage`` of the present time: the camera's pose in the world, and
      the models' in the camera.
    """

    message_type = "ros_gz_interfaces/msg/LogicalCameraImage"
    gz_topic = "logical_camera"

    @classmethod
    def read(cls, element: SensorElement) -> LogicalCameraSettings:
        """Read the frustum; the defaults are SDF's.

        Raises:
            InputError: If a value is invalid.
        """
        near = element.number("logical_camera/near", 0.0, least=0.0)
        far = element.number("logical_camera/far", 1.0)
        if far <= near:
            raise element.error(f"far is {far:g}, but it must be above near, {near:g}", "logical_camera/far")
        fov = element.number("logical_camera/horizontal_fov", 1.0, least=_POSSIBLE, most=pi - _POSSIBLE)
        ratio = element.number("logical_camera/aspect_ratio", 1.0, least=_POSSIBLE)
        return LogicalCameraSettings(near, far, tan(fov / 2.0), tan(fov / 2.0) / ratio)

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        self._body, self._pose = int(setup.body.index()), setup.pose
        self._poses = self.declare_plant_input("body_poses")
        self._moving = tuple(_moving(setup))
        self.declare_message_output(self._calc)

    def _calc(self, context: Context, output: AbstractValue) -> None:
        poses, settings = self._poses.Eval(context), self.setup.settings
        X_WC = poses[self._body] @ self._pose
        X_CW = X_WC.inverse()
        shared = self.host.shared
        if _STATIC not in shared:
            shared[_STATIC] = dict(_static(self.setup))
        models: dict[str, RigidTransform] = {name: X_CW @ X_WM for name, X_WM in shared[_STATIC].items()}
        models |= {name: X_CW @ poses[body] @ X_BM for name, body, X_BM in self._moving}
        seen = []
        for name, X_CM in sorted(models.items(), key=lambda item: item[0]):
            x, y, z = X_CM.translation().tolist()
            is_between = settings.near <= x <= settings.far
            if is_between and abs(y) <= x * settings.across and abs(z) <= x * settings.up:
                seen.append({"name": name, "pose": _pose(X_CM)})
        plain = {"header": self.header(context), "pose": _pose(X_WC), "model": seen}
        output.set_value(messages.message(self.message_type, plain))


def _moving(setup: SensorSetup) -> Iterator[tuple[str, int, RigidTransform]]:
    """Yield name, body and pose in the body of each model that has a place in the plant."""
    plant = setup.plant
    for instance in map(ModelInstanceIndex, range(plant.num_model_instances())):
        bodies = plant.GetBodyIndices(instance)
        if instance in (world_model_instance(), default_model_instance()) or not bodies:
            continue
        name = plant.GetModelInstanceName(instance)
        if plant.HasFrameNamed(MODEL_FRAME, instance):
            frame = plant.GetFrameByName(MODEL_FRAME, instance)
            body, pose = frame.body(), frame.GetFixedPoseInBodyFrame()
        else:
            body, pose = plant.get_body(bodies[0]), RigidTransform()
        yield name.rpartition("::")[2], int(body.index()), pose


def _static(setup: SensorSetup) -> Iterator[tuple[str, RigidTransform]]:
    """Yield name and pose in the world of each static model, and of the models inside it."""
    for model in setup.models:
        if model.is_static:
            for name, frames in model_frames(model.text).items():
                if MODEL_FRAME in frames:
                    yield name.rpartition("::")[2], frames[MODEL_FRAME]


def _pose(X: RigidTransform) -> dict[str, dict[str, float]]:
    x, y, z = X.translation().tolist()
    qw, qx, qy, qz = X.rotation().ToQuaternion().wxyz().tolist()
    return {"position": {"x": x, "y": y, "z": z}, "orientation": {"x": qx, "y": qy, "z": qz, "w": qw}}
