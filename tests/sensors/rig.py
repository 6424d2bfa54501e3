"""A box with sensors, in a world."""

from drake_twin import TwinBuilder
from drake_twin.scenario import World

BODY = """<robot name="box"><link name="box"><inertial><mass value="2"/>
  <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size=".4 .4 .2"/></geometry></collision></link>{}</robot>"""
START_HEIGHT = 0.1


def on_box(kind, inside="", name="s"):
    return f'<gazebo reference="box"><sensor name="{name}" type="{kind}">{inside}</sensor></gazebo>'


def twin_with(tmp_path, *sensors, world="", body=BODY, **options):
    """A twin of one robot named box, in a world with some elements."""
    (tmp_path / "box.urdf").write_text(body.format("".join(sensors)))
    more = {key: options.pop(key) for key in ("seed", "sensor_noise", "time_step", "engine") if key in options}
    if world is not None:
        text = f'<sdf version="1.9"><world name="w"><gravity>0 0 -9.81</gravity>{world}</world></sdf>'
        (tmp_path / "w.sdf").write_text(text)
        more["world"] = World(file=str(tmp_path / "w.sdf"), ground=True)
    options.setdefault("xyz", (0, 0, START_HEIGHT))
    return TwinBuilder(**more).robot("box", tmp_path / "box.urdf", **options).build()


def xyz(vector):
    return [vector.x, vector.y, vector.z]
