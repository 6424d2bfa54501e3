"""The twin of a running robot: it follows it, compares the two, warns, and looks ahead."""
