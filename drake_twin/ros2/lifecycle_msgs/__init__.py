"""Stand-ins for ``lifecycle_msgs``."""
