"""Arrays of every kind, in and out."""

import os

import numpy as np
import pytest

import relumine

KINDS = {
    "float64": lambda a: a.astype(np.float64),
    "float32": lambda a: a.astype(np.float32),
    "Fortran order": lambda a: np.asfortranarray(a),
    "sliced": lambda a: np.repeat(a, 2, axis=0)[::2],
    "columns of a wider array": lambda a: np.concatenate([a, a], axis=-1)[..., :3],
    "negative stride": lambda a: a[::-1].copy()[::-1],
    "big-endian": lambda a: a.astype(a.dtype.newbyteorder(">")),
    "read-only": lambda a: _read_only(a),
    "a list": lambda a: a.tolist(),
    "unaligned": lambda a: _unaligned(a),
}


def _read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def _unaligned(array):
    raw = bytearray(array.nbytes + 1)
    raw[1:] = np.ascontiguousarray(array).tobytes()
    return np.frombuffer(raw, dtype=array.dtype, offset=1).reshape(array.shape)


def tetrahedron():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float64)
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.int64)
    return vertices, triangles


@pytest.mark.parametrize("kind", KINDS)
def test_vertices_and_triangles_of_every_kind(kind):
    vertices, triangles = tetrahedron()
    mesh = relumine.Mesh(KINDS[kind](vertices), KINDS[kind](triangles))
    assert (mesh.vertices == vertices).all() and mesh.vertices.dtype == np.float32
    assert (mesh.triangles == triangles).all() and mesh.triangles.dtype == np.uint32


@pytest.mark.parametrize("dtype", "i1 i2 i4 i8 u1 u2 u4 u8 f2 f4 f8 >i4 >u8".split())
def test_triangles_of_every_type(dtype):
    vertices, triangles = tetrahedron()
    mesh = relumine.Mesh(vertices, triangles.astype(dtype))
    assert (mesh.triangles == triangles).all()


@pytest.mark.parametrize("kind", KINDS)
def test_environments_of_every_kind(kind):
    pixels = np.random.default_rng(1).random((8, 16, 3))
    environment = relumine.Environment(KINDS[kind](pixels))
    assert (environment.pixels == pixels.astype(np.float32)).all()


def wrong(message, vertices=None, triangles=None, **others):
    good = tetrahedron()
    with pytest.raises(ValueError) as error:
        relumine.Mesh(
            good[0] if vertices is None else vertices,
            good[1] if triangles is None else triangles,
            **others,
        )
    assert str(error.value).startswith(message), str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("dtype", ["f4", "f8", "u4", "i8"])
def test_what_is_checked_is_a_copy(dtype):
    """Other threads may write the user's array between its check and its use."""
    given = np.zeros((4, 3), dtype=dtype)
    for taken in (
        relumine._arrays.floats("given", given, None, 3),
        relumine._arrays.doubles("given", given, None, 3),
        relumine._arrays.indices("given", given, 1, None, 3),
    ):
        assert not np.shares_memory(taken, given)


def test_wrong_arrays_are_named():
    vertices, triangles = tetrahedron()
    nan, huge = vertices.copy(), vertices.copy()
    nan[2, 1] = np.nan
    huge[1, 0] = 1e300  # is infinite as a float32
    beyond, negative, broken = triangles.copy(), triangles.copy(), triangles + 0.5
    beyond[3, 0] = 4
    negative[1, 2] = -1
    wrong("vertices: expected finite numbers, got nan at [2, 1]", vertices=nan)
    wrong("vertices: expected finite numbers, got 1e+300 at [1, 0]", vertices=huge)
    wrong("vertices: expected shape (N, 3), got (3, 4)", vertices=vertices.T)
    wrong("vertices: expected shape (N, 3), got (0,)", vertices=[])
    wrong("vertices: expected at least one row, got none", vertices=np.zeros((0, 3)))
    wrong("vertices: expected numbers, got elements of type complex", vertices=vertices + 1j)
    wrong("vertices: expected numbers, got elements of type <U", vertices=vertices.astype(str))
    wrong("vertices: expected numbers, got elements of type bool", vertices=vertices > 0)
    wrong("vertices: expected", vertices=[[1, 2, 3], [4, 5]])
    wrong("triangles: expected whole numbers from 0 to 3, got 4 at [3, 0]", triangles=beyond)
    wrong("triangles: expected whole numbers from 0 to 3, got -1 at [1, 2]", triangles=negative)
    wrong("triangles: expected whole numbers from 0 to 3, got 0.5 at [0, 0]", triangles=broken)
    wrong("triangles: expected whole numbers", triangles=np.full((1, 3), np.nan))
    wrong("triangles: expected at least one row", triangles=np.zeros((0, 3), dtype=int))
    wrong("normals: expected shape (4, 3), got (3, 3)", normals=np.ones((3, 3)))
    wrong("uvs: expected shape (4, 2), got (4, 3)", uvs=np.ones((4, 3)))
    wrong("up: expected x, y or z, got 'q'", up="q")


