#!/usr/bin/env python3
"""Times bspray with savings of detail, samples and rays against itself without them, and tells how far the pictures differ.

    detail.py lod [--budgets 0.5,1] NAME=MODEL ARGUMENT... -- NAME=MODEL ARGUMENT...   # --lod against full meshes
    detail.py noise [--levels 0.1,0.05] NAME=MODEL ...                                 # --noise against uniform samples, at equal error
    detail.py rays NAME=MODEL ...                                                      # what is on by default against --exhaustive
    detail.py lamps NAME=MODEL ...                                                     # lamps chosen by the light tree against --light-sampler power
    detail.py grid MODEL.glb SIDE OUT.glb                                              # SIDE by SIDE copies of a model, which share its meshes

Runs are whole programs, file to picture, one after the other in turns, in another order each turn. Ratios are taken within a turn; printed are the median, least and greatest. User seconds are
of all threads and all their code, as the system counts them (with those that it spends itself); memory is the peak of the resident set. FLIP is the mean of HDR-FLIP of two EXR files by `bspray diff --json`; as the yardstick
stands that between two seeds. relMSE is against a reference of --reference samples a pixel with another seed. At equal error: uniform pictures of 16, 32, ... 512 samples are
points of error over seconds and over samples; between them logarithms are straight; the ratio is what uniform sampling takes to the other picture's error over what that took.
"""
import argparse
import json
import math
import os
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path


class Scene:
    def __init__(self, words):
        self.name, model = words[0].split("=", 1)
        self.arguments = [model, *words[1:]]


class Bench:
    def __init__(self, args):
        self.args = args
        self.folder = Path(tempfile.mkdtemp(prefix="bspray-detail-"))

    def file(self, name):
        return str(self.folder / name)

    def run(self, scene, more, output):
        """Seconds of clock and processors, bytes, and the report of one render."""
        command = [self.args.bspray, "render", *scene.arguments, *more, "-q", "--json", "-o", output]
        report = self.file("report.json")
        with open(report, "w") as out, open(self.file("log"), "w") as log:
            began = time.perf_counter()
            child = subprocess.Popen(command, stdout=out, stderr=log)
            _, status, usage = os.wait4(child.pid, 0)
            wall = time.perf_counter() - began
            child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            sys.exit(f"{' '.join(command)}: {Path(self.file('log')).read_text()}")
        return {"wall": wall, "user": usage.ru_utime + usage.ru_stime, "bytes": usage.ru_maxrss * 1024, "report": json.loads(Path(report).read_text())}

    def errors(self, a, b):
        words = [self.args.bspray, "diff", a, b, "--json", "--only", "R,G,B,A"]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode not in (0, 5):
            sys.exit(done.stderr)
        return json.loads(done.stdout)["color"]

    def turns(self, scene, ways, output="picture.png"):
        runs = {way: [] for way in ways}
        for turn in range(self.args.turns):
            names = list(ways)
            at = turn % len(names)
            for way in names[at:] + names[:at]:
                runs[way].append(self.run(scene, ways[way], self.file(output)))
        return runs

    def flip_of_seeds(self, scene):
        for seed in (0, 1):
            self.run(scene, ["--seed", str(seed)], self.file(f"seed{seed}.exr"))
        return self.errors(self.file("seed1.exr"), self.file("seed0.exr"))["flip"]


def ratios(over, under, what):
    values = [a[what] / b[what] for a, b in zip(over, under)]
    return f"{statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def median(runs, what):
    return statistics.median(r[what] for r in runs)


def row(*cells):
    print("| " + " | ".join(str(c) for c in cells) + " |", flush=True)


def lod(bench, scenes):
    row("scene", "budget, pixels", "triangles", "kept", "error, pixels", "wall s full", "wall ratio", "user ratio", "memory ratio", "FLIP to full", "FLIP of two seeds")
    row(*["---"] * 11)
    for scene in scenes:
        budgets = bench.args.budgets.split(",")
        runs = bench.turns(scene, {"full": [], **{b: ["--lod", b] for b in budgets}})
        yardstick = bench.flip_of_seeds(scene)
        for budget in budgets:
            bench.run(scene, ["--lod", budget], bench.file("lod.exr"))
            flip = bench.errors(bench.file("lod.exr"), bench.file("seed0.exr"))["flip"]
            found = runs[budget][0]["report"]["lod"]
            full, coarse = runs["full"], runs[budget]
            row(scene.name, budget, found["triangles"], found["kept"], f"{found['error_pixels']:.2f}", f"{median(full, 'wall'):.2f}", ratios(full, coarse, "wall"), ratios(full, coarse, "user"),
                ratios(full, coarse, "bytes"), f"{flip:.4f}", f"{yardstick:.4f}")


def interpolated(points, x, y, error):
    """The value y at an error, of points whose errors x fall."""
    for a, b in zip(points, points[1:]):
        if a[x] >= error >= b[x] or b is points[-1] or (a is points[0] and error > a[x]):
            share = math.log(error / a[x]) / math.log(b[x] / a[x])
            return a[y] * (b[y] / a[y]) ** share


