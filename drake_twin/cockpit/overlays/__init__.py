"""The twin's own overlays, one a file."""
