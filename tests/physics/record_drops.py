"""Record on which side other engines' bodies come to rest: MuJoCo, PyBullet, and DART as Gazebo's physics runs it.

``python tests/physics/record_drops.py GAZEBO`` writes ``drops.json`` beside this file. GAZEBO is a Python file with a
class ``Gz(world)``, a wrapper of gz-physics with ``step(count)`` and ``link(name)`` (position and quaternion w x y z).
"""

import json
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco
import numpy as np
import pybullet
from drops import APART, SECONDS, Drop, drops, upwards
from scipy.spatial.transform import Rotation

STEP = 0.001  # s
FILE = Path(__file__).parent / "drops.json"
GROUND = '<geom type="plane" size="9 9 1"/>'


def in_mujoco(drop: Drop) -> Rotation:
    """Friction 1, elliptic cones."""
    assets = shapes = ""
    for part in drop.parts:
        place = "{} {} {}".format(*part.xyz)
        if part.kind == "box":
            size = " ".join(str(value / 2) for value in part.sizes)
            shapes += f'<geom type="box" size="{size}" pos="{place}"/>'
        elif part.kind == "cylinder":
            shapes += f'<geom type="cylinder" size="{part.sizes[0]} {part.sizes[1] / 2}" pos="{place}"/>'
        else:
            vertices = np.round(part.mesh().vertices, 9).ravel().tolist()
            assets = f'<mesh name="hull" vertex="{" ".join(map(str, vertices))}" inertia="exact"/>'
            shapes += '<geom type="mesh" mesh="hull"/>'
    x, y, z, w = drop.turn.as_quat()
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = drop.inertia.tolist()
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><compiler inertiafromgeom="false"/>
<option timestep="{STEP}" cone="elliptic" integrator="implicitfast"/><asset>{assets}</asset>
<default><geom friction="1 0.005 0.0001" mass="0"/></default><worldbody>{GROUND}
<body pos="0 0 {drop.z}" quat="{w} {x} {y} {z}"><freejoint/>
<inertial pos="{" ".join(map(str, drop.center))}" mass="{drop.mass}" fullinertia="{xx} {yy} {zz} {xy} {xz} {yz}"/>
{shapes}</body></worldbody></mujoco>""")
    data = mujoco.MjData(model)
    if "mesh" in shapes:  # MuJoCo moves a mesh into the axes of its own inertia
        own = Rotation.from_quat(np.roll(model.mesh_quat[0], -1))
        model.geom_pos[1], model.geom_quat[1] = model.mesh_pos[0], np.roll(own.as_quat(), 1)
    mujoco.mj_step(model, data, int(SECONDS / STEP))
    return Rotation.from_quat(np.roll(data.qpos[3:7], -1))


def in_pybullet(drop: Drop) -> Rotation:
    """Friction 1 of both."""
    pybullet.resetSimulation()
    pybullet.setGravity(0, 0, -9.81)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=STEP, numSolverIterations=100)
    ground = pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE))
    pybullet.changeDynamics(ground, -1, lateralFriction=1.0, restitution=0.0)
    with TemporaryDirectory() as folder:
        (file := Path(folder) / "thing.urdf").write_text(drop.urdf(Path(folder) / "hull.obj").replace("file://", ""))
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        body = pybullet.loadURDF(str(file), (0, 0, 9), drop.turn.as_quat().tolist(), flags=flags)
    place = (np.array((0, 0, drop.z)) + drop.turn.apply(drop.center)).tolist()  # of its centre of mass
    frame = Rotation.from_quat(pybullet.getDynamicsInfo(body, -1)[4])
    pybullet.resetBasePositionAndOrientation(body, place, (drop.turn * frame).as_quat().tolist())
    pybullet.changeDynamics(body, -1, lateralFriction=1.0, restitution=0.0, linearDamping=0, angularDamping=0)
    pybullet.changeDynamics(body, -1, activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING)
    for _ in range(int(SECONDS / STEP)):
        pybullet.stepSimulation()
    return Rotation.from_quat(pybullet.getBasePositionAndOrientation(body)[1]) * frame.inv()


def in_dart(all_drops: tuple[Drop, ...], gazebo: Path) -> list[Rotation]:
    """All bodies in one world, apart from each other."""
    spec = spec_from_file_location("gazebo", gazebo)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    with TemporaryDirectory() as folder:
        models = "".join(_sdf(drop, number, Path(folder)) for number, drop in enumerate(all_drops))
        ground = "<collision name='c'><geometry><plane><normal>0 0 1</normal><size>999 999</size></plane></geometry>"
        ground = f"<model name='ground'><static>true</static><link name='l'>{ground}</collision></link></model>"
        world = f"<world name='w'><gravity>0 0 -9.81</gravity>{ground}{models}</world>"
        (file := Path(folder) / "world.sdf").write_text(f"<sdf version='1.9'>{world}</sdf>")
        dart = module.Gz(file)
    dart.step(int(SECONDS / STEP))
    links = {name.split("::")[-1]: name for name in dart.links}
    states = [dart.link(links[f"body{number}"]) for number in range(len(all_drops))]
    return [Rotation.from_quat(np.roll(state[3:7], -1)) for state in states]


def _sdf(drop: Drop, number: int, folder: Path) -> str:
    shapes = ""
    for index, part in enumerate(drop.parts):
        if part.kind == "hull":
            part.mesh().export(file := folder / f"{number}.stl")
            shape = f"<mesh><uri>{file}</uri></mesh>"
        elif part.kind == "box":
            shape = "<box><size>{} {} {}</size></box>".format(*part.sizes)
        else:
            shape = "<cylinder><radius>{}</radius><length>{}</length></cylinder>".format(*part.sizes)
        pose = "{} {} {} 0 0 0".format(*part.xyz)
        shapes += f"<collision name='c{index}'><pose>{pose}</pose><geometry>{shape}</geometry></collision>"
    rpy = " ".join(map(str, drop.turn.as_euler("xyz")))
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = drop.inertia.tolist()
    inertia = f"<ixx>{xx}</ixx><iyy>{yy}</iyy><izz>{zz}</izz><ixy>{xy}</ixy><ixz>{xz}</ixz><iyz>{yz}</iyz>"
    center = " ".join(map(str, drop.center))
    return (
        f"<model name='m{number}'><pose>{number * APART} 0 {drop.z} {rpy}</pose><link name='body{number}'><inertial>"
        f"<pose>{center} 0 0 0</pose><mass>{drop.mass}</mass><inertia>{inertia}</inertia></inertial>{shapes}"
        "</link></model>"
    )


def main() -> None:
    """Write the file."""
    all_drops = drops()
    pybullet.connect(pybullet.DIRECT)
    dart = in_dart(all_drops, Path(sys.argv[1]))
    rows = []
    for drop, rotation in zip(all_drops, dart, strict=True):
        turns = {"mujoco": in_mujoco(drop), "pybullet": in_pybullet(drop), "dart": rotation}
        rows.append({name: [round(value, 3) for value in upwards(turn)] for name, turn in turns.items()})
    lines = ",\n".join(json.dumps(row) for row in rows)
    FILE.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
