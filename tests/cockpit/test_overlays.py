"""What is drawn besides the robots: present while it is shown, gone afterwards, at the right place."""

import numpy as np
import pytest
from conftest import ARM, rovers
from pydrake.geometry import Box, Ellipsoid

from drake_twin import TwinBuilder
from drake_twin.cockpit.overlay import OVERLAY_KINDS
from drake_twin.cockpit.overlays.arrows import arrow_poses
from drake_twin.cockpit.overlays.contact_forces import _forces
from drake_twin.cockpit.overlays.frames import _in_world, _transforms
from drake_twin.cockpit.scene import OVERLAYS, Scene

NEED_MORE = ("sensors", "tracks", "goals", "fluids")  # than a rover that stands has


class Drawn:
    """What Meshcat would be told."""

    def __init__(self):
        self.objects = {}
        self.lines = {}
        self.moves = []
        self.colors = {}
        self.transforms = {}
        self.deleted = []

    def shared(self, twin):
        return Scene().shared(twin)

    def set_property(self, path, name, value):
        pass

    def set_lines(self, path, ends, color, **_):
        self.lines[path], self.colors[path] = ends, color

    def move(self, paths, poses):
        self.moves.append(poses)

    def set_object(self, path, shape, *color, **_):
        self.objects[path] = shape
        self.colors[path] = color

    def set_transform(self, path, pose):
        self.transforms[path] = pose

    def delete(self, path):
        self.deleted.append(path)


@pytest.fixture(scope="module")
def twin():
    twin = rovers(2).static_transform("world", "robot_1_odom").build()
    twin.advance_to(0.5)
    return twin


@pytest.mark.parametrize("name", [*OVERLAY_KINDS])
def test_an_overlay_is_there_while_it_is_shown_and_leaves_nothing(twin, name):
    scene = Scene()
    overlay = OVERLAY_KINDS[name].type(scene, twin)
    overlay.draw()
    assert scene.has_path(OVERLAYS) or name in NEED_MORE
    overlay.remove()
    assert not scene.has_path(OVERLAYS)


def test_collision_shapes_are_those_of_contact_and_go_along_with_their_links(twin):
    drawn = Drawn()
    shapes = OVERLAY_KINDS["collision"].type(drawn, twin)
    shapes.draw()
    path = f"{OVERLAYS}/collision/on/robot_2/robot_2_base_link"
    shapes_of_base = [shape for name, shape in drawn.objects.items() if name.startswith(f"{path}/")]
    assert [type(shape) for shape in shapes_of_base] == [Box]
    on = f"{OVERLAYS}/collision/on/robot_2"
    (of_wheel,) = [name for name in drawn.objects if name.startswith(f"{on}/robot_2_rear_left_wheel/")]
    (of_base,) = [name for name in drawn.objects if name.startswith(f"{path}/")]
    assert type(drawn.objects[of_wheel]) is Ellipsoid
    assert len({str(drawn.colors[name]) for name in (of_wheel, of_base)}) == 2
    assert path not in drawn.transforms  # the browser moves it


def test_an_inertia_ellipsoid_has_the_bodys_moments(tmp_path):
    file = tmp_path / "plate.urdf"
    file.write_text(
        '<robot name="plate"><link name="world"/><link name="a"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>'
        '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j"'
        ' type="continuous"><parent link="world"/><child link="a"/></joint></robot>'
    )
    drawn = Drawn()
    OVERLAY_KINDS["inertia"].type(drawn, TwinBuilder().robot("plate", file).build())
    (path,) = [path for path, shape in drawn.objects.items() if type(shape).__name__ == "Ellipsoid"]
    shape, place = drawn.objects[path], drawn.transforms[path]
    squares = sorted([shape.a() ** 2, shape.b() ** 2, shape.c() ** 2])
    moments = sorted(2 / 5 * (one + other) for one, other in zip(squares, squares[1:] + squares[:1], strict=True))
    assert moments == pytest.approx([0.02, 0.03, 0.04])
    assert place.translation() == pytest.approx([0.1, 0, 0])


def test_contact_arrows_are_drawn_for_wheels_on_the_ground(twin):
    scene = Scene()
    contacts = OVERLAY_KINDS["contacts"].type(scene, twin)
    contacts.draw()
    assert len([path for path in scene.everything().paths() if path.endswith("/shaft")]) == 8  # wheels


