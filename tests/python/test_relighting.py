"""From arrays to radiance and pictures, held to closed forms and to the command line."""

import inspect
import sys
import types

import numpy as np
import pytest

import relumine
from relumine import _core


def test_white_furnace():
    """A convex solid under a white sky reflects 1 at albedo 1: nothing is in the way."""
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    scene = relumine.precompute(vertices, triangles, refine=False)
    relighter = relumine.Relighter(scene)
    relighter.set_environment(relumine.Environment(np.ones((6, 8, 8, 3))))
    assert relighter.radiance == pytest.approx(1.0, abs=2e-3)
    assert relighter.verify(0, surface=0).relative_l2 < 2e-3


def test_a_lit_plane_and_the_orientation_of_arrays():
    """Light from +Y alone lights a plane that faces +Y by L, and from -Y not at all."""
    plane = ([[0, 0, 0], [0, 0, 1], [1, 0, 0]], [[0, 1, 2]])
    relighter = relumine.Relighter(relumine.precompute(*plane, refine=False))
    above, below = np.zeros((6, 16, 16, 3)), np.zeros((6, 16, 16, 3))
    above[[0, 1, 4, 5], :8] = above[2] = 1.0  # faces +X -X +Y -Y +Z -Z, rows from the top
    below[[0, 1, 4, 5], 8:] = below[3] = 1.0
    relighter.set_environment(relumine.Environment(above))
    assert relighter.radiance == pytest.approx(1.0, abs=2e-3)
    relighter.set_environment(relumine.Environment(below))
    assert relighter.radiance == pytest.approx(0.0, abs=1e-4)
    lat_long = np.zeros((16, 32, 3))
    lat_long[:8] = 1.0
    relighter.set_environment(relumine.Environment(lat_long))
    assert relighter.radiance == pytest.approx(1.0, abs=1e-2)


def test_faces_and_lat_long_agree(relighter, sky):
    as_lat_long = relighter.radiance.copy()
    relighter.set_environment(relumine.Environment(sky.cube))
    assert np.linalg.norm(relighter.radiance - as_lat_long) < 1e-5 * np.linalg.norm(as_lat_long)


def test_relighting_is_linear(relighter, sky):
    once = relighter.radiance.copy()
    relighter.set_environment(relumine.Environment(2 * sky.cube))
    assert relighter.radiance == pytest.approx(2 * once, rel=1e-4, abs=1e-6)


def ball(steps=24):
    """A sphere of radius 1, without poles."""
    theta = np.linspace(0.1, np.pi - 0.1, steps)
    phi = np.arange(2 * steps) * np.pi / steps
    t, p = np.meshgrid(theta, phi, indexing="ij")
    vertices = np.stack([np.sin(t) * np.cos(p), np.cos(t), np.sin(t) * np.sin(p)], -1)
    number = np.arange(2 * steps * steps).reshape(steps, 2 * steps)
    right = np.roll(number, -1, axis=1)
    quads = [number[:-1], right[:-1], right[1:], number[:-1], right[1:], number[1:]]
    triangles = np.stack([quad.ravel() for quad in quads], -1).reshape(-1, 3)
    return vertices.reshape(-1, 3), triangles


