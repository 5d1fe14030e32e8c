"""Writes the tiny models and clouds of tests/damaged_reconstruction/: sound ones of each kind, and one per defect.

A defect's folder holds only the files that are not those of `sound` (or of `sound_framed`, where rigs or frames are)."""

import pathlib
import shutil
import struct

NAN = float("nan")
NO_POINT = 2**64 - 1


def count(n):
    return struct.pack("<Q", n)


def camera(id=1, model=2, width=640, height=480, params=(500.0, 320.0, 240.0, -0.05)):
    return struct.pack("<IiQQ", id, model, width, height) + struct.pack(f"<{len(params)}d", *params)


def image(id, name, points, q=(1.0, 0.0, 0.0, 0.0), t=(0.0, 0.0, 5.0), camera=1, keypoints=None, x=None):
    keypoints = len(points) if keypoints is None else keypoints
    rows = [(100.5 + 10 * i if x is None else x, 200.25, p) for i, p in enumerate(points)]
    head = struct.pack("<I7dI", id, *q, *t, camera) + name + b"\0" + count(keypoints)
    return head + b"".join(struct.pack("<ddQ", *row) for row in rows)


def point(id, track, x=0.25, length=None, error=0.5):
    length = len(track) if length is None else length
    head = struct.pack("<Q3d3BdQ", id, x, -0.5, 0.125 * id, 10, 20, 30, error, length)
    return head + b"".join(struct.pack("<II", *element) for element in track)


def rig(id=1, flag=1):
    return struct.pack("<IIiIiIB7d", id, 2, 0, 1, 0, 2, flag, 1.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0)


def frame(id, data, rig=1, t=(0.0, 0.0, 5.0), data_count=None):
    head = struct.pack("<II7dI", id, rig, 1.0, 0.0, 0.0, 0.0, *t, len(data) if data_count is None else data_count)
    return head + b"".join(struct.pack("<iIQ", 0, 1, image) for image in data)


FIRST = image(10, b"a b/first photo.jpg", [5, 7, NO_POINT])
SECOND = image(11, b"second.jpg", [5, 7, 9], q=(0.8, 0.0, 0.6, 0.0))
POINTS = [point(5, [(10, 0), (11, 0)]), point(7, [(10, 1), (11, 1)]), point(9, [(11, 2)])]
SOUND = {
    "cameras": count(1) + camera(),
    "images": count(2) + FIRST + SECOND,
    "points3D": count(3) + b"".join(POINTS),
}
FRAMED = {
    "rigs": count(1) + rig(),
    "cameras": count(2) + camera() + camera(id=2),
    "frames": count(2) + frame(1, [10]) + frame(2, [11]),
    "images": count(2) + FIRST + image(11, b"second.jpg", [5, 7, 9]),
}


def images(*records):
    return {"images": count(len(records)) + b"".join(records)}


def points(*records):
    return {"points3D": count(len(records)) + b"".join(records)}


