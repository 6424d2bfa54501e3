"""Stand-ins for ``ros_gz_sim``."""
