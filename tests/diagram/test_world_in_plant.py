import numpy as np
import pytest
import trimesh
from conftest import ROVER

from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.errors import InputError, RunError
from drake_twin.findings import Kind
from drake_twin.scenario import World

PLANE = "<collision name='c'><geometry><plane><normal>0 0 1</normal></plane></geometry></collision>"
GROUND = f"<model name='ground_plane'><static>true</static><link name='l'>{PLANE}</link></model>"
CRATE = """<model name="{name}"><pose>{pose}</pose><link name="l"><inertial><mass>2</mass><inertia><ixx>0.02</ixx>
<iyy>0.02</iyy><izz>0.02</izz></inertia></inertial>{flags}<collision name="c"><geometry><box><size>0.2 0.2 0.2</size>
</box></geometry></collision><visual name="v"><geometry><box><size>0.2 0.2 0.2</size></box></geometry></visual></link>
</model>"""


def crate(name="crate", pose="3 0 1 0 0 0", flags=""):
    return CRATE.format(name=name, pose=pose, flags=flags)


def static(shape, pose="0 0 0 0 0 0", name="block"):
    collision = f"<collision name='c'><geometry>{shape}</geometry></collision>"
    return f"<model name='{name}'><static>1</static><pose>{pose}</pose><link name='l'>{collision}</link></model>"


def twin_in(tmp_path, body, *, robot="robot_1", xyz=(0, 0, 0.13), **options):
    file = tmp_path / "w.world"
    file.write_text(f'<sdf version="1.9"><world name="w">{body}</world></sdf>')
    world = World(file=str(file), **options)
    return TwinBuilder(time_step=0.002, world=world).robot(robot, ROVER, xyz=xyz).build()


def model_state(twin, name):
    plant = twin.plant
    context = plant.GetMyContextFromRoot(twin.context)
    return plant.GetPositionsAndVelocities(context, plant.GetModelInstanceByName(name))


def height(twin, name="crate"):
    return model_state(twin, name)[6]


def test_a_free_body_falls_as_the_worlds_gravity_says(tmp_path):
    twin = twin_in(tmp_path, "<gravity>0 0 -1.62</gravity>" + GROUND + crate(pose="3 0 10 0 0 0"))
    twin.advance_to(1.0)
    assert model_state(twin, "crate")[12] == pytest.approx(-1.62)
    # Symplectic Euler, one half step of velocity beyond the parabola.
    assert height(twin) == pytest.approx(10 - 1.62 / 2 * (1.0 + 0.002), abs=1e-9)


def test_the_scenarios_gravity_goes_before_the_files(tmp_path):
    twin = twin_in(tmp_path, GROUND + crate(pose="3 0 10 0 0 0"), gravity=(0.0, 0.0, 0.0))
    twin.advance_to(0.5)
    assert height(twin) == 10


def test_a_crate_falls_onto_the_ground_and_rests(tmp_path):
    twin = twin_in(tmp_path, GROUND + crate())
    twin.advance_to(2.0)
    assert height(twin) == pytest.approx(0.1, abs=1e-3)
    assert np.abs(model_state(twin, "crate")[7:]).max() < 1e-3


def test_a_model_without_gravity_stays_where_it_is(tmp_path):
    twin = twin_in(tmp_path, GROUND + crate(flags="<gravity>0</gravity>"))
    twin.advance_to(1.0)
    assert height(twin) == 1.0


def test_the_rover_stands_on_a_box_of_the_world(tmp_path):
    body = GROUND + static("<box><size>4 4 0.5</size></box>", "0 0 0.25 0 0 0")
    twin = twin_in(tmp_path, body, xyz=(0, 0, 0.65))
    twin.advance_to(1.0)
    assert twin.robot_state("robot_1").base_pose[2] == pytest.approx(0.63, abs=2e-3)


def test_the_rover_pushes_a_crate(tmp_path):
    twin = twin_in(tmp_path, GROUND + crate(pose="0.6 0 0.1 0 0 0"))
    twin.publish("/robot_1/forward_velocity_controller/commands", [5, 5, 5, 5])
    twin.advance_to(2.0)
    assert model_state(twin, "crate")[4] > 0.8