def test_highlights_follow_the_eye():
    """A white metal under a white sky sends 1 to each eye, and one mirrors what is across."""
    vertices, triangles = ball()
    scene = relumine.precompute(
        vertices, triangles, material=relumine.Ggx(0.4, albedo=0.0, f0=1.0), refine=False
    )
    relighter = relumine.Relighter(scene)
    with pytest.raises(RuntimeError, match="expected a scene that is lit"):
        relighter.towards((0, 0, 5))
    relighter.set_environment(relumine.Environment(np.ones((6, 16, 16, 3))))
    for eye in ([0, 0, 5], [4, 3, 0]):
        facing = scene.normals @ np.array(eye) > 2.5
        light = relighter.towards(eye)
        assert light[facing] == pytest.approx(1.0, abs=0.03)
    left = np.zeros((6, 16, 16, 3))
    left[0] = 1.0  # +X
    relighter.set_environment(relumine.Environment(left))
    light = relighter.towards([0, 0, 5])
    across = scene.nearest_receiver([np.sqrt(0.5), 0, np.sqrt(0.5)])
    ahead = scene.nearest_receiver([0, 0, 1])
    assert light[across, 0] > 0.9 > 0.05 > light[ahead, 0]
    with pytest.raises(ValueError, match="eye: expected"):
        relighter.towards([0, 0])
    with pytest.raises(ValueError, match="tolerance: expected 1e-5 to 1, got 2"):
        relighter.towards([0, 0, 5], tolerance=2)
    rough, made_rough = (
        relumine.Relighter(scene, surface_roughness=0.8),
        relumine.Relighter(
            relumine.precompute(
                vertices,
                triangles,
                material=relumine.Ggx(0.8, albedo=0.0, f0=1.0),
                refine=False,
            )
        ),
    )
    for each in (rough, made_rough):
        each.set_environment(relumine.Environment(left))
    assert (rough.towards([0, 0, 5]) == made_rough.towards([0, 0, 5])).all()
    assert abs(rough.towards([0, 0, 5]) - light).max() > 0.1
    matt = relumine.Relighter(relumine.precompute(vertices, triangles, refine=False))
    with pytest.raises(ValueError, match="surface|materials"):
        relumine.Relighter(matt.scene, surface_roughness=0.5)
    matt.set_environment(relumine.Environment(left))
    with pytest.raises(ValueError, match="expected vertices with glossy materials"):
        matt.towards([0, 0, 5])


def test_bounces(arrays):
    scene = relumine.precompute(*arrays, tolerance=0.05, bounces=True)
    assert scene.settings["bounces"]
    relighter = relumine.Relighter(scene)
    relighter.set_environment(relumine.Environment(np.ones((6, 8, 8, 3))))
    direct = relighter.radiance.copy()
    done = relighter.bounce(albedo=1.0)
    assert done.bounces > 1
    # White surfaces under a white sky reflect 1 everywhere, however they stand.
    assert np.mean(np.abs(relighter.radiance - 1)) < 0.02 < np.mean(np.abs(direct - 1))
    relighter.bounce(1, albedo=0.5)
    assert (relighter.radiance >= direct).all()
    assert relighter.bounced == pytest.approx(relighter.radiance - direct, abs=1e-6)
    relighter.set_environment(relumine.Environment(np.ones((6, 8, 8, 3))))
    assert (relighter.radiance == direct).all() and relighter.bounced.shape == (0, 3)


def test_scenes_without_bounces_say_so(relighter):
    with pytest.raises(ValueError, match="bounces"):
        relighter.bounce()


def test_pixels_and_texels(arrays, sky):
    vertices, triangles = arrays
    scene = relumine.precompute(
        vertices, triangles, tolerance=0.1, receivers="pixels:64x48", view="auto"
    )
    relighter = relumine.Relighter(scene)
    relighter.set_environment(sky)
    assert relighter.picture().shape == (48, 64, 3)
    assert relighter.picture(background="none").shape == (48, 64, 4)
    uvs = vertices[:, [0, 2]] * 0.1 + 0.5
    mesh = relumine.Mesh(vertices, triangles, uvs=uvs)
    with pytest.warns(relumine.RelumineWarning):  # the ball's charts overlap
        scene = relumine.precompute(mesh, tolerance=0.1, receivers="texels:32x32")
    relighter = relumine.Relighter(scene)
    relighter.set_environment(sky)
    assert relighter.picture().shape[:2] == (32, 32)


