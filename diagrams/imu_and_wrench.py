"""Sensors: the IMU on a box and the force/torque sensor below it, while the box is pushed.

Run it: python diagrams/imu_and_wrench.py
"""

from pathlib import Path
from tempfile import TemporaryDirectory

from drake_twin import TwinBuilder

URDF = """<robot name="stand"><link name="world"/>
<link name="post"><inertial><mass value="1"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="world"/><child link="post"/><origin xyz="0 0 1"/>
  <axis xyz="1 0 0"/><limit lower="-5" upper="5" effort="100" velocity="10"/></joint>
<link name="box"><inertial><mass value="2"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="mount" type="fixed"><parent link="post"/><child link="box"/></joint>
<gazebo reference="box"><sensor name="box_imu" type="imu"/></gazebo>
<gazebo reference="mount"><sensor name="mount_wrench" type="force_torque"/></gazebo>
<ros2_control name="hardware" type="system">
  <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
  <sensor name="box_imu">
    <state_interface name="orientation.x"/><state_interface name="orientation.y"/>
    <state_interface name="orientation.z"/><state_interface name="orientation.w"/>
    <state_interface name="angular_velocity.x"/><state_interface name="angular_velocity.y"/>
    <state_interface name="angular_velocity.z"/><state_interface name="linear_acceleration.x"/>
    <state_interface name="linear_acceleration.y"/><state_interface name="linear_acceleration.z"/>
  </sensor>
  <sensor name="mount_wrench">
    <state_interface name="force.x"/><state_interface name="force.y"/><state_interface name="force.z"/>
    <state_interface name="torque.x"/><state_interface name="torque.y"/><state_interface name="torque.z"/>
  </sensor>
</ros2_control></robot>"""

with TemporaryDirectory() as folder:
    file = Path(folder) / "stand.urdf"
    file.write_text(URDF)
    twin = (
        TwinBuilder()
        .robot("stand", file)
        .controller(
            "stand",
            "imu",
            "imu_sensor_broadcaster/IMUSensorBroadcaster",
            {"sensor_name": "box_imu", "frame_id": "box"},
        )
        .controller(
            "stand",
            "wrench",
            "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster",
            {"sensor_name": "mount_wrench", "frame_id": "mount"},
        )
        .build()
    )

twin.advance_to(0.5)
twin.entities.apply_wrench("stand::box", force=(6.0, 0.0, 0.0), duration=1.0)
for time in (0.5, 1.0):
    twin.advance_to(time)
    acceleration = twin.latest("/stand/imu/imu").linear_acceleration
    force = twin.latest("/stand/wrench/wrench").wrench.force
    print(f"{time} s: acceleration x {acceleration.x:.3f} z {acceleration.z:.3f} m/s², force z {force.z:.2f} N")

assert abs(acceleration.z - 9.81) < 1e-6
assert abs(acceleration.x - 6.0 / 3.0) < 1e-3  # 6 N on 1 kg + 2 kg
assert abs(abs(force.z) - 2 * 9.81) < 1e-3  # the mount carries the box
