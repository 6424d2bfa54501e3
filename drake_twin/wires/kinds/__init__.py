"""The twin's own kinds of wires, one in each module: their options on the command line."""
