"""SDF's automatic inertia beside closed forms, and beside trimesh for meshes."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
import trimesh
from waters import POST

from drake_twin import TwinBuilder
from drake_twin.scenario import World


def weighed(folder, collisions, inertial='<inertial auto="true"/>'):
    """Mass, center of mass and inertia about it of a link with collisions, and what is said of it."""
    text = f'<sdf version="1.11"><model name="thing"><link name="l">{inertial}{collisions}</link></model></sdf>'
    (folder / "thing.sdf").write_text(text)
    twin = TwinBuilder().robot("thing", folder / "thing.sdf", xyz=(0, 0, 5)).build()
    inertia = twin.plant.GetBodyByName("l").default_spatial_inertia()
    center = inertia.get_com()
    tensor = inertia.Shift(center).CalcRotationalInertia().CopyToFullMatrix3()
    said = [item.what for item in twin.findings if "inertia" in item.what or "density" in item.what]
    return inertia.get_mass(), center, tensor, said


def collision(geometry, *, density=None, pose=""):
    own = "" if density is None else f"<density>{density}</density>"
    place = f"<pose>{pose}</pose>" if pose else ""
    return f'<collision name="c{len(geometry)}{pose}">{place}{own}<geometry>{geometry}</geometry></collision>'


def principal(*moments):
    return np.diag(moments)


@pytest.mark.parametrize(
    ("geometry", "volume", "center", "moments"),
    [
        ("<box><size>1 2 3</size></box>", 6.0, 0.0, (13 / 12, 10 / 12, 5 / 12)),
        ("<sphere><radius>0.5</radius></sphere>", pi / 6, 0.0, (0.1, 0.1, 0.1)),
        (
            "<cylinder><radius>0.5</radius><length>2</length></cylinder>",
            pi / 2,
            0.0,
            (0.25 / 4 + 4 / 12, 0.25 / 4 + 4 / 12, 0.125),
        ),
        (
            "<cone><radius>0.5</radius><length>2</length></cone>",
            pi * 0.25 * 2 / 3,
            -0.5,
            (3 / 80 * (1 + 4), 3 / 80 * (1 + 4), 0.3 * 0.25),
        ),
        ("<ellipsoid><radii>1 2 3</radii></ellipsoid>", 8 * pi, 0.0, (13 / 5, 10 / 5, 5 / 5)),
    ],
    ids=["box", "sphere", "cylinder", "cone", "ellipsoid"],
)
def test_shapes_have_the_mass_and_moments_of_mechanics(tmp_path, geometry, volume, center, moments):
    mass, place, tensor, said = weighed(tmp_path, collision(geometry, density=700))
    assert mass == pytest.approx(700 * volume)
    assert place == pytest.approx((0, 0, center), abs=1e-12)
    assert tensor == pytest.approx(mass * principal(*moments), abs=1e-9 * mass)
    assert said == []


def test_a_capsule_is_a_cylinder_and_a_sphere(tmp_path):
    radius, length = 0.3, 1.2
    text = f"<capsule><radius>{radius}</radius><length>{length}</length></capsule>"
    mass, _, tensor, _ = weighed(tmp_path, collision(text, density=1))
    mesh = trimesh.creation.capsule(length, radius, count=[256, 256])
    assert mass == pytest.approx(pi * radius**2 * (length + 4 / 3 * radius))
    assert tensor[2, 2] / mass == pytest.approx(mesh.moment_inertia[2, 2] / mesh.volume, rel=1e-3)
    assert tensor[0, 0] / mass == pytest.approx(mesh.moment_inertia[0, 0] / mesh.volume, rel=1e-3)


def test_two_shapes_add_up_where_they_are(tmp_path):
    """A dumbbell of two spheres, 2 m apart and turned about x."""
    ball = "<sphere><radius>0.1</radius></sphere>"
    pair = collision(ball, density=300, pose="0 1 0 0.4 0 0") + collision(ball, density=900, pose="0 -1 0 0 0 0")
    mass, center, tensor, _ = weighed(tmp_path, pair)
    one = 4 / 3 * pi * 0.1**3
    light, heavy = 300 * one, 900 * one
    assert (mass, center[1]) == pytest.approx((light + heavy, (light - heavy) / (light + heavy)))
    own = 0.4 * 0.01 * mass
    assert tensor == pytest.approx(principal(own, own, own) + light * heavy / mass * 4 * principal(1, 0, 1), abs=1e-9)


@pytest.mark.parametrize("scale", [(1, 1, 1), (0.5, 2, -1)])
def test_a_mesh_is_the_solid_within_its_triangles(tmp_path, scale):
    """A body that is not convex: a bracket of two boxes."""
    arm = trimesh.creation.box((1, 0.2, 0.2))
    post = trimesh.creation.box((0.2, 0.2, 1))
    post.apply_translation((0.6, 0, 0.4))
    bracket = trimesh.util.concatenate([arm, post])
    bracket.export(tmp_path / "bracket.stl")
    text = f"<mesh><uri>bracket.stl</uri><scale>{' '.join(map(str, scale))}</scale></mesh>"
    mass, center, tensor, _ = weighed(tmp_path, collision(text, density=500))
    bracket.apply_scale(scale)
    bracket.fix_normals()
    bracket.density = 500
    assert mass == pytest.approx(500 * (0.04 + 0.04) * abs(np.prod(scale)), rel=1e-6)
    assert center == pytest.approx(bracket.center_mass, abs=1e-6)
    assert tensor == pytest.approx(bracket.moment_inertia, rel=1e-5, abs=1e-6 * mass)


def test_a_links_density_is_that_of_collisions_without_one(tmp_path):
    box = "<box><size>1 1 1</size></box>"
    inertial = '<inertial auto="true"><density>20</density></inertial>'
    assert weighed(tmp_path, collision(box), inertial)[0] == pytest.approx(20)
    assert weighed(tmp_path, collision(box, density=30), inertial)[0] == pytest.approx(30)


def test_without_a_density_it_is_that_of_water_and_a_finding_says_so(tmp_path):
    mass, *_, said = weighed(tmp_path, collision("<box><size>1 0.1 0.1</size></box>"))
    assert mass == pytest.approx(10)
    assert said == ["link l: a collision has no <density>: it weighs 10 kg by 1000 kg/m³, as in Gazebo"]


def test_a_given_mass_scales_the_inertia(tmp_path):
    inertial = '<inertial auto="true"><mass>3</mass></inertial>'
    mass, _, tensor, said = weighed(tmp_path, collision("<sphere><radius>0.5</radius></sphere>"), inertial)
    assert (mass, tensor[0, 0]) == pytest.approx((3.0, 0.3))
    assert said == []


def test_what_has_no_volume_is_a_finding(tmp_path):
    mass, *_, said = weighed(tmp_path, "")
    assert mass == pytest.approx(1.0)
    assert said == ['link l: its inertia is auto="true", and no collision has a volume: it is that of 1 kg']
    negative = weighed(tmp_path, collision("<box><size>1 1 1</size></box>", density=-5))[3]
    assert "its density is -5 kg/m³, and has to be above zero" in negative[0]
    gone = weighed(tmp_path, collision("<mesh><uri>gone.stl</uri></mesh>", density=5))[3]
    assert gone[0].startswith("link l: a collision does not count for its inertia: ")


@pytest.mark.parametrize(("name", "part"), [("sphere", 2 / 5), ("cylinder", 1 / 2)])
def test_things_of_a_world_roll_down_a_slope_as_solids_do(tmp_path, name, part):
    """a = g sin φ / (1 + I / (m r²))."""
    size = "<radius>0.3</radius>" + ("<length>0.6</length>" if name == "cylinder" else "")
    slope = radians(10)
    thing = f'<link name="l"><inertial auto="true"/>{collision(f"<{name}>{size}</{name}>", density=50)}</link>'
    hill = f'<link name="g">{collision("<plane/>")}</link>'
    (tmp_path / "w.sdf").write_text(f"""<sdf version="1.11"><world name="w"><model name="hill"><static>1</static>
<pose>0 0 0 0 {slope} 0</pose>{hill}</model><model name="m"><pose>0 0 {0.3 / cos(slope)} {pi / 2} 0 0</pose>{thing}
</model></world></sdf>""")
    (tmp_path / "post.urdf").write_text(POST)
    builder = TwinBuilder(world=World(file=str(tmp_path / "w.sdf")))
    twin = builder.robot("post", tmp_path / "post.urdf", xyz=(50, 0, 0)).build()
    twin.advance_to(0.2)
    before = twin.entities.state("m").linear
    twin.advance_to(1.2)
    gained = np.linalg.norm(np.subtract(twin.entities.state("m").linear, before))
    assert gained == pytest.approx(9.8 * sin(slope) / (1 + part), rel=0.01)