def test_wrong_classes_are_named(relighter, scene):
    pixels = np.ones((4, 8, 3))
    for call, message in [
        (lambda: relumine.Relighter(5), "scene: expected a relumine.Scene, got int"),
        (lambda: relighter.set_environment(scene), "environment: expected a relumine.Environment"),
        (lambda: relighter.set_environment(pixels), r"relumine.Environment\(array\) makes one"),
        (lambda: relighter.set_lights([1]), "lights: expected a relumine.LightList, got list"),
        (lambda: relumine.precompute(scene), "mesh: expected a relumine.Mesh, got Scene"),
        (lambda: relumine.plan(scene, "a.plan"), "mesh: expected a relumine.Mesh, got Scene"),
        (lambda: relumine.Scene.unclustered(5), "mesh: expected a relumine.Mesh, got int"),
        (lambda: relighter.set_rotation("x"), "degrees: expected a number, got str"),
        (lambda: relighter.bounce("x"), "bounces: expected a whole number, got str"),
        (lambda: relighter.verify(1.5), "samples: expected a whole number, got float"),
        (lambda: relighter.set_layers(3), "layers: expected a list of layers, got int"),
        (lambda: relighter.set_layers([3]), r"layers\[0\]: expected a relumine.Layer or a dict"),
        (lambda: relighter.lit_by("disc"), "region: expected a region as relumine.Disc"),
        (lambda: relighter.picture(size="8x8").png(exposure="x"), "exposure: expected a number"),
        (lambda: relighter.picture(size="8x8").save(5), "path: expected a path, got int"),
        (lambda: relumine.Mesh.load(5), "path: expected a path, got int"),
        (lambda: relumine.set_threads("all"), "count: expected a whole number, got str"),
    ]:
        with pytest.raises(TypeError, match=message):
            call()
    for number, message in [
        (lambda: relighter.verify(-1), "samples: expected a whole number from 0 to"),
        (lambda: relumine.set_threads(-1), "count: expected a whole number from 0 to"),
        (lambda: relumine.precompute_part("a.plan", 2, 2, "b"), "part: expected .* 0 to 1, got 2"),
    ]:
        with pytest.raises(ValueError, match=message):
            number()
    with pytest.raises(ValueError, match=r"expected shape \(N, M, 3\), got \(4, 8\)"):
        relumine.Environment(pixels[..., 0])


class OfTrimesh:
    """What trimesh has of a mesh, with vertex colours as a screen shows them."""

    class visual:
        kind = "vertex"
        vertex_colors = np.array([[255, 188, 0, 255]] * 4, np.uint8)

    vertices, faces = map(np.asarray, tetrahedron())


class OfOpen3d:
    """What Open3D has of a mesh: vectors, empty where there are none."""

    vertices, triangles = map(np.asarray, tetrahedron())
    vertex_normals = np.zeros((0, 3))
    vertex_colors = np.full((4, 3), 0.5)


def test_meshes_of_other_libraries_are_taken():
    vertices, triangles = map(np.asarray, tetrahedron())
    for other, color in [(OfTrimesh(), (1.0, 0.5029, 0.0)), (OfOpen3d(), (0.214, 0.214, 0.214))]:
        mesh = relumine.Mesh.of(other)
        assert (mesh.vertices == vertices.astype(np.float32)).all()
        assert (mesh.triangles == triangles).all()
        assert mesh.colors[3] == pytest.approx(color, abs=1e-3)
        scene = relumine.precompute(other, tolerance=0.1, refine=False)
        assert scene.num_receivers == 4
    assert relumine.Mesh.of(OfOpen3d(), floor=5).floor == 5
    assert relumine.Mesh.of(mesh) is mesh
    with pytest.raises(TypeError, match="mesh: expected a relumine.Mesh, got int; Mesh.load"):
        relumine.precompute(7)


def test_names_of_files_are_taken_as_meshes(tmp_path):
    mesh = relumine.Mesh(*tetrahedron())
    mesh.save(tmp_path / "a.glb")
    scene = relumine.precompute(tmp_path / "a.glb", tolerance=0.1, refine=False)
    assert scene.num_receivers == 4
    assert relumine.Mesh.of(str(tmp_path / "a.glb"), floor=5).floor == 5
    assert len(relumine.Mesh.load(os.fsencode(tmp_path / "a.glb")).vertices) == 4
    with pytest.raises(FileNotFoundError, match="nope.glb"):
        relumine.precompute("nope.glb")
    with pytest.raises(TypeError, match="vertices: expected an array, got None"):
        relumine.Mesh(None, tetrahedron()[1])
    with pytest.raises(TypeError, match=r"got Mesh: relumine.precompute\(\) makes one"):
        relumine.Relighter(mesh)
    with pytest.raises(TypeError, match=r"got str: relumine.Environment.load\(\) reads a file"):
        relumine.Relighter(scene).set_environment("sky.exr")


