"""The viewer as a person uses it: a display of its own, real key presses and mouse moves, and what came of them as the viewer saves it.

Nothing here waits for a time: Ctrl+S saves when all is computed, and a state that is waited for is read again until it is there.
"""

import contextlib
import ctypes
import json
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import time
import tomllib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
sys.path.insert(0, str(Path(__file__).resolve().parent))
from pictures import read_mask, read_png  # noqa: E402
from program import FAULTS, HUNG, PATIENCE, PROGRAM, ProgramTest, wait_until, workers  # noqa: E402, F401

# A floor of 8 x 4 m and a triangle 1 m over it: the diagonal of the bounds is 9 m, so that a step of the keys is 0.18 m.
STEP = 0.18
SCENE = """
[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [8, 4]
[[shape]]
kind = "triangle"
points = [[-1, 1, -0.6], [1, 1, -0.6], [0.2, 1, 0.8]]
albedo = [0.8, 0.3, 0.2]
[[light]]
name = "lamp"
kind = "point"
position = [0.5, 2.25, 0.25]
[[light]]
name = "noon"
kind = "directional"
direction = [0.25, -1, 0.125]
[[light]]
name = "panel"
kind = "rect"
center = [0.5, 3, 0]
half_u = [0.5, 0, 0]
half_v = [0, 0, 0.5]
[[view]]
name = "front"
eye = [0, 3, 6]
target = [0, 0.5, 0]
[[view]]
name = "side"
eye = [6, 2, 1]
target = [0, 0.25, 0]
"""


def tool(name):
    """Where a program is that the tests need; scripts/setup --check installs it."""
    found = shutil.which(name)
    if not found:
        raise AssertionError(f"there is no {name}: the tests of the viewer need it; scripts/setup --check installs it")
    return found


