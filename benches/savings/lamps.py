#!/usr/bin/env python3
"""Makes a house of many rooms, each with a lamp of its own: `lamps.py SIDE OUT.glb`.

SIDE by SIDE rooms of 4 by 4 units, 3 high, with doors in all inner walls, a table in each, and a square lamp that hangs in each, of eight colours and powers. A camera in a room sees
some others through the doors. Two triangles a lamp send light, so that 20 by 20 rooms have 800.
"""
import json
import struct
import sys
from pathlib import Path

ROOM, HEIGHT, DOOR, LINTEL = 4.0, 3.0, 1.2, 2.2
PLASTER, WOOD = 0, 1
LAMPS = [(12, 9, 6), (6, 6, 7), (20, 14, 8), (3, 4, 6), (9, 3, 2), (2, 5, 9), (15, 15, 13), (5, 8, 3)]


def quad(a, b, c, d):
    return [a, b, c, a, c, d]


def wall(along, at, start, end, low, high):
    """A wall along x (0) or z (1), at a place of the other axis."""
    point = lambda t, y: (t, y, at) if along == 0 else (at, y, t)
    return quad(point(start, low), point(end, low), point(end, high), point(start, high))


def house(side):
    length = side * ROOM
    parts = {PLASTER: [], WOOD: []}
    for y in (0.0, HEIGHT):
        parts[PLASTER] += quad((0, y, 0), (length, y, 0), (length, y, length), (0, y, length))
    for along in (0, 1):
        for line in range(side + 1):
            at = line * ROOM
            if line in (0, side):
                parts[PLASTER] += wall(along, at, 0, length, 0, HEIGHT)
                continue
            for room in range(side):
                start, middle = room * ROOM, (room + 0.5) * ROOM
                parts[PLASTER] += wall(along, at, start, middle - DOOR / 2, 0, HEIGHT)
                parts[PLASTER] += wall(along, at, middle + DOOR / 2, start + ROOM, 0, HEIGHT)
                parts[PLASTER] += wall(along, at, middle - DOOR / 2, middle + DOOR / 2, LINTEL, HEIGHT)
    for i in range(side * side):
        x, z = i % side * ROOM + 0.6, i // side * ROOM + 0.6
        parts[WOOD] += quad((x, 0.8, z), (x + 0.9, 0.8, z), (x + 0.9, 0.8, z + 0.9), (x, 0.8, z + 0.9))
        # Number by number, so that neighbours differ.
        lamp = 2 + (i * 5 + i // side * 3) % len(LAMPS)
        x, z, y = x + 1.2, z + 1.2, HEIGHT - 0.8
        parts.setdefault(lamp, []).extend(quad((x, y, z), (x + 0.4, y, z), (x + 0.4, y, z + 0.4), (x, y, z + 0.4)))
    return parts


def write(parts, output):
    data, primitives, views, accessors = b"", [], [], []
    for material, corners in sorted(parts.items()):
        body = b"".join(struct.pack("<3f", *corner) for corner in corners)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(body)})
        low, high = ([f(c[k] for c in corners) for k in range(3)] for f in (min, max))
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": len(corners), "type": "VEC3", "min": low, "max": high})
        primitives.append({"attributes": {"POSITION": len(accessors) - 1}, "material": material})
        data += body
    plain = lambda color: {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0}, "doubleSided": True}
    lamp = lambda color: {**plain((0, 0, 0)), "emissiveFactor": [c / max(color) for c in color], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": max(color)}}}
    document = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "materials": [plain((0.7, 0.7, 0.68)), plain((0.45, 0.3, 0.2)), *map(lamp, LAMPS)],
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    Path(output).write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    write(house(int(sys.argv[1])), sys.argv[2])
