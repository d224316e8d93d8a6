#!/usr/bin/env python3
"""Renders models with bspray and with Mitsuba 3, by the same camera and light, and measures how much the pictures differ: mean FLIP.

    pip install mitsuba flip-evaluator pillow
    against_mitsuba.py --bspray target/release/bspray --light white|map|own --model specification|conserving|principled MODEL...

Models are read by models.py and shaded by gltf_bsdf.py, neither of which shares code with bspray; `principled` is Mitsuba's own BSDF, where a material
has no more than it. Both pictures: 400 x 300, box filter, 256 samples a pixel (twice as many in Mitsuba, whose
samples are less even), eight bounces (Mitsuba counts the eye's ray too: nine), two threads,
clipped to sRGB at the same exposure. FLIP is its authors' (LDR, 67 pixels a degree), over the whole picture and over the pixels that show the model.

`white` is radiance 1 from everywhere, `map` an image with a broad bright sun and coloured sides, made here, `own` the model's punctual lights and
emissive surfaces. bspray's equirectangular images have +X in the middle and +Z at three quarters, Mitsuba's +Z in the middle and +X at a
quarter: the same image, turned by a quarter of its width.

Output, in --out: NAME-LIGHT-MODEL.png (bspray, Mitsuba, FLIP), and a row of a Markdown table on stdout.
"""
import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

import drjit as dr
import flip_evaluator
import mitsuba as mi
import numpy as np
from PIL import Image

mi.set_variant("llvm_ad_rgb")
import gltf_bsdf  # noqa: E402  after the variant
import models  # noqa: E402

WIDTH, HEIGHT, DEPTH = 400, 300, 8
# Samples of a pass, whose paths all are in memory at once.
PASS = 64


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("models", nargs="+")
    p.add_argument("--bspray", default="target/release/bspray")
    p.add_argument("--out", type=Path, default=Path("/tmp/ref"))
    p.add_argument("--light", choices=["white", "map", "own"], default="white")
    p.add_argument("--model", choices=["specification", "conserving", "principled"], default="specification")
    p.add_argument("--terminator", action="store_true", help="give the reference bspray's softening of shadow terminators")
    p.add_argument("--spp", type=int, default=256)
    p.add_argument("--more", type=int, default=2, help="Mitsuba gets so many times the samples, beyond those that are timed")
    p.add_argument("--camera", nargs=argparse.REMAINDER, default=[], help="flags for bspray's camera; last")
    p.add_argument("--exposure", type=float, default=0.0, help="stops, in both pictures")
    p.add_argument("--threads", type=int, default=2)
    return p.parse_args()