def noise(bench, scenes):
    row("scene", "level", "mean samples", "relMSE", "FLIP", "user s", "uniform over it at equal relMSE: user", "samples", "at equal FLIP: user", "samples")
    row(*["---"] * 10)
    for scene in scenes:
        bench.run(scene, ["--spp", str(bench.args.reference), "--seed", "77"], bench.file("reference.exr"))

        def point(more):
            runs = [bench.run(scene, [*more, "--seed", str(seed)], bench.file(f"{seed}.exr")) for seed in range(bench.args.turns)]
            errors = [bench.errors(bench.file(f"{seed}.exr"), bench.file("reference.exr")) for seed in range(bench.args.turns)]
            mean = lambda name: statistics.mean(e[name] for e in errors)
            return {"relmse": mean("rel_mse"), "flip": mean("flip"), "user": median(runs, "user"), "samples": statistics.mean(r["report"]["samples"] for r in runs), "runs": runs}

        uniform = [point(["--spp", str(16 << i)]) for i in range(6)]
        for level in bench.args.levels.split(","):
            found = point(["--noise", level])
            gain = lambda x, y: f"{interpolated(uniform, x, y, found[x]) / found[y]:.2f}"
            mean = statistics.mean(r["report"]["noise"]["mean_samples_per_pixel"] for r in found["runs"])
            row(scene.name, level, f"{mean:.0f}", f"{found['relmse']:.5f}", f"{found['flip']:.4f}", f"{found['user']:.2f}", gain("relmse", "user"), gain("relmse", "samples"), gain("flip", "user"), gain("flip", "samples"))


def lamps(bench, scenes):
    rays(bench, scenes, ["--light-sampler", "power"])


def rays(bench, scenes, without=("--exhaustive",)):
    row("scene", "shadow rays left out", "wall ratio", "user ratio", "memory ratio", "relMSE on over off", "FLIP on to off", "FLIP of two seeds")
    row(*["---"] * 8)
    for scene in scenes:
        bench.run(scene, ["--spp", str(bench.args.reference), "--seed", "77", "--exhaustive"], bench.file("reference.exr"))
        runs = bench.turns(scene, {"off": [*without], "on": []})
        shadow = {way: r[0]["report"]["rays"]["shadow"] for way, r in runs.items()}
        yardstick = bench.flip_of_seeds(scene)
        errors = {"on": [], "off": []}
        for seed in range(bench.args.turns):
            for way, more in (("on", []), ("off", without)):
                bench.run(scene, [*more, "--seed", str(seed)], bench.file(f"{way}{seed}.exr"))
                errors[way].append(bench.errors(bench.file(f"{way}{seed}.exr"), bench.file("reference.exr"))["rel_mse"])
        flip = bench.errors(bench.file("on0.exr"), bench.file("off0.exr"))["flip"]
        more = statistics.mean(errors["on"]) / statistics.mean(errors["off"])
        row(scene.name, f"{100 - 100 * shadow['on'] / max(shadow['off'], 1):.1f} %", ratios(runs["off"], runs["on"], "wall"), ratios(runs["off"], runs["on"], "user"), ratios(runs["off"], runs["on"], "bytes"),
            f"{more:.3f}", f"{flip:.5f}", f"{yardstick:.4f}")


def grid(model, side, output):
    """Copies of all nodes of a GLB file, side by side on the ground."""
    data = Path(model).read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document, rest = json.loads(data[20 : 20 + length]), data[20 + length :]
    nodes, roots = document["nodes"], document["scenes"][document.get("scene", 0)]["nodes"]
    bounds = [document["accessors"][p["attributes"]["POSITION"]] for m in document["meshes"] for p in m["primitives"]]
    reach = float(os.environ.get("GRID_STEP", 0)) or 2.2 * max(abs(x) for a in bounds for x in a["min"] + a["max"])
    copies, tops = [], []
    for copy in range(int(side) ** 2):
        first = len(copies)
        for node in nodes:
            children = [c + first for c in node.get("children", [])]
            copies.append({**node, **({"children": children} if children else {})})
        place = [copy % int(side) * reach, 0.0, copy // int(side) * reach]
        copies.append({"translation": place, "children": [r + first for r in roots]})
        tops.append(len(copies) - 1)
    document.update(nodes=copies, scenes=[{"nodes": tops}], scene=0)
    for gone in ("animations", "skins"):
        document.pop(gone, None)
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + rest
    Path(output).write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["lod", "noise", "rays", "lamps"])
    parser.add_argument("--bspray", default="target/release/bspray")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--reference", type=int, default=4096)
    parser.add_argument("--budgets", default="0.5,1")
    parser.add_argument("--levels", default="0.1,0.05")
    if sys.argv[1:2] == ["grid"]:
        return grid(*sys.argv[2:])
    words = sys.argv[1:]
    first = next((i for i, word in enumerate(words) if "=" in word and not word.startswith("-")), len(words))
    args = parser.parse_args(words[:first])
    scenes, words = [], words[first:] + ["--"]
    while words:
        end = words.index("--")
        if end:
            scenes.append(Scene(words[:end]))
        words = words[end + 1 :]
    {"lod": lod, "noise": noise, "rays": rays, "lamps": lamps}[args.what](Bench(args), scenes)


if __name__ == "__main__":
    main()
