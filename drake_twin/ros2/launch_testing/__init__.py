"""Stand-ins for ``launch_testing``."""
