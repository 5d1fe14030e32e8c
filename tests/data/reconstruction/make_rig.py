"""Writes rig_bin and rig_txt: a made-up scene of two cameras on a rig, as pycolmap writes it."""

import pathlib

import pycolmap

pycolmap.set_random_seed(3)
options = pycolmap.SyntheticDatasetOptions()
options.num_rigs = 1
options.num_cameras_per_rig = 2
options.num_frames_per_rig = 3
options.num_points3D = 12
options.num_points2D_without_point3D = 2
options.track_length = 4
options.camera_model_id = pycolmap.CameraModelId.OPENCV
options.camera_params = [900.5, 910.25, 512.0, 384.0, -0.05, 0.01, 0.001, -0.002]
options.camera_width, options.camera_height = 1024, 768
reconstruction = pycolmap.synthesize_dataset(options)
for folder, write in (("rig_bin", reconstruction.write_binary), ("rig_txt", reconstruction.write_text)):
    pathlib.Path(folder).mkdir(exist_ok=True)
    write(folder)
