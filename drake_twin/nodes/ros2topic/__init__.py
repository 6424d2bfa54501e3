"""Stand-in for ``ros2topic``: what Python programs use of the command line's, in ``ros2topic.api``."""
