"""ROS 2 launch files, evaluated without ROS.

`evaluate` returns what a launch file starts, as `launched` describes. The folders ``launch``, ``launch_ros`` and so on
stand for ROS's modules of the same path, see `stand_in_modules`.
"""
