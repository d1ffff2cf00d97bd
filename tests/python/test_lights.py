"""Light lists."""

import numpy as np
import pytest

import relumine


@pytest.mark.parametrize("method", ["median-cut", "variance", "importance"])
def test_methods_keep_the_power(sky, method):
    lights = sky.place_lights(32, method=method)
    assert len(lights) == 32 and lights.method == method
    n = sky.face_resolution
    s = 2 * (np.arange(n) + 0.5) / n - 1
    angle = (2 / n) ** 2 / (1 + s[:, None] ** 2 + s**2) ** 1.5
    power = (sky.cube * angle[None, :, :, None]).sum(axis=(0, 1, 2))
    assert lights.total_irradiance == pytest.approx(power, rel=5e-3)
    assert np.linalg.norm(lights.directions, axis=1) == pytest.approx(1.0)
    assert lights.solid_angles.sum() == pytest.approx(4 * np.pi, rel=0.1)


def test_wrong_options(sky):
    with pytest.raises(ValueError, match="^number: expected"):
        sky.place_lights(0)
    with pytest.raises(ValueError, match="^method: expected median-cut, variance or importance"):
        sky.place_lights(4, method="best")


@pytest.mark.parametrize("name", "a.json a.csv a.pbrt a.xml a.usda a.py a.gltf".split())
def test_formats(sky, folder, name):
    sky.median_cut(8).save(name)
    assert (folder / name).stat().st_size > 100
    with pytest.raises(ValueError, match="^path: expected"):
        sky.median_cut(8).save("a.txt")
    with pytest.raises(ValueError, match="^format: expected"):
        sky.median_cut(8).save("a.json", format="yaml")


def test_lists_come_back(sky, folder):
    lights = sky.median_cut(8)
    lights.save("lights.json")
    again = relumine.LightList.load("lights.json")
    assert (again.directions == lights.directions).all()
    assert (again.irradiances == lights.irradiances).all()
    assert again.method == "median-cut"


def test_a_list_that_was_changed_is_checked_again(relighter, folder):
    for name, value in (("directions", np.nan), ("irradiances", -1.0), ("solid_angles", np.inf)):
        lights = relumine.LightList([[0, 1, 0]], [[1, 1, 1]])
        getattr(lights, name)[0] = value
        with pytest.raises(ValueError, match=f"^{name}: expected"):
            relighter.set_lights(lights)
    lights.solid_angles = np.zeros(3)
    with pytest.raises(ValueError, match="^solid_angles: expected shape"):
        lights.save("a.json")


def test_many_lights_are_the_environment(relighter, sky):
    exact = relighter.radiance.copy()
    relighter.set_lights(sky.place_lights(256))
    many = np.linalg.norm(relighter.radiance - exact) / np.linalg.norm(exact)
    relighter.set_lights(sky.place_lights(4))
    few = np.linalg.norm(relighter.radiance - exact) / np.linalg.norm(exact)
    assert many < 0.06 < few


def test_questions_about_layers_keep_a_light_list(relighter, sky):
    key = relumine.Layer("key", relumine.Disc((1, 1, 1), 20), relumine.Emit((4, 3, 2)))
    relighter.set_layers([key])
    relighter.set_lights(sky.place_lights(8))
    lit = relighter.radiance.copy()
    assert relighter.layers == [] and not relighter.can_undo and not relighter.can_redo
    relighter.undo()
    with pytest.raises(ValueError, match="^mark: expected an environment"):
        relighter.mark()
    assert (relighter.radiance == lit).all()
    assert relighter.picture(size=(8, 8), background="none")[..., 3].max() > 0


def test_light_lists_without_a_precompute(arrays):
    """One light from straight above lights what faces it by its irradiance over pi."""
    mesh = relumine.Mesh([[0, 0, 0], [0, 0, 1], [1, 0, 0]], [[0, 1, 2]])
    relighter = relumine.Relighter(relumine.Scene.unclustered(mesh))
    relighter.set_lights(relumine.LightList([[0, 2, 0]], [[np.pi, 2 * np.pi, 0]]))
    assert relighter.radiance == pytest.approx(np.tile([1.0, 2.0, 0.0], (3, 1)), rel=1e-5)


def test_a_first_sight_without_bounces(arrays, scene, sky):
    """A quick scene is lit as the precomputed one is, nearly, by direct light."""
    quick, whole = relumine.Scene.quick(relumine.Mesh(*arrays)), scene
    assert quick.num_receivers == len(arrays[0])
    lit = []
    for each in (quick, whole):
        relighter = relumine.Relighter(each)
        relighter.set_environment(sky)
        lit.append(relighter.radiance[: len(arrays[0])])
    off = np.linalg.norm(lit[0] - lit[1]) / np.linalg.norm(lit[1])
    assert 0.0 < off < 0.05


def test_lights_for_a_scene(relighter):
    exact = relighter.radiance.copy()
    told = []
    lights = relighter.transfer_lights(2, progress=told.append)
    assert 1 <= len(lights) <= 2 and told[-1] == 1.0
    relighter.set_lights(lights)
    assert np.linalg.norm(relighter.radiance - exact) < 0.8 * np.linalg.norm(exact)