def test_a_file_without_ground_has_none_and_the_scenario_may_add_or_take_it(tmp_path):
    heights = {}
    for name, body, ground in (
        ("none", "", None),
        ("added", "", True),
        ("file's", GROUND, None),
        ("off", GROUND, False),
    ):
        twin = twin_in(tmp_path, body, ground=ground)
        twin.advance_to(0.5)
        heights[name] = twin.robot_state("robot_1").base_pose[2]
    assert heights["added"] == pytest.approx(0.13, abs=1e-3)
    assert heights["file's"] == pytest.approx(0.13, abs=1e-3)
    assert heights["none"] < -1
    assert heights["off"] < -1


def test_the_files_friction_holds_or_lets_slip(tmp_path):
    """On a slope of 0.3 rad (tan 0.31) a crate stays where friction is 1, and slides where the ground's is 0.1."""
    for mu, slides in ((1.0, False), (0.05, True)):
        surface = f"<surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface></collision>"
        tilted = GROUND.replace("</collision>", surface).replace("<link", "<pose>0 0 0 0 0.3 0</pose><link")
        twin = twin_in(tmp_path, tilted + crate(pose="0 5 0.106 0 0.3 0"), ground=None)
        twin.advance_to(1.0)
        assert bool(model_state(twin, "crate")[4] > 0.2) is slides


SLAB = """<robot name="slab"><link name="l"><inertial><mass value="2"/><inertia ixx="0.05" ixy="0" ixz="0" iyy="0.05"
iyz="0" izz="0.1"/></inertial><collision><geometry><box size="0.5 0.5 0.05"/></geometry></collision></link>
<gazebo reference="l"><mu1>1.5</mu1><mu2>1.5</mu2></gazebo></robot>"""


@pytest.mark.parametrize(("world", "friction"), [("empty.sdf", 1.0), ("empty.world", 1.5)])
def test_the_ground_of_gazebos_own_worlds_has_its_friction_there(tmp_path, world, friction):
    """Gazebo classic's has that of its model (100 and 50), so that the slab's counts; gz-sim's has SDF's default."""
    file = tmp_path / "slab.urdf"
    file.write_text(SLAB)
    pull, press = 9.81 * np.sin(np.radians(60)), 9.81 * np.cos(np.radians(60))
    world = World(file=world, gravity=(pull, 0, -press))
    twin = TwinBuilder(world=world).robot("slab", str(file), xyz=(0, 0, 0.025)).build()
    speeds = []
    for time in (0.2, 0.4):
        twin.advance_to(time)
        speeds.append(model_state(twin, "slab")[10])
    assert (speeds[1] - speeds[0]) / 0.2 == pytest.approx(pull - friction * press, rel=0.01)


def test_the_scenarios_ground_friction_goes_before_the_files(tmp_path):
    tilted = GROUND.replace("<link", "<pose>0 0 0 0 0.3 0</pose><link")
    twin = twin_in(tmp_path, tilted + crate(pose="0 5 0.106 0 0.3 0"), ground_friction=0.05)
    twin.advance_to(1.0)
    assert model_state(twin, "crate")[4] > 0.2


def test_what_does_not_move_has_no_body_of_its_own(tmp_path):
    blocks = "".join(static("<box><size>1 1 1</size></box>", f"{9 + n} 9 1 0 0 0", f"b{n}") for n in range(20))
    bare, full = twin_in(tmp_path, ""), twin_in(tmp_path, blocks)
    assert full.plant.num_bodies() == bare.plant.num_bodies()
    assert twin_in(tmp_path, GROUND + blocks).plant.num_bodies() == bare.plant.num_bodies() + 1


def test_what_does_not_move_is_drawn_in_its_colour_where_it_stands(tmp_path):
    visual = """<visual name="v"><pose>0 0 1 0 0 0</pose><geometry><sphere><radius>0.3</radius></sphere></geometry>
    <material><diffuse>0.1 0.2 0.3 0.5</diffuse></material></visual>"""
    link = f"<link name='l'><pose>0 2 0 0 0 0</pose>{visual}</link>"
    twin = twin_in(tmp_path, f"<model name='ball'><static>1</static><pose>5 0 0 0 0 0</pose>{link}</model>")
    (geometry,) = twin.plant.GetVisualGeometriesForBody(twin.plant.world_body())
    scene_graph = twin.diagram.GetSubsystemByName("scene_graph")
    inspector = scene_graph.model_inspector()
    assert inspector.GetPoseInFrame(geometry).translation() == pytest.approx([5, 2, 1])
    color = inspector.GetIllustrationProperties(geometry).GetProperty("phong", "diffuse")
    assert color.rgba == pytest.approx([0.1, 0.2, 0.3, 0.5])


