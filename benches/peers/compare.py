#!/usr/bin/env python3
"""Finds captures in a city with general registration of point clouds, and with ours, in one run.

    python3 benches/peers/compare.py [--seeds 1-5] [--voxel 2.0] CITYWELD SCENE...

CITYWELD is the built program. SCENE is a folder with scene.json ("city": an OBJ file, relative; "terrain": a list of such), truth.json ("transform" with
scale, rotation, translation; "bounds" of the points that count) and sfm/ (points3D.bin or .txt of COLMAP) or cloud.ply.

The others are helped, because they need it: they are given the true scale, and the city cropped to 200 m about the true place and sampled evenly
to points. Each run turns the cloud at random (all of SO(3)) about its middle. All clouds are thinned to the voxel size first.
    Open3D          FPFH (normals within 2 voxels, features within 5), RANSAC on mutual matches (3 points, edges within 0.9, 1.5 voxels, 100,000
                    rounds at most, confidence 0.999), then ICP point to plane within 1.5 voxels: the library's own tutorial
    KISS-Matcher    as it comes, at that voxel size; then the same ICP
    TEASER++        is told as missing where it is not installed: PyPI has no package of it
Ours runs twice: with nothing known and all of the city, and with what the others know (--scale, --near 200 m). Times are processor seconds, all threads
added: of the whole program for ours, of registration alone for the others (features, matching, poses, ICP; the city's features included, reading and
sampling not).
A run is a success where the rms over the points that count is under 1 m (up left out where scene.json says that it is not determined).

Needs numpy, `pip install open3d kiss-matcher`; what is not installed is left out, and said.
"""
import argparse
import importlib
import json
import resource
import struct
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

NEAR_M, SUCCESS_M, POINTS_OF_M2 = 200.0, 1.0, 4.0


def optional(name):
    try:
        return importlib.import_module(name)
    except ImportError as error:
        print(f"left out: {name} cannot be loaded ({error})")
        return None


def colmap_points(folder):
    if (folder / "points3D.bin").exists():
        data, at, points = (folder / "points3D.bin").read_bytes(), 8, []
        for _ in range(struct.unpack_from("<Q", data)[0]):
            points.append(struct.unpack_from("<3d", data, at + 8))
            at += 51 + 8 * struct.unpack_from("<Q", data, at + 43)[0]
        return np.array(points)
    lines = (line.split() for line in (folder / "points3D.txt").open() if line.strip() and line[0] != "#")
    return np.array([[float(value) for value in words[1:4]] for words in lines])


class Scene:
    def __init__(self, folder, open3d):
        self.folder, self.name = folder, folder.name
        words = json.loads((folder / "scene.json").read_text())
        truth = json.loads((folder / "truth.json").read_text())
        self.meshes = [folder / words["city"]] + [folder / mesh for mesh in words.get("terrain") or []]
        self.axes = [0, 1] if words.get("undetermined_along") else [0, 1, 2]
        t = truth["transform"]
        self.scale, self.rotation, self.shift = t["scale"], np.array(t["rotation"]), np.array(t["translation"])
        cloud = folder / "cloud.ply"
        self.sfm = cloud if cloud.exists() else folder / "sfm"
        self.points = np.asarray(open3d.io.read_point_cloud(str(cloud)).points) if cloud.exists() else colmap_points(folder / "sfm")
        placed = self.placed(self.points)
        low, high = truth.get("bounds") or (placed.min(0), placed.max(0))
        self.counts = ((placed >= low) & (placed <= high)).all(1)
        self.middle = np.median(placed[self.counts], axis=0)
        self.target = self.sampled()

    def placed(self, points):
        return self.scale * points @ self.rotation.T + self.shift

    def rms(self, placed):
        off = (placed - self.placed(self.points))[self.counts][:, self.axes]
        return float(np.sqrt((off**2).sum(1).mean()))

    def sampled(self):
        """points on the city within reach, about the true middle"""
        g, found = np.random.default_rng(0), []
        for polygon in (polygon for path in self.meshes for polygon in polygons(path)):
            points = on_polygon(polygon, g)
            found.append(points[np.hypot(*(points - self.middle)[:, :2].T) < NEAR_M])
        return np.concatenate(found) - self.middle


def polygons(path):
    """faces of an OBJ file, whatever their number of corners"""
    corners, faces = [], []
    for words in (line.split() for line in path.open()):
        if words and words[0] == "v":
            corners.append([float(value) for value in words[1:4]])
        elif words and words[0] == "f":
            faces.append([int(word.split("/")[0]) for word in words[1:]])
    corners = np.array(corners)
    return [corners[[k - 1 if k > 0 else k for k in face]] for face in faces]


def on_polygon(polygon, g):
    """even points on a polygon: drawn in the box about it in its plane, kept by the even-odd rule"""
    normal = np.cross(polygon - polygon[0], np.roll(polygon, -1, axis=0) - polygon[0]).sum(0)
    if np.linalg.norm(normal) < 1e-6:
        return np.empty((0, 3))
    normal /= np.linalg.norm(normal)
    u = np.cross(normal, [0, 0, 1] if abs(normal[2]) < 0.9 else [1, 0, 0])
    u /= np.linalg.norm(u)
    axes = np.stack([u, np.cross(normal, u)])
    flat = (polygon - polygon[0]) @ axes.T
    low, size = flat.min(0), np.ptp(flat, axis=0)
    points = low + size * g.uniform(size=(g.poisson(size.prod() * POINTS_OF_M2), 2))
    inside = np.zeros(len(points), bool)
    for (ax, ay), (bx, by) in zip(flat, np.roll(flat, -1, axis=0)):
        if ay != by:
            inside ^= ((ay > points[:, 1]) != (by > points[:, 1])) & (points[:, 0] < ax + (points[:, 1] - ay) * (bx - ax) / (by - ay))
    return polygon[0] + points[inside] @ axes


