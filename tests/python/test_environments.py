"""Environments: conventions, turns, conversions, the doctor."""

import numpy as np
import pytest

import relumine

AXES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]


def lamp(face, n=16):
    """A soft lamp around one axis."""
    cube = np.zeros((6, n, n, 3))
    cube[face, n // 4 : -n // 4, n // 4 : -n // 4] = 1.0
    return cube


@pytest.mark.parametrize("face", range(6))
def test_faces_lie_where_they_should(face):
    environment = relumine.Environment(lamp(face))
    lit = [environment.irradiance(axis)[0] for axis in AXES]
    assert int(np.argmax(lit)) == face


def test_the_middle_of_a_lat_long_is_plus_z():
    pixels = np.zeros((32, 64, 3))
    pixels[14:18, 30:34] = 1.0
    assert np.argmax([relumine.Environment(pixels).irradiance(a)[0] for a in AXES]) == 4
    turned = relumine.Environment(pixels, rotate=90)
    assert np.argmax([turned.irradiance(a)[0] for a in AXES]) == 0
    tilted = relumine.Environment(pixels, tilt=-90)
    assert np.argmax([tilted.irradiance(a)[0] for a in AXES]) == 2
    flipped = relumine.Environment(pixels, flip="z")
    assert np.argmax([flipped.irradiance(a)[0] for a in AXES]) == 5
    # Blender's lat-long has its +X in the middle, which is ours.
    blender = relumine.Environment(pixels, convention="blender")
    assert np.argmax([blender.irradiance(a)[0] for a in AXES]) == 0


def test_bytes_of_a_screen_are_no_radiance():
    for kind in (np.uint8, np.uint16):
        with pytest.raises(ValueError, match="pixels: expected linear radiance, got uint"):
            relumine.Environment(np.full((8, 16, 3), 200, kind))
    assert relumine.Environment(np.full((8, 16, 3), 2)).cube.max() == pytest.approx(2)


def test_alpha_is_left_out_with_a_word():
    for shape in [(8, 16, 4), (6, 8, 8, 4)]:
        with pytest.warns(relumine.RelumineWarning, match="a fourth channel, which is left out"):
            environment = relumine.Environment(np.ones(shape))
        assert environment.pixels.shape[-1] == 3


def test_turned_counts_from_the_picture(sky):
    assert (sky.turned(rotate=90).turned(rotate=10).cube == sky.turned(rotate=10).cube).all()
    assert (sky.turned().cube == sky.cube).all()


def test_conversions_keep_energy(sky):
    for layout in "latlong cube strip cross hcross octahedral angular mirrorball".split():
        pixels = sky.convert(layout=layout, face_resolution=32)
        again = relumine.Environment(pixels, layout=layout)
        assert again.irradiance((0, 1, 0)) == pytest.approx(sky.irradiance((0, 1, 0)), rel=1e-2)
    with pytest.raises(ValueError, match="^size: expected"):
        sky.convert(layout="cube", size=(10, 10))
    with pytest.raises(ValueError, match="^layout: expected latlong"):
        sky.convert(layout="round")
    with pytest.raises(ValueError, match="^to: expected"):
        sky.convert(to="maya")


def test_files_come_back(sky, folder):
    sky.turned(rotate=40).save("sky.exr", layout="latlong", size=(64, 32))
    sky.save("{face}.hdr", face_resolution=16)
    faces = relumine.Environment.load("{face}.hdr")
    assert faces.layout == "cube"
    for axis in AXES:
        assert faces.irradiance(axis) == pytest.approx(sky.irradiance(axis), rel=1e-2)
    back = relumine.Environment.load("sky.exr", rotate=-40)
    for axis in AXES:
        assert back.irradiance(axis) == pytest.approx(sky.irradiance(axis), rel=2e-2)


def test_bad_pixels(sky):
    pixels = sky.pixels.copy()
    pixels[3, 4, 1] = np.nan
    pixels[5, 6] = -100.0
    with pytest.raises(ValueError, match=r"^environment: .*1 NaN.*\(4, 3\); use fix_env$"):
        relumine.Environment(pixels)
    fixed = relumine.Environment(pixels, fix_env=True)
    assert np.isfinite(fixed.cube).all() and fixed.cube.min() >= 0


def test_wrong_arrays_are_named():
    for shape in [(8, 16), (8, 16, 5), (5, 8, 8, 3), (6, 8, 4, 3), (0, 0, 3)]:
        with pytest.raises(ValueError, match="^pixels: expected"):
            relumine.Environment(np.ones(shape))
    with pytest.raises(ValueError, match="layout angular"):
        relumine.Environment(np.ones((8, 8, 3)))
    with pytest.raises(ValueError, match="^layout: expected latlong"):
        relumine.Environment(np.ones((8, 8, 3)), layout="disc")
    with pytest.raises(ValueError, match="convention"):
        relumine.Environment(np.ones((8, 16, 3)), convention="maya")
    with pytest.raises(ValueError, match="^rotate: expected"):
        relumine.Environment(np.ones((8, 16, 3)), rotate=np.inf)


def sunny():
    pixels = np.full((64, 128, 3), 0.3)
    pixels[16, 40] = 5000.0
    return relumine.Environment(pixels, rotate=20, face_resolution=32)


def test_the_doctor_finds_the_sun_in_the_worlds_axes():
    environment = sunny()
    sun = environment.doctor()["sun"]
    at = np.unravel_index(np.argmax(environment.cube[..., 0]), environment.cube.shape[:3])
    n = environment.face_resolution
    assert sun["azimuth_degrees"] == pytest.approx(180 - 360 * 40.5 / 128 + 20, abs=0.01)
    assert sun["share_of_power"] > 0.5 and at[0] in range(6) and n == 32
    assert environment.doctor()["upside_down"] is False


def test_the_sun_comes_off():
    environment = sunny()
    sky, sun = environment.without_sun()
    assert sky.cube.max() == pytest.approx(0.3, rel=1e-3)
    whole = np.array(environment.irradiance(sun.directions[0]))
    parts = np.array(sky.irradiance(sun.directions[0])) + sun.irradiances[0]
    assert whole == pytest.approx(parts, rel=0.01)
    with pytest.raises(ValueError, match="^environment: expected a sun, got none: "):
        relumine.Environment(np.ones((8, 16, 3))).without_sun()


def test_notebooks_show_environments(sky):
    assert sky._repr_png_().startswith(b"\x89PNG")
    assert repr(sky) == "<relumine.Environment: latlong 64 x 32, lights as 6 x 16 x 16>"


def test_turns_about_any_axis(sky):
    """A turn about +Y is a rotation; any other takes the light of a direction to the turned one."""
    c, s = np.cos(0.7), np.sin(0.7)
    about_y = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    assert sky.turned(turn=about_y).cube == pytest.approx(
        sky.turned(rotate=np.degrees(0.7)).cube, abs=1e-4
    )
    axes = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])  # +X to +Z, +Y to +X, +Z to +Y
    turned = sky.turned(turn=axes)
    for normal in (np.eye(3)[0], [0.6, 0, 0.8]):
        assert turned.irradiance(axes @ normal) == pytest.approx(sky.irradiance(normal), rel=1e-3)
    with pytest.raises(ValueError, match="^turn: expected the matrix of a rotation"):
        sky.turned(turn=2 * np.eye(3))
    with pytest.raises(ValueError, match="^turn: expected shape"):
        sky.turned(turn=[1, 2, 3])
