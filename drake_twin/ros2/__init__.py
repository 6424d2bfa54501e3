"""ROS 2 launch files, evaluated with no ROS on the machine: what they start.

`evaluate` is the way in, `launched` what comes out; the entities stand under ROS's own module names while a Python
launch file runs, see `ros_modules`.
"""
