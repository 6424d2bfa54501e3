"""The page of a twin that a Python program made: watch it and steer it in the browser while the program runs.

Run it: python diagrams/page_of_a_program.py

It ends after three seconds; run(until=None) would run until Ctrl-C.
"""

from drake_twin import TwinBuilder, show

ROVER = "package://rover_description/urdf/rover.urdf.xacro"

twin = TwinBuilder().robot("rover", ROVER, xyz=(0, 0, 0.13)).build()
page = show(twin)  # prints the page's address; in a notebook's cell the page itself appears
twin.publish("/rover/forward_velocity_controller/commands", [2.0, 4.0, 2.0, 4.0])
twin.run(until=3.0)  # in real time, and processes what is pressed on the page
print(f"the rover is at x {twin.robot_state('rover').base_pose[0]:.2f} m")
page.close()
