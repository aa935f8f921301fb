"""Scenes of Gnomon as text for POV-Ray, and the pictures that it renders of them.

Everything is white and reflects without a cosine (brilliance 0), so the brightness of a pixel is the share of the light that it sees:
the picture is the mask. Needs numpy and POV-Ray 3.7.
"""

import re
import subprocess
from collections import namedtuple
from pathlib import Path

import numpy as np
from pov_holes import SETTINGS as HOLES
from pov_holes import have_area, textures

# POV-Ray ignores casters nearer than 1e-3 of its units to the lit point, or behind a hole: 10 micrometers, where a meter is 100 units.
SCALE = 100
SETTINGS = """#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 1 }
background { rgb 0 }
#default { texture { pigment { rgb 1 } finish { ambient 0 emission 0 diffuse 1 brilliance 0 phong 0 specular 0 } } }
"""
Rendering = namedtuple("Rendering", "picture trace_ms parse_ms shadow_rays")  # brightness, height x width, 0 .. 1


def numbers(values):
    """As the scene has them: float32, whose shortest decimals JSON shows."""
    return np.asarray(values, np.float32).astype(float)


def vector(v):
    return "<" + ", ".join(f"{x:.17g}" for x in v) + ">"


def place(point):
    return vector(SCALE * numbers(point))


def length(value):
    return f"{SCALE * float(np.float32(value)):.17g}"


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


def light_source(light, corners, grid=1, shadows=True):
    """Of a rectangle, a grid of points, each in the middle of its share (grid_points): POV-Ray puts the outer ones on the ends of
    the axes that it is given, so these are shorter than the sides. A pixel's
    brightness is the share of points that nothing hides times the share of points above its horizon."""
    end = " rgb 1 " + ("" if shadows else "shadowless ")
    if light["kind"] in ("point", "spot"):
        return f"light_source {{ {place(light['position'])}{end}}}\n"
    if light["kind"] == "rect":
        sides = [vector(2 * SCALE * (grid - 1) / grid * numbers(light[half])) for half in ("half_u", "half_v")]
        area = f"area_light {', '.join(sides)}, {grid}, {grid} area_illumination on " if grid > 1 else ""
        return f"light_source {{ {place(light['center'])}{end}{area}}}\n"
    if light["kind"] != "directional":
        raise ValueError(f"light {light['name']} is a {light['kind']} light; one of point, spot, directional, rect is required")
    low, high = corners.min((0, 1)), corners.max((0, 1))  # it shines from its plane on, which must lie outside the scene
    way = numbers(light["direction"])
    middle, far = (low + high) / 2, 10 * np.linalg.norm(high - low) / np.linalg.norm(way)
    return f"light_source {{ {vector(SCALE * (middle - far * way))}{end}parallel point_at {vector(SCALE * middle)} }}\n"


def grid_points(light, grid):
    """Of a rectangle's grid, points x 3, in meters."""
    along = (np.arange(grid) + 0.5) / grid * 2 - 1
    u, v = (along[:, None] * numbers(light[half]) for half in ("half_u", "half_v"))
    return numbers(light["center"]) + (u[:, None] + v[None]).reshape(-1, 3)


def curved_text(shape):
    """Of a shape that POV-Ray has exactly; None for others."""
    if shape["kind"] == "sphere":
        return f"sphere {{ {place(shape['center'])}, {length(shape['radius'])}"
    if shape["kind"] == "disc":
        return f"disc {{ {place(shape['center'])}, {vector(numbers(shape['normal']))}, {length(shape['radius'])}"
    if shape["kind"] == "cone":
        axis, base = numbers(shape["axis"]), numbers(shape["base"])
        peak = base + numbers(shape["height"]) * axis / np.linalg.norm(axis)
        return f"cone {{ {vector(SCALE * base)}, {length(shape['radius'])}, {vector(SCALE * peak)}, 0"
    return None


