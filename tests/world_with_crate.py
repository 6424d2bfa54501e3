"""A world with a ramp that never moves and a crate of 2 kg that does, and a rover in it."""

from conftest import ROVER

from drake_twin import TwinBuilder
from drake_twin.scenario import World

CRATE_AT = (-0.5, 0.9, 0.2)

_WORLD = """<sdf version="1.9"><world name="crates"><gravity>0 0 -9.81</gravity>
<light name="lamp" type="point"><pose>1 2 3 0 0 0</pose><diffuse>1 0.5 0 1</diffuse></light>
<model name="ramp"><static>true</static><pose>1 2 0.05 0 0 0</pose><link name="link">
  <collision name="c"><geometry><box><size>1 1 0.1</size></box></geometry>
    <surface><friction><ode><mu>0.5</mu><mu2>0.5</mu2></ode></friction></surface></collision>
  <visual name="v"><geometry><box><size>1 1 0.1</size></box></geometry></visual></link></model>
<model name="crate"><pose>-0.5 0.9 0.2 0 0 0</pose><link name="link">
  <inertial><mass>2</mass><inertia><ixx>0.053</ixx><iyy>0.053</iyy><izz>0.053</izz></inertia></inertial>
  <collision name="c"><geometry><box><size>0.4 0.4 0.4</size></box></geometry></collision>
  <visual name="v"><geometry><box><size>0.4 0.4 0.4</size></box></geometry>
    <material><diffuse>0.1 0.7 0.2 1</diffuse></material></visual></link></model>
</world></sdf>"""


def rover_and_crate(folder) -> TwinBuilder:
    """A rover at (-0.5, 0) beside the crate and the ramp."""
    file = folder / "crates.sdf"
    file.write_text(_WORLD)
    return TwinBuilder(world=World(file=str(file), ground=True)).robot("rover", ROVER, xyz=(-0.5, 0, 0.13))
