"""The operator itself: its transpose, batches, and what workers get."""

import copy
import multiprocessing
import pickle

import numpy as np
import pytest

import relumine


def inner(a, b):
    return np.sum(np.asarray(a, np.float64) * np.asarray(b, np.float64))


def test_the_adjoint_is_the_transpose(scene):
    random = np.random.default_rng(3)
    relighter = relumine.Relighter(scene, clusters_only=True)
    for _ in range(5):
        relighter.set_environment(relumine.Environment(random.random((6, 16, 16, 3))))
        weights = random.uniform(-0.5, 1, (scene.num_receivers, 3))
        gradient = relighter.adjoint(weights)
        assert gradient.shape == (6, 16, 16, 3)
        forward = inner(relighter.radiance, weights)
        assert inner(relighter.environment, gradient) == pytest.approx(forward, rel=1e-5)


@pytest.mark.parametrize("size", [(16, 8), (32, 16), (96, 48)])
def test_the_adjoint_by_lat_long_pixels_is_the_transpose(scene, size):
    random = np.random.default_rng(4)
    relighter = relumine.Relighter(scene, clusters_only=True)
    width, height = size
    for brightest in (1.0, 1e4):
        # A bright pixel would choose a finer map, if the environment chose one.
        pixels = random.random((height, width, 3))
        pixels[1, 2] = brightest
        relighter.set_environment(relumine.Environment(pixels, face_resolution=16))
        weights = random.uniform(-0.5, 1, (scene.num_receivers, 3))
        gradient = relighter.adjoint(weights, size=size)
        assert gradient.shape == pixels.shape
        assert inner(pixels, gradient) == pytest.approx(inner(relighter.radiance, weights), rel=1e-4)
    with pytest.raises(ValueError, match="size: expected a whole number from 1"):
        relighter.adjoint(weights, size=(0, 4))


def test_light_is_found_again(scene, sky):
    relighter = relumine.Relighter(scene, clusters_only=True)
    relighter.set_environment(sky)
    target = relighter.radiance.copy()
    found = relighter.fit_environment(target, face_resolution=8)
    assert found.distance < 0.05
    assert found.environment.face_resolution == 8
    relighter.set_environment(found.environment)
    error = np.linalg.norm(relighter.radiance - target) / np.linalg.norm(target)
    assert error == pytest.approx(found.distance, rel=1e-2)
    coarse = relighter.fit_environment(target, face_resolution=1, iterations=20)
    assert coarse.distance > found.distance

    with pytest.raises(ValueError, match="expected a relighter with shadow rays"):
        relighter.fit_lights(target, 1)
    relighter = relumine.Relighter(scene)
    relighter.set_lights(relumine.LightList([(0.6, 0.8, 0.0)], [(3.0, 2.0, 1.0)]))
    lights = relighter.fit_lights(relighter.radiance.copy(), 1)
    assert lights.distance < 0.3 and len(lights.lights) == 1
    with pytest.raises(ValueError, match="wanted: expected shape"):
        relighter.fit_environment(target[:5])
    with pytest.raises(ValueError, match="number: expected a whole number from 1"):
        relighter.fit_lights(target, 0)


def test_light_is_found_in_a_picture(scene, sky):
    relighter = relumine.Relighter(scene, clusters_only=True)
    relighter.set_environment(sky)
    options = dict(camera=(30, 20), albedo=0.5, background="none")
    picture = np.asarray(relighter.picture(size=(96, 64), **options))[..., :3]
    found = relighter.fit_environment(picture, face_resolution=4, **options)
    assert found.distance < 0.2


def test_torch_differentiates_a_relight(scene):
    torch = pytest.importorskip("torch")
    from relumine.torch import relight

    relighter = relumine.Relighter(scene, clusters_only=True)
    for shape in [(6, 8, 8, 3), (16, 32, 3)]:
        pixels = torch.rand(shape, dtype=torch.float64, requires_grad=True)
        radiance = relight(relighter, pixels)
        other = relight(relighter, torch.ones(6, 4, 4, 3))  # whose derivative comes first
        weights = torch.rand(radiance.shape, dtype=torch.float64)
        (radiance * weights).sum().backward()
        total = (pixels * pixels.grad).sum().item()
        assert total == pytest.approx((radiance * weights).sum().item(), rel=1e-4)
        assert other.shape == radiance.shape