def heed_signals():
    """In a process that starts: what runs in the background of a shell ignores some."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


class Display:
    """An X server without a screen or window manager. `resources` are what xrdb loads."""

    def __init__(self, resources="", size="1600x1300"):
        ours, theirs = os.pipe()
        command = [tool("Xvfb"), "-displayfd", str(theirs), "-screen", "0", f"{size}x24", "-nolisten", "tcp", "-noreset"]
        self.server = subprocess.Popen(command, pass_fds=[theirs], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(theirs)
        with os.fdopen(ours) as pipe:
            number = pipe.readline().strip()
        if not number:
            raise AssertionError(f"Xvfb did not start: exit {self.server.wait()}")
        self.name = f":{number}"
        if resources:
            subprocess.run([tool("xrdb"), "-nocpp", "-merge"], input=resources, text=True, check=True, env=self.environment())

    def environment(self, base=os.environ):
        return dict(base, DISPLAY=self.name)

    def close(self):
        self.server.terminate()
        self.server.wait()


class Saved:
    """A folder that Ctrl+S wrote."""

    def __init__(self, folder):
        self.folder = folder
        self.command = (folder / "command.txt").read_text().rstrip("\n")
        self.window = json.loads((folder / "window.json").read_text())
        scene = tomllib.loads((folder / "scene.toml").read_text())
        self.lights, (self.view,), self.scene = scene["light"], scene["view"], scene["scene"]
        if len(self.lights) == 1:
            self.light = self.lights[0]

    def option(self, name):
        return re.search(rf" --{name} (\S+)", self.command)[1]

    technique = property(lambda self: self.option("technique"))
    size = property(lambda self: tuple(map(int, self.option("size").split("x"))))
    eye = property(lambda self: self.view["eye"])
    target = property(lambda self: self.view["target"])
    mask = property(lambda self: read_mask(self.folder / "mask.exr"))
    picture = property(lambda self: read_png(self.folder / "picture.png"))
    place = property(lambda self: self.window["picture"])
    picked = property(lambda self: self.window["picked"])
    sides = property(lambda self: self.window["sides"])

    def control(self, name):
        """The middle of a control in the window."""
        place = self.window["controls"].get(name)
        if not place or not place["visible"]:
            raise AssertionError(f"{name} is not to be seen; there are {' '.join(self.window['controls'])}")
        return place["x"] + place["width"] / 2, place["y"] + place["height"] / 2

    def has(self, name):
        return self.window["controls"].get(name, {}).get("visible", False)

    def rows_of(self, combo, seen=True):
        """The items of an open list: those that are to be seen, or all."""
        return [name for name in self.window["controls"] if name.startswith(combo + ".") and (self.has(name) or not seen)]

    def light_pixel(self):
        """Where the picture shows a light with a position: column and row, not rounded."""
        return self.pixel_of(self.light["position"])

    def pixel_of(self, point):
        """Where the picture shows a point before the eye."""
        forward = unit(minus(self.target, self.eye))
        right = unit(cross(forward, self.view["up"]))
        up = cross(right, forward)
        to = minus(point, self.eye)
        width, height = self.size
        scale = height / 2 / math.tan(math.radians(self.view["fov_y_degrees"]) / 2) / dot(to, forward)
        return width / 2 + scale * dot(to, right), height / 2 - scale * dot(to, up)


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


class Viewer:
    """One `gnomon view`, started and in the focus of its display."""

    def __init__(self, test, *arguments, display=None, options=()):
        self.test, self.out = test, test.dir / "out"
        self.display = display or test.display
        self.environment = self.display.environment(test.environment)
        self.log = test.dir / "log"
        with self.log.open("wb") as log:
            self.process = subprocess.Popen([PROGRAM, *options, "view", "--out", "out", *map(str, arguments)], cwd=test.dir,
                                            env=self.environment, stdout=log, stderr=log, preexec_fn=heed_signals)
        test.addCleanup(self.close)
        self.window = self.wait(lambda: self.xdo("search", "--onlyvisible", "--pid", self.process.pid, may_fail=True), "a window")
        self.window = self.window.split()[-1]
        self.xdo("windowfocus", "--sync", self.window)
        self.xdo("mousemove", "--window", self.window, 2, 2)

    def xdo(self, *words, may_fail=False):
        done = subprocess.run([tool("xdotool"), *map(str, words)], env=self.environment, text=True, capture_output=True, timeout=PATIENCE)
        if done.returncode and not may_fail:
            raise AssertionError(f"xdotool {words}: {done.stderr}\n{self.words()}")
        return done.stdout.strip()

    def words(self):
        """All that the program has printed."""
        return self.log.read_text()

    def wait(self, ask, what):
        def answer():
            status = self.process.poll()
            assert status is None, f"waiting for {what}: the viewer has exited with {status}\n{self.words()}"
            return ask()

        try:
            return wait_until(answer, what)
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.words()}") from None

    @contextlib.contextmanager
    def stopped(self):
        """Within it the viewer stands still; all that happens meanwhile comes to it at once. What is short stays short for it so, also
        where xdotool has to wait for a core: a key that is down for a third of a second is held, a click of half a second is a drag."""
        self.process.send_signal(signal.SIGSTOP)
        try:
            yield
        finally:
            self.process.send_signal(signal.SIGCONT)

    # Keys by xdotool's names.

    def press(self, *keys):
        for key in keys:
            with self.stopped():
                self.xdo("key", key)

    def save(self):
        """What Ctrl+S writes; the viewer does so when all is computed."""
        folder = self.next_folder()
        self.press("ctrl+s")
        return self.saved(folder)

    def next_folder(self):
        """Where the next Ctrl+S writes."""
        return next(f for f in (self.out / f"{k:02}" for k in range(1, 1000)) if not f.exists())

    def saved(self, folder):
        self.wait(folder.is_dir, f"{folder.name} to be saved")
        return Saved(folder)

    def until(self, is_so, what):
        """The first save that is so: for what a click begins and a later picture shows."""
        end = time.monotonic() + PATIENCE
        while not is_so(saved := self.save()):
            assert time.monotonic() < end, f"waited {PATIENCE} s for {what}: {saved.command}\n{saved.window}\n{self.words()}"
        return saved

    # Mouse, in pixels of the window.

    def move(self, x, y):
        self.xdo("mousemove", "--window", self.window, round(x), round(y))

    def click(self, x, y):
        self.move(x, y)
        with self.stopped():
            self.xdo("click", 1)

    def drag(self, start, end, button=1, key=None):
        """Presses at the start, moves to the end in two steps, and lets go."""
        self.move(*start)
        if key:
            self.xdo("keydown", key)
        self.xdo("mousedown", button)
        self.move((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        self.move(*end)
        self.xdo("mouseup", button)
        if key:
            self.xdo("keyup", key)

    def at(self, saved, x, y):
        """The middle of a pixel of the picture."""
        return saved.place["x"] + x, saved.place["y"] + y

    def use(self, saved, control):
        self.click(*saved.control(control))

    def choose(self, saved, combo, item):
        """Opens a list with the mouse and clicks one of its items."""
        self.use(saved, combo)
        wanted = f"{combo}.{item}"
        opened = self.until(lambda s: s.rows_of(combo), f"the list of {combo}")
        # A list that is longer than the window is scrolled by the wheel, as far as it goes.
        for _ in opened.rows_of(combo, seen=False):
            if opened.has(wanted):
                break
            seen = opened.rows_of(combo)
            self.move(*opened.control(seen[0]))
            is_below = opened.window["controls"][wanted]["y"] > opened.window["controls"][seen[0]]["y"]
            self.xdo("click", 5 if is_below else 4)
            opened = self.save()
        self.use(opened, wanted)

    def resize(self, width, height):
        self.xdo("windowsize", "--sync", self.window, width, height)

    def ask_to_close(self):
        """What a window manager sends when its button is pressed; xdotool does not have it."""
        x = ctypes.CDLL("libX11.so.6")
        x.XOpenDisplay.restype = ctypes.c_void_p
        x.XInternAtom.restype = ctypes.c_ulong
        x.XInternAtom.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
        x.XSendEvent.argtypes = [ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]
        x.XCloseDisplay.argtypes = [ctypes.c_void_p]
        display = x.XOpenDisplay(self.display.name.encode())
        kind, how = (x.XInternAtom(display, name, 0) for name in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW"))
        # XClientMessageEvent: type, serial, send_event, display, window, message_type, format, five longs.
        event = struct.pack("@iLiPLLi5l", 33, 0, 1, display, int(self.window), kind, 32, how, 0, 0, 0, 0)
        x.XSendEvent(display, int(self.window), 0, 0, ctypes.create_string_buffer(event, 192))
        x.XCloseDisplay(display)

    def close(self):
        """Ends it if it still runs. Its exit status."""
        if self.process.poll() is None:
            self.process.terminate()
        return self.process.wait(PATIENCE)


class ViewerTest(ProgramTest):
    """Each class has a display of its own; each test starts viewers on it."""

    resources = ""

    @classmethod
    def setUpClass(cls):
        cls.display = Display(cls.resources)
        super().setUpClass()
        cls.addClassCleanup(cls.display.close)

    def view(self, *arguments, **how):
        return Viewer(self, *arguments, **how)

    def view_scene(self, *arguments, **how):
        """On the scene of this file, under the lamp: a step of the keys is STEP."""
        self.write("floor.toml", SCENE)
        return self.view("--scene", "floor.toml", "--size", "480x400", *arguments, **how)

    def assert_near(self, a, b, tolerance=1e-4):
        self.assertEqual(len(a), len(b))
        for x, y in zip(a, b):
            self.assertAlmostEqual(x, y, delta=tolerance, msg=f"{a} {b}")

    def assert_renders_alike(self, saved):
        """The saved command, unchanged, gives the saved mask, pixel for pixel. The folder of what it rendered."""
        tools = self.dir / "tools"
        if not tools.exists():
            tools.mkdir()
            (tools / "gnomon").symlink_to(PROGRAM)
        environment = dict(self.environment, PATH=f"{tools}:{os.environ['PATH']}")
        done = subprocess.run(["/bin/sh", "-c", saved.command], cwd=self.dir, env=environment, text=True, capture_output=True,
                              timeout=PATIENCE)
        self.assertEqual(done.returncode, 0, f"{saved.command}\n{done.stderr}")
        folder = self.dir / saved.option("out")
        width, height, ours = saved.mask
        self.assertEqual((width, height), saved.size)
        theirs = read_mask(folder / "mask.exr")
        self.assertEqual((width, height), theirs[:2])
        wrong = sum(a != b for a, b in zip(ours, theirs[2]))
        self.assertEqual(wrong, 0, f"{wrong} of {width * height} pixels differ: {saved.command}")
        return folder

    def workers(self):
        return workers(self.dir)
