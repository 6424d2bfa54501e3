"""Worlds of water, and bodies in them, as SDF for tests of gz-sim's systems of the water."""

from itertools import pairwise

import numpy as np

from drake_twin import TwinBuilder
from drake_twin.scenario import World

G = 9.8  # SDF's default
WATER = 1000.0


def box(name, size, density=None, pose="0 0 0 0 0 0", *, mass=None, low=0.0, more="", collisions=None):
    """SDF of a box of a density, with its center of mass lower than its middle by ``low`` (m)."""
    x, y, z = size
    mass = density * x * y * z if mass is None else mass
    moments = dict(zip("xyz", (y * y + z * z, x * x + z * z, x * x + y * y), strict=True))
    inertia = "".join(f"<i{axis}{axis}>{mass / 12 * value}</i{axis}{axis}>" for axis, value in moments.items())
    geometry = f"<box><size>{x} {y} {z}</size></box>" if collisions is None else collisions
    return f"""<model name="{name}"><pose>{pose}</pose><link name="hull"><inertial><pose>0 0 {-low} 0 0 0</pose>
<mass>{mass}</mass><inertia>{inertia}</inertia></inertial>
<collision name="c"><geometry>{geometry}</geometry></collision></link>{more}</model>"""


def buoyancy(body="<uniform_fluid_density>1000</uniform_fluid_density>"):
    """SDF of gz-sim's Buoyancy."""
    return f'<plugin filename="gz-sim-buoyancy-system" name="gz::sim::systems::Buoyancy">{body}</plugin>'


def layers(*changes, below=WATER):
    """SDF of layers of a fluid, from (height, density above it)."""
    own = "".join(
        f"<density_change><above_depth>{height}</above_depth><density>{density}</density></density_change>"
        for height, density in changes
    )
    return buoyancy(f"<graded_buoyancy><default_density>{below}</default_density>{own}</graded_buoyancy>")


SEA = layers((0.0, 0.0))


# A twin has a robot: this one stands still beside the others.
POST = """<robot name="post"><link name="world"/><link name="top"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="foot" type="fixed"><parent link="world"/><child link="top"/></joint></robot>"""


def twin_of(folder, body, step=0.001, robots=None, **options):
    """A twin of a world with models in it, and robots: name → (their SDF, xyz, rpy)."""
    file = folder / "water.sdf"
    file.write_text(f'<sdf version="1.9"><world name="water">{body}</world></sdf>')
    builder = TwinBuilder(time_step=step, world=World(file=str(file), ground=False), **options)
    if robots is None:
        (folder / "post.urdf").write_text(POST)
        builder.robot("post", folder / "post.urdf", xyz=(50, 0, 0))
    for name, (text, xyz, *rpy) in (robots or {}).items():
        (folder / f"{name}.sdf").write_text(f'<sdf version="1.9">{text}</sdf>')
        builder.robot(name, folder / f"{name}.sdf", xyz=xyz, rpy=rpy[0] if rpy else (0, 0, 0))
    return builder.build()


def height(twin, name):
    return twin.entities.state(name).position[2]


def roll(twin, name):
    w, x, y, z = twin.entities.state(name).orientation
    return float(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)))


def sampled(twin, read, duration, every=0.01):
    """The times and values of a quantity while the twin runs."""
    times, values = [twin.time], [read()]
    for _ in range(round(duration / every)):
        twin.advance_to(round(twin.time + every, 9))
        times.append(twin.time)
        values.append(read())
    return np.array(times), np.array(values)


def period_of(times, values):
    """The period of an oscillation about zero, from where it passes that upwards."""
    crossings = [
        times[number] - before * (times[number + 1] - times[number]) / (after - before)
        for number, (before, after) in enumerate(pairwise(values))
        if before < 0 <= after
    ]
    return (crossings[-1] - crossings[0]) / (len(crossings) - 1)


def hydrodynamics(link="hull", /, **elements):
    """SDF of gz-sim's Hydrodynamics."""
    own = "".join(f"<{tag}>{value}</{tag}>" for tag, value in {"link_name": link, **elements}.items())
    return f'<plugin filename="gz-sim-hydrodynamics-system" name="gz::sim::systems::Hydrodynamics">{own}</plugin>'


def bladder(link="hull", /, **elements):
    """SDF of gz-sim's BuoyancyEngine."""
    own = "".join(f"<{tag}>{value}</{tag}>" for tag, value in {"link_name": link, **elements}.items())
    return f'<plugin filename="gz-sim-buoyancy-engine-system" name="gz::sim::systems::BuoyancyEngine">{own}</plugin>'


def thruster(joint="shaft", /, **elements):
    """SDF of gz-sim's Thruster."""
    values = {"joint_name": joint, "thrust_coefficient": 0.02, "propeller_diameter": 0.1, **elements}
    own = "".join(f"<{tag}>{value}</{tag}>" for tag, value in values.items() if value is not None)
    return f'<plugin filename="gz-sim-thruster-system" name="gz::sim::systems::Thruster">{own}</plugin>'


def propelled(size, *plugins, side=0.0, inertia=1e-4, density=WATER):
    """SDF of a box with a propeller of 0.1 kg behind it, whose thrust is along x at a distance from the middle (m)."""
    moments = "".join(f"<i{axis}{axis}>{inertia}</i{axis}{axis}>" for axis in "xyz")
    propeller = f"""<link name="propeller"><pose>-0.5 {side} 0 0 0 0</pose><inertial><mass>0.1</mass>
<inertia>{moments}</inertia></inertial></link><joint name="shaft" type="revolute"><parent>hull</parent>
<child>propeller</child><axis><xyz>1 0 0</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis></joint>"""
    return box("auv", size, density, more=propeller + "".join(plugins))