def mesh_text(mesh, corners, curved, holes=None):
    """Loose triangles, because POV-Ray keeps them in double, but those of a mesh2 in float. `holes`: a pov_holes.Holes for meshes with
    an alpha mask or a transmission. Glass that is seen is there twice: once for the eye, which it stops, and once for the light."""
    seen = mesh.get("seen", True)
    if mesh.get("transmission") and seen:
        parts = [mesh | {"transmission": None, "casts": False}, mesh | {"seen": False}] if mesh["casts"] else [mesh | {"transmission": None}]
        return "".join(mesh_text(part, corners, curved, holes) for part in parts)
    if not seen and not mesh["casts"]:
        return ""
    end = ("" if mesh["casts"] else " no_shadow") + ("" if seen else " no_image") + " }\n"
    shape = curved_text(mesh["shape"]) if curved and mesh["shape"] and not textures(mesh) else None
    if shape:
        return shape + end
    first = mesh["first_triangle"]
    some = SCALE * corners[first:first + mesh["triangles"]]
    if textures(mesh):
        return holes.triangles(mesh, some, vector, end)
    return "".join("triangle { " + ", ".join(map(vector, t)) + end for t in some[have_area(some)])


def meshes_text(meshes, corners, curved, holes=None):
    return (HOLES if holes else "") + "".join(mesh_text(mesh, corners, curved, holes) for mesh in meshes)


def pixels_of(picture, width, height, asked):
    """Of a PPM of 16 bits its green, height x width, 0 .. 1; RuntimeError where it is not there, older than `asked`, or of another size."""
    if not picture.is_file():
        raise RuntimeError("povray says that it rendered, but wrote no picture")
    if picture.stat().st_mtime_ns < asked:
        raise RuntimeError("povray's picture is older than its scene")
    data = picture.read_bytes()
    head = re.match(rb"P6(?:\s|#.*\n)+(\d+)\s+(\d+)(?:\s|#.*\n)+65535\s", data)
    if not head or (int(head[1]), int(head[2]), len(data) - head.end()) != (width, height, 6 * width * height):
        begins = data[:20].decode(errors="replace")
        raise RuntimeError(f"povray's picture has {len(data)} bytes and begins with {begins!r}; a PPM of {width} x {height} and 16 bits is wanted")
    return np.frombuffer(data, ">u2", offset=head.end()).reshape(height, width, 3)[:, :, 1] / 65535


def started(arguments, folder):
    """Runs povray in a folder: its exit status and all that it printed. On a busy machine povray may give up before it has read a
    word, because its threads start late; then it is started again, up to nine times."""
    for _ in range(10):
        done = subprocess.run(["povray", *arguments], cwd=folder, capture_output=True, stdin=subprocess.DEVNULL, text=True,
                              errors="replace", check=False)
        said = done.stdout + done.stderr
        if not done.returncode or "Timed out waiting for worker thread startup" not in said:
            break
    return done.returncode, said


def render(text, width, height, folder, threads):
    """Renders a scene in a folder, a ray through the center of each pixel. The folder may have any name: povray, which reads much into
    the names that it is given, is given none of it."""
    scene, picture = Path(folder, "scene.pov"), Path(folder, "scene.ppm")
    picture.unlink(missing_ok=True)  # that of the render before
    scene.write_text(text)
    options = ["+FP16", f"+W{width}", f"+H{height}", f"+WT{threads}", "-A", "-D", "File_Gamma=1", "-GD", "-GR", "-GW"]
    status, said = started([f"+I{scene.name}", f"+O{picture.name}", *options], folder)
    if status:
        lines = [line.strip() for line in said.splitlines() if line.strip()]
        why = next((line for line in lines if "rror" in line), lines[-1] if lines else "it said nothing")
        raise RuntimeError(f"povray ended with {status}: {why}")
    seconds = dict(re.findall(r"(Parse|Trace) Time:.*\(([0-9.]+) seconds\)", said))
    if set(seconds) != {"Parse", "Trace"}:
        raise RuntimeError("povray says no times; the adapter is made for version 3.7")
    rays = re.search(r"Shadow Ray Tests: +([0-9]+)", said)
    brightness = pixels_of(picture, width, height, scene.stat().st_mtime_ns)
    return Rendering(brightness, 1000 * float(seconds["Trace"]), 1000 * float(seconds["Parse"]), int(rays[1]) if rays else 0)
