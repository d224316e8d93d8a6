#!/usr/bin/env python3
"""Times bspray, Mitsuba 3 and Cycles on the same picture: one point light, matt grey surfaces, one camera, as many samples and bounces.

    pip install mitsuba bpy        # bpy for Cycles only
    speed.py [--peers mitsuba-scalar_rgb,mitsuba-llvm_ad_rgb,cycles] [--integrator direct|path] [--threads 1|2] NAME=FILE.obj,EYE,TARGET,FOV,LIGHT...

EYE, TARGET and LIGHT are X:Y:Z. Of the OBJ file only vertices and faces are kept. Renderers run in turns, each in a process of its own. Seconds are
of processor time with one thread, of the clock with more: bspray's are the whole program's, from OBJ to PNG; those of the others are import, build, one
render and, of Cycles, the file; without the start of Python and the import of modules. Mitsuba's llvm variant compiles its kernels on the first turn, which
does not count for it. A row is printed only if the means of all pictures agree within 2 %, and no picture is black.
"""
import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

WIDTH, HEIGHT, ALBEDO = 640, 480, 0.8


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("scenes", nargs="*", metavar="NAME=FILE,EYE,TARGET,FOV,LIGHT")
    p.add_argument("--bspray", default="target/release/bspray")
    p.add_argument("--peers", default="mitsuba-scalar_rgb")
    p.add_argument("--integrator", choices=["direct", "path"], default="direct")
    p.add_argument("--bounces", type=int, default=4, help="of path: how often light may be reflected, the last time towards the eye")
    p.add_argument("--spp", type=int, default=16)
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--turns", type=int, default=5)
    p.add_argument("--as-peer", help=argparse.SUPPRESS)
    p.add_argument("--out", help=argparse.SUPPRESS)
    return p.parse_args()


class View:
    """A scene of the command line, with its file reduced to vertices and faces."""

    def __init__(self, text):
        self.name, rest = text.split("=", 1)
        self.file, eye, target, fov, light = rest.rsplit(",", 4)
        self.eye, self.target, self.light = ([float(x) for x in t.split(":")] for t in (eye, target, light))
        self.fov = float(fov)
        self.reach = sum((a - b) ** 2 for a, b in zip(self.light, self.target)) ** 0.5

    def reduced(self, folder):
        """The same view of a copy with one material, and the file that holds the light."""
        copy = folder / f"{self.name}.obj"
        with open(self.file, errors="replace") as source, open(copy, "w") as out:
            out.write("mtllib grey.mtl\nusemtl grey\n")
            for line in source:
                if line.startswith("v "):
                    out.write(line)
                elif line.startswith("f "):
                    out.write("f " + " ".join(corner.split("/")[0] for corner in line.split()[1:]) + "\n")
        (folder / "grey.mtl").write_text(f"newmtl grey\nillum 1\nKd {ALBEDO} {ALBEDO} {ALBEDO}\n")
        punctual = "KHR_lights_punctual"
        light = {"lights": [{"type": "point", "intensity": 3.14159 * self.reach**2}]}
        node = {"translation": self.light, "extensions": {punctual: {"light": 0}}}
        document = {"asset": {"version": "2.0"}, "extensionsUsed": [punctual], "extensions": {punctual: light}, "nodes": [node], "scenes": [{"nodes": [0]}], "scene": 0}
        (folder / f"{self.name}-light.gltf").write_text(json.dumps(document))
        self.file = str(copy)
        return self

    def words(self):
        at = lambda p: ":".join(map(repr, p))
        return f"{self.name}={self.file},{at(self.eye)},{at(self.target)},{self.fov!r},{at(self.light)}"


class Clock:
    def __init__(self, threads):
        self.read = time.process_time if threads == 1 else time.perf_counter
        self.began = self.read()

    def seconds(self):
        return self.read() - self.began


