"""Stand-ins for ``launch_yaml``."""
