#!/usr/bin/python3 -IB
"""Small things that broke once: devices and links as output, what killed programs leave, long and odd names, huge values, full logs."""

import json
import os
import resource
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PATIENCE, SMALL, ProgramTest, records  # noqa: E402

ANY = ["--scene", "single_triangle", "--technique", "unshadowed", "--light", "sun"]
LONG = "n" * 230
MEMORY = 4 << 30  # of addresses, of which libraries and their threads take most


def gone_process():
    """The number of a process that was there just now."""
    process = subprocess.Popen(["true"])
    process.wait()
    return process.pid


class Leftovers(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_folder = cls.home / "run"
        one = cls("test_a_log_that_is_full_stops_nothing")
        one.dir = cls.home
        suite = one.write("odd.toml", """
width = 64
height = 48
processes = 1
repetitions = 1
[[group]]
scenes = ["single_triangle"]
lights = ["point", "sun"]
techniques = ["embree_rays", { use = "shadow_map:resolution=64", label = "'quoted" }, { use = "shadow_map:resolution=128", label = "''100 %s" }]
""")
        one.succeed("run", suite, "--out", cls.run_folder)

    def copy_of_run(self, change=lambda row: None):
        shutil.copytree(self.run_folder, self.dir / "run")
        rows = records(self.run_folder)
        for row in rows:
            change(row)
        (self.dir / "run/records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        return rows

    # Output that is no regular file

    def test_a_device_or_pipe_is_not_replaced(self):
        self.copy_of_run()
        for name in ("page.html", "front.svg", "detail.obj"):
            os.mkfifo(self.dir / name)
        (self.dir / "null.html").symlink_to("/dev/null")
        says = ["cannot be written", "no regular file"]
        self.refuse("report", "run", "--out", "page.html", says=["page.html", *says])
        self.refuse("report", "run", "--out", "null.html", says=["null.html", *says])
        self.refuse("report", "run", "--out", "/dev/full", says=["/dev/full", *says])
        self.refuse("figure", "run", "front", "--out", "front.svg", says=["front.svg", *says])
        self.refuse("render", "--scene", "single_triangle", "--technique", "two_pass_object", "--size", "64x48", "--out", "out", "--detail",
                    "detail.obj", says=["detail.obj", *says])
        self.assertTrue(all((self.dir / name).is_fifo() for name in ("page.html", "front.svg", "detail.obj")))
        self.assertTrue(Path("/dev/full").is_char_device() and (self.dir / "null.html").is_symlink())

    def test_a_pipe_in_a_folder_for_results_is_not_replaced(self):
        for out, name in (("rendered", "mask.exr"), ("ran", "records.jsonl")):
            (self.dir / out).mkdir()
            os.mkfifo(self.dir / out / name)
        done = self.gnomon("render", *ANY, "--size", "64x48", "--out", "rendered")
        self.assertEqual((done.returncode, os.listdir(self.dir / "rendered")), (2, ["mask.exr"]), done.stderr)
        self.assertIn("mask.exr cannot be written: it is there and no regular file", done.stderr)
        self.assertEqual(self.gnomon("run", *ANY, *SMALL, "--out", "ran").returncode, 2)
        self.refuse("run", *ANY, *SMALL, "--out", "ran", "--resume", says=["records.jsonl", "no regular file"])
        self.refuse("table", "ran", says=["records.jsonl", "is not a file"])
        self.assertEqual(sorted(path.name for path in self.dir.iterdir()), ["ran", "rendered"])
        self.assertTrue((self.dir / "rendered/mask.exr").is_fifo() and (self.dir / "ran/records.jsonl").is_fifo())

    def test_a_link_to_a_file_stays_and_the_file_is_replaced(self):
        self.copy_of_run()
        page = self.write("elsewhere.html", "old")
        (self.dir / "page.html").symlink_to(page)
        self.succeed("report", "run", "--out", "page.html")
        self.assertTrue((self.dir / "page.html").is_symlink())
        self.assertIn("<html", page.read_text()[:300])

    # What killed programs leave

    def test_what_a_killed_program_left_is_cleared_by_the_next_of_its_kind(self):
        dead, alive = gone_process(), os.getpid()
        for out in ("picture", "merged"):
            for folder in (f".{out}.{dead}.part", f".{out}.{alive}.part", f".{out}.part", f".{out}.notes.{dead}", f".other.{dead}.part"):
                (self.dir / folder).mkdir(exist_ok=True)
                self.write(f"{folder}/half", "half")
        self.succeed("render", *ANY, "--size", "64x48", "--out", "picture/")
        self.succeed("merge", self.run_folder, "--out", "merged")
        for out in ("picture", "merged"):
            self.assertEqual(sorted(p.name for p in self.dir.glob(f".{out}*")),
                             sorted([f".{out}.{alive}.part", f".{out}.part", f".{out}.notes.{dead}"]))
        self.assertTrue((self.dir / f".other.{dead}.part").exists())

    def test_what_a_killed_run_left_is_cleared_by_the_next_one(self):
        self.copy_of_run()
        dead = gone_process()
        temporary = self.dir / "tmp"
        temporary.mkdir()
        self.environment = dict(self.environment, TMPDIR=str(temporary), GNOMON_CACHE=str(self.dir / "cache"))
        self.succeed("table", "run", "--rescore")
        left = [self.write(f"run/{name}", "half") for name in (f".records.jsonl.{dead}.part", f".table.md.{dead}.part")]
        left += [temporary / f"gnomon-frames-{dead}.abcdef"]
        left[-1].mkdir()
        frame = next((self.dir / "cache/frames").glob("*.gbuffer"))
        left.append(frame.with_name(f".{frame.name}.{dead}.part"))
        left[-1].write_bytes(b"half")
        frame.unlink()
        mine = [self.write(f"run/{name}", "mine") for name in (".notes", f".notes.{dead}", ".part", "a.part")]
        self.succeed("table", "run", "--rescore", "--save")
        self.assertEqual([str(path) for path in left if path.exists()], [])
        self.assertTrue(all(file.exists() for file in mine))

    def test_merge_takes_no_picture_through_a_link(self):
        row = self.copy_of_run()[0]
        secret = self.write("secret", "not of this run")
        (self.dir / "run" / row["mask"]).unlink()
        (self.dir / "run" / row["mask"]).symlink_to(secret)
        self.refuse("merge", "run", "--out", "merged", says=[row["mask"], "link", "merge takes the files of a folder only"])
        shutil.rmtree(self.dir / "run/masks")
        (self.dir / "run/masks").symlink_to(self.run_folder / "masks")
        self.refuse("merge", "run", "--out", "merged", says=["link", "merge takes the files of a folder only"])
        self.assertEqual(sorted(p.name for p in self.dir.iterdir()), ["run", "secret"])
        (self.dir / "linked").symlink_to(self.run_folder)  # a link that is named is what was meant
        self.succeed("merge", "linked", "--out", "merged")

    # Names

    def test_long_names_of_scenes_and_suites(self):
        light = '[[light]]\nname = "{}"\nkind = "directional"\ndirection = [0, -1, 0]\n'
        scene = self.write(f"{LONG}.toml", 'scene = "single_triangle"\n' + light.format("l" * 100))
        self.succeed("run", "--scene", scene, "--technique", "unshadowed", *SMALL, "--out", "out")
        self.assertEqual([row["status"] for row in records(self.dir / "out")], ["ok"])
        self.succeed("render", "--scene", scene, "--technique", "unshadowed", "--size", "64x48", "--out", "p" * 255)
        suite = self.write(f"{'s' * 250}.toml", '[[group]]\nscenes = ["single_triangle"]\ntechniques = ["unshadowed"]\n')
        self.refuse("run", suite, says=["s" * 250, "File name too long"])
        scene = self.write("long.toml", 'scene = "single_triangle"\n' + light.format("l" * 101))
        self.refuse("run", "--scene", scene, "--technique", "unshadowed", "--out", "none", says=["long.toml:3", "at most 100"])

    def test_labels_that_begin_with_a_quote_or_hold_a_percent_sign(self):
        for kind in ("front", "stages", "causes"):
            for ending in ("svg", "png", "pdf"):
                self.succeed("figure", self.run_folder, kind, "--out", f"{kind}.{ending}")
            text = (self.dir / f"{kind}.svg").read_text()
            self.assertIn("&#39;quoted" if "&#39;" in text else "'quoted", text)
            self.assertIn("100 %s", text)

    # Values

    def test_values_at_the_end_of_what_numbers_hold(self):
        for value in (1e307, 1.7e308, 5e-324):
            def change(row):
                if row["technique"] == "shadow_map":
                    for metrics in row["metrics"].values():
                        metrics["error"] = metrics["wrong_rate"] = value
                    row["stages"]["resolve"] = [[value]]
            shutil.rmtree(self.dir / "run", ignore_errors=True)
            self.copy_of_run(change)
            for call in (["figure", "run", "front", "--script"], ["analyze", "run", "best"], ["analyze", "run", "front"], ["table", "run"],
                         ["figure", "run", "stages", "--script"]):
                done = subprocess.run(self.command(*call), cwd=self.dir, env=self.environment, capture_output=True, timeout=PATIENCE)
                self.assertIn(done.returncode, (0, 2), f"{value} {call} {done.stderr}")

    def test_memory_that_is_not_there_is_called_that(self):
        few = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))}
        done = self.gnomon("certify", "--scene", "single_triangle", "--size", "16384x16384", **few)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr.splitlines()[-1], "^gnomon: .*(out of|not enough) memory")  # what took long may come before
        done = self.gnomon("run", *ANY, "--size", "16384x16384", "--processes", "1", "--repetitions", "1", "--out", "out", **few)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertNotIn("bad_alloc", done.stdout + done.stderr)
        self.assertRegex(done.stdout + done.stderr, "(out of|not enough) memory")

    def test_empty_texts_are_no_values(self):
        for name in ("--threads", "--processes", "--timeout", "--interval"):
            self.refuse("run", *ANY, "--dry-run", name, "", says=[f"{name}: a number is wanted"])
        for name in ("--size", "--truth", "--shard", "--out"):
            self.refuse("run", *ANY, "--dry-run", name, "", says=[f"{name}: "])
        for name in ("--size", "--threads", "--view", "--out"):
            self.refuse("render", *ANY, *([] if name == "--out" else ["--out", "none"]), name, "", says=[name])
        self.assertEqual(list(self.dir.iterdir()), [])

    # Standard error

    def test_a_log_that_is_full_stops_nothing(self):
        with open("/dev/full", "w") as full:
            calls = {("run", *ANY, *SMALL, "--out", "out"): 0, ("table", "out", "--rescore", "--save"): 0, ("run", "nothing"): 2}
            for call, status in calls.items():
                done = subprocess.run(self.command(*call), cwd=self.dir, env=self.environment, stdout=subprocess.DEVNULL, stderr=full)
                self.assertEqual(done.returncode, status, call)
        self.assertEqual([row["status"] for row in records(self.dir / "out")], ["ok"])


if __name__ == "__main__":
    unittest.main()
