"""The page of several twins at once, drawn on a Meshcat server that outlives them."""
