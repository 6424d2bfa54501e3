"""Worlds of crates, and rovers in them, for islands of any size."""

import numpy as np
from conftest import ROVER
from pydrake.math import RollPitchYaw

from drake_twin import TwinBuilder
from drake_twin.scenario import World

WHEELS = "/{}/forward_velocity_controller/commands"


def model(name, xyz, rpy=(0, 0, 0), size=(0.4, 0.4, 0.4), mass=2.0, mu=None, more=""):
    """A model of a world: a box; one of no mass does not move."""
    x, y, z = (float(side) for side in size)
    Ix, Iy, Iz = (mass / 12 * (one**2 + other**2) for one, other in ((y, z), (x, z), (x, y)))
    shape = f"<geometry><box><size>{x} {y} {z}</size></box></geometry>"
    pose = " ".join(map(str, (*xyz, *rpy)))
    surface = "" if mu is None else f"<surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface>"
    inertia = f"<inertia><ixx>{Ix}</ixx><iyy>{Iy}</iyy><izz>{Iz}</izz></inertia>"
    inertial = f"<inertial><mass>{mass}</mass>{inertia}</inertial>" if mass else ""
    return (
        f'<model name="{name}"><static>{"false" if mass else "true"}</static><pose>{pose}</pose><link name="link">'
        f'{inertial}<collision name="c">{shape}{surface}</collision>'
        f'<visual name="v">{shape}</visual>{more}</link></model>'
    )


def crates(folder, *models, gravity=-9.81, ground=True, time_step=0.002, **options):
    """A builder of a twin of such models."""
    file = folder / "crates.sdf"
    text = f'<sdf version="1.9"><world name="w"><gravity>0 0 {gravity}</gravity>{"".join(models)}</world></sdf>'
    file.write_text(text, encoding="utf-8")
    return TwinBuilder(world=World(file=str(file), ground=ground), time_step=time_step, **options)


def with_rovers(builder, *places, **options):
    """The same with rovers at x, y and yaw, named r0, r1 and so on."""
    for index, (x, y, yaw) in enumerate(places):
        builder.robot(f"r{index}", ROVER, xyz=(x, y, 0.13), rpy=(0, 0, yaw), **options)
    return builder


def drive(twin, robot, speed):
    """Turn all wheels of a rover (rad/s)."""
    twin.publish(WHEELS.format(robot), [speed] * 4)


def archipelago(twin):
    return twin._session.physics.islands.archipelago


def groups(twin):
    """The names in each island that is stepped."""
    found = archipelago(twin)
    return [tuple(found.movers[number].name for number in group) for group in found._groups]


def resting(twin):
    """The names of those that rest."""
    found = archipelago(twin)
    return {mover.name for mover, rests in zip(found.movers, found._rest.rested, strict=True) if rests}


def state(twin):
    return twin.plant.GetPositionsAndVelocities(twin.plant.GetMyContextFromRoot(twin.context))


def quaternion(rpy):
    return RollPitchYaw(*rpy).ToQuaternion().wxyz()


def pose(twin, name):
    found = twin.entities.state(name)
    return np.array([*found.position, *found.orientation])