BINARY = {
    "sound": {},
    "sound_framed": FRAMED,
    # Refused.
    "cameras_cut": {"cameras": SOUND["cameras"][:-3]},
    "images_cut": {"images": SOUND["images"][:-10]},
    "points_cut": {"points3D": SOUND["points3D"][:-10]},
    "cameras_count_lies": {"cameras": count(4 * 10**9) + camera()},
    "images_count_lies": {"images": count(4 * 10**9) + FIRST + SECOND},
    "points_count_lies": {"points3D": count(4 * 10**9) + b"".join(POINTS)},
    "points_count_overflows": {"points3D": count(2**64 - 1) + b"".join(POINTS)},
    "points_count_too_low": {"points3D": count(2) + b"".join(POINTS)},
    "keypoint_count_lies": images(image(10, b"first.jpg", [5, 7, 9], keypoints=4 * 10**9), SECOND),
    "track_length_lies": points(point(5, [(10, 0), (11, 0)], length=4 * 10**9), *POINTS[1:]),
    "name_without_end": {"images": count(1) + FIRST[:64] + b"n" * 80},
    "camera_model_unknown": {"cameras": count(1) + camera(model=99)},
    "camera_nan": {"cameras": count(1) + camera(params=(500.0, NAN, 240.0, -0.05))},
    "camera_without_focal_length": {"cameras": count(1) + camera(params=(0.0, 320.0, 240.0, -0.05))},
    "camera_without_size": {"cameras": count(1) + camera(width=0)},
    "camera_id_twice": {"cameras": count(2) + camera() + camera()},
    "image_id_twice": images(FIRST, FIRST),
    "image_of_missing_camera": images(image(10, b"first.jpg", [5, 7, NO_POINT], camera=3), SECOND),
    "odd_image_position_nan": images(image(10, b"first.jpg", [5, 7, NO_POINT], t=(0.0, NAN, 5.0)), SECOND),
    "odd_image_rotation_zero": images(image(10, b"first.jpg", [5, 7, NO_POINT], q=(0.0, 0.0, 0.0, 0.0)), SECOND),
    "keypoint_nan": images(image(10, b"first.jpg", [5, 7, NO_POINT], x=NAN), SECOND),
    "point_id_twice": points(*POINTS, POINTS[0]),
    "odd_point_nan": points(point(5, [(10, 0), (11, 0)], x=NAN), *POINTS[1:]),
    "odd_point_error_nan": points(point(5, [(10, 0), (11, 0)], error=NAN), *POINTS[1:]),
    "odd_track_of_missing_image": points(point(5, [(10, 0), (12, 0)]), *POINTS[1:]),
    "odd_track_of_missing_keypoint": points(point(5, [(10, 0), (11, 3)]), *POINTS[1:]),
    "no_points": {"points3D": count(0)},
    "empty_files": {"cameras": b"", "images": b"", "points3D": b""},
    "frames_cut": FRAMED | {"frames": FRAMED["frames"][:-1]},
    "frames_data_count_lies": FRAMED | {"frames": count(1) + frame(1, [10], data_count=2**32 - 1)},
    "frame_id_twice": FRAMED | {"frames": count(2) + frame(1, [10]) + frame(1, [11])},
    "frame_of_missing_rig": FRAMED | {"frames": count(2) + frame(1, [10], rig=4) + frame(2, [11])},
    "frame_position_nan": FRAMED | {"frames": count(2) + frame(1, [10], t=(NAN, 0.0, 0.0)) + frame(2, [11])},
    "rig_flag_unknown": FRAMED | {"rigs": count(1) + rig(flag=7)},
    # Tolerated, with a warning.
    "odd_keypoint_of_missing_point": images(image(10, b"first.jpg", [5, 7, 8]), SECOND),
    "odd_track_contradicted": images(image(10, b"first.jpg", [5, 9, NO_POINT]), SECOND),
    "odd_point_without_track": points(*POINTS, point(12, [])),
    "odd_image_without_keypoints": images(FIRST, SECOND, image(12, b"third.jpg", [])),
    "odd_name_latin1": images(image(10, b"Stra\xdfe.jpg", [5, 7, NO_POINT]), SECOND),
    "odd_rotation_of_length_two": images(image(10, b"first.jpg", [5, 7, NO_POINT], q=(2.0, 0.0, 0.0, 0.0)), SECOND),
    "odd_pose_of_frame_differs": FRAMED | {"frames": count(2) + frame(1, [10], t=(1.0, 2.0, 3.0)) + frame(2, [11])},
}

CAMERA = "1 SIMPLE_RADIAL 640 480 500 320 240 -0.05"
IMAGES = """10 1 0 0 0 0 0 5 1 a b/first photo.jpg
100.5 200.25 5 110.5 200.25 7 120.5 200.25 -1
11 0.8 0 0.6 0 0 0 5 1 second.jpg
100.5 200.25 5 110.5 200.25 7 120.5 200.25 9"""
POINT_LINES = """5 0.25 -0.5 0.625 10 20 30 0.5 10 0 11 0
7 0.25 -0.5 0.875 10 20 30 0.5 10 1 11 1
9 0.25 -0.5 1.125 10 20 30 0.5 11 2"""


def text(cameras=CAMERA, images=IMAGES, points=POINT_LINES, rigs=None, frames=None):
    files = {"cameras": cameras, "images": images, "points3D": points, "rigs": rigs, "frames": frames}
    return {stem: f"# {stem}\n{lines}\n".encode() for stem, lines in files.items() if lines is not None}


