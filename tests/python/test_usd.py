"""Stages of USD as scenes, and light back into stages: run by tests/python/usd.sh."""

import io
import itertools
import json
import math
import os
import re
import struct
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from PIL import Image
from pxr import Usd, UsdGeom, UsdLux, UsdValidation

import relumine
import relumine.usd

pytestmark = pytest.mark.filterwarnings("ignore::relumine.RelumineWarning")


def usda(text, head=""):
    """A text as the format wants it: a line for each statement."""
    lines = re.sub(r"(?<=\S) *\}", "\n}", text.replace("{ ", "{\n"))
    return f"#usda 1.0\n(\n{head}\n)\n{lines}"


def stage_of(text, up="Y", meters=1.0):
    stage = Usd.Stage.CreateInMemory()
    head = f'    upAxis = "{up}"\n    metersPerUnit = {meters}'
    assert stage.GetRootLayer().ImportFromString(usda(text, head))
    return stage


def loaded(text, up="Y", meters=1.0, **options):
    return relumine.usd.load(stage_of(text, up, meters), **options)


CARD = """
def Mesh "Card" {{
    uniform token subdivisionScheme = "none"
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [{}]
    color3f[] primvars:displayColor = [(1, 1, 1)]
}}
"""
TRIANGLE = """
def Mesh "M" {
    uniform token subdivisionScheme = "none"
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
"""