def test_materials(arrays, sky):
    scene = relumine.precompute(
        *arrays, tolerance=0.1, material=relumine.Lambert((0.5, 0.25, 0.125))
    )
    relighter = relumine.Relighter(scene)
    relighter.set_environment(relumine.Environment(np.ones((6, 8, 8, 3))))
    ratio = relighter.radiance[:, 0] / np.maximum(relighter.radiance[:, 1], 1e-9)
    assert np.median(ratio) == pytest.approx(2.0, rel=1e-4)
    grey = relumine.Relighter(scene, surface_albedo=0.5)
    grey.set_environment(relumine.Environment(np.ones((6, 8, 8, 3))))
    assert grey.radiance[:, 1] == pytest.approx(relighter.radiance[:, 0], abs=1e-5)
    shiny = relumine.precompute(
        *arrays, tolerance=0.1, material=relumine.Ggx(0.4, f0=0.5), view=((0, 1, 5), (0, 0, 0), 40)
    )
    assert relumine.Relighter(shiny).set_environment(sky).seconds_relight > 0
    with pytest.raises(ValueError, match="^material: expected numbers of 0 to 1 as roughness"):
        relumine.precompute(*arrays, material=relumine.Ggx(2.0))
    with pytest.raises(ValueError, match="group"):
        relumine.precompute(*arrays, material={"hat": relumine.Lambert()})


def test_any_brdf(arrays, tmp_path):
    """A Lambertian function is a Lambertian surface; what no surface does is refused."""
    view = ((0, 1, 5), (0, 0, 0), 40)
    white = relumine.Environment(np.ones((6, 8, 8, 3)))

    def radiance(material):
        scene = relumine.precompute(*arrays, tolerance=0.1, material=material, view=view)
        relighter = relumine.Relighter(scene)
        relighter.set_environment(white)
        return relighter.radiance.copy()

    matt = relumine.Brdf.of(lambda light, eye: np.full((len(light), 3), (0.5, 0.25, 0.1)) / np.pi)
    expected = radiance(relumine.Lambert((0.5, 0.25, 0.1)))
    assert radiance({"": matt}) == pytest.approx(expected, abs=1e-5)
    values = np.empty((3, 90, 90, 90))
    values[:] = np.reshape((0.5, 0.25, 0.1), (3, 1, 1, 1)) / np.pi
    assert radiance(relumine.Brdf.table(values)) == pytest.approx(expected, abs=1e-5)
    with pytest.raises(ValueError, match="values"):
        relumine.Brdf.table(values[:2])
    values[1, 0, 0, 0] = np.nan
    with pytest.raises(ValueError, match="0 or more, got nan of green"):
        relumine.Brdf.table(values)
    for function, wrong in (
        (lambda light, eye: np.ones(len(light)), "reflects at most what arrives, got 3.14"),
        (lambda light, eye: 0.3 * light[:, 2], "reciprocal"),
        (lambda light, eye: -light[:, 2], "0 or more"),
        (lambda light, eye: np.ones(3), r"function: expected numbers of shape \(\d+, 3\)"),
    ):
        with pytest.raises(ValueError, match=wrong):
            relumine.Brdf.of(function)
    (tmp_path / "bad.binary").write_bytes(b"MERL")
    with pytest.raises(relumine.FileError, match="expected a table of a BRDF, got 4 bytes"):
        relumine.Brdf.load(tmp_path / "bad.binary")


def test_pictures(relighter):
    picture = relighter.picture(size=(80, 60), background="none", camera=(30, 25))
    assert picture.shape == (60, 80, 4) and picture.dtype == np.float32
    assert 0 < picture[..., 3].mean() < 1
    assert picture._repr_png_().startswith(b"\x89PNG")
    assert relighter._repr_png_().startswith(b"\x89PNG")
    assert (picture * 2).exposure == picture.exposure
    assert picture[..., 0]._repr_png_() is None
    black = relighter.picture(size=(80, 60), albedo=0, background=(0, 0, 1))
    assert (black[..., :2] == 0).all() and black[..., 2].max() == 1
    with pytest.raises(ValueError, match="^size: expected"):
        relighter.picture(size=(0, 3))
    with pytest.raises(ValueError, match="^tone_map: expected neutral, agx, aces or none"):
        relighter.picture(tone_map="filmic")
    with pytest.raises(ValueError, match="^background: expected"):
        relighter.picture(background="sharpish")
    with pytest.raises(ValueError, match="^camera: expected"):
        relighter.picture(camera=(1,))
    with pytest.raises(TypeError, match="no option expossure; did you mean exposure"):
        relighter.picture(expossure=1)


