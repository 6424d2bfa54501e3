"""Stand-ins for ``launch_ros``."""
