"""What cameras need: their lenses and messages, the scene, and the process that draws it.

`drake_twin.sensors.camera` has the kinds of cameras. What draws is imported for the first picture that is asked for.
"""
