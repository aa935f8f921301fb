"""Blender as a child of an adapter, for Gnomon: what adapters of its renderers share. See docs/engines.md."""

import numpy as np
from gnomon_engine import Awaited, Camera, Child, require_version

HARD = ("point", "spot", "directional")


def start_blender(script, folder, threads, **environment):
    """A process of Blender that runs a script, without a window, and its version; RuntimeError unless that is the adapters'."""
    child = Child("Blender", ["blender", "-b", "--factory-startup", "-noaudio", "--python", str(script)], **environment)
    version = child.ask(do="start", folder=folder, threads=threads)["version"]
    require_version("Blender", version, "3.4")
    return child, version


def basis(right, up, back, place):
    """The matrix of a camera or light that looks along -z, with y up."""
    return [[*row, where] for row, where in zip(np.column_stack((right, up, back)).tolist(), place)] + [[0, 0, 0, 1]]


def looking(way, place):
    """The same for a light that shines along `way`."""
    back = -np.asarray(way, float) / np.linalg.norm(way)
    right = np.cross(np.eye(3)[np.argmin(np.abs(back))], back)
    right /= np.linalg.norm(right)
    return basis(right, np.cross(back, right), back, place)


def lamp_of(light, intensity):
    """Of a light of this intensity what relight of Blender's side takes; a spot is a point.

    Blender's watts: a lamp without area sends P / (4 pi) W/sr, one with area has the radiance P / (4 A), and a sun's are W/m2.
    """
    kind, size, sides, power = "POINT", (0, 0), 1, 4 * np.pi * intensity
    if light.kind == "directional":
        kind, power, matrix = "SUN", intensity, looking(light.direction, (0, 0, 0))
    elif light.kind in HARD:
        matrix = looking((0, -1, 0), light.position)
    else:
        kind, sides = "AREA", 1 if light.one_sided else 2
        if light.kind == "disc":
            matrix, size = looking(light.normal, light.center), (2 * light.radius, None)
            power = 4 * np.pi * light.radius**2 * intensity
        else:  # it shines along half_u x half_v
            u, v = np.linalg.norm(light.half_u), np.linalg.norm(light.half_v)
            back = -np.cross(light.half_u, light.half_v) / (u * v)
            matrix, size = basis(-light.half_u / u, light.half_v / v, back, light.center), (2 * u, 2 * v)
            power = 4 * 4 * u * v * intensity
    return {"kind": kind, "power": float(power), "matrix": matrix, "size": size, "sides": sides}


def look_of(gbuffer, corners):
    """Of a G-buffer's view, with planes that hold all corners, what look() of Blender's side takes."""
    c = Camera(gbuffer.view, gbuffer.width, gbuffer.height, corners)
    return {"matrix": basis(c.right, c.up, -c.forward, c.eye), "fov_y": float(np.radians(c.fov_y_degrees)),
            "near": c.near, "far": c.far, "width": gbuffer.width, "height": gbuffer.height}


def rendered(technique, gbuffer, **request):
    """The picture that `technique.blender` renders of a view, height x width doubles, and its answer."""
    picture = Awaited(technique.folder, "frame.npy")
    done = technique.blender.ask(do="frame", **look_of(gbuffer, technique.corners), out=str(picture.path), **request)
    pixels = np.load(picture.taken()).astype(float)
    if pixels.shape != (gbuffer.height, gbuffer.width):
        raise RuntimeError(f"Blender's picture has the shape {pixels.shape}; {(gbuffer.height, gbuffer.width)} is required")
    return pixels, done
