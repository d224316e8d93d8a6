#!/usr/bin/env python3
"""Times bspray with its savings against `--exhaustive`: the same pictures, whole programs, in turns.

    against_exhaustive.py [--models FOLDER] [--scenes NAME,...] [--turns N] [--spp N] [--threads N] [--bspray FILE]

FOLDER has the models that are not in this project: gltf/Sponza, gltf/FlightHelmet, gltf/khronos/MetalRoughSpheresNoTextures, gltf/chess-board.glb, obj/bunny.obj, obj/city_etoile. Landscapes are made with
`generate-models terrain`, the field of chess sets by `detail.py`: 50 x 50 of them. A scene whose model is not there is left out, and named. `--with "--lod 0.5"` gives the run with savings more of them.

Printed is a row a scene: user seconds and wall seconds of both, peak memory of both (ru_maxrss), and how often as much the exhaustive run takes: above 1 savings
pay. Then when the first pixels were there, the share of the triangles for which the structure was built, FLIP between both pictures, and FLIP between two seeds, which is
what noise does. Median (least to most) of turns; the other of two neighbouring turns goes first.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import detail

HERE = Path(__file__).resolve().parents[2]
SETS = 50
WITHIN = ["--camera-position=0.4,1.2,0.2", "--camera-focal-point=3,0.3,4", "--camera-view-angle", "50"]


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--bspray", default=str(HERE / "target/release/bspray"))
    p.add_argument("--generate", default=str(HERE / "target/release/examples/generate-models"))
    p.add_argument("--models", type=Path, default=HERE / "shared")
    p.add_argument("--scenes", help="names, with commas between [default: all]")
    p.add_argument("--turns", type=int, default=3)
    p.add_argument("--resolution", default="1280x720")
    p.add_argument("--spp", type=int, default=4)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--with", dest="more", default="", help="further arguments of the run with savings, such as \"--lod 0.5\"")
    p.add_argument("--large", type=int, default=10_000_000, help="triangles of the largest landscape, which is rendered once a pixel")
    return p.parse_args()


def views(a, folder):
    """Each scene's name, model, and arguments of its own; the model may have to be made."""
    shared, ours = a.models, HERE / "models"
    terrain = lambda count: lambda: generated(a, folder, count)
    chess = shared / "gltf/chess-board.glb"
    once = ["--spp", "1"]
    return [
        ("sponza", shared / "gltf/Sponza/Sponza.gltf", ["--camera-position=-8,2,0", "--camera-focal-point=10,3,0", "--camera-view-angle", "60"]),
        ("city_etoile", shared / "obj/city_etoile/etoile.obj", []),
        ("courtyard", ours / "courtyard.glb", []),
        ("bunny", shared / "obj/bunny.obj", []),
        ("helmet", shared / "gltf/FlightHelmet/FlightHelmet.gltf", []),
        ("helmet normals", shared / "gltf/FlightHelmet/FlightHelmet.gltf", ["--integrator", "normals"]),
        ("sponza id", shared / "gltf/Sponza/Sponza.gltf", ["--integrator", "id", "--camera-position=-8,2,0", "--camera-focal-point=10,3,0", "--camera-view-angle", "60"]),
        ("spheres afar", shared / "gltf/khronos/MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb", ["--camera-position=0.00323,0.00325,0.05", "--camera-focal-point=0.00323,0.00325,0"]),
        ("terrain afar", terrain(1_000_000), ["--camera-position=700,300,950", "--camera-focal-point=175,-40,200"]),
        ("terrain within", terrain(1_000_000), WITHIN),
        ("chess field", lambda: chess_field(chess, folder), []),
        ("large terrain", terrain(a.large), once),
        ("large terrain within", terrain(a.large), [*once, *WITHIN]),
    ]


def generated(a, folder, count):
    file = folder / f"terrain-{count}.glb"
    if not file.exists():
        subprocess.run([a.generate, "terrain", str(count), str(file)], check=True, stdout=subprocess.DEVNULL)
    return file


def chess_field(source, folder):
    """A field of chess sets, which share their meshes."""
    file = folder / "chess-field.glb"
    if not source.exists():
        return source
    if not file.exists():
        detail.grid(source, SETS, file)
    return file


def run(a, model, more, output):
    """User seconds, wall seconds and peak megabytes of one render."""
    words = [a.bspray, "render", str(model), "-o", str(output), "-q", "--threads", str(a.threads)]
    if "--spp" not in more:
        words += ["--spp", str(a.spp)]
    words += ["--resolution", a.resolution, *more]
    began = time.perf_counter()
    child = subprocess.Popen(words, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - began
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        sys.exit(f"{' '.join(words)}: exit code {child.returncode}")
    return usage.ru_utime, wall, usage.ru_maxrss / 1024


def report(a, model, more):
    """The render's own report, from a run that does not count for times."""
    with tempfile.TemporaryDirectory() as folder:
        words = [a.bspray, "render", str(model), "-o", f"{folder}/a.png", "-q", "--json", "--threads", str(a.threads), "--resolution", a.resolution]
        if "--spp" not in more:
            words += ["--spp", str(a.spp)]
        return json.loads(subprocess.run([*words, *more], check=True, capture_output=True, text=True).stdout)


def flip(a, one, other):
    words = [a.bspray, "diff", "--json", "--fail", "inf", "--warn", "inf", str(one), str(other)]
    told = json.loads(subprocess.run(words, capture_output=True, text=True).stdout)
    return find(told, "flip")


def find(value, name):
    """The first number under a name, or the mean of what is there."""
    if isinstance(value, dict):
        if name in value:
            inner = value[name]
            return inner["mean"] if isinstance(inner, dict) else inner
        value = list(value.values())
    if isinstance(value, list):
        for one in value:
            found = find(one, name)
            if found is not None:
                return found
    return None


def told(values, digits=2):
    return f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def main():
    a = arguments()
    wanted = a.scenes.split(",") if a.scenes else None
    print("| scene | user s, savings | user s, exhaustive | ratio | wall s, savings | wall s, exhaustive | ratio | MiB, savings | MiB, exhaustive | ratio "
          "| first pixel, s | exhaustive | built | FLIP | of two seeds |")
    print("|---|---|---|---|---|---|---|---:|---:|---|---:|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name, model, more in views(a, folder):
            if wanted and name not in wanted:
                continue
            model = model() if callable(model) else model
            if not model.exists():
                print(f"{name}: {model} is not there", file=sys.stderr)
                continue
            pictures = [folder / "savings.png", folder / "exhaustive.png", folder / "seed.png"]
            runs = ([], [])
            for turn in range(a.turns):
                for which in [(0, 1), (1, 0)][turn % 2]:
                    flags = [[*more, *a.more.split()], [*more, "--exhaustive"]][which]
                    runs[which].append(run(a, model, flags, pictures[which]))
            run(a, model, [*more, "--exhaustive", "--seed", "1"], pictures[2])
            cells = [name]
            for kind in range(3):
                ours, theirs = ([r[kind] for r in runs[which]] for which in range(2))
                ratios = [b / max(x, 1e-9) for x, b in zip(ours, theirs)]
                digits = 0 if kind == 2 else 2
                cells += [told(ours, digits), told(theirs, digits), told(ratios)]
            with_savings, without = report(a, model, [*more, *a.more.split()]), report(a, model, [*more, "--exhaustive"])
            cells += [f"{r['seconds']['first_pixel']:.2f}" for r in (with_savings, without)]
            cells.append(f"{100 * with_savings['accelerator']['built_share']:.1f} %")
            cells += [f"{flip(a, pictures[i], pictures[1]):.5f}" for i in (0, 2)]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
