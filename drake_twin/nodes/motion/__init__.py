"""Motions of arms that `drake_twin.nodes.programs.move_group` plans: groups, kinematics, collisions, paths, times."""