def card(place, normal, side=0.001):
    """A small white square."""
    n = np.asarray(normal, float) / np.linalg.norm(normal)
    u = np.cross(np.eye(3)[np.abs(n).argmin()], n)
    u /= np.linalg.norm(u)
    v = np.cross(n, u)
    corners = [
        np.asarray(place) + side * (x * u + y * v) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    return CARD.format(", ".join(f"({c[0]:.9f}, {c[1]:.9f}, {c[2]:.9f})" for c in corners))


def radiance_of_card(light, place, normal, up="Y", meters=1.0):
    """What a white card in the stage's axes sends out."""
    asset = loaded(light + card(place, normal), up, meters)
    relighter = relumine.Relighter(relumine.precompute(asset.mesh, refine=False, bounces=False))
    asset.light(relighter)
    (drawn,) = [d for d in asset._drawn if d.path == "/Card"]
    return np.array(relighter.radiance)[drawn.first : drawn.first + 4].mean(0)


def polygon_irradiance(corners, place, normal):
    """Lambert's formula, for a radiance of 1 and a polygon above the horizon."""
    p = [np.asarray(c, float) - place for c in corners]
    p = [c / np.linalg.norm(c) for c in p]
    total = np.zeros(3)
    for a, b in zip(p, p[1:] + p[:1]):
        n = np.cross(a, b)
        total += math.acos(np.clip(a @ b, -1, 1)) * n / np.linalg.norm(n)
    return abs(total @ np.asarray(normal)) / 2


def light(kind, **inputs):
    lines = "\n".join(
        f"    {value[0]} inputs:{name} = {value[1]}" for name, value in inputs.items()
    )
    return f'def {kind} "L" {{\n    float inputs:intensity = 10\n{lines}\n}}\n'


def number(x):
    return ("float", x)


ON = ("bool", 1)
RECT = [(-0.5, -0.25, 0), (0.5, -0.25, 0), (0.5, 0.25, 0), (-0.5, 0.25, 0)]


@pytest.mark.parametrize(
    "text, place, normal, expected",
    [
        (light("DistantLight", angle=number(10)), (0, 0, 0), (0, 0, 1), 10 * math.sin(math.radians(5)) ** 2),
        (light("DistantLight", angle=number(10)), (0, 0, 0), (0, 0.6, 0.8), 8 * math.sin(math.radians(5)) ** 2),
        (light("DistantLight", angle=number(10)), (0, 0, 0), (0, 0, -1), 0),
        (light("DistantLight", angle=number(10), normalize=ON), (0, 0, 0), (0, 0, 1), 10 / math.pi),
        (light("DistantLight", angle=number(0.53), normalize=ON), (0, 0, 0), (0, 0, 1), 10 / math.pi),
        (light("DistantLight", angle=number(0)), (0, 0, 0), (0, 0, 1), 10 / math.pi),
        (light("SphereLight", radius=number(0.5)), (0, 0, -3), (0, 0, 1), 10 * 0.25 / 9),
        (light("SphereLight", radius=number(0.5)), (2, 0, 0), (-1, 0, 0), 10 * 0.25 / 4),
        (light("SphereLight", radius=number(0.5), normalize=ON), (0, 0, -3), (0, 0, 1), 10 / math.pi / 36),
        (light("SphereLight", radius=number(0), normalize=ON), (0, 0, -3), (0, 0, 1), 10 / math.pi / 36),
        (light("DiskLight", radius=number(0.5)), (0, 0, -3), (0, 0, 1), 10 * 0.25 / 9.25),
        (light("DiskLight", radius=number(0.5)), (0, 0, 3), (0, 0, -1), 0),
        (light("DiskLight", radius=number(0.5), normalize=ON), (0, 0, -3), (0, 0, 1), 10 / math.pi / 9.25),
        (light("RectLight", width=number(1), height=number(0.5)), (0, 0, -3), (0, 0, 1),
         10 / math.pi * polygon_irradiance(RECT, (0, 0, -3), (0, 0, 1))),
        (light("RectLight", width=number(1), height=number(0.5)), (0, 0, 3), (0, 0, -1), 0),
        (light("RectLight", width=number(1), height=number(0.5), normalize=ON, exposure=number(1)), (1, 1, -3), (0, 0, 1),
         40 / math.pi * polygon_irradiance(RECT, (1, 1, -3), (0, 0, 1))),
    ],
)  # fmt: skip
@pytest.mark.parametrize("up, meters", [("Y", 1.0), ("Z", 0.01)])
def test_lights_have_the_radiance_of_their_formulas(text, place, normal, expected, up, meters):
    """UsdLux's numbers are of the stage's unit, so metres change nothing."""
    got = radiance_of_card(text, place, normal, up, meters)
    assert got == pytest.approx([expected] * 3, rel=0.01, abs=1e-6)


def test_a_cylinder_light_shines_from_its_side_alone():
    text = light("CylinderLight", radius=number(0.2), length=number(2))
    x = (np.arange(400) + 0.5) / 400 * 2 - 1
    t = (np.arange(400) + 0.5) / 400 * 2 * math.pi
    x, t = np.meshgrid(x, t)
    normal = np.stack([0 * x, np.cos(t), np.sin(t)], -1)
    to_light = np.stack([x, 0.2 * np.cos(t), 0.2 * np.sin(t)], -1) - [0, 0, -3]
    r = np.linalg.norm(to_light, axis=-1)
    cosines = np.clip(to_light[..., 2] / r, 0, 1) * np.clip(-(to_light * normal).sum(-1) / r, 0, 1)
    irradiance = (cosines / r**2).sum() * (2 / 400) * (2 * math.pi * 0.2 / 400)
    got = radiance_of_card(text, (0, 0, -3), (0, 0, 1))
    assert got == pytest.approx([10 * irradiance / math.pi] * 3, rel=0.01)
    assert radiance_of_card(text, (4, 0, 0), (-1, 0, 0)) == pytest.approx([0] * 3, abs=1e-6)


def ies_file(folder, candela, vertical=range(0, 181, 5), horizontal=(0,), head="1 -1 1"):
    """A file of LM-63 in a folder, and what it has at (vertical, horizontal)."""
    rows = ["IESNA:LM-63-2002", "TILT=NONE"]
    rows.append(f"{head} {len(vertical)} {len(horizontal)} 1 2 0 0 0\n1 1 1")
    rows += [" ".join(map(str, vertical)), " ".join(map(str, horizontal))]
    rows += [" ".join(f"{candela(v, h):.9g}" for v in vertical) for h in horizontal]
    (folder / "lamp.ies").write_text("\n".join(rows) + "\n")
    return ("asset", f"@{folder / 'lamp.ies'}@")


IES, SCALE = "shaping:ies:file", "shaping:ies:angleScale"
IES_NORMALIZE = "shaping:ies:normalize"


@pytest.mark.parametrize("up, meters", [("Y", 1.0), ("Z", 0.01)])
def test_profiles_shape_lights(tmp_path, up, meters):
    def seen(kind, direction, **inputs):
        """Radiance of a card around the light, times pi: intensity."""
        d = np.array(direction, float) / np.linalg.norm(direction)
        text = light(kind, **inputs)
        return math.pi * 9.0 * radiance_of_card(text, tuple(3.0 * d), tuple(-d), up, meters).mean()

    def at(v, h=0.0):
        v, h = math.radians(v), math.radians(h)
        return (math.sin(v) * math.cos(h), math.sin(v) * math.sin(h), -math.cos(v))

    def slope(v, h):
        return 100.0 - 0.5 * v + (0.1 * h if v else 0.0)

    file = ies_file(tmp_path, slope, horizontal=(0, 90))
    sphere = {"radius": number(0.5), IES: file}
    own = 10 * math.pi * 0.25
    for v, h in ((0, 0), (40, 0), (40, 90), (130, 45), (60, 210)):
        expected = own * slope(v, {210: 30}.get(h, h))
        assert seen("SphereLight", at(v, h), **sphere) == pytest.approx(expected, rel=0.003)
    found = seen("SphereLight", at(40), **{**sphere, SCALE: number(2)})
    assert found == pytest.approx(own * slope(20, 0), rel=0.003)
    found = seen("SphereLight", at(140), **{**sphere, SCALE: number(-0.5)})
    assert found == pytest.approx(own * slope(100, 0), rel=0.003)
    # Half a degree beyond what is left of the angles there is nothing.
    assert seen("SphereLight", at(89.0), **{**sphere, SCALE: number(-0.5)}) == 0.0
    found = seen("SphereLight", at(40), normalize=ON, **sphere)
    assert found == pytest.approx(10 / 4 * slope(40, 0), rel=0.003)
    cone = {"shaping:cone:angle": number(60), "shaping:cone:softness": number(0.5)}
    found = seen("SphereLight", at(45), **{**sphere, **cone})
    assert found == pytest.approx(own * slope(45, 0) * 0.5, rel=0.005)
    flat = {IES: ies_file(tmp_path, lambda v, h: 7.0), IES_NORMALIZE: ON}
    for v in (0, 50, 85):
        found = seen("RectLight", at(v), width=number(1), height=number(0.5), **flat)
        assert found == pytest.approx(10 * 0.5 * math.cos(math.radians(v)), rel=0.003)
        found = seen("DiskLight", at(v), radius=number(0.5), **flat)
        assert found == pytest.approx(10 * math.pi / 4 * math.cos(math.radians(v)), rel=0.003)
    assert seen("RectLight", at(95), width=number(1), height=number(0.5), **flat) == 0.0


def test_profiles_of_half_a_sphere_are_normalized_by_half(tmp_path):
    file = ies_file(tmp_path, lambda v, h: 5.0, range(0, 91, 5))
    text = light("SphereLight", radius=number(0.5), **{IES: file, IES_NORMALIZE: ON})
    found = radiance_of_card(text, (0, 0, -3), (0, 0, 1)).mean()
    assert found == pytest.approx(10 * 0.25 / 9, rel=0.003)


def test_profiles_that_cannot_be_read_are_named(tmp_path):
    (tmp_path / "lamp.ies").write_text("no lamp\n")
    for file in (f"@{tmp_path / 'lamp.ies'}@", "@gone.ies@"):
        text = light("SphereLight", radius=number(0.5), **{IES: ("asset", file)})
        asset = loaded(text + TRIANGLE + "}")
        assert asset.lamps == ["L"]
        assert any("its IES profile is left out: " in line for line in asset.notes)
    file = ies_file(tmp_path, lambda v, h: 1.0)
    asset = loaded(light("CylinderLight", **{IES: file}) + TRIANGLE + "}")
    assert any("an IES profile of such a light is left out" in line for line in asset.notes)


def test_colour_and_temperature():
    text = light("DistantLight", angle=number(20), color=("color3f", "(1, 0.5, 0.25)"),
                 enableColorTemperature=ON, colorTemperature=number(3000))  # fmt: skip
    tint = np.array([1, 0.5, 0.25]) * np.array(UsdLux.BlackbodyTemperatureAsRgb(3000))
    expected = 10 * math.sin(math.radians(10)) ** 2 * tint
    assert radiance_of_card(text, (0, 0, 0), (0, 0, 1)) == pytest.approx(expected, rel=0.01)


def lat_long(height=64):
    """Directions (H, 2 H, 3) and solid angles of a lat-long, as OpenEXR has it, and a sky with four lobes."""
    y, x = np.mgrid[0:height, 0 : 2 * height]
    elevation = np.pi / 2 - np.pi * (y + 0.5) / height
    longitude = np.pi - np.pi * (x + 0.5) / height
    w = np.stack([np.cos(elevation) * np.sin(longitude), np.sin(elevation),
                  np.cos(elevation) * np.cos(longitude)], -1)  # fmt: skip
    solid = np.cos(elevation) * (np.pi / height) * 2 * np.sin(np.pi / height / 2)
    sky = np.full(w.shape, 0.1)
    for to, sharp, color in (((1, 0.2, 0.1), 20, (5, 0, 0)), ((-0.1, 1, 0.3), 12, (0, 5, 0)),
                             ((0.2, -0.3, 1), 8, (0, 0, 5)), ((-1, -0.5, -1), 10, (2, 2, 0))):  # fmt: skip
        sky += np.exp(sharp * (w @ (np.array(to) / np.linalg.norm(to)) - 1))[..., None] * color
    return w, solid, sky.astype(np.float32)


def turn_about(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {"X": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
            "Y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
            "Z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]), "": np.eye(3)}[axis]  # fmt: skip


@pytest.fixture(scope="module")
def sky_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("sky") / "sky.exr"
    relumine.Environment(lat_long()[2], face_resolution=64).save(path, to="usd")
    return path


@pytest.mark.parametrize(
    "up, kind, axis",
    list(itertools.product("YZ", ("DomeLight", "scene", "Y", "Z"), ("", "X", "Y", "Z"))),
)
def test_domes_stand_as_they_should(sky_file, up, kind, axis):
    is_new = kind != "DomeLight"
    text = f"""
def {"DomeLight_1" if is_new else "DomeLight"} "Dome" {{
    asset inputs:texture:file = @{sky_file}@
    float inputs:intensity = 2
    float inputs:exposure = 1
    color3f inputs:color = (1, 0.5, 0.25)
    {f'uniform token poleAxis = "{kind}"' if is_new else ""}
    {f"float xformOp:rotate{axis} = 37" if axis else ""}
    {f'uniform token[] xformOpOrder = ["xformOp:rotate{axis}"]' if axis else ""}
}}
""" + TRIANGLE + "}"  # fmt: skip
    environment = loaded(text, up).environment
    pole = {"DomeLight": "Y", "scene": up}.get(kind, kind)
    pole_turn = np.eye(3) if pole == "Y" else np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    to_world = np.eye(3) if up == "Y" else np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    w, solid, sky = lat_long()
    w = w @ (to_world @ turn_about(axis, 37) @ pole_turn).T
    for normal in [*np.eye(3), *-np.eye(3), np.ones(3) / math.sqrt(3)]:
        share = (np.clip(w @ normal, 0, None) * solid)[..., None]
        expected = 4 * np.array([1, 0.5, 0.25]) * (sky * share).sum((0, 1))
        assert environment.irradiance(normal) == pytest.approx(expected, rel=0.006)


def test_domes_add_up_and_one_without_a_picture_has_its_colour():
    domes = "".join(
        f'def DomeLight "D{i}" {{ color3f inputs:color = ({i}, 1, 0)\n}}\n' for i in (1, 2)
    )
    cube = np.asarray(loaded(domes + TRIANGLE + "}").environment.cube)
    assert cube == pytest.approx(np.broadcast_to([3, 2, 0], cube.shape))


def test_a_picture_that_is_not_there_is_said_and_has_one_colour():
    asset = loaded(
        'def DomeLight "D" { asset inputs:texture:file = @./gone.exr@\n}\n' + TRIANGLE + "}"
    )
    assert any("gone.exr" in note for note in asset.notes)
    assert np.asarray(asset.environment.cube) == pytest.approx(1)


# Meshes.


def test_units_and_the_up_axis():
    asset = loaded(TRIANGLE.replace("(0, 1, 0)", "(0, 0, 5)") + "}", "Z", 0.01)
    assert asset.mesh.vertices[:, 1].max() == pytest.approx(0.05)


def test_holes_concave_polygons_and_winding():
    """An L of six corners has its area; a left-handed one looks to the other side; a hole is none."""
    text = """
def Mesh "M" {
    uniform token subdivisionScheme = "none"
    int[] faceVertexCounts = [6, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 4, 5, 0, 1, 2]
    int[] holeIndices = [1]
    point3f[] points = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)]
    uniform token orientation = "%s"
}"""
    for orientation, side in (("rightHanded", 1), ("leftHanded", -1)):
        mesh = loaded(text % orientation).mesh
        p = mesh.vertices[mesh.triangles]
        cross = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        assert cross[:, 2].min() * side >= 0 if side > 0 else cross[:, 2].max() <= 0
        assert np.abs(cross).sum() / 2 == pytest.approx(3)
        assert mesh.normals == pytest.approx(np.broadcast_to([0, 0, side], mesh.normals.shape))


def test_corners_with_uvs_and_normals_of_their_own_are_parted(tmp_path):
    """Two quadrangles share an edge: with uvs of corners that differ there, 8 vertices, else 6."""
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    text = """
def Mesh "M" {
    uniform token subdivisionScheme = "none"
    int[] faceVertexCounts = [4, 4]
    int[] faceVertexIndices = [0, 1, 4, 3, 1, 2, 5, 4]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1), %s] (interpolation = "faceVarying")
    rel material:binding = </Look>
}
""" + textured(tmp_path / "red.png")  # fmt: skip
    assert len(loaded(text % "(0, 0), (1, 0), (1, 1), (0, 1)").mesh.vertices) == 8
    mesh = loaded(text % "(1, 0), (2, 0), (2, 1), (1, 1)").mesh
    assert len(mesh.vertices) == 6
    # v counts from the top there.
    order = np.lexsort(mesh.vertices.T[:2])
    assert mesh.uvs[order] == pytest.approx(
        np.array([[0, 1], [1, 1], [2, 1], [0, 0], [1, 0], [2, 0]])
    )


def cube_mesh(extra="", scheme="catmullClark"):
    return f"""
def Mesh "M" {{
    uniform token subdivisionScheme = "{scheme}"
    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
    int[] faceVertexIndices = [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5]
    point3f[] points = [(-1, -1, -1), (1, -1, -1), (-1, 1, -1), (1, 1, -1),
                        (-1, -1, 1), (1, -1, 1), (-1, 1, 1), (1, 1, 1)]
    {extra}
}}
"""


def test_catmull_clark_of_a_cube():
    """A corner of valence 3 goes to 5/9, an edge's middle to 3/4, a face's stays."""
    mesh = loaded(cube_mesh(), subdivision=1).mesh
    assert len(mesh.vertices) == 26
    assert np.abs(mesh.vertices[:8]) == pytest.approx(5 / 9)
    distances = np.sort(np.linalg.norm(mesh.vertices, axis=1))
    assert distances[:8] == pytest.approx(math.sqrt(3) * 5 / 9)
    assert distances[8:14] == pytest.approx(1)
    assert distances[14:] == pytest.approx(math.sqrt(2) * 0.75)
    # The limit of a corner: (n^2 p + 4 sum of edges + sum of faces) / (n (n + 5)) = 1/2.
    fine = loaded(cube_mesh(), subdivision=5).mesh
    assert np.abs(fine.vertices[:8]) == pytest.approx(0.5, abs=1e-3)


def test_sharp_creases_and_corners_keep_a_cube():
    """All edges infinitely sharp: the surface is the cube, and its normals break at the edges."""
    edges = [0, 1, 1, 3, 3, 2, 2, 0, 4, 5, 5, 7, 7, 6, 6, 4, 0, 4, 1, 5, 2, 6, 3, 7]
    extra = f"""int[] creaseIndices = {edges}
    int[] creaseLengths = {[2] * 12}
    float[] creaseSharpnesses = {[10] * 12}"""
    mesh = loaded(cube_mesh(extra), subdivision=2).mesh
    assert np.abs(mesh.vertices).max(1) == pytest.approx(1)
    assert np.abs(mesh.normals).max(1) == pytest.approx(1, abs=1e-6)
    # A crease of sharpness 1 is kept for one level and smooth from there on.
    soft = loaded(cube_mesh(extra.replace("10", "1")), subdivision=1).mesh
    assert np.abs(soft.vertices).max(1) == pytest.approx(1)


def test_a_sheet_keeps_its_boundary():
    text = """
def Mesh "M" {
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    uniform token interpolateBoundary = "%s"
}"""
    corners = loaded(text % "edgeAndCorner", subdivision=3).mesh.vertices[:4]
    assert corners == pytest.approx(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]))
    assert loaded(text % "edgeOnly", subdivision=1).mesh.vertices[0] == pytest.approx(
        [1 / 8, 1 / 8, 0]
    )


def test_normals_without_a_scheme_make_polygons():
    normals = "normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1)]\n}"
    text = TRIANGLE.replace('uniform token subdivisionScheme = "none"', "") + normals
    asset = loaded(text)
    assert len(asset.mesh.vertices) == 3 and any("subdivision scheme" in n for n in asset.notes)


INSTANCES = """
def PointInstancer "I" {
    int[] protoIndices = [0, 0, 1, 0]
    point3f[] positions = [(0, 0, 0), (10, 0, 0), (20, 0, 0), (30, 0, 0)]
    quath[] orientations = [(1, 0, 0, 0), (0.70710678, 0, 0.70710678, 0), (1, 0, 0, 0), (1, 0, 0, 0)]
    float3[] scales = [(1, 1, 1), (2, 2, 2), (1, 1, 1), (1, 1, 1)]
    int64[] invisibleIds = [3]
    rel prototypes = [</I/A>, </I/Inner>]
    def Mesh "A" {
        uniform token subdivisionScheme = "none"
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    }
    def PointInstancer "Inner" {
        int[] protoIndices = [0, 0]
        point3f[] positions = [(0, 0, 0), (0, 5, 0)]
        rel prototypes = [</I/A>]
    }
}
"""


def test_instances_of_instances():
    mesh = loaded(INSTANCES).mesh
    assert len(mesh.vertices) == 12  # 0, 10 and two at 20; the fourth is masked
    second = mesh.vertices[3:6]
    assert second == pytest.approx(np.array([[10, 0, 0], [10, 0, -2], [10, 2, 0]]), abs=2e-3)
    assert mesh.vertices[9:12, 1].max() == pytest.approx(6)


def test_purpose_visibility_and_instanceable_prims():
    text = """
class "P" { def Mesh "M" {
    uniform token subdivisionScheme = "none"
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
} }
def Xform "A" (instanceable = true
inherits = </P>) {}
def Xform "B" (instanceable = true
inherits = </P>) {
    double3 xformOp:translate = (5, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"] }
def Xform "C" (inherits = </P>) { token visibility = "invisible" }
def Xform "D" (inherits = </P>) { uniform token purpose = "proxy" }
def Xform "E" (inherits = </P>) { uniform token purpose = "render" }
"""
    assert len(loaded(text).mesh.vertices) == 9
    assert len(loaded(text, purposes=("proxy",)).mesh.vertices) == 3
    assert loaded(text).mesh.vertices[:, 0].max() == pytest.approx(6)


def test_time_samples_and_the_first_time():
    text = TRIANGLE.replace("point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]",
        "point3f[] points.timeSamples = { 5: [(0,0,0),(1,0,0),(0,1,0)], 15: [(0,0,0),(3,0,0),(0,1,0)] }") + "}"  # fmt: skip
    assert loaded(text).mesh.vertices.max() == 1
    assert loaded(text, time=10).mesh.vertices.max() == 2


@pytest.mark.parametrize("kind, area", [
    ('Cube "S" { double size = 2', 24), ('Sphere "S" { double radius = 2', 16 * math.pi),
    ('Cylinder "S" { double radius = 1\ndouble height = 3\nuniform token axis = "X"', 8 * math.pi),
    ('Cone "S" { double radius = 1\ndouble height = 2', math.pi * (1 + math.sqrt(5))),
    ('Capsule "S" { double radius = 1\ndouble height = 2', 8 * math.pi),
    ('Plane "S" { double width = 2\ndouble length = 3', 6)])  # fmt: skip
def test_shapes_look_outwards_and_have_their_area(kind, area):
    mesh = loaded(f"def {kind}\n}}").mesh
    p = mesh.vertices[mesh.triangles]
    cross = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    assert np.linalg.norm(cross, axis=1).sum() / 2 == pytest.approx(area, rel=0.01)
    assert ((cross * mesh.normals[mesh.triangles].mean(1)).sum(1) > -1e-12).all()
    if "Plane" not in kind:
        assert ((cross * p.mean(1)).sum(1) > -1e-12).all()


def test_a_colour_above_a_mesh_counts_as_an_array_of_one_or_without():
    for kind, value in (("color3f", "(0.5, 0.25, 1)"), ("color3f[]", "[(0.5, 0.25, 1)]")):
        text = f'def Xform "X" {{\n{kind} primvars:displayColor = {value}\n{TRIANGLE}}}\n}}\n'
        assert loaded(text).mesh.colors == pytest.approx(np.broadcast_to([0.5, 0.25, 1], (3, 3)))


SKIN = """
def SkelRoot "R" (prepend apiSchemas = ["SkelBindingAPI"]) {
    rel skel:skeleton = </R/S>
    def Skeleton "S" (prepend apiSchemas = ["SkelBindingAPI"]) {
        uniform token[] joints = ["a"]
        uniform matrix4d[] bindTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))]
        uniform matrix4d[] restTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))]
        rel skel:animationSource = </R/A>
    }
    def SkelAnimation "A" {
        uniform token[] joints = ["a"]
        float3[] translations.timeSamples = { 0: [(0, 0, 0)], 10: [(0, 0, 10)] }
        quatf[] rotations = [(1, 0, 0, 0)]
        half3[] scales = [(1, 1, 1)]
    }
    def Mesh "M" (prepend apiSchemas = ["SkelBindingAPI"]) {
        uniform token subdivisionScheme = "none"
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        int[] primvars:skel:jointIndices = [0] (interpolation = "constant"
elementSize = 1)
        float[] primvars:skel:jointWeights = [1] (interpolation = "constant"
elementSize = 1)
    }
}
"""


def test_a_skin_stands_in_its_pose():
    assert loaded(SKIN, time=5).mesh.vertices[:, 2] == pytest.approx([5, 5, 5])


@pytest.mark.parametrize("name", ["normals", "primvars:normals"])
def test_normals_of_a_skin_turn_with_it(name):
    """By 90 degrees about X: OpenUSD's baking leaves primvars alone."""
    text = SKIN.replace("quatf[] rotations = [(1, 0, 0, 0)]", "quatf[] rotations = [(0.7071068, 0.7071068, 0, 0)]")
    normals = f"normal3f[] {name} = [(0, 0, 1), (0, 0, 1), (0, 0, 1)] (interpolation = \"vertex\"\n)\n"
    text = text.replace("        int[] primvars:skel:jointIndices", normals + "        int[] primvars:skel:jointIndices")
    mesh = loaded(text, time=0).mesh
    assert mesh.vertices[2] == pytest.approx([0, 0, 1], abs=1e-5)
    assert mesh.normals == pytest.approx(np.broadcast_to([0, -1, 0], (3, 3)), abs=1e-5)


# Materials.


def textured(
    path, *, st_node="", inputs="", output="rgb", name="diffuseColor", kind="color3f", scale=""
):
    return f"""
def Material "Look" {{
    token outputs:surface.connect = </Look/S.outputs:surface>
    def Shader "S" {{
        uniform token info:id = "UsdPreviewSurface"
        {kind} inputs:{name}.connect = </Look/T.outputs:{output}>
        {inputs}
        token outputs:surface
    }}
    def Shader "T" {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @{path}@
        {scale}
        float2 inputs:st.connect = {"</Look/X.outputs:result>" if st_node else "</Look/R.outputs:result>"}
        float3 outputs:rgb
        float outputs:r
        float outputs:g
        float outputs:b
        float outputs:a
    }}
    def Shader "X" {{
        uniform token info:id = "UsdTransform2d"
        float2 inputs:in.connect = </Look/R.outputs:result>
        {st_node}
        float2 outputs:result
    }}
    def Shader "R" {{
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }}
}}
"""


def bound(look, st="(0, 0), (1, 0), (0, 1)"):
    return TRIANGLE + f"""
    texCoord2f[] primvars:st = [{st}] (interpolation = "vertex")
    rel material:binding = </Look>
}}
""" + look  # fmt: skip


def test_preview_surface_numbers():
    asset = loaded(bound("""
def Material "Look" {
    token outputs:surface.connect = </Look/S.outputs:surface>
    def Shader "S" {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor = (0.1, 0.2, 0.3)
        float inputs:metallic = 0.25
        float inputs:roughness = 0.75
        float inputs:ior = 2
        float inputs:clearcoat = 0.5
        float inputs:clearcoatRoughness = 0.1
        color3f inputs:emissiveColor = (0, 3, 0)
        float inputs:occlusion = 0.5
        token outputs:surface
    }
}"""))  # fmt: skip
    (material,) = asset.mesh.materials
    assert material["base_color"] == pytest.approx([0.1, 0.2, 0.3])
    assert material["metallic"] == pytest.approx(0.25) and material["roughness"] == pytest.approx(
        0.75
    )
    assert material["ior"] == pytest.approx(2) and material["coat"] == pytest.approx(0.5)
    assert material["emission"] == pytest.approx([0, 3, 0])
    assert [n for n in asset.notes if "occlusion" in n]


def test_the_specular_workflow():
    (material,) = loaded(bound("""
def Material "Look" {
    token outputs:surface.connect = </Look/S.outputs:surface>
    def Shader "S" {
        uniform token info:id = "UsdPreviewSurface"
        int inputs:useSpecularWorkflow = 1
        color3f inputs:specularColor = (0.5, 0.25, 0.125)
        float inputs:roughness = 0.25
        token outputs:surface
    }
}""")).mesh.materials  # fmt: skip
    assert material["model"] == "specular-glossiness"
    assert material["specular"] == pytest.approx([0.5, 0.25, 0.125])
    assert material["roughness"] == pytest.approx(0.25)


def document(text):
    """The glTF document that a stage becomes."""
    data = relumine.usd.convert(stage_of(text))[0]
    return json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])


