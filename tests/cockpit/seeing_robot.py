"""A box with sensors before a wall."""

from drake_twin import TwinBuilder
from drake_twin.scenario import World

BOX = """<robot name="box"><link name="box"><inertial><mass value="2"/>
  <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size=".4 .4 .2"/></geometry></collision></link>
  <gazebo reference="box"><sensor name="lidar" type="gpu_lidar"><pose>0 0 0.4 0 0 0</pose><update_rate>10</update_rate>
    <lidar><scan><horizontal><samples>31</samples><min_angle>-0.3</min_angle><max_angle>0.3</max_angle></horizontal>
    </scan><range><min>0.1</min><max>20</max></range></lidar></sensor></gazebo>
  <gazebo reference="box"><sensor name="imu" type="imu"><update_rate>50</update_rate></sensor></gazebo>
  <gazebo reference="box"><sensor name="camera" type="camera"><pose>0 0 0.4 0 0 0</pose><update_rate>10</update_rate>
    <camera><horizontal_fov>1.0</horizontal_fov><image><width>640</width><height>480</height></image>
    <clip><near>0.05</near><far>20</far></clip></camera></sensor></gazebo>
</robot>"""
WALL = """<sdf version="1.9"><world name="w"><gravity>0 0 -9.81</gravity>
<model name="wall"><static>true</static><pose>2.5 0 1 0 0 0</pose><link name="l">
  <visual name="v"><geometry><box><size>1 20 4</size></box></geometry>
    <material><ambient>0.8 0.1 0.1 1</ambient><diffuse>0.8 0.1 0.1 1</diffuse></material></visual>
  <collision name="c"><geometry><box><size>1 20 4</size></box></geometry></collision>
  <sensor name="eye" type="altimeter"><update_rate>20</update_rate></sensor></link></model></world></sdf>"""


def seeing(folder, robots=1, camera="camera"):
    """Boxes side by side, 2 m before a red wall."""
    (folder / "box.urdf").write_text(BOX.replace('type="camera"', f'type="{camera}"'))
    (folder / "w.sdf").write_text(WALL)
    builder = TwinBuilder(world=World(file=str(folder / "w.sdf"), ground=True))
    for index in range(robots):
        builder.robot(f"box_{index}", folder / "box.urdf", xyz=(0, 2.0 * index, 0.1))
    return builder
