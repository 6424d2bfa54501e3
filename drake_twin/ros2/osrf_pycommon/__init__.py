"""Stand-ins for ``osrf_pycommon``."""
