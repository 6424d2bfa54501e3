"""A page that several twins share, drawn by a Meshcat server in a process of its own."""