def test_every_option_of_pictures_is_a_keyword(relighter, command_line, folder):
    """The table of the library is the signature, and each value is read as the program reads it."""
    rows = {name: (default, example) for name, default, _, example in _core.picture_options()}
    for function in (relumine.Relighter.picture, relumine.Relighter.save):
        keywords = inspect.signature(function).parameters
        for name, (default, _) in rows.items():
            assert keywords[name].default == default, name
            assert f"\n{name} " in function.__doc__, name
    for name, (default, example) in rows.items():
        relighter.picture(**{"size": (8, 6), name: default})
        relighter.picture(**{"size": (8, 6), name: example})
        if isinstance(default, (int, float)) and not isinstance(default, bool):
            with pytest.raises(ValueError, match=f"^{name}: expected"):
                relighter.picture(**{name: 1e30})


def test_a_camera_has_a_field_of_view(relighter):
    both = relighter.picture(size=(40, 30), camera=(30, 25, None, 60))
    assert (both == relighter.picture(size=(40, 30), camera=(30, 25), fov=60)).all()
    assert (both == relighter.picture(size=(40, 30), camera="30,25,,60")).all()
    numbers = (np.float64(30), np.int64(25), None, np.float32(60))
    assert (both == relighter.picture(size=(40, 30), camera=numbers)).all()
    with pytest.raises(ValueError, match="^camera: expected either a field of view here or fov"):
        relighter.picture(camera=(30, 25, 5, 60), fov=50)


def test_equals_the_command_line(relighter, sky, folder, command_line):
    relighter.scene.save("boulder.prt")
    sky.save("sky.exr", layout="cube")
    environment = relumine.Environment.load("sky.exr", rotate=30, face_resolution=16)
    relighter.set_environment(environment)
    command_line(
        "relight", "boulder.prt", "sky.exr", "--rotate", 30, "--face-resolution", 16,
        "-o", "out.npy", "--albedo", 1,
    )  # fmt: skip
    assert (np.load("out.npy") == relighter.radiance).all()
    relighter.save("own.npy", albedo=1)
    assert (np.load("own.npy") == relighter.radiance).all()
    relighter.save("own.png", size=(160, 120))
    command_line(
        "relight", "boulder.prt", "sky.exr", "--rotate", 30, "--face-resolution", 16,
        "-o", "out.png", "--size", "160x120",
    )  # fmt: skip
    assert (folder / "own.png").read_bytes() == (folder / "out.png").read_bytes()
    picture = relighter.picture(size=(160, 120))
    assert picture.png() == (folder / "out.png").read_bytes()


def test_what_is_closed_is_closed(scene, sky):
    with relumine.Relighter(scene) as relighter:
        relighter.set_environment(sky)
        radiance = relighter.radiance
    assert repr(relighter) == "<relumine.Relighter: closed>"
    assert np.isfinite(radiance).all()
    with pytest.raises(RuntimeError, match="closed"):
        relighter.set_environment(sky)


def test_order_of_calls(scene):
    relighter = relumine.Relighter(scene)
    for call in (lambda: relighter.radiance, relighter.verify, relighter.picture):
        with pytest.raises(RuntimeError, match="lit"):
            call()
    with pytest.raises(RuntimeError, match="set_environment"):
        relighter.set_layers([])
    with pytest.raises(ValueError, match="precomputed"):
        mesh = relumine.Mesh(scene.vertices, scene.triangles)
        relumine.Relighter(relumine.Scene.unclustered(mesh)).set_environment(
            relumine.Environment(np.ones((6, 2, 2, 3)))
        )


