"""Has POV-Ray make the shadow mask of a frame that `gnomon export` wrote.

usage: python3 pov_mask.py FOLDER LIGHT MASK
FOLDER is what `gnomon export --out` wrote, LIGHT the name of a point, spot or directional light in it. The mask is white where POV-Ray
sees light, black in shadow, on surfaces turned away and on the background. Where casters let a part of the light through it is that part,
in 16 bits; where that part is of another size for red, green and blue, the mask is a picture of three colors (PPM), and POV-Ray renders
each. Prints the seconds that POV-Ray took.
Needs numpy and POV-Ray 3.7 (Debian: python3-numpy, povray), and pov_scene.py and pov_holes.py beside it.
"""

import json
import os
import sys
import tempfile
from pathlib import Path

import numpy as np
from pov_holes import Holes
from pov_scene import SETTINGS, camera, light_source, meshes_text, render


def channels_of(meshes):
    """How many colors the glass that casts tells apart: 1 or 3."""
    return max((mesh["transmission"]["channels"] for mesh in meshes if mesh["casts"] and mesh.get("transmission")), default=1)


def in_channel(meshes, values, channel):
    """The meshes and the numbers of their transmissions in one channel, as of gray glass."""
    taken, firsts, count = [np.zeros(0, np.float32)], {}, 0
    changed = []
    for mesh in meshes:
        glass = mesh.get("transmission")
        if glass:
            first, channels, texels = glass["first_value"], glass["channels"], glass["width"] * glass["height"]
            if first not in firsts:  # meshes share a transmission
                firsts[first] = count
                taken.append(values[first:first + channels * texels][min(channel, channels - 1)::channels])
                count += texels
            mesh = mesh | {"transmission": glass | {"channels": 1, "first_value": firsts[first]}}
        changed.append(mesh)
    return changed, np.concatenate(taken)


def main(folder, name, mask):
    frame, scene = (json.loads((folder / file).read_text()) for file in ("frame.json", "scene.json"))
    light = next((light for light in frame["lights"] if light["name"] == name), None)
    if not light:
        sys.exit(f"light = {name} is not in {folder}; it has: {', '.join(light['name'] for light in frame['lights'])}")
    arrays = {name: np.load(folder / array["file"]) for name, array in scene["arrays"].items()}
    corners = arrays["position"].astype(float)[arrays["triangle"]]
    width, height = frame["width"], frame["height"]
    pictures, seconds = [], 0
    for channel in range(channels_of(scene["meshes"])):
        meshes, values = in_channel(scene["meshes"], arrays.get("transmission_values", np.zeros(0, np.float32)), channel)
        with tempfile.TemporaryDirectory() as place:
            holes = Holes(arrays.get("alpha_mask_bits"), values, arrays["uv"][arrays["triangle"]], place) if "uv" in arrays else None
            text = (SETTINGS + camera(frame["view"], width, height) + light_source(light, corners) +
                    meshes_text(meshes, corners, frame["truth"] == "shape", holes))
            lit = render(text, width, height, place, os.cpu_count())
        pictures.append(lit.picture)
        seconds += lit.trace_ms / 1000
    has_glass = any(mesh["casts"] and mesh.get("transmission") for mesh in scene["meshes"])
    share = np.stack(pictures, axis=-1)
    most, kind, share = (65535, ">u2", share) if has_glass else (255, "u1", share >= 0.5)
    magic = b"P6" if len(pictures) == 3 else b"P5"
    mask.write_bytes(magic + b" %d %d %d\n" % (width, height, most) + np.rint(most * share).astype(kind).tobytes())
    print(f"{seconds:.2f} s")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__.strip())
    main(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
