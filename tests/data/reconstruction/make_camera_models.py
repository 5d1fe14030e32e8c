"""Writes camera_models.json: pixels that pycolmap gives for points in the camera frame, for every camera model."""

import itertools
import json

import numpy as np
import pycolmap

PARAMS = {
    "SIMPLE_PINHOLE": [700.25, 512.5, 380.75],
    "PINHOLE": [700.25, 710.5, 512.5, 380.75],
    "SIMPLE_RADIAL": [700.25, 512.5, 380.75, -0.08],
    "RADIAL": [700.25, 512.5, 380.75, -0.12, 0.03],
    "OPENCV": [700.25, 710.5, 512.5, 380.75, -0.15, 0.04, 0.002, -0.003],
    "OPENCV_FISHEYE": [420.25, 425.5, 512.5, 380.75, 0.03, -0.01, 0.004, -0.0008],
    "FULL_OPENCV": [700.25, 710.5, 512.5, 380.75, 0.4, -0.1, 0.001, -0.002, 0.02, 0.5, -0.05, 0.01],
    "FOV": [500.25, 505.5, 512.5, 380.75, 0.9],
    "SIMPLE_RADIAL_FISHEYE": [420.25, 512.5, 380.75, -0.03],
    "RADIAL_FISHEYE": [420.25, 512.5, 380.75, -0.03, 0.006],
    "THIN_PRISM_FISHEYE": [420.25, 425.5, 512.5, 380.75, 0.03, -0.01, 0.001, -0.002, 0.004, -0.0008, 0.0015, -0.0007],
    "RAD_TAN_THIN_PRISM_FISHEYE": [420.25, 425.5, 512.5, 380.75, 0.03, -0.02, 0.01, -0.004, 0.0009, -0.0001, 0.001,
                                   -0.002, 0.0015, -0.0004, -0.0007, 0.0003],
    "SIMPLE_DIVISION": [700.25, 512.5, 380.75, -0.11],
    "DIVISION": [700.25, 710.5, 512.5, 380.75, 0.07],
    "SIMPLE_FISHEYE": [420.25, 512.5, 380.75],
    "FISHEYE": [420.25, 425.5, 512.5, 380.75],
    "EUCM": [420.25, 425.5, 512.5, 380.75, 0.6, 1.1],
    "EQUIRECTANGULAR": [1024.0, 768.0],
}
DIRECTIONS = [(0, 0), (1e-9, -2e-9), (0.003, 0.004), (0.1, 0.2), (-0.31, 0.12), (0.5, -0.45), (-0.72, -0.55), (0.8, 0.6)]
DEPTHS = [0.37, 1.0, 52.5]
WIDE = [(2.0, -1.0, 1.0), (0.4, 3.0, 1.0)]
BEHIND = [(1.0, 2.0, -3.0), (-0.5, -0.25, -4.0), (0.0, 1.0, 0.0)]

models = []
for model, params in PARAMS.items():
    camera = pycolmap.Camera(model=model, width=1024, height=768, params=params)
    cases = []
    points = [(u * d, v * d, d) for (u, v), d in zip(DIRECTIONS, itertools.cycle(DEPTHS))]
    points += WIDE if "FISHEYE" in model or model == "EUCM" else []
    points += BEHIND if model == "EQUIRECTANGULAR" else []
    for x in points:
        pixel = camera.img_from_cam(np.array(x))
        cases.append({"x_in_cam": x, "pixel": [float(c) for c in np.asarray(pixel).ravel()]})
    models.append({"id": int(pycolmap.CameraModelId.__members__[model]), "model": model, "params": params, "cases": cases})
known = {n for n in pycolmap.CameraModelId.__members__ if n != "INVALID"}
assert known == set(PARAMS), known ^ set(PARAMS)
lines = ",\n".join(json.dumps(m) for m in models)
with open("camera_models.json", "w") as file:
    file.write(f'{{"pycolmap": "{pycolmap.__version__}", "width": 1024, "height": 768, "models": [\n{lines}\n]}}\n')
