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
    vertices = relumine.Relighter(relumine.precompute(*arrays))
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
