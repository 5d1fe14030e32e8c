"""Bytes a second at which other programs read the files of `benches/reading.rs`.

    CITYWELD_BENCH_FILES=FOLDER cargo bench --bench reading        (writes the files into the empty FOLDER, and reads them)
    pip install cjio lxml laspy[lazrs] pycolmap numpy trimesh
    python benches/peers_reading.py FOLDER

Each file is read three times, the fastest counts; one thread where the program lets one choose. What they do with a file differs: cjio and lxml make
a tree, laspy unpacks records, pycolmap builds a reconstruction, trimesh loads meshes; none judges facets.
"""

import os
import sys
import time
from pathlib import Path


def megabytes(path):
    files = path.iterdir() if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files) / 1e6


def cjio(path):
    from cjio import cityjson

    with open(path, encoding="utf-8") as file:
        return cityjson.reader(file=file, ignore_duplicate_keys=True)


def lxml(path):
    from lxml import etree

    return etree.parse(path, etree.XMLParser(huge_tree=True))


def laspy(path):
    import laspy

    with laspy.open(path, laz_backend=laspy.LazBackend.Lazrs) as reader:
        points = reader.read()
    return points.x, points.y, points.z


def pycolmap(path):
    import pycolmap

    return pycolmap.Reconstruction(path)


def trimesh(path):
    import trimesh

    return trimesh.load(path, process=False)


PEERS = [
    ("COLMAP binary", "binary", pycolmap),
    ("COLMAP text", "text", pycolmap),
    ("OBJ", "city.obj", trimesh),
    ("CityJSON", "city.city.json", cjio),
    ("CityGML", "city.gml", lxml),
    ("LAZ", "scan.laz", laspy),
]


def main():
    folder = Path(sys.argv[1])
    for name, file, read in PEERS:
        path = folder / file
        seconds = []
        for _ in range(3):
            begin = time.perf_counter()
            read(str(path))
            seconds.append(time.perf_counter() - begin)
        size = megabytes(path)
        print(f"{name:14} {read.__name__:9} {size:7.1f} MB {min(seconds):7.2f} s {size / min(seconds):8.1f} MB/s", flush=True)


if __name__ == "__main__":
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    main()
