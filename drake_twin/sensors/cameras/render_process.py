"""The process that draws the pictures of cameras: ``python -m drake_twin.sensors.cameras.render_process``.

It is told what to draw by a `Connection`, takes poses from a file in memory and puts pictures there, and ends when the
other end of the connection does. A process of its own, since Drake's renderer holds the interpreter's lock, and since
VTK ends the whole process where Mesa is installed by half.
"""

import mmap
import sys
from math import degrees, pi
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
from pydrake.geometry import (
    Box,
    Capsule,
    ClippingRange,
    ColorRenderCamera,
    Convex,
    Cylinder,
    DepthRange,
    DepthRenderCamera,
    Ellipsoid,
    FramePoseVector,
    GeometryFrame,
    GeometryInstance,
    HalfSpace,
    LightParameter,
    MakeRenderEngineVtk,
    Mesh,
    PerceptionProperties,
    RenderCameraCore,
    RenderEngineVtkParams,
    RenderLabel,
    Rgba,
    SceneGraph,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.systems.sensors import CameraInfo

from drake_twin.description.surroundings import Light
from drake_twin.python_process import ignore_stops
from drake_twin.sensors.cameras.picture import COLOR, DEPTH, NO_OPENGL, NO_SCENE, View
from drake_twin.sensors.cameras.scene import SeenScene, SeenShape

_GREY = np.array([0.9, 0.9, 0.9, 1.0])
_SHADOWS = 2048  # pixels of a shadow map's side
_BRIGHTNESS = pi  # of a light of intensity 1, by which a surface that faces it has its own color
# What no light of the world reaches is lit from four sides by points far away, which cast no shadows: how bright it is,
# linearly, beside lights and without any.
_FILL, _ALONE = 0.15, 0.6
_SIDES = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
_FAR_AWAY = 1e5  # m
_RENDERER = "vtk"
_POSSIBLE = 1e-4  # m: the least near clip
_NEAREST = 1e-2  # m, from which on depths are told apart from what is too near


class NoOpenGLError(RuntimeError):
    """Raised if OpenGL is missing."""


class Painter:
    """Draws one scene.

    Args:
        scene: What there is to see.

    Raises:
        NoOpenGLError: If OpenGL is missing.
        RuntimeError: If a file cannot be read.
    """

    def __init__(self, scene: SeenScene):
        self._scene_graph = graph = SceneGraph()
        self._source = graph.RegisterSource("seen")
        self._frames = [graph.RegisterFrame(self._source, GeometryFrame(f"{index}")) for index in scene.bodies]
        brightness = (_FILL if scene.lights else _ALONE) * _BRIGHTNESS
        lights = [
            LightParameter(type="point", frame="world", position=_FAR_AWAY * np.array(side), intensity=brightness)
            for side in _SIDES
        ]
        lights += map(_light, scene.lights)
        parameters = RenderEngineVtkParams(
            backend="EGL",
            force_to_pbr=True,  # else a glTF mesh that joins would change the look of everything
            default_diffuse=_GREY,
            default_clear_color=np.array(scene.background),
            lights=lights,
            cast_shadows=any(light.casts_shadows for light in scene.lights),
            shadow_map_size=_SHADOWS,
        )
        try:
            engine = MakeRenderEngineVtk(parameters)
        except RuntimeError as error:
            raise NoOpenGLError(str(error)) from None
        graph.AddRenderer(_RENDERER, engine)
        for number, shape in enumerate(scene.shapes):
            instance = GeometryInstance(_transform(np.reshape(shape.pose, (3, 4))), _shape(shape), f"{number}")
            instance.set_perception_properties(_look(shape))
            if shape.moves is None:
                graph.RegisterAnchoredGeometry(self._source, instance)
            else:
                graph.RegisterGeometry(self._source, self._frames[shape.moves], instance)
        self._context = graph.CreateDefaultContext()
        self._world = graph.world_frame_id()

    def draw(self, view: View, poses: np.ndarray) -> np.ndarray:
        """Return a picture.

        Args:
            view: What is asked for.
            poses: The poses of the bodies that move and, last, of the camera's optical frame, (bodies + 1, 3, 4).
        """
        vector = FramePoseVector()
        for frame, pose in zip(self._frames, poses[:-1], strict=True):
            vector.set_value(frame, _transform(pose))
        self._scene_graph.get_source_pose_port(self._source).FixValue(self._context, vector)
        query = self._scene_graph.get_query_output_port().Eval(self._context)
        fx, fy, cx, cy = view.intrinsics
        # Drake's renderer takes the center from the picture's corner, not from the center of its first pixel.
        info = CameraInfo(view.width, view.height, fx, fy, cx + 0.5, cy + 0.5)
        near = max(min(view.near, _NEAREST) if view.kind == DEPTH else view.near, _POSSIBLE)
        core = RenderCameraCore(_RENDERER, info, ClippingRange(near, view.far * 1.001), RigidTransform())
        X_WC = _transform(poses[-1])
        if view.kind == DEPTH:
            camera = DepthRenderCamera(core, DepthRange(max(view.near, near), view.far))
            depth = np.array(query.RenderDepthImage(camera, self._world, X_WC).data[:, :, 0])
            depth[depth == 0.0] = -np.inf  # what is too near
            return depth
        camera = ColorRenderCamera(core, False)
        if view.kind == COLOR:
            return np.asarray(query.RenderColorImage(camera, self._world, X_WC).data[:, :, :3])
        labels = np.asarray(query.RenderLabelImage(camera, self._world, X_WC).data[:, :, 0])
        return np.where(labels < int(RenderLabel.kMaxUnreserved), labels, 0).astype(np.uint16)


def serve(connection: Connection, file: int) -> None:
    """Draw what is asked for, until the other end of the connection closes."""
    memory: mmap.mmap | None = None
    painter: Painter | None = None
    while True:
        kind, *values = connection.recv()
        if kind == "scene":
            painter = None  # its memory first
            painter = Painter(*values)
            continue
        number, view, bodies, begin, size = values
        if memory is None or len(memory) < size:
            memory = mmap.mmap(file, size)
        assert painter is not None, "a picture without a scene"
        poses = np.frombuffer(memory, dtype=float, count=bodies * 12, offset=begin).reshape(bodies, 3, 4).copy()
        try:
            memory[begin : begin + view.size] = painter.draw(view, poses).tobytes()
            problem = ""
        except Exception as error:
            problem = _text(error)
        connection.send((number, problem))


def main(connection: str, file: str) -> None:
    """Serve; say what goes wrong to who has asked.

    Args:
        connection: The number of the connection's file.
        file: That of the memory.
    """
    ignore_stops()
    link: Any = Connection(int(connection))
    try:
        serve(link, int(file))
    except (EOFError, ConnectionError):
        return
    except NoOpenGLError as error:
        link.send((NO_OPENGL, _text(error)))
    except Exception as error:
        link.send((NO_SCENE, _text(error)))


def _text(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _transform(matrix: np.ndarray) -> RigidTransform:
    return RigidTransform(np.vstack([matrix, [0.0, 0.0, 0.0, 1.0]]))


def _shape(shape: SeenShape) -> Shape:
    sizes = shape.sizes
    if shape.kind == "plane":
        return HalfSpace()
    if shape.kind == "mesh":
        return Mesh(shape.file, np.array(sizes))
    if shape.kind == "hull":
        return Convex(np.reshape(sizes, (-1, 3)), "hull")
    kinds = {"box": Box, "sphere": Sphere, "cylinder": Cylinder, "capsule": Capsule, "ellipsoid": Ellipsoid}
    return kinds[shape.kind](*sizes)


def _look(shape: SeenShape) -> PerceptionProperties:
    properties = PerceptionProperties()
    properties.AddProperty("label", "id", RenderLabel(shape.label))
    if not shape.file.endswith((".gltf", ".glb")):  # these have their own
        if shape.color:
            properties.AddProperty("phong", "diffuse", Rgba(*shape.color))
        if shape.texture:
            properties.AddProperty("phong", "diffuse_map", shape.texture)
    return properties


def _light(light: Light) -> LightParameter:
    found = LightParameter(
        type=light.kind,
        frame="world",
        color=Rgba(*(min(1.0, max(0.0, part)) for part in light.color), 1.0),
        intensity=light.intensity * _BRIGHTNESS,
        position=np.array(light.position),
        direction=np.array(light.direction),
        attenuation_values=np.array(light.attenuation),
    )
    if light.kind == "spot":
        found.cone_angle = degrees(light.cone_angle) / 2.0
    return found


if __name__ == "__main__":
    main(*sys.argv[1:])
