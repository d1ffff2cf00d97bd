"""Textures of Basis Universal in glTF: run by tests/python/usd.sh."""

import base64
import io
import json
import os
import pickle
import struct
import subprocess
import sys

import alktx2
import numpy as np
import pytest
from PIL import Image

import relumine

#: Four corners, each of a colour of its own: what is turned or mirrored shows.
CORNERS = {(0, 0): (200, 40, 40), (1, 0): (40, 200, 40), (0, 1): (40, 40, 200), (1, 1): (220, 220, 40)}


def picture(alpha=255):
    pixels = np.zeros((64, 64, 4), np.uint8)
    for (x, y), color in CORNERS.items():
        pixels[32 * y : 32 * y + 32, 32 * x : 32 * x + 32] = (*color, alpha)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "png")
    return file.getvalue()


def ktx2(folder, codec="uastc", **options):
    (folder / "in.png").write_bytes(picture(**options))
    alktx2.encode_image_to_ktx2(str(folder / "in.png"), str(folder / "out.ktx2"), codec=codec, srgb=True)
    return (folder / "out.ktx2").read_bytes()


def square(image, name="image.ktx2"):
    """A glTF document and its binary data: a square that is 2 wide, with a Basis texture."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)
    triangles = np.array([0, 1, 2, 0, 2, 3], np.uint32)
    views, data = [], b""
    for part in (corners.tobytes(), uvs.tobytes(), triangles.tobytes(), image):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(part)})
        data += part + b"\0" * (-len(part) % 4)
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_texture_basisu"],
        "extensionsRequired": ["KHR_texture_basisu"],
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
             "min": [-1, -1, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5125, "count": 6, "type": "SCALAR"},
        ],
        "images": [{"name": name, "bufferView": 3, "mimeType": "image/ktx2"}],
        "textures": [{"extensions": {"KHR_texture_basisu": {"source": 0}}}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    }, data  # fmt: skip


def glb(document, data):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    size = 28 + len(text) + len(data)
    return b"".join([
        struct.pack("<4s3I4s", b"glTF", 2, size, len(text), b"JSON"), text,
        struct.pack("<I4s", len(data), b"BIN\0"), data,
    ])  # fmt: skip


def drawn(path, *program):
    """The picture of a file under a white sky, and what was said."""
    picture = path.with_suffix(".drawn.png")
    environment = path.with_name("white.exr")
    relumine.Environment(np.ones((6, 8, 8, 3), np.float32), face_resolution=8).save(environment)
    run = subprocess.run(
        [*program, "relight", path, environment, "-o", picture, "--camera", "0,0",
         "--size", "48x48"],
        capture_output=True, text=True,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    return np.asarray(Image.open(picture).convert("RGB"), float), run.stderr


BY_PYTHON = (sys.executable, "-m", "relumine")
PLAIN = (os.environ["RELUMINE_PROGRAM"],)


def plainly(tmp_path, **options):
    """The picture of the same square with its PNG."""
    document, data = square(picture(**options))
    del document["extensionsRequired"], document["extensionsUsed"]
    document["textures"] = [{"source": 0}]
    (tmp_path / "png.glb").write_bytes(glb(document, data))
    return drawn(tmp_path / "png.glb", *PLAIN)[0]


@pytest.mark.parametrize("codec", ["uastc", "etc1s"])
def test_both_codecs_look_as_their_pictures(tmp_path, codec):
    path = tmp_path / "basis.glb"
    path.write_bytes(glb(*square(ktx2(tmp_path, codec))))
    expected = plainly(tmp_path)
    found, said = drawn(path, *BY_PYTHON)
    assert "basisu" not in said
    assert np.abs(found - expected).mean() < 2.0
    for other in (expected[::-1], expected[:, ::-1], expected.swapaxes(0, 1)):
        assert np.abs(found - other).mean() > 10.0, "it would show no turn"
    assert relumine.Mesh.load(path).materials[0]["base_color_texture"] == "image.ktx2"


def test_files_beside_a_gltf_and_in_it(tmp_path):
    document, data = square(ktx2(tmp_path))
    (tmp_path / "arrays.bin").write_bytes(data)
    document["buffers"][0]["uri"] = "arrays.bin"
    view = document["bufferViews"].pop()
    image = data[view["byteOffset"] :]
    (tmp_path / "a b.ktx2").write_bytes(image)
    document["images"] = [{"uri": "a%20b.ktx2"}]
    (tmp_path / "beside.gltf").write_text(json.dumps(document))
    inside = "data:image/ktx2;base64," + base64.b64encode(image).decode()
    document["images"] = [{"uri": inside}]
    (tmp_path / "inside.gltf").write_text(json.dumps(document))
    expected = plainly(tmp_path)
    for name in ("beside.gltf", "inside.gltf"):
        found, _ = drawn(tmp_path / name, *BY_PYTHON)
        assert np.abs(found - expected).mean() < 2.0, name


def test_a_broken_texture_is_named_and_left_out(tmp_path):
    good = ktx2(tmp_path)
    path = tmp_path / "broken.glb"
    path.write_bytes(glb(*square(good[: len(good) // 2])))
    with pytest.warns(relumine.RelumineWarning, match="the texture image.ktx2 is left out: "):
        relumine.Mesh.load(path)
    _, said = drawn(path, *BY_PYTHON)
    assert said.count("the texture image.ktx2 is left out: ") == 1
    path.write_bytes(glb(*square(good))[:-9])
    with pytest.raises(OSError, match="broken.glb: expected"):
        relumine.Mesh.load(path)


def test_the_bare_program_names_what_reads_them(tmp_path):
    path = tmp_path / "basis.glb"
    path.write_bytes(glb(*square(ktx2(tmp_path))))
    assert "pip install relumine[basis]" in drawn(path, *PLAIN)[1]


def test_a_pickle_reads_the_file_again(tmp_path):
    path = tmp_path / "basis.glb"
    path.write_bytes(glb(*square(ktx2(tmp_path))))
    mesh = relumine.Mesh.load(path)
    again = pickle.loads(pickle.dumps(mesh))
    assert again.materials == mesh.materials