def colors_of(folder, picture, st="(0.25, 0.25), (0.75, 0.25), (0.25, 0.75)", **look_options):
    """What the three vertices of a matte triangle reflect of a white sky."""
    picture.save(folder / "color.png")
    inputs = "int inputs:useSpecularWorkflow = 1"
    mesh = loaded(bound(textured(folder / "color.png", inputs=inputs, **look_options), st)).mesh
    relighter = relumine.Relighter(relumine.precompute(mesh, refine=False, bounces=False))
    relighter.set_environment(relumine.Environment(np.ones((6, 4, 4, 3))))
    return np.array(relighter.radiance)


def test_channels_scale_bias_and_transforms_of_textures(tmp_path):
    """Four texels: red and green below, blue and white above."""
    picture = Image.new("RGB", (2, 2))
    for at, color in {
        (0, 1): (255, 0, 0),
        (1, 1): (0, 255, 0),
        (0, 0): (0, 0, 255),
        (1, 0): (255,) * 3,
    }.items():
        picture.putpixel(at, color)
    near = {"abs": 0.01}
    assert colors_of(tmp_path, picture) == pytest.approx(np.eye(3), **near)
    scale = "float4 inputs:scale = (0.75, 0.5, 1, 1)\nfloat4 inputs:bias = (0, 0.25, 0, 0)"
    expected = np.array([[0.75, 0.25, 0], [0, 0.75, 0], [0, 0.25, 1]])
    assert colors_of(tmp_path, picture, scale=scale) == pytest.approx(expected, **near)
    red = np.array([[1] * 3, [0] * 3, [0] * 3])
    assert colors_of(tmp_path, picture, output="r") == pytest.approx(red, **near)
    # A turn of 90 degrees takes (u, v) to (-v, u).
    turned = np.array([[0, 1, 0], [1, 1, 1], [1, 0, 0]])
    assert colors_of(tmp_path, picture, st_node="float inputs:rotation = 90") == pytest.approx(
        turned, **near
    )
    moved = np.array([[1, 1, 1], [0, 0, 1], [0, 1, 0]])
    node = "float2 inputs:scale = (1, -1)\nfloat2 inputs:translation = (0.5, 0)"
    assert colors_of(tmp_path, picture, st_node=node) == pytest.approx(moved, **near)
    # Raw bytes of 128 are 128 of 255, those of sRGB 0.216.
    grey = Image.new("RGB", (2, 2), (128,) * 3)
    assert colors_of(tmp_path, grey) == pytest.approx(0.216, **near)
    raw = 'token inputs:sourceColorSpace = "raw"'
    assert colors_of(tmp_path, grey, scale=raw) == pytest.approx(128 / 255, **near)


