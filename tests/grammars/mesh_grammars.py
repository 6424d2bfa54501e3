"""Grammars of glTF, GLB, STL, OBJ and COLLADA: sound meshes with lying counts, lengths, indexes and references."""

import base64
import json
import struct
from xml.etree import ElementTree

from choices import Choices, as_xml, damaged
from xml_grammars import add

CORNERS = ((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1), (0.1, 0.1, 0.1), (0.05, 0.05, 0.2))
COUNTS = (0, 1, 2**16, 2**31 - 1, 2**32 - 1, 83, 84)
FLOATS = (float("nan"), float("inf"), -float("inf"), 1e30, 3e38, 1e-40, 0.0, 1e13)


def corners(c: Choices) -> list[tuple[float, ...]]:
    count = c.choice((3, 4, 6)) if not c.is_wrong() else c.choice((0, 1, 2))
    scale = c.choice((1, 1, 1000, 1e-6))
    points = [tuple(scale * (value + 0.01 * c.random()) for value in point) for point in CORNERS[:count]]
    if c.is_wrong():
        points = [tuple(c.choice(FLOATS) if c.maybe(0.3) else value for value in point) for point in points]
    if c.is_wrong():
        points = points[:1] * len(points)
    return points


def faces(c: Choices, count: int) -> list[tuple[int, ...]]:
    """Faces that close the solid, mostly."""
    found = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3), (1, 2, 4), (3, 4, 5)]
    found = [face for face in found if max(face) < count] or [(0, 0, 0)]
    if c.is_wrong():
        found.append(tuple(c.choice((-1, 0, 1, count, 2**16, 2**31, 2**32 - 1)) for _ in range(3)))
    return found


def stl(choices: Choices) -> dict[str, bytes]:
    c = choices
    points = corners(c)
    triangles = [[points[index % len(points)] for index in face] for face in faces(c, len(points))] if points else []
    if c.maybe():
        lines = ["solid x"]
        for triangle in triangles:
            lines += [f"facet normal {c.numbers(3)}", "outer loop"]
            texts = [[c.number() if c.is_wrong() else f"{value:g}" for value in point] for point in triangle]
            lines += [f"vertex {' '.join(text)}" for text in texts]
            lines += ["endloop", "endfacet"]
        lines.append("endsolid x")
        if c.is_wrong():
            lines.remove(c.choice(lines))
        return {"m.stl": damaged("\n".join(lines).encode("utf-8", "surrogatepass"), c)}
    count = c.choice(COUNTS) if c.is_wrong() else len(triangles)
    head = c.choice((b"", b"solid x", b"COLOR=")).ljust(80, b"\0")
    body = b"".join(struct.pack("<12fH", 0, 0, 1, *(v for p in t for v in p), c.randrange(3)) for t in triangles)
    return {"m.stl": damaged(head + struct.pack("<I", count) + body, c)}


def obj(choices: Choices) -> dict[str, bytes]:
    c = choices
    points = corners(c)
    material = c.word("m.mtl", "missing.mtl", "m.obj")
    lines = [f"mtllib {material}"] if c.maybe(0.3) else []
    lines += [f"v {' '.join(c.number() if c.is_wrong() else f'{value:g}' for value in point)}" for point in points]
    lines += ["vn 0 0 1"] if c.maybe() else []
    lines += ["vt 0 0"] if c.maybe(0.3) else []
    lines += [f"usemtl {c.word('red')}"] if c.maybe(0.3) else []
    for face in faces(c, len(points)):
        form = c.choice(("{}", "{}", "{}//1", "{}/1", "{}/1/1", "{}/")) if c.maybe(0.5) else "{}"
        indexes = [c.choice((-1, 0, index + 1, 99)) if c.is_wrong() else index + 1 for index in face]
        lines.append("f " + " ".join(form.format(index) for index in indexes))
    if c.is_wrong():
        wrong = c.choice(("f", "f 1", "v", "v 1 2", "l 1 2", "p 1", "o \xe9", "g", "\\"))
        lines.insert(c.randrange(len(lines) + 1), wrong)
    picture = c.word("picture.png", "m.mtl", "/dev/zero")
    mtl = f"newmtl red\nKd {c.numbers(3, 0, 1)}\nd {c.number(0, 1)}\nmap_Kd {picture}\n"
    return {
        "m.obj": damaged("\n".join(lines).encode("utf-8", "surrogatepass"), c),
        "m.mtl": damaged(mtl.encode("utf-8", "surrogatepass"), c),
        "picture.png": damaged(PICTURE, c),
    }


