"""Has POV-Ray make the shadow mask of a frame that `gnomon export` wrote.

usage: python3 pov_mask.py FOLDER LIGHT MASK.pgm
FOLDER is what `gnomon export --out` wrote, LIGHT the name of a point, spot or directional light in it. The mask is white where POV-Ray
sees light, black in shadow, on surfaces turned away and on the background. Where casters let a part of the light through it is that part,
in 16 bits. Prints the seconds that POV-Ray took.
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


def main(folder, name, mask):
    frame, scene = (json.loads((folder / file).read_text()) for file in ("frame.json", "scene.json"))
    light = next((light for light in frame["lights"] if light["name"] == name), None)
    if not light:
        sys.exit(f"light = {name} is not in {folder}; it has: {', '.join(light['name'] for light in frame['lights'])}")
    arrays = {name: np.load(folder / array["file"]) for name, array in scene["arrays"].items()}
    corners = arrays["position"].astype(float)[arrays["triangle"]]
    width, height = frame["width"], frame["height"]
    with tempfile.TemporaryDirectory() as place:
        textures = (arrays.get(name) for name in ("alpha_mask_bits", "transmission_values"))
        holes = Holes(*textures, arrays["uv"][arrays["triangle"]], place) if "uv" in arrays else None
        text = (SETTINGS + camera(frame["view"], width, height) + light_source(light, corners) +
                meshes_text(scene["meshes"], corners, frame["truth"] == "shape", holes))
        lit = render(text, width, height, place, os.cpu_count())
    has_glass = any(mesh["casts"] and mesh.get("transmission") for mesh in scene["meshes"])
    most, kind, share = (65535, ">u2", lit.picture) if has_glass else (255, "u1", lit.picture >= 0.5)
    mask.write_bytes(b"P5 %d %d %d\n" % (width, height, most) + np.rint(most * share).astype(kind).tobytes())
    print(f"{lit.trace_ms / 1000:.2f} s")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__.strip())
    main(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
