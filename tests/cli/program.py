"""What the tests of the program share: running it, reading what it wrote, and small files for it to choke on."""

import json
import os
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("GNOMON_PROGRAM", str(ROOT / "build/release/gnomon"))
FAULTS = os.environ.get("GNOMON_FAULTS", str(ROOT / "build/release/gnomon_faults.so"))
DATA = ROOT / "tests/data"
SANITIZED = "ASAN_OPTIONS" in os.environ  # as the preset of that build sets

# Seconds to wait. They say nothing of how fast anything is: what is sound takes a small part of them, also where other work keeps every
# core busy, and what never comes or never goes is found out all the same.
PATIENCE = 240  # for what has to come, such as a file, a worker, the end of a program
GONE = 30  # for processes to go that have to go by themselves
HUNG = 8  # what --timeout grants a step where one hangs on purpose, while sound steps take milliseconds

# Enough to see that it works: one process, one repetition, few pixels.
SMALL = ["--processes", "1", "--repetitions", "1", "--warmups", "1", "--size", "160x90"]
# The same for tests that look at no picture: what writes pictures takes longer to load than such a row to run.
NUMBERS = ["--pictures", "none", *SMALL]
# The lights that every generated scene has. Some have lights with area besides.
HARD = ["--light", "point", "--light", "sun"]


def small_maps(texels=288):
    """Every technique that can run here, with small pictures of its own: enough where masks are compared with each other."""
    def asked(*arguments):
        return json.loads(subprocess.run([PROGRAM, *arguments, "--json"], check=True, capture_output=True, text=True).stdout)

    for technique in (entry["id"] for entry in asked("list", "techniques") if not entry["named_only"]):
        names = {parameter["name"] for parameter in asked("describe", technique)["parameters"]}
        yield ":".join([technique, *(f"{name}={texels}" for name in sorted(names & {"resolution", "hemicube"}))])


# The description of a technique that is the program ID.py; further lines may follow.
PROGRAM_SHEET = """title = "T"
summary = "S."
source = "None."
error = "E."
fails = "F."
command = ["/usr/bin/python3", "-IB", "{id}.py"]
"""


class ProgramTest(unittest.TestCase):
    """Each class has a folder of its own, with a cache in it; each test a folder below, by which its processes are known."""

    @classmethod
    def setUpClass(cls):
        cls.home = Path(tempfile.mkdtemp(prefix="gnomon-cli-"))
        (cls.home / "cache").mkdir()
        cls.environment = dict(os.environ, GNOMON_CACHE=str(cls.home / "cache"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.home)

    def setUp(self):
        self.dir = self.home / self.id().rsplit(".", 1)[-1]
        self.dir.mkdir()
        self.environment = dict(type(self).environment, GNOMON_TEST=str(self.dir))

    def command(self, *arguments):
        return [PROGRAM, *map(str, arguments)]

    def gnomon(self, *arguments, **options):
        """Runs the program to its end. Its folder is the test's."""
        return subprocess.run(self.command(*arguments), cwd=self.dir, env=self.environment, text=True, capture_output=True,
                              timeout=PATIENCE, **options)

    def start(self, *arguments, **options):
        """Starts the program and does not wait for it."""
        return subprocess.Popen(self.command(*arguments), cwd=self.dir, env=self.environment, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)

    def succeed(self, *arguments, status=0):
        """Its standard output, after it has exited with `status`."""
        done = self.gnomon(*arguments)
        self.assertEqual(done.returncode, status, f"{' '.join(map(str, arguments))}\n{done.stdout}\n{done.stderr}")
        return done.stdout

    def refuse(self, *arguments, says, **options):
        """It exits with 2, says one line that holds every text of `says`, and prints nothing else."""
        done = self.gnomon(*arguments, **options)
        call = f"{' '.join(map(str, arguments))}\n{done.stdout}\n{done.stderr}"
        self.assertEqual(done.returncode, 2, call)
        self.assertEqual(done.stdout, "", call)
        self.assertTrue(done.stderr.startswith("gnomon: ") and done.stderr.count("\n") == 1, call)
        for text in says:
            self.assertIn(text, done.stderr)

    def assert_gone(self):
        """Nobody is left of what this test started. Who was killed may take a moment to go."""
        wait_until(lambda: not workers(self.dir, keepers=True), "all processes to be gone", GONE)

    def write(self, name, text):
        file = self.dir / name
        file.write_bytes(text) if isinstance(text, bytes) else file.write_text(text)
        return file

    def names(self, folder):
        """All files below a folder, hidden ones too."""
        return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file())


def records(folder):
    return [json.loads(line) for line in (folder / "records.jsonl").read_text().splitlines()]


def what(record):
    """What a record is about; the same in every run of the same rows."""
    return tuple(record[key] for key in ("job", "scene", "light", "view", "technique", "settings"))


# All that may differ from run to run of one row on one machine, and why.
LOOSE = {
    "stages": "times",
    "moving_stages": "times",
    "moving_stages": "times",
    "harness_stages": "times",
    "floor": "times",
    "iterations": "as many calls as take a millisecond",
    "stop": "says which times were narrow enough",
    "seconds": "a time",
    "peak_bytes": "pages that the process had at most, also those of threads, driver, libraries, earlier rows and programs",
    "gl.upload_ms": "a time",
    "context.load_average": "what else the machine did",
    "context.scene_file": "a path from the folder of the run",
    "context.started": "a date",
}


def measured(record):
    """What must come out the same in every run of the same row: everything but what is loose."""
    row = {key: dict(value) if isinstance(value, dict) else value for key, value in record.items()}
    for path in LOOSE:
        *group, key = path.split(".")
        part = row[group[0]] if group else row
        if part is not None:
            part.pop(key, None)
    return row


def wait_until(is_so, what, seconds=PATIENCE):
    """Calls again and again until it is so, and returns the answer."""
    end = time.monotonic() + seconds
    while not (answer := is_so()):
        if time.monotonic() > end:
            raise AssertionError(f"waited {seconds} s for {what}")
        time.sleep(0.01)
    return answer


def workers(marker, keepers=False):
    """Processes that live now and have `marker` in their environment or command line; those that keep them only where requested."""
    found = []
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit() or int(folder.name) == os.getpid():
            continue
        try:
            text = (folder / "environ").read_bytes() + (folder / "cmdline").read_bytes()
            is_dead = (folder / "stat").read_text().rsplit(")", 1)[1].split()[0] in "ZX"
            is_dead = is_dead or not keepers and (folder / "comm").read_text() == "gnomon-keeper\n"
        except OSError:
            continue
        if str(marker).encode() in text and not is_dead:
            found.append(int(folder.name))
    return found


def scene_toml(light="", view="", mesh='[[shape]]\nkind = "plane"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = [8, 8]\n'):
    """A described scene: a floor at y = 0 unless told otherwise."""
    return "\n".join([mesh, light, view])