def test_meshes_are_saved(tmp_path):
    vertices, triangles = tetrahedron()
    mesh = relumine.Mesh(vertices, triangles, uvs=np.zeros((4, 2)), groups=["a", "a", "b", "b"])
    mesh.save(tmp_path / "a.glb")
    again = relumine.Mesh.load(tmp_path / "a.glb")
    assert again.groups == ["a", "b"] and len(again.triangles) == 4
    with pytest.warns(relumine.RelumineWarning, match="a.ply: left out: groups"):
        mesh.save(tmp_path / "a.ply")
    with pytest.raises(OSError, match="expected a mesh file to write"):
        mesh.save(tmp_path / "a.stl")
    scene = relumine.precompute(mesh, tolerance=0.1, refine=False, movable=True)
    scene.save_mesh(tmp_path / "b.glb")
    assert relumine.Mesh.load(tmp_path / "b.glb").groups == ["a", "b"]
    with pytest.raises(ValueError, match=r"path: expected a .prt file, got '.glb': save_mesh\(\)"):
        scene.save(tmp_path / "c.glb")
    assert not (tmp_path / "c.glb").exists()


def test_triangles_alone_are_refused():
    vertices, triangles = tetrahedron()
    with pytest.raises(ValueError, match="^triangles: expected an array beside"):
        relumine.precompute(vertices)
    with pytest.raises(ValueError, match="^triangles: expected none beside a mesh"):
        relumine.precompute(relumine.Mesh(vertices, triangles), triangles)


def test_order_and_number_of_vertices_are_kept(arrays, scene):
    assert (scene.vertices == arrays[0].astype(np.float32)).all()
    # Receivers are lifted off the surface by the bias.
    assert np.abs(scene.positions - scene.vertices).max() <= 1.01 * scene.settings["bias"]
    assert (scene.triangles == arrays[1]).all()


def test_views_are_read_only_and_outlive_their_owner():
    vertices, triangles = tetrahedron()
    mesh = relumine.Mesh(vertices, triangles)
    view = mesh.vertices
    with pytest.raises(ValueError):
        view[0, 0] = 1.0
    with pytest.raises(ValueError):
        view.flags.writeable = True
    del mesh
    assert (view == vertices).all()


def test_radiance_is_a_view_of_the_present(relighter, sky):
    before = relighter.radiance
    kept = before.copy()
    relighter.set_environment(sky.turned(rotate=90))
    assert before.ctypes.data == relighter.radiance.ctypes.data
    assert (before == relighter.radiance).all() and not (before == kept).all()
    del relighter
    assert np.isfinite(before).all()


def test_results_speak_to_other_libraries(relighter):
    radiance = relighter.radiance
    assert radiance.flags.c_contiguous and radiance.dtype == np.float32
    assert memoryview(radiance).readonly
    assert np.from_dlpack(radiance.copy()).shape == radiance.shape  # torch, jax


def test_regions_receivers_and_lights_are_checked(relighter):
    with pytest.raises(ValueError, match=r"^radiance: expected shape \(N, M, 3\)"):
        relighter.update_region("+x", 0, 0, np.ones((2, 3)))
    with pytest.raises(ValueError, match=r"^radiance: expected finite numbers, got inf"):
        relighter.update_region("+x", 0, 0, np.full((2, 2, 3), np.inf))
    with pytest.raises(ValueError, match="^face: expected"):
        relighter.update_region("x", 0, 0, np.ones((2, 2, 3)))
    with pytest.raises(ValueError, match="rectangle"):
        relighter.update_region("+x", 15, 0, np.ones((2, 2, 3)))
    with pytest.raises(ValueError, match="^receivers: expected whole numbers"):
        relighter.contribution_map([relighter.scene.num_receivers])
    with pytest.raises(ValueError, match="^receivers: expected at least one"):
        relighter.contribution_map(np.zeros(0, dtype=int))
    with pytest.raises(ValueError, match="^directions: expected"):
        relumine.LightList([[0, 0, 0]], [[1, 1, 1]])
    with pytest.raises(ValueError, match="^irradiances: expected"):
        relumine.LightList([[0, 1, 0]], [[1, -1, 1]])