def test_other_things_block_the_light():
    """A large plane over a small one takes all light from above."""
    x, z = np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], indexing="ij")
    vertices = np.stack([x.ravel(), np.zeros(9), z.ravel()], axis=1)
    triangles = [[i, i + 1, i + 3] for i in (0, 1, 3, 4)] + [
        [i + 1, i + 4, i + 3] for i in (0, 1, 3, 4)
    ]
    roof = (vertices * 100 + [0, 0.5, 0], triangles)
    lit = {}
    for name, blockers in (("open", None), ("closed", roof)):
        mesh = relumine.Mesh(vertices, triangles, blockers=blockers)
        scene = relumine.precompute(mesh, refine=False)
        assert len(scene.vertices) == 9
        lit[name] = relumine.Relighter(scene)
        lit[name].set_environment(relumine.Environment(np.ones((6, 8, 8, 3))))
    assert lit["open"].radiance == pytest.approx(np.ones((9, 3)), abs=0.02)
    assert lit["closed"].radiance.max() < 0.02
    # A lamp below the roof is seen, one above it is not; one below the plane neither.
    points = [[0, 0.4, 0], [0, 0.6, 0], [0, -0.4, 0]]
    assert (lit["closed"].sees(points) == [True, False, False]).all()
    assert (lit["open"].sees(points) == [True, True, False]).all()
    many = np.column_stack([np.zeros(40), np.linspace(0.1, 0.9, 40), np.zeros(40)])
    assert (lit["closed"].sees(many) == (many[:, 1] < 0.5)).all()
    with pytest.raises(ValueError, match=r"^points: expected shape \(N, 3\)"):
        lit["open"].sees([1, 2, 3])
    with pytest.raises(ValueError, match=r"^blockers: expected \(vertices, triangles\)"):
        relumine.Mesh(vertices, triangles, blockers=(vertices,))
    with pytest.raises(ValueError, match=r"^blockers\[1\]: expected whole numbers from 0 to 8"):
        relumine.Mesh(vertices, triangles, blockers=(vertices, [[0, 1, 9]]))


def test_places_of_texels(arrays):
    vertices, triangles = arrays
    mesh = relumine.Mesh(vertices[-2304:], triangles[-4418:] - 4608,
                         uvs=vertices[-2304:, [0, 2]] / 6 + 0.5)  # fmt: skip
    scene = relumine.precompute(mesh, tolerance=0.1, receivers="texels:16x16", bounces=False)
    assert len(scene.places) == scene.num_receivers == 256
    row, column = scene.places // 16, scene.places % 16
    # u runs along +X, v upwards along +Z.
    assert scene.positions[:, 0] == pytest.approx((column + 0.5) / 16 * 6 - 3, abs=1e-3)
    assert scene.positions[:, 2] == pytest.approx(3 - (row + 0.5) / 16 * 6, abs=1e-3)
    assert relumine.precompute(mesh, tolerance=0.1, refine=False).places.shape == (0,)


def test_a_picture_is_denoised(monkeypatch):
    given = []

    def denoise(color, albedo, normal, hdr):
        given.append((color.shape, albedo, normal, hdr))
        return 0.5 * color

    monkeypatch.setitem(sys.modules, "pyoidn", types.SimpleNamespace(denoise=denoise))
    picture = relumine.Picture(np.full((4, 6, 4), 0.5), exposure=1.5, tone_map="agx")
    smooth = picture.denoised(albedo=np.ones((4, 6, 3)))
    assert given[0][0] == (4, 6, 3) and given[0][1].dtype == np.float32 and given[0][3]
    assert given[0][2] is None
    assert (smooth[..., :3] == 0.25).all() and (smooth[..., 3] == 0.5).all()
    assert (smooth.exposure, smooth.tone_map) == (1.5, "agx")
    with pytest.raises(ValueError, match=r"normals: expected shape \(4, 6, 3\)"):
        picture.denoised(normals=np.ones((6, 4, 3)))
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(ImportError, match=r"pip install relumine\[denoise\]"):
        picture.denoised()