def test_uvs_that_are_not_there_are_those_of_st(tmp_path):
    """Blender asks for UVMap where it writes st."""
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    look = textured(tmp_path / "red.png").replace('varname = "st"', 'varname = "UVMap"')
    asset = loaded(bound(look))
    assert np.asarray(asset.mesh.uvs).tolist() == [[0, 1], [1, 1], [0, 0]]
    assert any("primvars:UVMap is not there: st stands for it" in line for line in asset.notes)
    asset = loaded(bound(look).replace("primvars:st", "primvars:other"))
    assert any("primvars:UVMap is not there: its texture is one colour" in line for line in asset.notes)


def test_metallic_and_roughness_of_two_pictures(tmp_path):
    Image.new("L", (2, 2), 51).save(tmp_path / "rough.png")
    Image.new("L", (4, 4), 204).save(tmp_path / "metal.png")
    look = textured(tmp_path / "rough.png", output="r", name="roughness", kind="float",
                    inputs="float inputs:metallic.connect = </Look/M.outputs:r>")  # fmt: skip
    look = look.rstrip()[:-1] + f"""
    def Shader "M" {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @{tmp_path}/metal.png@
        float2 inputs:st.connect = </Look/R.outputs:result>
        float outputs:r
    }}
}}
"""
    asset = loaded(bound(look))
    (material,) = asset.mesh.materials
    assert material["metallic_roughness_texture"] is not None
    data, _ = relumine.usd.convert(stage_of(bound(look)))
    start = data.index(b"\x89PNG")
    pixels = np.asarray(Image.open(io.BytesIO(data[start:])))
    assert pixels.shape == (4, 4, 3) and (pixels[..., 1:] == [51, 204]).all()


