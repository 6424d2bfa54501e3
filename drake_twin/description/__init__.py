"""Robot files as plain data: packages, xacro, URDF, ``<ros2_control>``, controllers' YAML and meshes."""
