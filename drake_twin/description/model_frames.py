"""Where the frames of a static model are."""

from collections import defaultdict

from lxml import etree
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FrameIndex

MODEL_FRAME = "__model__"  # of SDF


def model_frames(text: str) -> dict[str, dict[str, RigidTransform]]:
    """Return model → frame → pose in the world, of a static model and of the models inside it.

    Args:
        text: SDF of the model alone, for Drake's parser.

    Raises:
        RuntimeError: If Drake refuses the model.
    """
    root = etree.fromstring(text)
    for link in root.iter("link"):
        for shape in (*link.findall("collision"), *link.findall("visual")):
            link.remove(shape)
    plant = MultibodyPlant(0.001)
    Parser(plant).AddModelsFromString(etree.tostring(root, encoding="unicode"), "sdf")
    plant.Finalize()
    context = plant.CreateDefaultContext()
    found: defaultdict[str, dict[str, RigidTransform]] = defaultdict(dict)
    for frame in map(plant.get_frame, map(FrameIndex, range(plant.num_frames()))):
        model = plant.GetModelInstanceName(frame.model_instance())
        found[model][frame.name()] = plant.CalcRelativeTransform(context, plant.world_frame(), frame)
    return dict(found)