RIG = "1 3 CAMERA 1 CAMERA 2 1 1 0 0 0 0.5 0 0 IMU 7 0"
FRAMES = "1 1 1 0 0 0 0 0 5 1 CAMERA 1 10\n2 1 0.8 0 0.6 0 0 0 5 1 CAMERA 1 11"
TWO_CAMERAS = CAMERA + "\n2 PINHOLE 640 480 500 500 320 240"
TEXT = {
    "sound": text(),
    "sound_framed": text(cameras=TWO_CAMERAS, rigs=RIG, frames=FRAMES),
    # Refused.
    "camera_model_unknown": text(cameras="1 FANCY 640 480 500 320 240"),
    "camera_parameter_missing": text(cameras="1 SIMPLE_RADIAL 640 480 500 320 240"),
    "camera_parameter_extra": text(cameras=CAMERA + " 7"),
    "image_line_cut": text(images="10 1 0 0 0 0 0\n\n"),
    "image_of_missing_camera": text(images=IMAGES.replace("5 1 second", "5 3 second")),
    "keypoints_cut": text(images=IMAGES[:-9]),
    "keypoint_no_number": text(images=IMAGES.replace("110.5", "11O.5", 1)),
    "keypoint_nan": text(images=IMAGES.replace("110.5", "nan", 1)),
    "keypoint_of_negative_point": text(images=IMAGES.replace("25 7", "25 -7", 1)),
    "keypoint_line_missing": text(images=IMAGES.split("\n")[0] + "\n" + "\n".join(IMAGES.split("\n")[2:])),
    "point_position_word": text(points=POINT_LINES.replace("0.875", "far")),
    "odd_point_position_infinite": text(points=POINT_LINES.replace("0.875", "inf")),
    "point_color_300": text(points=POINT_LINES.replace("20", "300", 1)),
    "point_line_cut": text(points=POINT_LINES.replace("10 20 30 0.5 11 2", "10 20")),
    "point_id_twice": text(points=POINT_LINES.replace("7 0.25", "5 0.25")),
    "track_cut": text(points=POINT_LINES + " 10"),
    "track_image_beyond_u32": text(points=POINT_LINES.replace("11 2", "99999999999 2")),
    "odd_track_of_missing_image": text(points=POINT_LINES.replace("11 2", "12 2")),
    "odd_track_of_missing_keypoint": text(points=POINT_LINES.replace("11 2", "11 3")),
    "no_points": text(points="# nothing"),
    "rig_sensor_unknown": text(cameras=TWO_CAMERAS, rigs="1 2 CAMERA 1 LIDAR 2 0", frames=FRAMES),
    "rig_cut": text(cameras=TWO_CAMERAS, rigs="1 4000000000 CAMERA 1", frames=FRAMES),
    "frame_cut": text(cameras=TWO_CAMERAS, rigs=RIG, frames="1 1 1 0 0 0 0 0 5 4000000000 CAMERA 1 10"),
}


def ply(encoding, header, rows):
    return f"ply\nformat {encoding} 1.0\n{header}end_header\n".encode() + rows


XYZ = "property double x\nproperty double y\nproperty double z\n"
RGB = "property uchar red\nproperty uchar green\nproperty uchar blue\n"
NORMAL = "property float nx\nproperty float ny\nproperty float nz\n"
FACES = "element face 1\nproperty list uchar int vertex_indices\n"
LE = "binary_little_endian"
ROWS = [(0.25, -0.5, 1.125), (1.0, 2.0, 3.0), (-1.5, 0.0, 1e-3)]
COLORS = [(10, 20, 30), (0, 128, 255), (1, 2, 3)]
ASCII_ROWS = "".join("%r %r %r\n" % row for row in ROWS)


def binary_rows(order, position="d", extra=b"", rows=ROWS):
    return b"".join(struct.pack(f"{order}3{position}3B", *row, *rgb) + extra for row, rgb in zip(rows, COLORS))