def turned(scene, seed):
    """the cloud in metres, turned at random about its middle"""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    q *= np.linalg.det(q)
    metric = scene.scale * scene.points
    return (metric - np.median(metric[scene.counts], axis=0)) @ q.T


def cloud_of(open3d, points, voxel):
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points)).voxel_down_sample(voxel)
    cloud.estimate_normals(open3d.geometry.KDTreeSearchParamHybrid(radius=2 * voxel, max_nn=30))
    return cloud


def with_icp(open3d, source, target, pose, voxel):
    registration = open3d.pipelines.registration
    plane = registration.TransformationEstimationPointToPlane()
    return registration.registration_icp(source, target, 1.5 * voxel, pose, plane).transformation


def by_open3d(open3d, _, points, target_points, voxel, seed):
    registration = open3d.pipelines.registration
    open3d.utility.random.seed(seed)
    source, target = (cloud_of(open3d, p, voxel) for p in (points, target_points))
    within = open3d.geometry.KDTreeSearchParamHybrid(radius=5 * voxel, max_nn=100)
    features = [registration.compute_fpfh_feature(cloud, within) for cloud in (source, target)]
    found = registration.registration_ransac_based_on_feature_matching(
        source, target, *features, True, 1.5 * voxel, registration.TransformationEstimationPointToPoint(False), 3,
        [registration.CorrespondenceCheckerBasedOnEdgeLength(0.9), registration.CorrespondenceCheckerBasedOnDistance(1.5 * voxel)],
        registration.RANSACConvergenceCriteria(100_000, 0.999))
    return with_icp(open3d, source, target, found.transformation, voxel)


def by_kiss(open3d, kiss, points, target_points, voxel, _):
    found = kiss.KISSMatcher(kiss.KISSMatcherConfig(voxel)).estimate(points.astype(np.float32), target_points.astype(np.float32))
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = found.rotation, np.asarray(found.translation).ravel()
    return with_icp(open3d, *(cloud_of(open3d, p, voxel) for p in (points, target_points)), pose, voxel)


def by_peer(method, open3d, module, scene, seed, voxel):
    points = turned(scene, seed)
    begun = time.process_time()
    pose = np.asarray(method(open3d, module, points, scene.target, voxel, seed))
    seconds = time.process_time() - begun
    return scene.rms(points @ pose[:3, :3].T + pose[:3, 3] + scene.middle), seconds, ""


def children_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def by_ours(program, scene, seed, known):
    city, *terrain = map(str, scene.meshes)
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "align", city, str(scene.sfm), "-o", folder + "/out", "--seed", str(seed), "--quiet"]
        for mesh in terrain:
            command += ["--terrain", mesh]
        if known:
            x, y = scene.middle[:2]
            command += ["--scale", repr(scene.scale), "--near", f"{x:.2f},{y:.2f},{NEAR_M:g}"]
        begun = children_seconds()
        status = subprocess.run(command, capture_output=True, text=True)
        seconds = children_seconds() - begun
        if status.returncode > 1:
            raise SystemExit(status.stderr)
        told = json.loads(Path(folder, "out", "alignment.json").read_text())
    pose = told.get("transform") or told.get("best_candidate")
    if pose is None:
        return float("inf"), seconds, told["verdict"]
    placed = pose["scale"] * scene.points @ np.array(pose["rotation"]).T + pose["translation"]
    return scene.rms(placed), seconds, told["verdict"]


def main():
    arguments = argparse.ArgumentParser(usage=__doc__)
    arguments.add_argument("--seeds", default="1-5")
    arguments.add_argument("--voxel", type=float, default=2.0)
    arguments.add_argument("program")
    arguments.add_argument("scenes", nargs="+", type=Path)
    given = arguments.parse_args()
    first, _, last = given.seeds.partition("-")
    seeds = range(int(first), int(last or first) + 1)
    open3d, kiss = optional("open3d"), optional("kiss_matcher")
    optional("teaserpp_python")
    if open3d is None:
        raise SystemExit("open3d thins the clouds and ends every registration: pip install open3d")
    open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    print("| scene | method | success | median rms, m | median processor s | verdicts |\n|---|---|---|---|---|---|", flush=True)
    for folder in given.scenes:
        scene = Scene(folder, open3d)
        methods = {"Open3D": lambda seed: by_peer(by_open3d, open3d, None, scene, seed, given.voxel)}
        if kiss is not None:
            methods["KISS-Matcher"] = lambda seed: by_peer(by_kiss, open3d, kiss, scene, seed, given.voxel)
        methods["ours, nothing known"] = lambda seed: by_ours(given.program, scene, seed, False)
        methods["ours, scale and 200 m known"] = lambda seed: by_ours(given.program, scene, seed, True)
        for name, method in methods.items():
            rms, seconds, verdicts = zip(*(method(seed) for seed in seeds))
            good = sum(value < SUCCESS_M for value in rms)
            told = ", ".join(f"{verdicts.count(v)} {v}" for v in sorted(set(verdicts)) if v)
            print(f"| {scene.name} | {name} | {good} of {len(rms)} | {np.median(rms):.2f} | {np.median(seconds):.1f} | {told} |", flush=True)


if __name__ == "__main__":
    main()
