"""Where joints, links and bases are: arrays and indices that systems and controllers share, without Drake."""