def test_models_in_a_static_model_stand_where_they_belong(tmp_path):
    shape = "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision>"
    inner = f"<model name='i'><pose>0 3 0 0 0 0</pose><link name='l'>{shape}</link></model>"
    twin = twin_in(tmp_path, f"<model name='o'><static>1</static><pose>9 0 0 0 0 0</pose>{inner}</model>")
    assert twin.findings.warnings == ()
    geometry = next(iter(twin.plant.GetCollisionGeometriesForBody(twin.plant.world_body())))
    inspector = twin.diagram.GetSubsystemByName("scene_graph").model_inspector()
    assert inspector.GetPoseInFrame(geometry).translation() == pytest.approx([9, 3, 0])


def test_hundreds_of_shapes_stand_beside_a_plane(tmp_path):
    blocks = "".join(
        static("<box><size>1 1 1</size></box>", f"{9 + 2 * (n % 25)} {9 + 2 * (n // 25)} 1 0 0 0", f"b{n}")
        for n in range(400)
    )
    twin = twin_in(tmp_path, GROUND + blocks)
    twin.advance_to(0.1)
    assert twin.robot_state("robot_1").base_pose[2] == pytest.approx(0.13, abs=1e-3)


def test_a_terrain_too_fine_for_the_plant_is_made_coarser_and_said_to_be(tmp_path):
    x, y = np.meshgrid(np.linspace(-10, 10, 60), np.linspace(-10, 10, 60))
    index = np.arange(3600).reshape(60, 60)
    a, b, c, d = index[:-1, :-1].ravel(), index[:-1, 1:].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel()
    vertices = np.column_stack([x.ravel(), y.ravel(), (0.3 * np.sin(x) * np.cos(y)).ravel()])
    faces = np.vstack([np.column_stack([a, b, d]), np.column_stack([a, d, c])])
    trimesh.Trimesh(vertices, faces).export(tmp_path / "hills.stl")
    twin = twin_in(tmp_path, static("<mesh><uri>hills.stl</uri></mesh>"), xyz=(0, 0, 0.4))
    assert twin.plant.NumBodiesWithName("static_world") == 0
    world = twin.plant.world_body()
    assert 100 < len(twin.plant.GetCollisionGeometriesForBody(world)) <= 1200
    assert any("have too many faces for contact" in warning for warning in twin.findings.warnings)
    twin.advance_to(1.0)
    assert 0 < twin.robot_state("robot_1").base_pose[2] < 0.4


def test_many_planes_that_are_walls_are_no_endless_ground(tmp_path):
    plane = "<plane><normal>-1 0 0</normal><size>1 1</size></plane>"
    walls = "".join(static(plane, f"{n} 5 0.5 0 0 0", f"wall{n}") for n in range(20))
    twin = twin_in(tmp_path, GROUND + walls + crate(pose="3.5 0 0.1 0 0 0"))
    twin.advance_to(0.5)
    assert model_state(twin, "crate")[4] == pytest.approx(3.5, abs=1e-6)


def test_a_rover_stands_inside_a_room_that_is_one_mesh(tmp_path):
    outer, inner = trimesh.creation.box((6, 6, 3)), trimesh.creation.box((5, 5, 2))
    inner.invert()
    trimesh.util.concatenate([outer, inner]).export(tmp_path / "room.stl")
    floor = 0.5
    room = static("<mesh><uri>room.stl</uri></mesh>", f"0 0 {floor + 1} 0 0 0")
    twin = twin_in(tmp_path, room, xyz=(0, 0, floor + 0.14))
    twin.publish("/robot_1/forward_velocity_controller/commands", [8, 8, 8, 8])
    twin.advance_to(5.0)
    x, _, z = twin.robot_state("robot_1").base_pose[:3]
    assert 1.5 < x < 2.5  # it drove up to the wall, and not through it
    assert z > floor + 0.1