def light_map(width=1024):
    """Equirectangular, in bspray's turn: +X in the middle, +Z at three quarters, up at the top."""
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(width // 2) + 0.5) / (width // 2))
    phi, theta = 2 * np.pi * (u - 0.5), np.pi * v
    d = np.stack([np.cos(phi) * np.sin(theta), np.cos(theta), np.sin(phi) * np.sin(theta)], -1)
    return light_from(d).astype(np.float32)


def light_from(d):
    sides = [((1, 0, 0), (0.5, 0.1, 0.1)), ((-1, 0, 0), (0.1, 0.4, 0.4)), ((0, 0, 1), (0.1, 0.4, 0.1)), ((0, 0, -1), (0.4, 0.1, 0.4)), ((0, 1, 0), (0.3, 0.5, 0.9)), ((0, -1, 0), (0.15, 0.12, 0.1))]
    image = np.full(d.shape, 0.05)
    for axis, color in sides:
        image += np.maximum(d @ np.array(axis, float), 0)[..., None] ** 2 * color
    sun = np.array([0.5, 0.7, 0.6]) / np.linalg.norm([0.5, 0.7, 0.6])
    image += 12 * np.exp(60 * (d @ sun - 1))[..., None] * [1, 0.9, 0.7]
    return image


def ours(a, path, exr, map_file):
    light = {
        "white": ["--background-color", "1,1,1"],
        "map": ["--hdri-file", str(map_file)],
        "own": ["--sky", "off"],
    }[a.light]
    run = [a.bspray, "render", str(path), "-o", str(exr), "--resolution", f"{WIDTH}x{HEIGHT}", "--spp", str(a.spp), "--filter", "box"]
    run += ["--max-depth", str(DEPTH), "--threads", str(a.threads), "--json", "--quiet", *light, *a.camera]
    began = time.perf_counter()
    done = subprocess.run(run, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(run)}\n{done.stderr}")
    report = json.loads(done.stdout)
    bitmap = mi.Bitmap(str(exr))
    names = [f.name for f in bitmap.struct_()]
    layers = np.array(bitmap)
    at = lambda name: layers[..., names.index(name)]
    seconds = time.perf_counter() - began
    # bspray's files leave the sky behind the surfaces to whoever lays them over it.
    alpha = at("A")[..., None]
    picture = np.stack([at(c) for c in "RGB"], -1) + (1 - alpha) * background(a, report["camera"])
    return picture.astype(np.float32), alpha[..., 0] > 0, report, seconds


def flag(camera, name):
    words = camera.split()
    return np.array([float(x) for x in words[words.index(name) + 1].split(",")])


def background(a, camera):
    """The light behind the pixels' centres."""
    if a.light != "map":
        return 1.0 if a.light == "white" else 0.0
    eye, target, up = (flag(camera, f"--camera-{name}") for name in ("position", "focal-point", "view-up"))
    forward = models.unit(target - eye)
    right = models.unit(np.cross(forward, up))
    half = np.tan(np.radians(flag(camera, "--camera-view-angle")[0]) / 2)
    x, y = np.meshgrid((np.arange(WIDTH) + 0.5) * 2 - WIDTH, HEIGHT - (np.arange(HEIGHT) + 0.5) * 2)
    d = models.unit(forward + half / HEIGHT * (x[..., None] * right + y[..., None] * np.cross(right, forward)))
    return light_from(d)


def texture_of(slot):
    wrap = {"repeat": dr.WrapMode.Repeat, "clamp": dr.WrapMode.Clamp, "mirror": dr.WrapMode.Mirror}[slot.wrap]
    mode = dr.FilterMode.Nearest if slot.nearest else dr.FilterMode.Linear
    return mi.Texture2f(mi.TensorXf(slot.image), filter_mode=mode, wrap_mode=wrap)


def bitmap_of(slot, image):
    wrap = {"repeat": "repeat", "clamp": "clamp", "mirror": "mirror"}[slot.wrap]
    to_uv = mi.ScalarTransform3f(np.vstack([slot.matrix, [0, 0, 1]]))
    bitmap = mi.Bitmap(np.ascontiguousarray(image, np.float32))
    return {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": wrap, "to_uv": to_uv, "filter_type": "nearest" if slot.nearest else "bilinear"}


def channel(m, name, index, factor, change=lambda x: x):
    """A number of a material, textured or not, for a BSDF of Mitsuba's own."""
    if name not in m.slots:
        return float(change(np.float32(factor)))
    slot = m.slots[name]
    return bitmap_of(slot, change(slot.image[..., index:index + 1] * factor))


def base_of(m):
    if "base_color" in m.slots:
        slot = m.slots["base_color"]
        return bitmap_of(slot, slot.image[..., :3] * np.array(m.base_color[:3], np.float32))
    return {"type": "rgb", "value": list(m.base_color[:3])}


def bsdf_of(m, a):
    if m.is_solid and m.transmission > 0:
        # The specification's refraction is Walter's, as Mitsuba's: its own plugin does it. Base colour tints each passage.
        alpha = channel(m, "metallic_roughness", 1, m.roughness, lambda r: np.maximum(r, 0.04) ** 2)
        return {"type": "roughdielectric", "distribution": "ggx", "int_ior": max(m.ior, 1.0005), "ext_ior": 1.0, "alpha": alpha, "specular_transmittance": base_of(m)}
    if a.model == "principled":
        inner = {"type": "principled", "base_color": base_of(m), "metallic": channel(m, "metallic_roughness", 2, m.metallic), "roughness": channel(m, "metallic_roughness", 1, m.roughness)}
        if m.coat:
            inner |= {"clearcoat": m.coat, "clearcoat_gloss": 1 - m.coat_roughness}
        inner = {"type": "twosided", "inside": inner}
        if "normal" in m.slots:
            slot = m.slots["normal"]
            inner = {"type": "normalmap", "normalmap": bitmap_of(slot, slot.image[..., :3]), "inside": inner}
        return inner
    for slot in m.slots.values():
        slot.texture = texture_of(slot)
    gltf_bsdf.MATERIALS.append(m)
    return {"type": "gltf", "material": len(gltf_bsdf.MATERIALS) - 1}


def emitter_of(m):
    if not any(m.emissive):
        return None
    if "emissive" in m.slots:
        slot = m.slots["emissive"]
        return {"type": "area", "radiance": bitmap_of(slot, slot.image[..., :3] * np.array(m.emissive, np.float32))}
    return {"type": "area", "radiance": {"type": "rgb", "value": list(m.emissive)}}


def mesh_of(p, m, bsdf, index):
    props = mi.Properties()
    props["bsdf"] = bsdf
    emitter = emitter_of(m)
    if emitter:
        props["emitter"] = mi.load_dict(emitter)
    if p.normals is None:
        props["face_normals"] = True
    mesh = mi.Mesh(f"part{index}", len(p.positions), len(p.triangles), props=props, has_vertex_normals=p.normals is not None, has_vertex_texcoords=bool(p.uvs))
    flat = lambda x: np.ascontiguousarray(x, np.float32).ravel()
    at = mi.traverse(mesh)
    at["vertex_positions"] = flat(p.positions)
    at["faces"] = p.triangles.astype(np.uint32).ravel()
    if p.normals is not None:
        at["vertex_normals"] = flat(p.normals)
    if p.uvs:
        at["vertex_texcoords"] = flat(p.uvs[0])
    at.update()
    if "normal" in m.slots and p.uvs:
        tangents = p.tangents if p.tangents is not None else models.made_tangents(p, p.uvs[m.slots["normal"].uv_set])
        mesh.add_attribute("vertex_tangent", 3, flat(tangents[:, :3]))
        mesh.add_attribute("vertex_side", 1, flat(tangents[:, 3]))
    if m.vertex_color:
        mesh.add_attribute("vertex_color", 3, flat(p.colors[:, :3]))
    if len(p.uvs) > 1:
        mesh.add_attribute("vertex_second", 3, flat(np.pad(p.uvs[1], ((0, 0), (0, 1)))))
    return mesh


def back_of(p, size):
    """Mitsuba's lights shine from their fronts: the same with its triangles turned over, a hair behind them."""
    points = p.positions[p.triangles]
    normals = models.unit(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]))
    corners = (points - normals[:, None] * 1e-5 * size)[:, [0, 2, 1]]
    return models.Primitive(corners.reshape(-1, 3), np.arange(corners.shape[0] * 3, dtype=np.uint32).reshape(-1, 3), p.material)


