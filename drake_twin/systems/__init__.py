"""Drake systems of a robot's sub-diagram, one LeafSystem a file.

Ports that carry ROS messages are abstract ports of `drake_twin.messages` types; None on such an input means that no
message has arrived yet. Output ports are computed on demand: only `GpioHardware` declares an event.
"""
