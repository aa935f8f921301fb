"""Engines that draw frames as shadow techniques, for Gnomon: what adapters of rasterizing engines share. See docs/engines.md.

An engine gives no mask, but pictures. Every surface is white and nothing but the light shines; the mask is the ratio of the frame with shadows to the frame without. The time of a resolve is
that of the frame with shadows, as the engine's user waits for it; the counts `plain_frame` and `frame_difference` have that of the frame without and what the two differ by.
"""

import atexit
import ctypes
import json
import os
import re
import select
import signal
import subprocess
import time
from pathlib import Path
from statistics import median

import numpy as np
from gnomon_technique import Technique

_END_WITH_PARENT = 1  # of prctl: PR_SET_PDEATHSIG
_CLOCK_STEP = 20_000_000  # ns: a file's time may be older than the clock's by a step of the kernel


def _end_with_parent():
    ctypes.CDLL(None).prctl(_END_WITH_PARENT, signal.SIGTERM)  # which lets a server remove its files


def _end(process):
    """Ends a process that this one started, by its id, and waits for its end."""
    if process.poll() is not None:
        return
    process.terminate()
    try:
        process.wait(5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def start_display(patience=20):
    """Starts an X server without a visible screen and returns its name for DISPLAY, ":7". It ends with this process."""
    reader, writer = os.pipe()
    command = ["Xvfb", "-displayfd", str(writer), "-screen", "0", "1920x1080x24", "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(command, pass_fds=[writer], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, preexec_fn=_end_with_parent)  # its last words are no engine's
    atexit.register(_end, server)
    os.close(writer)
    end, said = time.monotonic() + patience, b""
    while not said.endswith(b"\n"):
        is_ready = select.select([reader], [], [], max(0, end - time.monotonic()))[0]
        part = os.read(reader, 64) if is_ready else b""
        if not part:
            raise RuntimeError("Xvfb opened no display" + ("" if is_ready else f" within {patience} s"))
        said += part
    os.close(reader)
    return ":" + said.decode().strip()


class Child:
    """A renderer in a process of its own. It reads lines of JSON on standard input and answers each by one line on the file
    descriptor that the variable GNOMON_ANSWERS names: what it prints cannot come between. It ends with this process."""

    def __init__(self, name, command, **environment):
        self.name = name
        reader, writer = os.pipe()
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=2, pass_fds=[writer], text=True, encoding="utf-8",
                                        preexec_fn=_end_with_parent, env=dict(os.environ, GNOMON_ANSWERS=str(writer), **environment))
        os.close(writer)
        self.answers = os.fdopen(reader, encoding="utf-8")
        atexit.register(_end, self.process)

    def ask(self, **request):
        """The answer to a request; RuntimeError where it has the key "error", is no line of JSON, or the renderer has ended."""
        try:
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass  # the end of its answers shows it
        line = self.answers.readline()
        if not line.endswith("\n"):
            raise RuntimeError(f"{self.name} ended ({self.process.wait()}) when it was to answer {request['do']}")
        try:
            answer = json.loads(line)
        except ValueError:
            raise RuntimeError(f"{self.name} answered {request['do']} with no JSON: {line.strip()[:80]}") from None
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer

    def end(self):
        _end(self.process)


class Awaited:
    """A file that a renderer is to write. An older one is removed, so that an earlier answer is never taken for this one."""

    def __init__(self, folder, name):
        self.path = Path(folder, name)
        self.path.unlink(missing_ok=True)
        self.asked = time.time_ns()

    def taken(self):
        """The path of what was written since; RuntimeError where nothing was, or something older was put there."""
        try:
            written = self.path.stat().st_mtime_ns
        except FileNotFoundError:
            raise RuntimeError(f"no {self.path.name} was written") from None
        if written < self.asked - _CLOCK_STEP:
            raise RuntimeError(f"{self.path.name} is {(self.asked - written) / 1e9:.1f} s older than the request")
        return self.path

    def array(self, kind, height, width):
        """Its numbers of a NumPy kind, height x width; RuntimeError where it is of another size."""
        found, wanted = self.taken().stat().st_size, np.dtype(kind).itemsize * height * width
        if found != wanted:
            raise RuntimeError(f"{self.path.name} has {found} bytes; {wanted} are wanted, of {width} x {height} pixels")
        return np.fromfile(self.path, kind).reshape(height, width)


def require_version(name, found, wanted):
    """RuntimeError unless version `found` is `wanted` or begins with it: (1.12.10, 1.12)."""
    if found != wanted and not found.startswith(wanted + "."):
        raise RuntimeError(f"{name} {found or 'of unknown version'} is here; the adapter is made for {wanted}")


def is_closed(corners):
    """Whether each edge of triangles x 3 x 3, of corners distinguished by their places, is passed once each way."""
    place = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)[1].reshape(-1, 3).astype(np.int64)
    start, end, many = place.ravel(), np.roll(place, -1, axis=1).ravel(), place.max(initial=0) + 1
    passed = np.sort(start * many + end)
    return bool(np.array_equal(passed, np.sort(end * many + start)) and np.all(np.diff(passed) > 0))


