"""Stand-ins for ``controller_manager``."""