PICTURE = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)


def dae(choices: Choices) -> dict[str, bytes]:
    c = choices
    points, ns = corners(c), c.word("http://www.collada.org/2005/11/COLLADASchema")
    root = ElementTree.Element("COLLADA", version=c.word("1.4.1"), **({"xmlns": ns} if "\n" not in ns else {}))
    asset = add(root, "asset")
    add(asset, "unit", name="meter", meter=c.word("1", "0.001"))
    add(asset, "up_axis", c.word("Z_UP", "Y_UP"))
    images = add(root, "library_images")
    add(add(images, "image", id="i"), "init_from", c.word("picture.png", "missing.png"))
    effects = add(root, "library_effects")
    profile = add(add(effects, "effect", id="e"), "profile_COMMON")
    phong = add(add(profile, "technique", sid="common"), c.tag("phong", "lambert"))
    add(add(phong, "diffuse"), "color", c.numbers(4, 0, 1))
    add(add(add(root, "library_materials"), "material", id="mat"), "instance_effect", url=c.word("#e"))
    mesh = add(add(add(root, "library_geometries"), "geometry", id="g"), "mesh")
    source = add(mesh, "source", id="s")
    count = str(3 * len(points)) if not c.is_wrong() else c.number(0, 9)
    values = " ".join(c.number() if c.is_wrong() else f"{value:g}" for point in points for value in point)
    add(source, "float_array", values, id="a", count=count)
    accessor = add(add(source, "technique_common"), "accessor", source=c.word("#a"), stride=c.word("3"))
    accessor.set("count", str(len(points)))
    for axis in "XYZ":
        add(accessor, "param", name=axis, type="float")
    add(add(mesh, "vertices", id="v"), "input", semantic=c.word("POSITION"), source=c.word("#s"))
    found = faces(c, len(points))
    triangles = add(mesh, c.tag("triangles", "polylist"), material="mat", count=str(len(found)))
    add(triangles, "input", semantic="VERTEX", source=c.word("#v"), offset=c.word("0"))
    if triangles.tag == "polylist":
        add(triangles, "vcount", " ".join("3" for _ in found))
    add(triangles, "p", " ".join(str(index) for face in found for index in face))
    scene = add(add(root, "library_visual_scenes"), "visual_scene", id="vs")
    node = add(scene, "node", id="n")
    if c.maybe(0.3):
        add(node, c.choice(("matrix", "translate", "rotate", "scale")), c.numbers(c.choice((3, 4, 16))))
    if c.maybe(0.2):
        add(node, "instance_node", url=c.word("#n"))  # itself
    add(node, "instance_geometry", url=c.word("#g"))
    add(add(root, "scene"), "instance_visual_scene", url=c.word("#vs"))
    return {"m.dae": as_xml(root, c), "picture.png": PICTURE}