def test_a_model_of_models_moves_as_one(tmp_path):
    inner = "<model name='lid'><pose>0 0 0.2 0 0 0</pose><link name='lid'/></model>"
    joint = "<joint name='j' type='fixed'><parent>l</parent><child>lid::lid</child></joint>"
    twin = twin_in(tmp_path, GROUND + crate().replace("</model>", f"{inner}{joint}</model>"))
    before = twin.state_sha256()
    twin.advance_to(1.0)
    assert height(twin) < 0.5
    assert twin.state_sha256() != before


def test_links_of_one_model_pass_through_each_other(tmp_path):
    two = crate().replace("</model>", crate().partition("<link")[2].join(("<link", "")).replace('"l"', '"l2"'))
    twin = twin_in(tmp_path, "<gravity>0 0 0</gravity>" + two)
    twin.advance_to(0.2)
    assert np.abs(model_state(twin, "crate")[-6:]).max() == 0


def test_the_state_hash_covers_what_moves_in_the_world(tmp_path):
    hashes = set()
    for _ in range(2):
        twin = twin_in(tmp_path, GROUND + crate())
        twin.advance_to(0.3)
        hashes.add(twin.state_sha256())
    assert len(hashes) == 1
    higher = twin_in(tmp_path, GROUND + crate(pose="3 0 1.5 0 0 0"))
    higher.advance_to(0.3)
    assert higher.state_sha256() not in hashes


def test_reset_puts_the_worlds_models_back(tmp_path):
    twin = twin_in(tmp_path, GROUND + crate())
    before = twin.state_sha256()
    twin.advance_to(0.5)
    twin.reset()
    assert twin.state_sha256() == before
    assert height(twin) == 1.0


def test_a_robot_cannot_have_the_name_of_a_model(tmp_path):
    with pytest.raises(InputError, match=r"w\.world: robot 'crate' has the name of a model of the world"):
        twin_in(tmp_path, crate(), robot="crate")


def test_a_model_that_drake_refuses_is_left_out_with_the_reason(tmp_path):
    bad = '<model name="bad"><link name="l"/><joint name="j" type="revolute"><child>gone</child></joint></model>'
    twin = twin_in(tmp_path, GROUND + bad + crate())
    (finding,) = (item for item in twin.findings if "the model is left out" in item.what)
    assert finding.what.startswith("bad: the model is left out, because Drake refuses it (")
    assert (finding.kind, len(finding.lines)) == (Kind.IGNORED, 1)
    assert height(twin) == 1.0


def test_a_model_that_is_nowhere_ends_the_run_by_its_name(tmp_path):
    twin = twin_in(tmp_path, GROUND + crate())
    context = twin.plant.GetMyMutableContextFromRoot(twin.context)
    body = twin.plant.GetBodyByName("l", twin.plant.GetModelInstanceByName("crate"))
    index = twin.plant.num_positions() + body.floating_velocities_start_in_v()
    context.get_mutable_discrete_state_vector().SetAtIndex(index, np.nan)
    with pytest.raises(RunError, match=r"model 'crate' of the world is no longer at a finite position"):
        twin.advance_to(0.1)


@pytest.mark.parametrize(("friction", "acts"), [(1e-4, None), (0.6, "0.402 instead of 0.6")])
def test_friction_that_acts_otherwise_in_a_large_world_is_told_only_where_that_shows(tmp_path, friction, acts):
    # Drake's pair has 2·a·b/(a + b): the robot's shape has the a that gives 0.6 with 50, and 0.402 with 0.6.
    surface = "<surface><friction><ode><mu>{0}</mu><mu2>{0}</mu2></ode></friction></surface>"
    box = "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry>{}</collision>"
    models = "".join(
        f"<model name='m{number}'><static>1</static><pose>{3 * number} 9 0 0 0 0</pose>"
        f"<link name='l'>{box.format(surface.format(50 if number else 0.6))}</link></model>"
        for number in range(102)
    )
    (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='w'>{models}</world></sdf>")
    robot = f"<model name='r'><link name='l'>{box.format(surface.format(friction))}</link></model>"
    (tmp_path / "r.sdf").write_text(f"<sdf version='1.9'>{robot}</sdf>")
    twin = TwinBuilder(world=World(file=str(tmp_path / "w.sdf"), ground=False)).robot("r", tmp_path / "r.sdf").build()
    about = [text.partition(" acts as ")[2] for text in twin.findings.warnings if "too many shapes" in text]
    assert about == ([] if acts is None else [acts])
