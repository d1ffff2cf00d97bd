"""Meshes with the coordinates of maps: arrays lose an offset, single places count as in the file."""

import numpy as np
import pytest

import relumine

PLACE = np.array([691234.0, 520.0, 5334567.0])


@pytest.fixture
def far(folder):
    corners = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    faces = "f 1 3 5\nf 5 3 2\nf 2 3 6\nf 6 3 1\nf 5 4 1\nf 2 4 5\nf 6 4 2\nf 1 4 6\n"
    for name, place in (("near", 0.0), ("far", PLACE)):
        lines = "".join("v {} {} {}\n".format(*point) for point in corners + place)
        (folder / f"{name}.obj").write_text(lines + faces)
    near = relumine.Mesh.load(folder / "near.obj")
    with pytest.warns(relumine.RelumineWarning, match="coordinates are about 0.636 apart"):
        return [near, relumine.Mesh.load(folder / "far.obj")]


def test_meshes_tell_what_was_taken_off(far):
    near, mesh = far
    assert near.offset == (0.0, 0.0, 0.0)
    assert mesh.offset == tuple(PLACE)
    assert (mesh.vertices == near.vertices).all()
    assert (mesh.vertices + np.array(mesh.offset))[0].tolist() == [691235.0, 520.0, 5334567.0]
    assert any("far from the origin" in note for note in mesh.notes)


def test_single_places_count_as_in_the_file(far, sky):
    pictures = []
    for mesh, place in zip(far, (0.0, PLACE)):
        scene = relumine.precompute(mesh, tolerance=0.1, bounces=False, refine=False)
        assert scene.offset == mesh.offset
        assert scene.nearest_receiver(place + np.array([0.1, 0.2, 1.3])) == 4
        relighter = relumine.Relighter(scene)
        relighter.set_environment(sky)
        eye, target = place + np.array([2.1, 1.3, 3.7]), place + np.array([0.1, 0.2, 0.0])
        picture = relighter.picture(size=(16, 12), eye=eye, target=target, background="none")
        pictures.append(np.asarray(picture))
    assert np.abs(pictures[0] - pictures[1]).max() < 1e-5
    assert pictures[0][..., 3].max() == 1.0
