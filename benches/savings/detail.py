#!/usr/bin/env python3
"""Times bspray with savings of detail, samples and rays against itself without them, and tells how far the pictures differ.

    detail.py lod    [--turns N] NAME=MODEL,ARGUMENT,...    # --lod BUDGETS against the full meshes
    detail.py noise  [--turns N] NAME=MODEL,ARGUMENT,...    # --noise LEVELS against uniform sampling, at equal error
    detail.py rays   [--turns N] NAME=MODEL,ARGUMENT,...    # what is on by default against --exhaustive, and at equal error
    detail.py grid CHESS.glb ROWS OUT.gltf                  # ROWS by ROWS copies of a model's nodes, sharing its buffers

Runs are whole programs, file to PNG, interleaved, the order changed each turn. Ratios are taken within each turn; printed are medians with the least and the most. User seconds are
of all threads, as the system counts them; memory is the peak of the resident set. FLIP is the mean of HDR-FLIP of two EXR files by `bspray diff --json`, once a scene; as the yardstick
stands that between two seeds. relMSE is against a reference of REFERENCE samples a pixel with another seed. At equal error: uniform pictures of 8, 16, ... samples give a line of error
over seconds in logarithms; the ratio is of the seconds on it at the other picture's error to that picture's seconds.
"""
import argparse
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path


def run(command, timing):
    """Seconds of the clock and of processors, and bytes, of one run."""
    with open(timing, "w") as log:
        pid = os.fork()
        if pid == 0:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            os.dup2(log.fileno(), 2)
            os.execvp(command[0], command)
        import time

        began = time.perf_counter()
        _, status, usage = os.wait4(pid, 0)
        wall = time.perf_counter() - began
    if status != 0:
        sys.exit(f"{' '.join(command)}: {Path(timing).read_text()}")
    return {"wall": wall, "user": usage.ru_utime + usage.ru_stime, "bytes": usage.ru_maxrss * 1024}


class Bench:
    def __init__(self, args):
        self.args = args
        self.folder = Path(tempfile.mkdtemp(prefix="bspray-detail-"))

    def command(self, scene, more, output):
        return [self.args.bspray, "render", *scene.arguments, *more, "-q", "-o", str(output)]

    def time(self, scene, ways, turns):
        """For each way a list of runs, by turns."""
        runs = {way: [] for way in ways}
        for turn in range(turns):
            names = list(ways)
            names = names[turn % len(names):] + names[: turn % len(names)]
            for way in names:
                runs[way].append(run(self.command(scene, ways[way], self.folder / "a.png"), self.folder / "log"))
        return runs

    def picture(self, scene, more, name):
        output = self.folder / f"{scene.name}-{name}.exr"
        done = subprocess.run([*self.command(scene, more, output), "--json"], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(done.stderr)
        return output, json.loads(done.stdout)

    def diff(self, a, b):
        words = [self.args.bspray, "diff", str(a), str(b), "--json", "--only", "R,G,B,A,Z"]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode not in (0, 5):
            sys.exit(done.stderr)
        return json.loads(done.stdout)


class Scene:
    def __init__(self, text):
        self.name, rest = text.split("=", 1)
        self.arguments = rest.split(",,") if ",," in rest else rest.split()


def spread(values, form="{:.2f}"):
    return f"{form.format(statistics.median(values))} ({form.format(min(values))} to {form.format(max(values))})"


def ratios(runs, a, b, what):
    return [x[what] / y[what] for x, y in zip(runs[a], runs[b])]