def test_opacity(tmp_path):
    Image.new("RGBA", (2, 2), (255, 255, 255, 128)).save(tmp_path / "a.png")
    for threshold, mode in ((0.0, "BLEND"), (0.25, "MASK")):
        look = textured(tmp_path / "a.png", inputs=f"float inputs:opacityThreshold = {threshold}\n"
                        "float inputs:opacity.connect = </Look/T.outputs:a>")  # fmt: skip
        (material,) = document(bound(look))["materials"]
        assert material["alphaMode"] == mode and material.get("alphaCutoff", 0.0) == threshold


def test_standard_surface_and_what_it_has_more():
    asset = loaded(bound("""
def Material "Look" {
    token outputs:mtlx:surface.connect = </Look/S.outputs:out>
    def Shader "S" {
        uniform token info:id = "ND_standard_surface_surfaceshader"
        color3f inputs:base_color = (0.5, 0.25, 1)
        float inputs:base = 0.5
        float inputs:specular_roughness = 0.4
        float inputs:metalness = 0.125
        float inputs:coat = 1
        float inputs:subsurface = 0.5
        float inputs:thin_film_thickness = 300
        token outputs:out
    }
}"""))  # fmt: skip
    (material,) = asset.mesh.materials
    # Half of it is white: the colour of subsurface, which comes out where it goes in.
    assert material["base_color"] == pytest.approx([0.625, 0.5625, 0.75])
    assert material["roughness"] == pytest.approx(0.4) and material["metallic"] == pytest.approx(
        0.125
    )
    assert material["coat"] == pytest.approx(1)
    assert material["film"] == 1 and material["film_thickness_at_1"] == pytest.approx(300)
    assert material["film_ior"] == pytest.approx(1.5)
    assert len([n for n in asset.notes if "subsurface" in n]) == 1
    assert not any("thin_film" in n for n in asset.notes)


def test_the_film_of_open_pbr_has_micrometres_and_a_weight():
    look = """
def Material "Look" {
    token outputs:mtlx:surface.connect = </Look/S.outputs:out>
    def Shader "S" {
        uniform token info:id = "ND_open_pbr_surface_surfaceshader"
        float inputs:thin_film_weight = WEIGHT
        float inputs:thin_film_thickness = 0.25
        token outputs:out
    }
}"""
    (material,) = loaded(bound(look.replace("WEIGHT", "0.5"))).mesh.materials
    assert material["film"] == pytest.approx(0.5)
    assert material["film_thickness_at_1"] == pytest.approx(250)
    assert material["film_ior"] == pytest.approx(1.4)
    (material,) = loaded(bound(look.replace("WEIGHT", "0"))).mesh.materials
    assert "film" not in material