VERTICES = "element vertex 3\n"
PLY = {
    "sound_ascii": ply("ascii", VERTICES + XYZ + RGB, b"".join(
        b"%r %r %r %d %d %d\n" % (*row, *rgb) for row, rgb in zip(ROWS, COLORS))),
    "sound_little": ply(LE, VERTICES + XYZ + RGB, binary_rows("<")),
    "sound_big": ply("binary_big_endian", VERTICES + XYZ + RGB, binary_rows(">")),
    "sound_float": ply(LE, VERTICES + XYZ.replace("double", "float") + RGB, binary_rows("<", "f")),
    "sound_mesh": ply(LE, VERTICES + XYZ + RGB.replace("red", "diffuse_red").replace("green", "diffuse_green")
                      .replace("blue", "diffuse_blue") + "property list uchar float weights\n" + FACES,
                      binary_rows("<", extra=b"\2" + bytes(8)) + struct.pack("<B3i", 3, 0, 1, 2)),
    "sound_mesh_first": ply("ascii", FACES + VERTICES + XYZ + NORMAL, b"3 0 1 2\n" + b"".join(
        b"%r %r %r 0 0 1\n" % row for row in ROWS)),
    "sound_odd_header": ply("ascii", "comment Stra\xdfe\ncomment\nobj_info made by hand\n\n".encode("latin-1").decode("latin-1")
                            + VERTICES + XYZ + "property float scalar_Distance_(m)\n", b"".join(
                                b"%r %r %r 7\n" % row for row in ROWS)).decode().encode("latin-1"),
    "sound_crlf": ply("ascii", VERTICES + XYZ, ASCII_ROWS.encode()).replace(b"\n", b"\r\n"),
    # Refused.
    "bad_cut": ply(LE, VERTICES + XYZ + RGB, binary_rows("<")[:-1]),
    "bad_count_lies": ply(LE, "element vertex 4000000000\n" + XYZ + RGB, binary_rows("<")),
    "bad_count_lies_ascii": ply("ascii", "element vertex 4000000000\n" + XYZ, ASCII_ROWS.encode()),
    "bad_count_overflows": ply(LE, "element vertex 18446744073709551615\n" + XYZ + RGB, binary_rows("<")),
    "bad_count_too_low": ply(LE, "element vertex 2\n" + XYZ + RGB, binary_rows("<")),
    "bad_count_too_low_ascii": ply("ascii", "element vertex 2\n" + XYZ, ASCII_ROWS.encode()),
    "bad_count_negative": ply("ascii", "element vertex -3\n" + XYZ, ASCII_ROWS.encode()),
    "bad_list_length_lies": ply(LE, VERTICES + XYZ + RGB + "element face 1\nproperty list uint int i\n",
                                binary_rows("<") + struct.pack("<I3i", 2**32 - 1, 0, 1, 2)),
    "bad_no_vertex": ply("ascii", "element point 3\n" + XYZ, ASCII_ROWS.encode()),
    "bad_no_z": ply("ascii", VERTICES + XYZ.replace("z", "w"), ASCII_ROWS.encode()),
    "bad_x_list": ply("ascii", VERTICES + XYZ.replace("double x", "list uchar double x"), ASCII_ROWS.encode()),
    "bad_no_header_end": b"ply\nformat ascii 1.0\nelement vertex 3\n" + XYZ.encode(),
    "bad_format": ply("binary_middle_endian", VERTICES + XYZ, ASCII_ROWS.encode()),
    "bad_row_short": ply("ascii", VERTICES + XYZ, b"1 2 3\n4 5\n6 7 8\n"),
    "bad_row_long": ply("ascii", VERTICES + XYZ, b"1 2 3\n4 5 6 7\n6 7 8\n"),
    "bad_row_word": ply("ascii", VERTICES + XYZ, b"1 2 3\n4 five 6\n6 7 8\n"),
    "bad_element_without_properties": ply(LE, "element ghost 9000000000000000000\n" + VERTICES + XYZ + RGB, binary_rows("<")),
    "bad_element_twice": ply(LE, VERTICES + XYZ + RGB + VERTICES + XYZ, binary_rows("<")),
    "bad_property_twice": ply(LE, VERTICES + XYZ + "property double x\n", binary_rows("<")),
    "bad_no_points": ply("ascii", "element vertex 0\n" + XYZ, b""),
    "bad_all_nan": ply("ascii", VERTICES + XYZ, b"nan nan nan\n" * 3),
    # Tolerated, with a warning.
    "odd_nan_rows": ply("ascii", VERTICES + XYZ, b"1 2 3\n\nnan nan nan\n6 7 8\n\n"),
    "odd_nan_rows_binary": ply(LE, VERTICES + XYZ + RGB, binary_rows("<", rows=[ROWS[0], (NAN,) * 3, ROWS[2]])),
    "odd_zero_normal": ply("ascii", VERTICES + XYZ + NORMAL, b"1 2 3 0 0 2\n4 5 6 0 0 0\n6 7 8 nan 0 0\n"),
}

for kind, models, extension in (("binary", BINARY, "bin"), ("text", TEXT, "txt")):
    shutil.rmtree(kind, ignore_errors=True)
    sound = SOUND if kind == "binary" else models["sound"]
    framed = sound | models["sound_framed"]
    for name, files in models.items():
        folder = pathlib.Path(kind, name)
        folder.mkdir(parents=True)
        base = {} if name.startswith("sound") else framed if "frames" in files else sound
        for stem, content in (sound | files).items():
            if base.get(stem) != content:
                (folder / f"{stem}.{extension}").write_bytes(content)
shutil.rmtree("ply", ignore_errors=True)
pathlib.Path("ply").mkdir()
for name, content in PLY.items():
    pathlib.Path("ply", f"{name}.ply").write_bytes(content)
