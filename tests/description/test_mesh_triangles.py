import numpy as np
import pytest
import trimesh

from drake_twin.description import mesh_triangles as module
from drake_twin.description.mesh_triangles import mesh_triangles


@pytest.mark.parametrize("suffix", [".obj", ".glb"])
def test_triangles_of_a_file_are_those_of_the_mesh(tmp_path, suffix, monkeypatch):
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    if suffix == ".glb":  # y is up in glTF: what is 3 m high is long along y there
        box.apply_transform([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    file = tmp_path / f"box{suffix}"
    box.export(file)
    vertices, faces = mesh_triangles(file)
    np.testing.assert_allclose(np.ptp(vertices, axis=0), (1.0, 2.0, 3.0), atol=1e-6)
    again = trimesh.Trimesh(vertices, faces)
    assert again.volume == pytest.approx(6.0)

    def read(file):
        raise AssertionError("the file was read again")

    monkeypatch.setattr(module, "_read", read)
    for kept, first in zip(mesh_triangles(file), (vertices, faces), strict=True):
        assert kept.tobytes() == first.tobytes()
