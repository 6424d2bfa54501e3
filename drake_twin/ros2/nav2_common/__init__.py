"""Stand-ins for ``nav2_common``."""