@pytest.mark.parametrize(
    "surface, base, factor, color",
    [
        # All of standard_surface's subsurface goes to the other side.
        ("standard_surface", (0.4, 0.2, 0.1), 0.75, (1, 0.5, 0.25)),
        # OpenPBR's stays and goes by halves, here by a quarter and three quarters.
        ("open_pbr_surface", (0.4 * 0.25 / 0.4375 + 0.1875 / 0.4375, (0.05 + 0.1875 / 2) / 0.4375,
                              (0.025 + 0.1875 / 4) / 0.4375), 0.5625, (1, 0.5, 0.25)),
    ],
)  # fmt: skip
def test_thin_walls_pass_light_on(surface, base, factor, color):
    names = {"standard_surface": ("base", "subsurface", "bool inputs:thin_walled = 1", ""),
             "open_pbr_surface": ("base_weight", "subsurface_weight", "bool inputs:geometry_thin_walled = 1",
                                  "float inputs:subsurface_scatter_anisotropy = 0.5")}[surface]  # fmt: skip
    look = f"""
def Material "Look" {{
    token outputs:mtlx:surface.connect = </Look/S.outputs:out>
    def Shader "S" {{
        uniform token info:id = "ND_{surface}_surfaceshader"
        float inputs:{names[0]} = 1
        color3f inputs:base_color = (0.4, 0.2, 0.1)
        float inputs:{names[1]} = 0.75
        color3f inputs:subsurface_color = (1, 0.5, 0.25)
        {names[2]}
        {names[3]}
        token outputs:out
    }}
}}"""
    (material,) = document(bound(look))["materials"]
    assert material["pbrMetallicRoughness"]["baseColorFactor"][:3] == pytest.approx(base)
    assert material["extensions"]["KHR_materials_diffuse_transmission"] == {
        "diffuseTransmissionFactor": pytest.approx(factor),
        "diffuseTransmissionColorFactor": pytest.approx(color),
    }
    assert not any("subsurface" in line or "thin" in line for line in loaded(bound(look)).notes)
    thick = bound(look.replace("thin_walled = 1", "thin_walled = 0"))
    (material,) = document(thick)["materials"]
    assert "KHR_materials_diffuse_transmission" not in material.get("extensions", {})
    assert any("subsurface" in line for line in loaded(thick).notes)


def glass_of(surface, text, meters=1.0):
    look = f"""
def Material "Look" {{
    token outputs:mtlx:surface.connect = </Look/S.outputs:out>
    def Shader "S" {{
        uniform token info:id = "ND_{surface}_surfaceshader"
{text}
        token outputs:out
    }}
}}"""
    stage = stage_of(bound(look), meters=meters)
    data, reader = relumine.usd.convert(stage)
    size = struct.unpack_from("<I", data, 12)[0]
    (material,) = json.loads(data[20 : 20 + size])["materials"]
    return material, reader.notes.lines()


@pytest.mark.parametrize(
    "surface, text, volume, dispersion, base",
    [
        ("standard_surface", "float inputs:transmission = 1\ncolor3f inputs:transmission_color = (1, 0.5, 0.25)\n"
         "float inputs:transmission_dispersion = 40",
         {"thicknessFactor": 1.0}, 0.5, (1, 0.5, 0.25)),
        ("standard_surface", "float inputs:transmission = 1\ncolor3f inputs:transmission_color = (1, 0.5, 0.25)\n"
         "float inputs:transmission_depth = 30",
         {"thicknessFactor": 0.3, "attenuationDistance": 0.3, "attenuationColor": [1, 0.5, 0.25]}, 0, (1, 1, 1)),
        ("standard_surface", "float inputs:transmission = 1\nbool inputs:thin_walled = 1", None, 0, (1, 1, 1)),
        ("open_pbr_surface", "float inputs:transmission_weight = 1\n"
         "float inputs:transmission_dispersion_scale = 0.5\nfloat inputs:transmission_dispersion_abbe_number = 40",
         {"thicknessFactor": 1.0}, 0.25, (1, 1, 1)),
        ("open_pbr_surface", "float inputs:transmission_weight = 1", {"thicknessFactor": 1.0}, 0, (1, 1, 1)),
        ("gltf_pbr", "float inputs:transmission = 1\ncolor3f inputs:base_color = (1, 0.5, 0.25)", None, 0, (1, 0.5, 0.25)),
        ("gltf_pbr", "float inputs:transmission = 1\nfloat inputs:thickness = 50\nfloat inputs:dispersion = 0.36\n"
         "float inputs:attenuation_distance = 20\ncolor3f inputs:attenuation_color = (0.5, 1, 1)",
         {"thicknessFactor": 0.5, "attenuationDistance": 0.2, "attenuationColor": [0.5, 1, 1]}, 0.36, (1, 1, 1)),
    ],
)  # fmt: skip
def test_glass_is_a_body_unless_its_walls_are_thin(surface, text, volume, dispersion, base):
    material, notes = glass_of(surface, text, meters=0.01)
    extensions = material["extensions"]
    assert extensions["KHR_materials_transmission"] == {"transmissionFactor": 1.0}
    found = extensions.get("KHR_materials_volume")
    assert (found is None) == (volume is None)
    for name, value in (volume or {}).items():
        assert found[name] == pytest.approx(value), name
    assert extensions.get("KHR_materials_dispersion", {"dispersion": 0})["dispersion"] == pytest.approx(dispersion)
    assert material["pbrMetallicRoughness"]["baseColorFactor"][:3] == pytest.approx(base)
    assert not any("transmission" in line or "dispersion" in line or "thick" in line for line in notes)


def test_the_subsurface_of_a_thick_body_is_its_colour():
    text = ("float inputs:base = 1\ncolor3f inputs:base_color = (0.4, 0.2, 0)\nfloat inputs:subsurface = 0.5\n"
            "color3f inputs:subsurface_color = (0.8, 0.4, 1)")  # fmt: skip
    material, notes = glass_of("standard_surface", text)
    assert material["pbrMetallicRoughness"]["baseColorFactor"][:3] == pytest.approx((0.6, 0.3, 0.5))
    assert any("subsurface" in line for line in notes)


def test_a_file_of_materialx(tmp_path):
    """Nodes in a graph, with an interface, and a texture."""
    (tmp_path / "pictures/plain").mkdir(parents=True)
    Image.new("RGB", (2, 2), (0, 255, 0)).save(tmp_path / "pictures/plain/green.png")
    (tmp_path / "look.mtlx").write_text("""<?xml version="1.0"?>
<materialx version="1.38" colorspace="lin_rec709" fileprefix="pictures/">
  <nodegraph name="G" fileprefix="plain/">
    <input name="rough" type="float" value="0.375"/>
    <image name="picture" type="color3">
      <input name="file" type="filename" value="green.png" colorspace="srgb_texture"/>
    </image>
    <constant name="c" type="float"><input name="value" type="float" interfacename="rough"/></constant>
    <output name="color" type="color3" nodename="picture"/>
    <output name="r" type="float" nodename="c"/>
  </nodegraph>
  <standard_surface name="S" type="surfaceshader">
    <input name="base" type="float" value="1"/>
    <input name="base_color" type="color3" nodegraph="G" output="color"/>
    <input name="specular_roughness" type="float" nodegraph="G" output="r"/>
  </standard_surface>
  <surfacematerial name="Gold" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="S"/>
  </surfacematerial>
</materialx>""")
    text = bound('def Scope "Looks" (references = @./look.mtlx@</MaterialX>) {}\n').replace(
        "</Look>", "</Looks/Materials/Gold>"
    )
    (tmp_path / "a.usda").write_text(usda(text))
    asset = relumine.usd.load(tmp_path / "a.usda")
    (material,) = asset.mesh.materials
    assert material["name"] == "Gold" and material["roughness"] == pytest.approx(0.375), asset.notes
    assert material["base_color_texture"] is not None
    (tmp_path / "look.mtlx").write_text("<materialx")
    assert any("look.mtlx" in n for n in relumine.usd.load(tmp_path / "a.usda").notes)


