#!/usr/bin/env python3
"""Times bspray with its savings against `--exhaustive`: the same pictures, whole programs, in turns.

    against_exhaustive.py [--models FOLDER] [--scenes NAME,...] [--turns N] [--spp N] [--threads N] [--bspray FILE]

FOLDER has the models that are not in this project: gltf/Sponza, gltf/FlightHelmet, gltf/chess-board.glb, obj/bunny.obj, obj/city_etoile. Landscapes are made with
`generate-models terrain`, the field of chess sets here: 50 x 50 of them, by EXT_mesh_gpu_instancing. A scene whose model is not there is left out, and named.

Printed is a row a scene: user seconds and wall seconds of both, peak memory of both (ru_maxrss), and how often as much the exhaustive run takes: above 1 savings
pay. Then when the first pixels were there, the share of the triangles for which the structure was built, FLIP between both pictures, and FLIP between two seeds, which is
what noise does. Median (least to most) of turns; the other of two neighbouring turns goes first.
"""
import argparse
import json
import os
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parents[2]
SETS, SPACING = 50, 1.2


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
        ("terrain small", terrain(1_000_000), ["--camera-position=0,300,400", "--camera-focal-point=0,0,0", "--camera-view-angle", "40"]),
        ("terrain within", terrain(1_000_000), ["--camera-position=0.4,0.9,0.2", "--camera-focal-point=3,0.3,4", "--camera-view-angle", "50"]),
        ("chess field", lambda: chess_field(chess, folder), []),
        ("chess field, one", lambda: chess_field(chess, folder), ["--camera-position=0,0.5,0.9", "--camera-focal-point=0,0.05,0", "--camera-view-angle", "30"]),
        ("large terrain", terrain(a.large), once),
        ("large terrain within", terrain(a.large), [*once, "--camera-position=0.4,0.9,0.2", "--camera-focal-point=3,0.3,4", "--camera-view-angle", "50"]),
    ]


def generated(a, folder, count):
    file = folder / f"terrain-{count}.glb"
    if not file.exists():
        subprocess.run([a.generate, "terrain", str(count), str(file)], check=True, stdout=subprocess.DEVNULL)
    return file


def chess_field(source, folder):
    """A field of chess sets: every mesh node of the set gets the places of all sets, in its own space."""
    file = folder / "chess-field.glb"
    if file.exists() or not source.exists():
        return file if file.exists() else source
    data = source.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document, binary = json.loads(data[20 : 20 + length]), bytearray(data[28 + length :])
    cells = [(SPACING * (i - SETS // 2), SPACING * (j - SETS // 2)) for i in range(SETS) for j in range(SETS)]

    def descend(node, linear):
        node = document["nodes"][node]
        linear = product(linear, own_linear(node))
        if "mesh" in node:
            inverse = inverted(linear)
            places = [tuple(inverse[r][0] * x + inverse[r][2] * z for r in range(3)) for x, z in cells]
            binary.extend(b"\0" * (-len(binary) % 4))
            view = {"buffer": 0, "byteOffset": len(binary), "byteLength": 12 * len(places)}
            for place in places:
                binary.extend(struct.pack("<3f", *place))
            document["bufferViews"].append(view)
            document["accessors"].append({"bufferView": len(document["bufferViews"]) - 1, "componentType": 5126, "count": len(places), "type": "VEC3"})
            attributes = {"TRANSLATION": len(document["accessors"]) - 1}
            node.setdefault("extensions", {})["EXT_mesh_gpu_instancing"] = {"attributes": attributes}
        for child in node.get("children", []):
            descend(child, linear)

    for root in document["scenes"][document.get("scene", 0)]["nodes"]:
        descend(root, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    document["buffers"][0]["byteLength"] = len(binary)
    document.setdefault("extensionsUsed", []).append("EXT_mesh_gpu_instancing")
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary))
    file.write_bytes(head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)
    return file


def own_linear(node):
    """The linear part of a node's transform, row by row."""
    if "matrix" in node:
        m = node["matrix"]
        return [[m[4 * c + r] for c in range(3)] for r in range(3)]
    x, y, z, w = node.get("rotation", [0.0, 0.0, 0.0, 1.0])
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    scale = node.get("scale", [1.0, 1.0, 1.0])
    return [[turn[r][c] * scale[c] for c in range(3)] for r in range(3)]


def product(a, b):
    return [[sum(a[r][k] * b[k][c] for k in range(3)) for c in range(3)] for r in range(3)]


def inverted(m):
    (a, b, c), (d, e, f), (g, h, i) = m
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    cofactors = [[e * i - f * h, c * h - b * i, b * f - c * e], [f * g - d * i, a * i - c * g, c * d - a * f], [d * h - e * g, b * g - a * h, a * e - b * d]]
    return [[x / determinant for x in row] for row in cofactors]


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
                    flags = [more, [*more, "--exhaustive"]][which]
                    runs[which].append(run(a, model, flags, pictures[which]))
            run(a, model, [*more, "--exhaustive", "--seed", "1"], pictures[2])
            cells = [name]
            for kind in range(3):
                ours, theirs = ([r[kind] for r in runs[which]] for which in range(2))
                ratios = [b / max(x, 1e-9) for x, b in zip(ours, theirs)]
                digits = 0 if kind == 2 else 2
                cells += [told(ours, digits), told(theirs, digits), told(ratios)]
            with_savings, without = report(a, model, more), report(a, model, [*more, "--exhaustive"])
            cells += [f"{r['seconds']['first_pixel']:.2f}" for r in (with_savings, without)]
            cells.append(f"{100 * with_savings['accelerator']['built_share']:.1f} %")
            cells += [f"{flip(a, pictures[i], pictures[1]):.5f}" for i in (0, 2)]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