def theirs(a, path, camera):
    gltf_bsdf.MATERIALS.clear()
    gltf_bsdf.use(gltf_bsdf.Model.CONSERVING if a.model == "conserving" else gltf_bsdf.Model.SPECIFICATION)
    gltf_bsdf.HAS_TERMINATOR = a.terminator
    parts, materials = models.read(path)
    for m in materials:
        m.vertex_color = False
    for p in parts:
        materials[p.material].vertex_color = p.colors is not None
    if a.light == "white":
        light = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}
    elif a.light == "map":
        light = {"type": "envmap", "bitmap": mi.Bitmap(np.roll(light_map(), -256, 1))}
    else:
        light = None
    scene = {
        "type": "scene",
        "sensor": {
            "type": "perspective", "fov": float(flag(camera, "--camera-view-angle")[0]), "fov_axis": "y", "near_clip": 1e-5, "far_clip": 1e5,
            "to_world": mi.ScalarTransform4f().look_at(origin=flag(camera, "--camera-position").tolist(), target=flag(camera, "--camera-focal-point").tolist(), up=flag(camera, "--camera-view-up").tolist()),
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"},
            "sampler": {"type": "multijitter"},
        },
    }
    if light:
        scene["light"] = light
    bsdfs = {}
    size = np.ptp(np.concatenate([p.positions for p in parts]), 0).max()
    for i, p in enumerate(parts):
        m = materials[p.material]
        if p.material not in bsdfs:
            bsdfs[p.material] = mi.load_dict(bsdf_of(m, a))
        scene[f"part{i}"] = mesh_of(p, m, bsdfs[p.material], i)
        if m.double_sided and any(m.emissive):
            scene[f"part{i}-back"] = mesh_of(back_of(p, size), m, bsdfs[p.material], f"{i}-back")
    began = time.perf_counter()
    scene = mi.load_dict(scene)
    integrator = mi.load_dict({"type": "path", "max_depth": DEPTH + 1, "rr_depth": 100})
    total = np.zeros((HEIGHT, WIDTH, 3), np.float64)
    passes = -(-a.spp // PASS)
    for seed in range(passes * a.more):
        total += np.array(mi.render(scene, integrator=integrator, spp=min(PASS, a.spp), seed=seed))
        if seed + 1 == passes:
            seconds = time.perf_counter() - began
    return (total / (passes * a.more)).astype(np.float32), seconds


def display(linear, exposure):
    x = np.clip(np.nan_to_num(linear * 2**exposure), 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055).astype(np.float32)


def compare(a, path):
    path = Path(path)
    name = f"{path.stem}-{a.light}-{a.model}" + ("-terminator" if a.terminator else "")
    map_file = a.out / "map.exr"
    if not map_file.exists():
        mi.Bitmap(light_map()).write(str(map_file))
    mine, is_model, report, seconds = ours(a, path, a.out / f"{name}.exr", map_file)
    reference, their_seconds = theirs(a, path, report["camera"])
    mi.Bitmap(reference).write(str(a.out / f"{name}-mitsuba.exr"))
    x, y = display(mine, a.exposure), display(reference, a.exposure)
    error, mean, _ = flip_evaluator.evaluate(y, x, "LDR", applyMagma=False)
    error = np.asarray(error).reshape(HEIGHT, WIDTH)
    shown = flip_evaluator.evaluate(y, x, "LDR", applyMagma=True)[0]
    side = np.concatenate([x, y, np.asarray(shown).reshape(HEIGHT, WIDTH, 3)], 1)
    Image.fromarray((np.clip(side, 0, 1) * 255 + 0.5).astype(np.uint8)).save(a.out / f"{name}.png")
    ratio = mine[is_model].mean() / reference[is_model].mean()
    bad = int((~np.isfinite(reference)).sum())
    render = report.get("seconds", {}).get("render", seconds)
    print(f"| {path.stem} | {a.light} | {a.model}{', terminator' if a.terminator else ''} | {mean:.4f} | {error[is_model].mean():.4f} | {ratio:.4f} | {render:.1f} | {their_seconds:.1f} |" + (f" {bad} NaN" if bad else ""), flush=True)


def main():
    a = arguments()
    a.out.mkdir(parents=True, exist_ok=True)
    dr.set_thread_count(a.threads)
    mi.register_bsdf("gltf", gltf_bsdf.Gltf)
    for path in a.models:
        compare(a, path)


if __name__ == "__main__":
    main()