def test_subsets_have_their_own_materials():
    look = 'def Material "{0}" {{ token outputs:surface.connect = </{0}/S.outputs:surface>\n def Shader "S" {{ uniform token info:id = "UsdPreviewSurface"\n color3f inputs:diffuseColor = {1}\n token outputs:surface\n }} }}\n'
    text = cube_mesh("""
    uniform token subsetFamily:materialBind:familyType = "nonOverlapping"
    def GeomSubset "G" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [0, 5]
        rel material:binding = </A>
    }
    rel material:binding = </B>""", "none") + look.format("A", "(1, 0, 0)") + look.format("B", "(0, 1, 0)")  # fmt: skip
    mesh = loaded(text).mesh
    colors = {m["name"]: m["base_color"] for m in mesh.materials}
    assert colors == {"A": [1, 0, 0], "B": [0, 1, 0]} and len(mesh.triangles) == 12


# Bad input.


@pytest.mark.parametrize("change, words", [
    (("[0, 1, 2]", "[0, 1, 7]"), "index beyond"), (("[3]", "[4]"), "corners"),
    (("(0, 1, 0)]", "(0, nan, 0)]"), "not finite")])  # fmt: skip
def test_a_mesh_that_cannot_be_drawn_is_named(change, words):
    asset = loaded(TRIANGLE.replace(*change) + "}\n" + cube_mesh().replace('"M"', '"N"'))
    assert any(words in note and note.startswith("/M") for note in asset.notes)


def test_missing_and_circular_layers(tmp_path):
    (tmp_path / "a.usda").write_text(
        "#usda 1.0\n( subLayers = [@./b.usda@, @./gone.usda@] )\n" + TRIANGLE + "}"
    )
    (tmp_path / "b.usda").write_text(
        '#usda 1.0\n( subLayers = [@./a.usda@] )\ndef "X" (references = @./none.usda@</X>) {}\n'
    )
    asset = relumine.usd.load(tmp_path / "a.usda")
    assert len(asset.mesh.vertices) == 3
    for name in ("gone.usda", "none.usda", "a.usda"):
        assert any(name in note and "\n" not in note for note in asset.notes), asset.notes


