"""Stand-ins for ``launch_xml``."""