def mitsuba(a, view, variant):
    import mitsuba as mi
    import numpy as np

    mi.set_variant(variant)
    clock = Clock(a.threads)
    integrator = {"type": "direct"} if a.integrator == "direct" else {"type": "path", "max_depth": a.bounces + 1, "rr_depth": 100}
    scene = mi.load_dict({
        "type": "scene",
        "integrator": integrator,
        "sensor": {
            "type": "perspective", "fov": view.fov, "fov_axis": "y", "near_clip": 1e-4 * view.reach, "far_clip": 100 * view.reach,
            "to_world": mi.ScalarTransform4f().look_at(origin=view.eye, target=view.target, up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": a.spp},
        },
        "mesh": {
            "type": "obj", "filename": view.file, "face_normals": True,
            "bsdf": {"type": "twosided", "b": {"type": "diffuse", "reflectance": {"type": "rgb", "value": ALBEDO}}},
        },
        "light": {"type": "point", "position": view.light, "intensity": {"type": "rgb", "value": 3.14159 * view.reach**2}},
    })
    picture = np.array(mi.render(scene))
    seconds = clock.seconds()
    # Not as EXR: with one thread, Mitsuba waits for ever for its pool to write it.
    np.save(a.out + ".npy", picture)
    return seconds, f"mitsuba {mi.__version__} {variant}"


def cycles(a, view):
    import bpy
    from mathutils import Matrix, Vector

    bpy.ops.wm.read_factory_settings(use_empty=True)
    clock = Clock(a.threads)
    bpy.ops.wm.obj_import(filepath=view.file, forward_axis="Y", up_axis="Z")
    scene = bpy.context.scene
    grey = bpy.data.materials.new("grey")
    grey.use_nodes = True
    nodes = grey.node_tree.nodes
    nodes.clear()
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (ALBEDO, ALBEDO, ALBEDO, 1)
    grey.node_tree.links.new(diffuse.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs[0])
    for mesh in (o.data for o in scene.objects if o.type == "MESH"):
        mesh.materials.clear()
        mesh.materials.append(grey)
        mesh.shade_flat()
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.sensor_fit = "VERTICAL"
    camera.data.angle = view.fov * 3.141592653589793 / 180
    camera.data.clip_start, camera.data.clip_end = 1e-4 * view.reach, 100 * view.reach
    back = (Vector(view.eye) - Vector(view.target)).normalized()
    right = Vector((0, 1, 0)).cross(back).normalized()
    camera.matrix_world = Matrix((right, back.cross(right), back)).transposed().to_4x4()
    camera.matrix_world.translation = Vector(view.eye)
    scene.collection.objects.link(camera)
    scene.camera = camera
    lamp = bpy.data.lights.new("lamp", "POINT")
    lamp.shadow_soft_size = 0
    lamp.energy = 4 * 3.14159265**2 * view.reach**2
    placed = bpy.data.objects.new("lamp", lamp)
    placed.location = view.light
    scene.collection.objects.link(placed)
    render, settings = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
    render.threads_mode, render.threads = "FIXED", a.threads
    render.filepath, render.image_settings.file_format = a.out, "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.film_transparent = True
    settings.device, settings.samples, settings.use_adaptive_sampling, settings.use_denoising = "CPU", a.spp, False, False
    settings.pixel_filter_type, settings.filter_width = "BOX", 1.0
    settings.sample_clamp_indirect = 0.0
    bounces = 0 if a.integrator == "direct" else a.bounces - 1
    settings.max_bounces = settings.diffuse_bounces = bounces
    settings.min_light_bounces = bounces
    bpy.ops.render.render(write_still=True)
    return clock.seconds(), f"cycles (bpy {bpy.app.version_string})"


def child(a, run):
    """What a program writes that has as many cores as threads."""
    cores = sorted(os.sched_getaffinity(0))[: a.threads]
    done = subprocess.run(run, capture_output=True, text=True, timeout=600, preexec_fn=lambda: os.sched_setaffinity(0, cores))
    if done.returncode:
        sys.exit(f"{' '.join(run)}\n{done.stdout}{done.stderr}")
    return done.stdout


def ours(a, view, out):
    """Seconds from OBJ to PNG; with `.exr`, for the numbers, more is written."""
    at = lambda p: ",".join(map(repr, p))
    folder = Path(view.file).parent
    run = [a.bspray, "render", view.file, str(folder / f"{view.name}-light.gltf"), "-o", out, "--quiet", "--sky", "off", "--filter", "box"]
    run += [f"--camera-position={at(view.eye)}", f"--camera-focal-point={at(view.target)}", "--camera-view-up=0,1,0", f"--camera-view-angle={view.fov!r}"]
    run += ["--integrator", a.integrator, "--spp", str(a.spp), "--resolution", f"{WIDTH}x{HEIGHT}", "--threads", str(a.threads)]
    run += ["--max-depth", str(a.bounces)] if a.integrator == "path" else []
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    child(a, run)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu if a.threads == 1 else wall


def theirs(a, view, peer, out):
    run = [sys.executable, __file__, "--as-peer", peer, "--out", out, "--integrator", a.integrator, "--bounces", str(a.bounces)]
    run += ["--spp", str(a.spp), "--threads", str(a.threads), view.words()]
    return json.loads(child(a, run).splitlines()[-1])


def mean(path):
    import mitsuba as mi
    import numpy as np

    if os.path.exists(path + ".npy"):
        return float(np.load(path + ".npy").mean(dtype=np.float64))
    mi.set_variant("scalar_rgb")
    bitmap = mi.Bitmap(path)
    names = [f.name for f in bitmap.struct_()]
    layers = np.array(bitmap, dtype=np.float64)
    return float(layers[..., [names.index(c) for c in "RGB"]].mean())


def spread(values):
    return f"{statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def compare(a, view):
    peers = a.peers.split(",")
    times = {name: [] for name in ["bspray", *peers]}
    names = {}
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        view.reduced(folder)
        files = {name: str(folder / f"{name}.exr") for name in times}
        for turn in range(a.turns + 1):
            for name in times:
                seconds = ours(a, view, str(folder / "bspray.png")) if name == "bspray" else None
                if seconds is None:
                    seconds, names[name] = theirs(a, view, name, files[name])
                if turn > 0:
                    times[name].append(seconds)
        ours(a, view, files["bspray"])
        means = {name: mean(file) for name, file in files.items()}
    for name in peers:
        ratios = [b / p for b, p in zip(times["bspray"], times[name])]
        agree = means["bspray"] / means[name] if means[name] else 0.0
        if not 0.98 < agree < 1.02:
            sys.exit(f"{view.name}: the means differ: {means}")
        print(f"| {view.name} | {a.integrator} | {a.threads} | {names[name]} | {spread(times['bspray'])} | {spread(times[name])} | {spread(ratios)} | {agree:.4f} |", flush=True)


def main():
    a = arguments()
    views = [View(text) for text in a.scenes]
    if a.as_peer:
        kind, _, variant = a.as_peer.partition("-")
        seconds, name = mitsuba(a, views[0], variant) if kind == "mitsuba" else cycles(a, views[0])
        print("\n" + json.dumps([seconds, name]))
        return
    print("| scene | integrator | threads | peer | bspray, s | peer, s | ratio | ratio of means |\n|---|---|---:|---|---|---|---|---:|")
    for view in views:
        compare(a, view)


if __name__ == "__main__":
    main()
