"""Stand-in for ``nav2_simple_commander`` of Nav2 1.3 (Jazzy): navigation as a library, for nodes beside Nav2."""
