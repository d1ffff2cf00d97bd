"""Blockers that are a function."""

import pickle
import threading
import time

import numpy as np
import pytest

import relumine

CENTRE, RADIUS = np.array([0.2, 1.1, -0.1]), 0.6


def sphere(origins, directions):
    to_centre = CENTRE - origins
    along = (to_centre * directions).sum(axis=1)
    return (along > 0) & ((to_centre**2).sum(axis=1) - along**2 < RADIUS**2)


def is_near_edge(positions, w):
    to_centre = CENTRE - positions
    off = (to_centre**2).sum(axis=1) - (to_centre @ w) ** 2
    return np.abs(np.sqrt(off) - RADIUS) < 2e-3


def floor(n=33, size=2.0):
    """A square in y = 0, its normals up."""
    side = np.linspace(-size, size, n)
    x, z = np.meshgrid(side, side, indexing="ij")
    i = np.arange(n * n).reshape(n, n)
    a, b, c, d = (k.ravel() for k in (i[:-1, :-1], i[:-1, 1:], i[1:, 1:], i[1:, :-1]))
    vertices = np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)
    return vertices, np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


@pytest.fixture(scope="module")
def shadowed():
    return relumine.precompute(*floor(), blockers_function=sphere, refine=False, tolerance=0.05)


def test_a_sphere_under_an_even_sky_is_its_closed_form(shadowed):
    relighter = relumine.Relighter(shadowed)
    relighter.set_environment(relumine.Environment(np.ones((6, 16, 16, 3))))
    to_centre = CENTRE - shadowed.positions
    distance = np.linalg.norm(to_centre, axis=1)
    # The whole sphere is above the floor: its form factor is the cosine times (radius / distance)^2.
    expected = 1 - to_centre[:, 1] / distance * (RADIUS / distance) ** 2
    assert expected.min() < 0.75
    error = relighter.radiance - expected[:, None]
    assert np.sqrt((error**2).mean()) < 0.004 and np.abs(error).max() < 0.02


def test_shadows_of_sharp_lights_are_as_sharp_as_the_function(shadowed):
    w = np.array([0.3, 0.9, 0.2]) / np.linalg.norm([0.3, 0.9, 0.2])
    relighter = relumine.Relighter(shadowed)
    relighter.set_lights(relumine.LightList([w], [(np.pi, 2 * np.pi, 0)]))
    dark = sphere(shadowed.positions, np.broadcast_to(w, shadowed.positions.shape))
    assert 20 < dark.sum() < len(dark) / 2
    expected = np.where(dark, 0, w[1])[:, None] * [1, 2, 0]
    # Rays begin a little above the floor, so a receiver at the very edge may differ.
    sure = ~is_near_edge(shadowed.positions, w)
    assert sure.mean() > 0.98
    assert np.allclose(relighter.radiance[sure], expected[sure], atol=1e-5)
    # Others than the scene's own, and those of the mesh, which shades nothing.
    relighter = relumine.Relighter(shadowed, blockers_function=lambda o, d: np.ones(len(o), bool))
    relighter.set_lights(relumine.LightList([w], [(1, 1, 1)]))
    assert (relighter.radiance == 0).all()
    relighter = relumine.Relighter(pickle.loads(pickle.dumps(shadowed)))
    relighter.set_lights(relumine.LightList([w], [(np.pi, 2 * np.pi, 0)]))
    assert np.allclose(relighter.radiance[sure], expected[sure], atol=1e-5)


def test_points_in_space_may_be_asked_about(shadowed):
    points = np.array([[0.2, 3.0, -0.1], [1.7, 0.5, 0.4]])
    scene = relumine.precompute(*floor(5), receivers=points, blockers_function=sphere)
    relighter = relumine.Relighter(scene)
    relighter.set_environment(relumine.Environment(np.ones((6, 8, 8, 3))))
    # What is left of the sphere of directions outside of the cone.
    sine = RADIUS / np.linalg.norm(points - CENTRE, axis=1)
    assert np.allclose(relighter.radiance[:, 0], (1 + np.sqrt(1 - sine**2)) / 2, atol=2e-3)


def test_the_function_is_called_rarely():
    calls, rays = [], []

    def count(origins, directions):
        assert origins.shape == directions.shape and origins.dtype == np.float32
        assert np.allclose((directions**2).sum(axis=1), 1, atol=1e-5)
        calls.append(threading.get_ident())
        rays.append(len(origins))
        return np.zeros(len(origins), bool)

    scene = relumine.precompute(*floor(), blockers_function=count, refine=False, min_depth=5)
    assert sum(rays) == scene.report["rays"] > 1e5
    assert np.mean(rays) > 1000


def test_what_the_function_raises_comes_back():
    class Own(Exception):
        pass

    def fail(origins, directions):
        raise Own("no rays today")

    with pytest.raises(Own, match="no rays today"):
        relumine.precompute(*floor(9), blockers_function=fail, refine=False)
    scene = relumine.precompute(*floor(9), refine=False)
    relighter = relumine.Relighter(scene, blockers_function=fail)
    with pytest.raises(Own, match="no rays today"):
        relighter.set_lights(relumine.LightList([(0, 1, 0)], [(1, 1, 1)]))


def test_work_that_is_given_up_ends():
    class Enough(Exception):
        pass

    def slow(origins, directions):
        time.sleep(0.002)
        return np.zeros(len(origins), bool)

    def stop(fraction):
        raise Enough

    with pytest.raises(Enough):
        relumine.precompute(
            *floor(65), blockers_function=slow, refine=False, min_depth=6, progress=stop
        )
    relumine._core.wait_for_jobs()


@pytest.mark.parametrize(
    "answer",
    [lambda o, d: None, lambda o, d: np.zeros(3, bool), lambda o, d: np.zeros(len(o))],
    ids=["none", "another number", "floats"],
)
def test_other_answers_are_refused(answer):
    with pytest.raises(ValueError, match=r"blockers_function: expected \d+ booleans, got "):
        relumine.precompute(*floor(9), blockers_function=answer, refine=False)


def test_what_asks_the_triangles_is_refused(shadowed, folder):
    relighter = relumine.Relighter(shadowed)
    relighter.set_environment(relumine.Environment(np.ones((6, 4, 4, 3))))
    for ask in (relighter.verify, lambda: relighter.sees([[0, 5, 0]])):
        with pytest.raises(RuntimeError, match="blockers_function"):
            ask()
    with pytest.raises(ValueError, match="blockers_function: expected a function"):
        relumine.precompute(*floor(9), blockers_function=3)
    with pytest.raises(ValueError, match="blockers of light that bounces"):
        relumine.precompute(*floor(9), blockers_function=sphere, bounces=True)
    with pytest.raises(ValueError, match="blockers of stored highlights"):
        relumine.precompute(
            *floor(9), blockers_function=sphere, view="auto", material=relumine.Ggx(0.3)
        )
    with pytest.raises(ValueError, match="blockers of work that is resumed"):
        relumine.precompute(
            *floor(9), blockers_function=sphere, output="floor.prt", resume=True
        )