def test_jax_differentiates_a_relight(scene):
    jax = pytest.importorskip("jax")
    from relumine.jax import relight

    relighter = relumine.Relighter(scene, clusters_only=True)
    random = np.random.default_rng(6)
    weights = random.random((scene.num_receivers, 3)).astype(np.float32)

    def loss(pixels):
        return (relight(relighter, pixels) * weights).sum()

    for shape in [(6, 8, 8, 3), (16, 32, 3)]:
        pixels = random.random(shape, np.float32)
        relighter.set_environment(relumine.Environment(pixels, face_resolution=8))
        expected = inner(relighter.radiance, weights)
        for gradient_of in (jax.grad(loss), jax.jit(jax.grad(loss))):
            gradient = gradient_of(pixels)
            assert gradient.shape == shape and gradient.dtype == np.float32
            assert inner(pixels, gradient) == pytest.approx(expected, rel=1e-4)
        many = jax.vmap(lambda each: relight(relighter, each))(np.stack([pixels, 2 * pixels]))
        assert np.allclose(2 * many[0], many[1], rtol=1e-4)
        assert inner(many[0], weights) == pytest.approx(expected, rel=1e-5)
    with pytest.raises(jax.errors.JaxRuntimeError, match="expected finite radiance >= 0"):
        relight(relighter, np.full((6, 8, 8, 3), -1.0, np.float32)).block_until_ready()
    with pytest.raises(ValueError, match=r"pixels: expected shape .*, got \(6, 8, 7, 3\)"):
        relight(relighter, np.ones((6, 8, 7, 3), np.float32))


