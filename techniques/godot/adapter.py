"""Godot 3 as a shadow technique: the shadows of its renderers for OpenGL, GLES3 and GLES2.

A process of Godot draws to a display of its own (godot_side.gd, which exchange.sh lets read requests and answer them). The
material is white, with a light function by which all that is lit has one brightness: the frame with shadows over the one without
is the mask.
"""

import shutil
from pathlib import Path

import numpy as np
from gnomon_engine import Awaited, Child, Engine, require_version
from gnomon_technique import serve

REACH = 1.25  # of a light, in distances to the corner farthest from it: its maps end there
CONE_MARGIN = 1.01  # of a spot's tangent, so that light is on all of its rim's pixels
VECTORS = 25  # Godot's number of an array of vectors among the types of what its files hold
FILTERS = {"none": 0, "pcf5": 1, "pcf13": 2}
PROJECT = """config_version=4
[application]
config/name="godot"
[display]
window/size/width=16
window/size/height=16
window/vsync/use_vsync=false
[rendering]
quality/directional_shadow/size={map_size}
quality/shadows/filter_mode={filter}
"""
OF_FRAMES = ("map_size", "around", "splits", "split_1", "split_2", "split_3", "blend", "range", "bias", "sun_bias",
             "normal_bias", "split_scale", "contact")


def stored(vectors):
    """Vectors as Godot's get_var() reads them."""
    vectors = np.ascontiguousarray(vectors, "<f4").reshape(-1, 3)
    return np.array([8 + vectors.nbytes, VECTORS, len(vectors)], "<u4").tobytes() + vectors.tobytes()


class Godot(Engine):
    needs_display = True
    renderer = None

    def supports(self, scene, light, view):
        return "approximate", "frames of an engine: its own primary visibility"

    def start(self):
        if self.renderer:
            self.renderer.end()
        folder = Path(self.folder)
        for name in ("godot_side.gd", "exchange.sh"):
            shutil.copyfile(Path(__file__).with_name(name), folder / name)
        settings = {"map_size": self.settings.map_size, "filter": FILTERS[self.settings.filter]}
        (folder / "project.godot").write_text(PROJECT.format(**settings), encoding="utf-8")
        (folder / "answer.json").unlink(missing_ok=True)
        drivers = ["--video-driver", self.settings.driver.upper(), "--audio-driver", "Dummy"]
        command = ["godot3-runner", *drivers, "--path", self.folder, "-s", "godot_side.gd"]
        self.renderer = Child("Godot", command, HOME=self.folder, XDG_DATA_HOME=self.folder, LC_ALL="en_US.UTF-8")
        facts = self.renderer.ask(do="facts")
        require_version("Godot", facts["version"], "3.2")
        if facts["driver"] != self.settings.driver:
            raise RuntimeError(f"Godot draws by {facts['driver']}; {self.settings.driver} is required")
        self.maker = f"Godot {facts['version']} ({self.settings.driver.upper()}): {facts['gl']}"

    def load(self, scene):
        normals = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        parts = [(first, end) for first, end in self.ranges if end > first]
        with open(Path(self.folder, "geometry"), "wb") as file:
            for first, end in parts:
                file.write(stored(self.corners[first:end]))
                file.write(stored(np.repeat(normals[first:end], 3, axis=0)))
        self.renderer.ask(do="build", casts=[bool(self.casts[first]) for first, _ in parts])

    def place_light(self, light):
        place, way, reach, angle = np.zeros(3), np.array([0, 0, -1.0]), 1.0, 0.0
        if light.kind != "directional":
            place = light.position
            reach = REACH * np.linalg.norm(self.corners.reshape(-1, 3) - place, axis=1).max(initial=1e-3)
        if light.kind != "point":
            way = light.direction / np.linalg.norm(light.direction)
        if light.kind == "spot":
            angle = min(np.degrees(np.arctan(CONE_MARGIN * np.tan(np.radians(light.outer_degrees)))), 89.9)
        right = np.cross(np.eye(3)[np.argmin(np.abs(way))], -way)
        right /= np.linalg.norm(right)
        world = [right, np.cross(-way, right), -way, place]  # it shines along -z
        world = np.concatenate(world).tolist()
        self.renderer.ask(do="relight", kind=light.kind, world=world, reach=float(reach), angle=float(angle))

    def frame(self, camera, width, height, shadows):
        world = np.concatenate((camera.right, camera.up, -camera.forward, camera.eye)).tolist()
        eye = {"world": world, "fov_y_degrees": camera.fov_y_degrees, "near": float(camera.near), "far": float(camera.far)}
        settings = {name: getattr(self.settings, name) for name in OF_FRAMES}
        picture = Awaited(self.folder, "picture")
        done = self.renderer.ask(do="frame", width=width, height=height, camera=eye, shadows=shadows, settings=settings)
        return picture.array(np.float32, height, width)[::-1], done["ms"]


serve(Godot)
