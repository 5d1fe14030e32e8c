#!/usr/bin/env python3
"""Times PoseLib's solvers and ours in one run: python3 benches/compare_poselib.py (needs numpy, `pip install poselib`, cargo).

PoseLib's p6lp is our equation with all offsets 0, so (2,2,2) and (3,2,1) are the same problem for both (it has no closed form for
(3,2,1)); gp3p (three points on three rays, six planes) has three quadrics with constants, as (1,1,1,1,1,1) has. PoseLib is called from
Python: the cost of a call that hardly computes (up2p, two poses out) is measured beside and taken off; what further poses cost on their
way to Python stays in. Both sides: the fastest of many rounds over 1000 samples, one thread.
"""
import re
import subprocess
import time

import numpy as np
import poselib

ROUNDS, SAMPLES = 40, 1000
rng = np.random.default_rng(1)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def rotation():
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def concurrent(planes):
    """Rows on planes through the origin, in an order that starts with three independent normals."""
    order = sorted(range(6), key=lambda i: planes[:i].count(planes[i]))
    normals = unit(rng.normal(size=(3, 3)))
    l = np.array([normals[planes[i]] for i in order])
    x = rng.uniform(-50, 50, size=l.shape)
    x -= l * (x * l).sum(1, keepdims=True)
    return l, (x - rng.uniform(-50, 50, 3)) @ rotation()


def rays():
    r, t = rotation(), rng.uniform(-50, 50, 3)
    p, x = rng.uniform(-50, 50, (3, 3)), unit(rng.normal(size=(3, 3)))
    return p, x, (p + x * rng.uniform(10, 90, (3, 1)) - t) @ r


def two_pixels():
    x = unit(np.c_[rng.normal(size=(2, 2)), np.ones(2)])
    return x, x * rng.uniform(10, 90, (2, 1))


def microseconds(solver, samples):
    best = np.inf
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for sample in samples:
            solver(*sample)
        best = min(best, (time.perf_counter() - start) / len(samples))
    poses = np.mean([len(solver(*sample)) for sample in samples])
    return best * 1e6, poses


def ours():
    run = subprocess.run(["cargo", "run", "--release", "-q", "--example", "table1", "2000"], capture_output=True, text=True, check=True)
    lines = [[c.strip() for c in line.split("|")] for line in run.stdout.splitlines() if "[" in line]
    return {re.sub(r"[\[\] ]", "", c[1]): (float(c[8]), float(c[5])) for c in lines}


def main():
    made = lambda make: [make() for _ in range(SAMPLES)]
    call, _ = microseconds(poselib.up2p, made(two_pixels))
    mine = ours()
    print(f"a call that hardly computes (up2p): {call:.2f} us, taken off below\n")
    print("| sample | PoseLib | poses | us | ours, us | poses | ratio |\n|---|---|---|---|---|---|---|")
    for name, solver, samples, key in [
        ("(2,2,2), offsets 0", "p6lp", made(lambda: concurrent([0, 0, 1, 1, 2, 2])), "rigid2,2,2"),
        ("(3,2,1), offsets 0", "p6lp", made(lambda: concurrent([0, 0, 0, 1, 1, 2])), "rigid3,2,1"),
        ("three points on rays", "gp3p", made(rays), "rigid1,1,1,1,1,1"),
    ]:
        time_us, poses = microseconds(getattr(poselib, solver), samples)
        (our_us, our_poses), net = mine[key], time_us - call
        print(f"| {name} | {solver} | {poses:.2f} | {net:.2f} | {our_us:.2f} | {our_poses:.2f} | {net / our_us:.1f} |")


if __name__ == "__main__":
    main()