def test_meshes_are_pickled(arrays, folder):
    vertices, triangles = arrays
    mesh = relumine.Mesh(vertices, triangles, colors=np.full((len(vertices), 3), 0.5), floor=4)
    (folder / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 -1\nv 0 1 0\nf 1 2 3\nf 1 2 4\n")
    loaded = relumine.Mesh.load("mesh.obj", floor=3)
    for each in (mesh, loaded, mesh.simplified(500), loaded.refined(max_edge=0.4)):
        again = pickle.loads(pickle.dumps(each))
        for name in ("vertices", "triangles", "normals", "colors", "floor"):
            assert np.array_equal(getattr(again, name), getattr(each, name)), name
    kept = pickle.dumps(loaded)
    (folder / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 -2\nf 1 2 3\n")
    with pytest.raises(relumine.FileError, match="expected the file of the pickled mesh"):
        pickle.loads(kept)


def test_relighters_are_pickled(arrays, scene, sky):
    relighter = relumine.Relighter(scene, harmonics=2, clusters_only=True)
    assert pickle.loads(pickle.dumps(relighter)).scene.num_receivers == scene.num_receivers
    layer = relumine.Layer("key", relumine.Disc((1, 1, 1), 20), relumine.Emit((4, 4, 4)))

    def light():
        yield relighter.set_environment(sky)
        yield relighter.set_layers([layer])
        yield relighter.set_rotation(30)
        yield relighter.update_region("+x", 2, 2, np.full((3, 3, 3), 5.0))
        yield relighter.set_lights(relumine.LightList([(0, 1, 0)], [(1, 2, 3)]))

    for step in light():
        again = pickle.loads(pickle.dumps(relighter))
        assert step is not None
        assert again.radiance == pytest.approx(relighter.radiance, rel=1e-4, abs=1e-5)
        assert again.layers == relighter.layers
        assert again.harmonics.shape == relighter.harmonics.shape
    relighter.close()
    with pytest.raises(RuntimeError, match="got one that was closed"):
        pickle.dumps(relighter)


def test_the_adjoint_refuses_wrong_weights(scene):
    relighter = relumine.Relighter(scene)
    with pytest.raises(RuntimeError, match="expected a scene that is lit"):
        relighter.adjoint(np.ones(scene.num_receivers))
    relighter.set_environment(relumine.Environment(np.ones((6, 4, 4, 3))))
    with pytest.raises(ValueError, match="weights: expected shape"):
        relighter.adjoint(np.ones((5, 3)))
    with pytest.raises(ValueError, match="weights: expected finite numbers"):
        relighter.adjoint(np.full((scene.num_receivers, 3), np.nan))
    relighter.set_lights(relumine.LightList([(0, 1, 0)], [(1, 1, 1)]))
    with pytest.raises(RuntimeError, match="lit by an environment"):
        relighter.adjoint(np.ones(scene.num_receivers))


@pytest.mark.parametrize("order", [2, 3])
def test_the_adjoint_of_harmonics_is_the_transpose(scene, order):
    random = np.random.default_rng(order)
    relighter = relumine.Relighter(scene, harmonics=order)
    with pytest.raises(RuntimeError, match="expected a scene that is lit"):
        relighter.harmonics_adjoint(np.ones((scene.num_receivers, order**2, 3)))
    for _ in range(3):
        relighter.set_environment(relumine.Environment(random.random((6, 16, 16, 3))))
        weights = random.uniform(-0.5, 1, relighter.harmonics.shape)
        backward = inner(relighter.environment, relighter.harmonics_adjoint(weights))
        assert backward == pytest.approx(inner(relighter.harmonics, weights), rel=1e-5)
    with pytest.raises(ValueError, match="weights: expected shape"):
        relighter.harmonics_adjoint(np.ones((scene.num_receivers, 3)))
    with pytest.raises(RuntimeError, match="with harmonics"):
        relumine.Relighter(scene).harmonics_adjoint(weights)


def test_the_adjoint_of_points_is_the_transpose(arrays):
    random = np.random.default_rng(8)
    points = relumine.precompute(*arrays, receivers=random.uniform(-2, 2, (40, 3)))
    relighter = relumine.Relighter(points)
    relighter.set_environment(relumine.Environment(random.random((6, 16, 16, 3))))
    weights = random.uniform(-0.5, 1, (40, 3))
    backward = inner(relighter.environment, relighter.adjoint(weights))
    assert backward == pytest.approx(inner(relighter.radiance, weights), rel=1e-5)


def test_the_adjoint_of_a_picture_is_the_transpose(arrays):
    random = np.random.default_rng(9)
    pixels = relumine.precompute(
        *arrays, receivers="pixels:24x18:2", view="auto", bounces=0.05, tolerance=0.05
    )
    relighter = relumine.Relighter(pixels, clusters_only=True)
    weights = random.uniform(-0.5, 1, (18, 24, 3))
    with pytest.raises(RuntimeError, match="expected a scene that is lit"):
        relighter.picture_adjoint(weights)
    relighter.set_environment(relumine.Environment(random.random((6, 16, 16, 3))))
    relighter.bounce(bounces=3)
    for albedo in (1, (0.2, 0.5, 0.9)):
        picture = np.asarray(relighter.picture(albedo=albedo, background="none"))[..., :3]
        backward = inner(
            relighter.environment, relighter.picture_adjoint(weights, albedo=albedo)
        )
        assert backward == pytest.approx(inner(picture, weights), rel=1e-4)
    with pytest.raises(ValueError, match=r"weights: expected shape \(18, 24, 3\)"):
        relighter.picture_adjoint(weights.transpose(1, 0, 2))
    vertices = relumine.Relighter(relumine.precompute(*arrays, tolerance=0.5, bounces=False))
    vertices.set_environment(relumine.Environment(np.ones((6, 4, 4, 3))))
    with pytest.raises(ValueError, match="expected a scene of pixels, got vertices"):
        vertices.picture_adjoint(weights)


def test_a_batch_is_what_single_environments_give(scene):
    random = np.random.default_rng(4)
    cubes = random.random((5, 6, 8, 8, 3)).astype(np.float32)
    relighter = relumine.Relighter(scene)
    radiance = relighter.relight_batch(cubes)
    assert not relighter._core.is_lit
    half = np.empty(radiance.shape, np.float16)
    assert relighter.relight_batch(cubes, out=half) is half
    for i, cube in enumerate(cubes):
        relighter.set_environment(relumine.Environment(cube, face_resolution=8))
        assert np.allclose(radiance[i], relighter.radiance, rtol=1e-5)
        assert np.array_equal(half[i], radiance[i].astype(np.float16))


def test_a_batch_refuses_other_shapes(scene):
    relighter = relumine.Relighter(scene)
    with pytest.raises(ValueError, match="environments: expected shape"):
        relighter.relight_batch(np.ones((6, 8, 8, 3)))
    with pytest.raises(ValueError, match="out: expected shape"):
        relighter.relight_batch(np.ones((2, 6, 8, 8, 3)), out=np.empty((1, 2, 3)))
    with pytest.raises(ValueError, match="out: expected an array of floats"):
        relighter.relight_batch(np.ones((1, 6, 8, 8, 3)), out=[])


def test_a_batch_of_pictures_is_what_single_pictures_give(arrays):
    random = np.random.default_rng(5)
    cubes = random.random((3, 6, 8, 8, 3)).astype(np.float32)
    pixels = relumine.precompute(
        *arrays, receivers="pixels:24x18:2", view="auto", tolerance=0.05, bounces=0.05
    )
    vertices = relumine.precompute(*arrays, tolerance=0.05, bounces=0.05)
    for scene, options in (
        (pixels, dict(background="none", albedo=0.8)),
        (pixels, dict(bounces=2)),
        (vertices, dict(camera=(30, 20), size=(32, 24), floor_albedo=0.3, bounces=None)),
    ):
        relighter = relumine.Relighter(scene)
        pictures = relighter.picture_batch(cubes, **options)
        assert not relighter._core.is_lit
        half = np.empty(pictures.shape, np.float16)
        assert relighter.picture_batch(cubes, half, **options) is half
        bounces = options.pop("bounces", 0)
        surfaces = {name: options[name] for name in ("albedo", "floor_albedo") if name in options}
        for i, cube in enumerate(cubes):
            relighter.set_environment(relumine.Environment(cube, face_resolution=8))
            if bounces != 0:
                relighter.bounce(bounces, **surfaces)
            assert np.array_equal(pictures[i], relighter.picture(**options))
            assert np.array_equal(half[i], pictures[i].astype(np.float16))
        assert not np.array_equal(pictures[0], pictures[1])


def test_a_batch_of_pictures_refuses_other_shapes(scene):
    relighter = relumine.Relighter(scene)
    for wrong in [np.ones((6, 8, 8, 3)), np.ones((0, 6, 8, 8, 3)), np.ones((1, 5, 8, 8, 3))]:
        with pytest.raises(ValueError, match="environments: expected shape"):
            relighter.picture_batch(wrong)
    with pytest.raises(ValueError, match="out: expected shape"):
        relighter.picture_batch(np.ones((2, 6, 4, 4, 3)), np.empty((1, 24, 32, 3)), size=(32, 24))


def mean_radiance(arguments):
    scene, environment, layer = arguments
    relighter = relumine.Relighter(scene)
    relighter.set_environment(environment)
    relighter.set_layers([layer])
    return relighter.radiance.copy()


def test_spawned_workers_get_scenes_environments_and_layers(scene, sky):
    layer = relumine.Layer("key", relumine.Disc((1, 1, 1), 20), relumine.Emit((4, 3, 2)))
    work = (scene, sky.turned(rotate=30, tilt=5), layer)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        (there,) = pool.map(mean_radiance, [work])
    assert np.array_equal(there, mean_radiance(work))


def test_copies_are_equal(scene, sky):
    again = pickle.loads(pickle.dumps(sky))
    assert np.array_equal(again.cube, sky.cube) and repr(again) == repr(sky)
    assert np.array_equal(again.turned(rotate=20).cube, sky.turned(rotate=20).cube)
    assert pickle.loads(pickle.dumps(scene)).num_clusters == scene.num_clusters
    for each in (scene, sky):
        assert copy.deepcopy([each])[0] is each
    with pytest.raises(TypeError, match="scene without"):
        pickle.dumps(relumine.Scene.unclustered(relumine.Mesh(np.eye(3), [[0, 1, 2]])))


def test_one_normal_serves_all(scene):
    relighter = relumine.Relighter(scene, harmonics=2)
    relighter.set_environment(relumine.Environment(np.ones((6, 4, 4, 3))))
    light = relighter.harmonics
    one = relumine.irradiance(light, (0, 1, 0))
    assert np.array_equal(one, relumine.irradiance(light, np.tile((0, 1, 0), (len(light), 1))))
    with pytest.raises(ValueError, match="unit vectors"):
        relumine.irradiance(light, (0, 2, 0))
    without = relumine.Relighter(scene)
    without.set_environment(relumine.Environment(np.ones((6, 4, 4, 3))))
    with pytest.raises(RuntimeError, match="harmonics=3"):
        without.harmonics  # noqa: B018
    with pytest.raises(ValueError, match="Relighter.bounce"):
        relumine.precompute(np.zeros((3, 3)), np.zeros((1, 3), np.uint32), bounces=3)
