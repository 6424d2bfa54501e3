"""What the command line programs share, one concept a file."""