class Camera:
    """Of a view: `eye`, unit vectors `right`, `up`, `forward`, `fov_y_degrees`, `aspect`, and planes `near` and `far` that hold all of a scene."""

    def __init__(self, view, width, height, corners):
        self.eye = view.eye
        self.forward = (view.target - view.eye) / np.linalg.norm(view.target - view.eye)
        self.right = np.cross(self.forward, view.up)
        self.right /= np.linalg.norm(self.right)
        self.up = np.cross(self.right, self.forward)
        self.fov_y_degrees, self.aspect = view.fov_y_degrees, width / height
        depth = (corners.reshape(-1, 3) - self.eye) @ self.forward
        self.far = 1.01 * max(depth.max(initial=0), 1e-3)
        ahead = depth[depth > 0]
        self.near = max(0.99 * depth.min(initial=self.far), 1e-3 * self.far) if len(ahead) == depth.size else 1e-3 * self.far


class FramePairs:
    """Frames with shadows and without, drawn next to each other: what shadows cost is what the two of a pair differ by. The order
    alternates, so that neither is always the one that finds the caches warm."""

    def __init__(self):
        self.of = None

    def draw(self, of, frame):
        """The next pair, by `frame(shadows)`, which answers a tuple: its picture, its milliseconds and whatever else. Returns that
        with shadows and that without. `of`: the light, view and size that pairs are of; other ones begin anew."""
        if of != self.of:
            self.of, self.plain_ms, self.difference_ms = of, [], []
        with_first = len(self.plain_ms) % 2 == 0
        drawn = {shadows: frame(shadows) for shadows in (with_first, not with_first)}
        self.plain_ms.append(drawn[False][1])
        self.difference_ms.append(drawn[True][1] - drawn[False][1])
        return drawn[True], drawn[False]

    def counts(self):
        """Medians of all pairs so far; a difference that is lost in the noise is 0."""
        return {"plain_frame": (median(self.plain_ms), "ms"), "frame_difference": (max(0.0, median(self.difference_ms)), "ms")}


def pair_of(light, gbuffer):
    """What a pair of frames is of."""
    return light.name, gbuffer.view.name, gbuffer.width, gbuffer.height


class Engine(Technique):
    """What an adapter of an engine derives from; it gives the methods below that raise NotImplementedError.

    Geometry is `self.corners` (triangles x 3 x 3, float32, world space), `self.casts` and `self.receives` (of each triangle) and
    `self.ranges` (first and end triangle of each mesh); `self.light` is the light.
    """

    needs_display = False  # True: it draws to a window; `self.display` is a name for DISPLAY then

    def start(self):
        """Starts the engine, once, and refuses one of another version."""
        raise NotImplementedError

    def load(self, scene):
        """Takes the geometry."""
        raise NotImplementedError

    def place_light(self, light):
        """Takes the light."""
        raise NotImplementedError

    def frame(self, camera, width, height, shadows):
        """Draws a frame, with shadows or without, and ends it: its brightness, height x width, 0 .. 1 or 0 .. 255, and the
        milliseconds that it took, without reading it back. With shadows all that the engine draws for them counts."""
        raise NotImplementedError

    def file(self, name, array):
        """The name of a file between the adapter and its renderer, filled with an array's numbers."""
        path = Path(self.folder) / f"renderer_{name}"
        np.ascontiguousarray(array).tofile(path)
        return str(path)

    def setup(self):
        self.display = start_display() if self.needs_display else None
        if self.display:
            os.environ.update(DISPLAY=self.display, LIBGL_ALWAYS_SOFTWARE="1")
        self.pairs = FramePairs()
        self.start()

    def build(self, scene):
        self.corners = np.ascontiguousarray(scene.position[scene.triangle], np.float32)
        self.casts = np.array([mesh.casts for mesh in scene.meshes], bool)[scene.mesh]
        self.receives = np.array([mesh.receives for mesh in scene.meshes], bool)[scene.mesh]
        self.scene = scene
        self.ranges = [(mesh.first_triangle, mesh.first_triangle + mesh.triangles) for mesh in scene.meshes]
        self.load(scene)

    def relight(self, light):
        self.light = light
        self.place_light(light)

    def to_light(self):
        """The unit vectors from all corners to the light, triangles x 3 x 3, float32: normals that make all that is lit alike."""
        light = self.light
        away = -np.asarray(light.direction) if light.kind == "directional" else light.position - self.corners.astype(float)
        way = np.broadcast_to(away, self.corners.shape)
        return (way / np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-30)).astype(np.float32)

    def resolve(self, gbuffer, mask):
        camera = Camera(gbuffer.view, gbuffer.width, gbuffer.height, self.corners)
        (lit, self.ms), (full, _) = self.pairs.draw(pair_of(self.light, gbuffer), lambda shadows: self.frame(camera, gbuffer.width, gbuffer.height, shadows))
        self.counts.update(self.pairs.counts())
        full = np.asarray(full, float)
        mask[...] = np.where(full > 0, np.clip(lit / np.maximum(full, 1e-30), 0, 1), 1)
        mask[~gbuffer.faces(self.light, self.scene)] = 1