def _document(c: Choices) -> tuple[dict, bytes]:
    points = corners(c) or [(0.0, 0.0, 0.0)]
    found = faces(c, len(points))
    data = b"".join(struct.pack("<3f", *point) for point in points)
    indexes = b"".join(struct.pack("<3I", *(index & 0xFFFFFFFF for index in face)) for face in found)
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"},
        {"bufferView": 1, "componentType": 5125, "count": 3 * len(found), "type": "SCALAR"},
    ]
    finite = [point for point in points if all(value == value for value in point)] or [(0, 0, 0)]
    accessors[0]["min"] = [min(point[axis] for point in finite) for axis in range(3)]
    accessors[0]["max"] = [max(point[axis] for point in finite) for axis in range(3)]
    nodes = [{"mesh": 0}]
    for number in range(c.choice((0, 0, 1, 4))):
        nodes[number]["children"] = [number + 1]
        moved = ({"translation": [0, 0, 1]}, {"mesh": 0, "scale": [1, 2, 1]}, {"rotation": [0, 0, 0, 1]})
        nodes.append(c.choice(moved))
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": accessors,
        "bufferViews": [
            {"buffer": 0, "byteLength": len(data)},
            {"buffer": 0, "byteOffset": len(data), "byteLength": len(indexes)},
        ],
        "buffers": [{"byteLength": len(data) + len(indexes)}],
    }
    if c.maybe(0.4):
        document["meshes"][0]["primitives"][0]["material"] = 0
        looks = {"baseColorFactor": [1, 0, 0, 1], "baseColorTexture": {"index": 0}}
        document["materials"] = [{"pbrMetallicRoughness": looks}]
        document["textures"] = [{"source": 0, "sampler": 0}]
        document["samplers"] = [{"wrapS": 10497}]
        document["images"] = [{"uri": c.word("picture.png", "missing.png", "data:image/png;base64,AAAA")}]
    if c.maybe(0.2):
        document["skins"] = [{"joints": [0]}]
        document["animations"] = [
            {"channels": [{"sampler": 0, "target": {"node": 0}}], "samplers": [{"input": 1, "output": 0}]}
        ]
    if c.is_wrong():
        count = c.choice(COUNTS)
        holder = c.choice([*accessors, *document["bufferViews"], *document["buffers"]])
        holder[c.choice(("count", "byteLength", "byteOffset", "byteStride"))] = count
    return document, data + indexes


def gltf(choices: Choices) -> dict[str, bytes]:
    c = choices
    document, data = _document(c)
    inside = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    document["buffers"][0]["uri"] = c.word("m.bin", "m.bin", inside)
    return {
        "m.gltf": damaged(json.dumps(c.altered(document)).encode(), c),
        "m.bin": damaged(data, c),
        "picture.png": PICTURE,
    }


def glb(choices: Choices) -> dict[str, bytes]:
    c = choices
    document, data = _document(c)
    text = json.dumps(c.altered(document)).encode()
    text += b" " * (-len(text) % 4)

    def length(actual: int) -> int:
        return c.choice(COUNTS) if c.is_wrong() else actual

    parts = struct.pack("<I4s", length(len(text)), b"JSON") + text
    parts += struct.pack("<I4s", length(len(data)), b"BIN\0") + data
    head = struct.pack("<4sII", b"glTF", 1 if c.is_wrong() else 2, length(12 + len(parts)))
    return {"m.glb": damaged(head + parts, c)}


def ply(choices: Choices) -> dict[str, bytes]:
    c = choices
    points = corners(c)
    found = faces(c, len(points))
    form = c.word("ascii", "binary_little_endian")
    count = c.choice(COUNTS) if c.is_wrong() else len(points)
    head = f"ply\nformat {form} 1.0\nelement vertex {count}\n" + "".join(f"property float {axis}\n" for axis in "xyz")
    head += f"element face {c.choice(COUNTS) if c.is_wrong() else len(found)}\n"
    head += f"property list {c.word('uchar', 'uint')} {c.word('int')} vertex_indices\nend_header\n"
    if form == "ascii":
        body = "".join(f"{' '.join(f'{value:g}' for value in point)}\n" for point in points).encode()
        body += "".join(f"3 {' '.join(map(str, face))}\n" for face in found).encode()
    else:
        body = b"".join(struct.pack("<3f", *point) for point in points)
        body += b"".join(struct.pack("<B3I", 3, *(index & 0xFFFFFFFF for index in face)) for face in found)
    return {"m.ply": damaged(head.encode("utf-8", "surrogatepass") + body, c)}