@pytest.mark.parametrize(
    "content", [b"", b"#usda 1.0\ndef {", b"PXR-USDC" + bytes(100), b"PK\x03\x04"]
)
@pytest.mark.parametrize("name", ["a.usda", "a.usdc", "a.usdz", "a.usd"])
def test_files_that_are_no_stage(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(OSError) as error:
        relumine.usd.load(tmp_path / name)
    assert name in str(error.value) and "\n" not in str(error.value)


def test_a_file_that_is_not_there_and_a_stage_without_a_mesh(tmp_path):
    with pytest.raises(FileNotFoundError):
        relumine.usd.load(tmp_path / "gone.usda")
    with pytest.raises(OSError, match="expected a stage with a mesh"):
        loaded('def Xform "X" {}')
    with pytest.raises(ValueError, match="camera"):
        loaded(TRIANGLE + "}", camera="/None")


def test_instances_of_instances_of_instances_have_a_limit():
    """1,000 instances of 1,000 of 1,000: refused before memory is taken."""
    many = ", ".join(["0"] * 1000)
    places = ", ".join(["(0, 0, 0)"] * 1000)
    text = TRIANGLE + "}\n"
    for i in range(3):
        text += f'def PointInstancer "I{i}" {{ int[] protoIndices = [{many}]\n point3f[] positions = [{places}]\n' \
                f' rel prototypes = [{"</M>" if i == 0 else f"</I{i - 1}>"}]\n}}\n'  # fmt: skip
    with pytest.raises(ValueError, match="at most 1000000"):
        loaded(text)


def test_an_instancer_of_itself_and_odd_arrays():
    text = (
        TRIANGLE
        + '}\ndef PointInstancer "I" { int[] protoIndices = [0, 9]\n point3f[] positions = [(0,0,0),(1,1,1)]\n rel prototypes = [</I>]\n}\n'
    )
    text += 'def PointInstancer "J" { int[] protoIndices = [0, 0]\n point3f[] positions = [(0,0,0)]\n rel prototypes = [</M>]\n}\n'
    asset = loaded(text)
    assert len(asset.mesh.vertices) == 3
    assert any("/I" in n for n in asset.notes) and any("/J" in n for n in asset.notes)


def test_textures_that_cannot_be_read(tmp_path):
    (tmp_path / "bad.png").write_bytes(b"no picture")
    asset = loaded(
        bound(textured(tmp_path / "bad.png", output="r", name="roughness", kind="float"))
    )
    assert any("bad.png" in n for n in asset.notes)


# Packages, cameras, the way back, the command.


def test_a_package_with_its_texture(tmp_path):
    picture = io.BytesIO()
    Image.new("RGB", (2, 2), (255, 0, 0)).save(picture, "PNG")
    text = "#usda 1.0\n" + bound(textured("0/red.png"))
    with zipfile.ZipFile(tmp_path / "a.usdz", "w", zipfile.ZIP_STORED) as file:
        file.writestr("a.usda", text)
        file.writestr("0/red.png", picture.getvalue())
    asset = relumine.usd.load(tmp_path / "a.usdz")
    assert asset.mesh.materials[0]["base_color_texture"] is not None, asset.notes


def test_the_camera():
    camera = """
def Camera "C" { float focalLength = 50
    float verticalAperture = 24
    float horizontalAperture = 36
    double3 xformOp:translate = (0.25, 0.25, 3)
    uniform token[] xformOpOrder = ["xformOp:translate"] }
"""
    mesh = loaded(TRIANGLE + "}" + camera, camera="/C").mesh
    scene = relumine.precompute(mesh, receivers="pixels:36x24", view="auto")
    relighter = relumine.Relighter(scene, highlight_rays=0)
    relighter.set_environment(relumine.Environment(np.ones((6, 4, 4, 3))))
    seen = np.asarray(relighter.picture(background="none"))[..., 3]
    # 2 atan(12 / 50) at 3: 1.44 high, so that the triangle has 0.5 of 1.44 x 2.16.
    assert seen.mean() == pytest.approx(0.5 / (1.44 * 2.16), rel=0.08)


def checked(path):
    """What usd-core's validators say of a stage."""
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    errors = UsdValidation.ValidationContext(validators).Validate(Usd.Stage.Open(str(path)))
    return [e.GetMessage() for e in errors if e.GetType() != UsdValidation.ValidationErrorType.Info]


@pytest.mark.parametrize("up", "YZ")
def test_light_goes_back_into_the_stage(tmp_path, sky_file, up):
    head = f'upAxis = "{up}"\nmetersPerUnit = 1\ndefaultPrim = "World"'
    text = 'def Xform "World" {\n' + f"""
def DomeLight "Sky" {{ asset inputs:texture:file = @{sky_file}@
    float xformOp:rotateX = 30
    uniform token[] xformOpOrder = ["xformOp:rotateX"] }}
def DistantLight "Sun" {{ float inputs:intensity = 1000
    float3 xformOp:rotateXYZ = (-40, 20, 0)
    uniform token[] xformOpOrder = ["xformOp:rotateXYZ"] }}
def RectLight "Lamp" {{ float inputs:intensity = 3
    double3 xformOp:translate = (0, 0, 4)
    uniform token[] xformOpOrder = ["xformOp:translate"] }}
""" + cube_mesh(scheme="none") + INSTANCES.replace("</I", "</World/I") + "}\n"  # fmt: skip
    path = tmp_path / "scene.usda"
    path.write_text(usda(text, head))
    before = path.read_bytes()
    asset = relumine.usd.load(path)
    scene = relumine.precompute(asset.mesh, bounces=False)
    relighter = relumine.Relighter(scene)
    asset.light(relighter)
    relighter.set_layers([*relighter.layers,
                          relumine.Layer("rim", relumine.Disc((-1, 1, -1), 5), relumine.Emit((0, 4, 8)), gain_ev=1)])  # fmt: skip
    lit = tmp_path / "lit.usda"
    relumine.usd.save(lit, asset, relighter, emission={"Lamp": (0.5, 0.25, 0)})
    assert path.read_bytes() == before and checked(lit) == []
    stage = Usd.Stage.Open(str(lit))
    # The colours of a corner are the light of its vertex.
    primvar = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/World/M")).GetPrimvar("displayColor")
    colors = np.array(primvar.Get())
    assert primvar.GetInterpolation() == "faceVarying" and colors.shape == (24, 3)
    (drawn,) = [d for d in asset._drawn if d.path == "/World/M"]
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/World/M"))
    corners = np.array(mesh.GetPointsAttr().Get())[np.array(mesh.GetFaceVertexIndicesAttr().Get())]
    to_world = corners if up == "Y" else corners[:, [0, 2, 1]] * [1, 1, -1]
    vertex = drawn.first + drawn.shown.of_file
    assert asset.mesh.vertices[vertex] == pytest.approx(to_world, abs=1e-6)
    assert colors == pytest.approx(np.array(relighter.radiance)[vertex])
    # Read again, the lights are the same, and the lamp is dimmed.
    again = relumine.usd.load(lit)
    second = relumine.Relighter(relumine.precompute(again.mesh, bounces=False))
    again.light(second)
    assert {layer.name for layer in again.layers} == {"Sun", "rim"}
    for normal in [*np.eye(3), *-np.eye(3)]:
        old, new = (
            relumine.Environment(np.array(r.environment)).irradiance(normal)
            for r in (relighter, second)
        )
        assert new == pytest.approx(old, rel=0.002)
    lamp = [m for m in again.mesh.materials if m["name"] == "Lamp"][0]
    assert lamp["emission"] == pytest.approx([1.5, 0.75, 0])


def test_refined_surfaces_and_instances_get_colours(tmp_path):
    path = tmp_path / "scene.usda"
    path.write_text('#usda 1.0\n( defaultPrim = "P"\nupAxis = "Y"\nmetersPerUnit = 1 )\nclass Xform "P" {' + cube_mesh() + '}\n'
                    'def Xform "A" (instanceable = true\ninherits = </P>) {}\n'
                    'def DomeLight "D" {}\n')  # fmt: skip
    asset = relumine.usd.load(path)
    relighter = relumine.Relighter(relumine.precompute(asset.mesh, bounces=False, refine=False))
    asset.light(relighter)
    relumine.usd.save(tmp_path / "lit.usdc", asset, relighter)
    stage = Usd.Stage.Open(str(tmp_path / "lit.usdc"))
    prim = stage.GetPrimAtPath("/A/M")
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("displayColor")
    assert not prim.IsInstanceProxy() and primvar.GetInterpolation() == "vertex"
    assert np.array(primvar.Get()) == pytest.approx(
        np.array(relighter.radiance)[asset._drawn[0].first :][:8]
    )


def test_other_layers_go_into_the_dome(tmp_path):
    path = tmp_path / "scene.usda"
    path.write_text("#usda 1.0\n" + TRIANGLE + '}\ndef DomeLight "D" {}\n')
    asset = relumine.usd.load(path)
    relighter = relumine.Relighter(relumine.precompute(asset.mesh, bounces=False))
    asset.light(relighter)
    relighter.set_layers([
        relumine.Layer("box", relumine.Rectangle((0, 1, 0), 40, 30), relumine.Emit((5, 5, 5))),
        relumine.Layer("dim", relumine.Disc((0, 1, 0), 90), relumine.Gain(0.5)),
        relumine.Layer("key", relumine.Disc((0, 0, 1), 10), relumine.Emit((1, 1, 1)), kelvin=3000)])  # fmt: skip
    relumine.usd.save(tmp_path / "lit.usda", asset, relighter, colors=False)
    again = relumine.usd.load(tmp_path / "lit.usda")
    assert [layer.name for layer in again.layers] == ["key"]
    second = relumine.Relighter(relumine.precompute(again.mesh, bounces=False))
    again.light(second)
    for normal in [*np.eye(3), *-np.eye(3)]:
        old, new = (
            relumine.Environment(np.array(r.environment)).irradiance(normal)
            for r in (relighter, second)
        )
        assert new == pytest.approx(old, rel=0.005, abs=1e-6)


def test_save_refuses(tmp_path):
    path = tmp_path / "scene.usda"
    path.write_text("#usda 1.0\n" + TRIANGLE + "}\n")
    asset = relumine.usd.load(path)
    relighter = relumine.Relighter(relumine.precompute(asset.mesh))
    asset.light(relighter)
    with pytest.raises(OSError, match="another file"):
        relumine.usd.save(path, asset, relighter)
    with pytest.raises(OSError, match=".usda"):
        relumine.usd.save(tmp_path / "lit.usdz", asset, relighter)
    with pytest.raises(FileNotFoundError):
        relumine.usd.save(tmp_path / "none" / "lit.usda", asset, relighter)
    with pytest.raises(ValueError, match="emission"):
        relumine.usd.save(tmp_path / "lit.usda", asset, relighter, emission={"none": 1})
    assert sorted(p.name for p in tmp_path.iterdir() if p.suffix == ".usda") == ["scene.usda"]


def run(*arguments, folder):
    environment = {
        **os.environ,
        "PATH": os.path.dirname(os.environ["RELUMINE_PROGRAM"]) + ":" + os.environ["PATH"],
    }
    return subprocess.run([sys.executable, "-m", "relumine", *map(str, arguments)], cwd=folder,
                          env=environment, capture_output=True, text=True)  # fmt: skip


def test_the_command_takes_stages(tmp_path, sky_file):
    (tmp_path / "a.usda").write_text(
        "#usda 1.0\n" + cube_mesh(scheme="none") + 'def DomeLight "D" {}\n'
    )
    size = ("--size", "64x48", "-o")
    assert run("relight", "a.usda", *size, "own.png", folder=tmp_path).returncode == 0
    assert run("relight", "a.usda", sky_file, *size, "sky.png", folder=tmp_path).returncode == 0
    own, sky = (np.asarray(Image.open(tmp_path / f"{n}.png")).astype(float) for n in ("own", "sky"))
    assert own.shape == (48, 64, 3) and np.abs(own - sky).max() > 20
    assert "12 triangles" in run("info", "a.usda", folder=tmp_path).stdout
    gone = run("relight", "gone.usda", "-o", "x.png", folder=tmp_path)
    assert gone.returncode == 1 and gone.stderr.count("\n") == 1 and "gone.usda" in gone.stderr
