"""Programs that talk to a running twin over Zenoh, and mean what the ``ros2`` tools of the same names mean.

They need neither ROS nor Drake, whose import would take longer than what they do.
"""
