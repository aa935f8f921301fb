"""Has POV-Ray make the shadow mask of a frame that `gnomon export` wrote.

usage: python3 pov_mask.py FOLDER LIGHT MASK.pgm
FOLDER is what `gnomon export --out` wrote, LIGHT the name of a point or directional light in it. The mask is white where POV-Ray
sees light, black in shadow, on surfaces turned away and on the background. Prints the seconds that POV-Ray took.
Needs numpy and POV-Ray 3.7 (Debian: python3-numpy, povray).
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SCALE = 100  # POV-Ray ignores blockers nearer than 1e-3 of its units to the lit point: 10 micrometers, where a meter is 100 units
SETTINGS = """#version 3.7;
global_settings { assumed_gamma 1 }
background { rgb 0 }
#default { texture { pigment { rgb 1 } finish { ambient 0 emission 0 diffuse 1 } } }
"""  # all is white and nothing glows; lights are so bright that the least of their light saturates a pixel


def numbers(values):
    """As the scene has them: float32, whose shortest decimals JSON shows."""
    return np.asarray(values, np.float32).astype(float)


def vector(v):
    return "<" + ", ".join(f"{x:.17g}" for x in v) + ">"


def camera(view, width, height):
    """POV-Ray keeps direction, right and up as they are where there is no look_at, so its left-handed world mirrors nothing."""
    eye, up = numbers(view["eye"]), numbers(view["up"])
    forward = numbers(view["target"]) - eye
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    tall = 2 * np.tan(np.radians(numbers(view["fov_y_degrees"])) / 2)
    up = np.cross(right, forward) * tall
    right *= tall * width / height
    return f"camera {{ perspective location {vector(SCALE * eye)} right {vector(right)} up {vector(up)} direction {vector(forward)} }}\n"


def light_source(light, corners):
    if light["kind"] == "point":
        return f"light_source {{ {vector(SCALE * numbers(light['position']))} rgb 1e9 }}\n"
    if light["kind"] != "directional":
        sys.exit(f"light {light['name']} is a {light['kind']} light; a mask of black and white needs a point or directional light")
    low, high = corners.min((0, 1)), corners.max((0, 1))  # it shines from its plane on, which must lie outside the scene
    way = numbers(light["direction"])
    middle, far = (low + high) / 2, 10 * np.linalg.norm(high - low) / np.linalg.norm(way)
    return f"light_source {{ {vector(SCALE * (middle - far * way))} rgb 1e9 parallel point_at {vector(SCALE * middle)} }}\n"


def mesh_text(mesh, corners, curved):
    """Loose triangles, because POV-Ray keeps them in double, but those of a mesh2 in float."""
    end = " }\n" if mesh["casts"] else " no_shadow }\n"
    kind = mesh["shape"]["kind"] if curved and mesh["shape"] else "plane"
    if kind == "sphere":
        return f"sphere {{ {vector(SCALE * numbers(mesh['shape']['center']))}, {SCALE * numbers(mesh['shape']['radius']):.17g}{end}"
    if kind not in ("plane", "box"):
        sys.exit(f"mesh {mesh['name']} is a {kind}: export it as triangles, with --truth mesh")
    first = mesh["first_triangle"]
    return "".join("triangle { " + ", ".join(map(vector, SCALE * t)) + end for t in corners[first:first + mesh["triangles"]])


def pov_text(folder, frame, light):
    scene = json.loads((folder / "scene.json").read_text())
    arrays = {name: np.load(folder / array["file"]) for name, array in scene["arrays"].items()}
    corners = arrays["position"].astype(float)[arrays["triangle"]]
    return (SETTINGS + camera(frame["view"], frame["width"], frame["height"]) + light_source(light, corners) +
            "".join(mesh_text(mesh, corners, frame["truth"] == "shape") for mesh in scene["meshes"]))


def picture(text, width, height):
    """The green channel of what POV-Ray renders, a ray through the center of each pixel, and the seconds it took."""
    with tempfile.TemporaryDirectory() as place:
        Path(place, "scene.pov").write_text(text)
        start = time.monotonic()
        done = subprocess.run(["povray", "+Iscene.pov", "+Oscene.ppm", "+FP", f"+W{width}", f"+H{height}", "-A", "-D", "-GA"],
                              cwd=place, capture_output=True, stdin=subprocess.DEVNULL, text=True, check=False)
        seconds = time.monotonic() - start
        if done.returncode:
            sys.exit(f"povray ended with {done.returncode}\n{done.stderr}")
        pixels = Path(place, "scene.ppm").read_bytes()[-3 * width * height:]  # behind a header of varying length
    return np.frombuffer(pixels, "u1").reshape(height, width, 3)[:, :, 1], seconds


def main(folder, name, mask):
    frame = json.loads((folder / "frame.json").read_text())
    light = next((light for light in frame["lights"] if light["name"] == name), None)
    if not light:
        sys.exit(f"light = {name} is not in {folder}; it has: {', '.join(light['name'] for light in frame['lights'])}")
    width, height = frame["width"], frame["height"]
    lit, seconds = picture(pov_text(folder, frame, light), width, height)
    mask.write_bytes(b"P5 %d %d 255\n" % (width, height) + np.where(lit >= 128, 255, 0).astype("u1").tobytes())
    print(f"{seconds:.2f} s")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__.strip())
    main(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