def test_frames_are_where_tf_puts_them(twin):
    links = {link.child_frame_id: link for topic in ("/tf_static", "/tf") for link in _transforms(twin, topic)}
    pose = _in_world("robot_2_base_link", links, {"world": np.eye(4)})
    assert pose[:3, 3] == pytest.approx(twin.robot_state("robot_2").base_pose[:3], abs=1e-9)
    wheel = twin.plant.GetBodyByName("robot_2_rear_left_wheel")
    truth = twin.plant.EvalBodyPoseInWorld(twin.plant.GetMyContextFromRoot(twin.context), wheel)
    assert _in_world("robot_2_rear_left_wheel", links, {"world": np.eye(4)}) == pytest.approx(
        truth.GetAsMatrix4(), abs=1e-9
    )


def test_frames_that_hang_on_nothing_and_circles_are_left_out(twin):
    links = {link.child_frame_id: link for link in _transforms(twin, "/tf")}
    child = next(iter(links))
    assert _in_world(child, {child: links[child]}, {"nowhere": np.eye(4)}) is None
    assert _in_world("unknown", links, {"world": np.eye(4)}) is None


def test_an_arms_frames_follow_its_joints_and_are_not_sent_again_while_time_stands():
    twin = TwinBuilder().robot("arm", ARM).build()
    drawn = Drawn()
    frames = OVERLAY_KINDS["frames"].type(drawn, twin)
    frames.draw()
    (before,) = drawn.moves
    frames.draw()
    assert len(drawn.moves) == 1
    twin.entities.set_joint_positions("arm", {"joint_1": 0.5})
    twin.advance_to(0.1)
    frames.draw()
    assert np.abs(drawn.moves[-1] - before)[:, :3, 3].max() > 0.01


def test_contact_arrows_carry_the_robots_and_crates_that_stand(tmp_path):
    crate = tmp_path / "crate.urdf"
    crate.write_text(
        '<robot name="crate"><link name="a"><inertial><mass value="3"/><inertia ixx="0.01" iyy="0.01" izz="0.01"'
        ' ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>'
        "</link></robot>"
    )
    twin = rovers(1).robot("crate", crate, xyz=(3, 0, 0.1)).build()
    twin.advance_to(1.0)
    force = sum(force for _, force in _forces(twin))
    plant = twin.plant
    weight = 9.81 * plant.CalcTotalMass(plant.GetMyContextFromRoot(twin.context))
    assert force == pytest.approx([0, 0, weight], abs=0.01 * weight)


def test_a_frames_axes_point_away_from_its_origin_along_x_y_and_z(twin):
    drawn = Drawn()
    OVERLAY_KINDS["frames"].type(drawn, twin).draw()
    path = f"{OVERLAYS}/frames/0"
    for axis, (ends, colors) in enumerate(
        zip(drawn.lines[path].reshape(3, 2, 3), drawn.colors[path].reshape(3, 2, 3), strict=True)
    ):
        assert ends[0] == pytest.approx([0, 0, 0])
        assert ends[1] / np.linalg.norm(ends[1]) == pytest.approx(np.eye(3)[axis])
        assert colors.argmax(axis=1).tolist() == [axis, axis]


def test_an_arrow_begins_at_its_point_and_is_as_long_as_its_vector():
    points = np.array([[1.0, 2, 3], [0, 0, 0], [4, 5, 6]])
    vectors = np.array([[0.0, 0, 0.2], [0.3, 0, 0], [-0.01, 0.02, -0.03]])
    arrows, shafts, heads = arrow_poses(points, vectors, 0.02).reshape(3, 3, 4, 4)
    for point, vector, arrow, shaft, head in zip(points, vectors, arrows, shafts, heads, strict=True):
        begin, end = (arrow @ shaft @ [0, 0, z, 1] for z in (-0.5, 0.5))  # of a cylinder of 1 m
        assert begin[:3] == pytest.approx(point)
        assert end[:3] == pytest.approx(point + vector)
        assert np.linalg.det(arrow[:3, :3]) == pytest.approx(1.0)
        tip = arrow @ head @ [0, 0, 0, 1]  # where Drake's cones have theirs
        assert tip[:3] == pytest.approx(point + vector + 0.02 * vector / np.linalg.norm(vector))
