"""Compares a model with itself moved, both opened by pycolmap. Arguments: model, moved model, scale, rotation (9 numbers,
row by row), translation (3). Prints the largest differences: of points, of camera centres (both in units of the moved
model, as a share of its largest coordinate), of viewing directions, of reprojection errors (pixels), of the means of them,
and of the centres by rigs and frames."""

import sys

import numpy as np
import pycolmap

before, after = (pycolmap.Reconstruction(path) for path in sys.argv[1:3])
numbers = [float(a) for a in sys.argv[3:]]
scale, rotation, translation = numbers[0], np.array(numbers[1:10]).reshape(3, 3), np.array(numbers[10:13])


def moved(x):
    return scale * rotation @ x + translation


def reprojection_error(model, image, keypoint):
    pixel = model.cameras[image.camera_id].img_from_cam(image.cam_from_world() * model.points3D[keypoint.point3D_id].xyz)
    return None if pixel is None else np.linalg.norm(np.asarray(pixel).ravel() - keypoint.xy)


assert set(before.points3D) == set(after.points3D) and set(before.images) == set(after.images)
size = max(np.abs(p.xyz).max() for p in after.points3D.values())
points = max(np.abs(moved(p.xyz) - after.points3D[i].xyz).max() for i, p in before.points3D.items()) / size
centers = directions = errors = 0.0
for i, a in before.images.items():
    b = after.images[i]
    assert (a.name, a.camera_id, a.num_points3D) == (b.name, b.camera_id, b.num_points3D)
    centers = max(centers, np.abs(moved(a.projection_center()) - b.projection_center()).max() / size)
    directions = max(directions, np.abs(rotation @ a.viewing_direction() - b.viewing_direction()).max())
    for p, q in zip(a.points2D, b.points2D):
        assert p.point3D_id == q.point3D_id and (p.xy == q.xy).all()
        if p.has_point3D():
            pair = reprojection_error(before, a, p), reprojection_error(after, b, q)
            assert (pair[0] is None) == (pair[1] is None)
            errors = max(errors, abs(pair[0] - pair[1]) if pair[0] is not None else 0.0)
means = abs(before.compute_mean_reprojection_error() - after.compute_mean_reprojection_error())
for i, point in before.points3D.items():
    assert point.error == after.points3D[i].error and (point.color == after.points3D[i].color).all()
    assert point.track.length() == after.points3D[i].track.length()
print(points, centers, directions, errors, means)
