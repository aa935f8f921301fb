#!/usr/bin/python3 -IB
"""Where output goes: folders that cannot be made, full disks, limits, two runs in one place."""

import resource
import signal
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import SMALL, ProgramTest, records  # noqa: E402

ANY = ["--scene", "single_triangle", "--technique", "unshadowed", "--light", "sun"]


def limit_files(bytes_count):
    """For a child: files may not grow past this many bytes, and the one who tries is told instead of killed."""

    def apply():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_count, bytes_count))

    return apply


class Output(ProgramTest):
    def test_a_path_below_a_file_is_refused(self):
        self.write("file", "I was here first")
        for command in (["run", *ANY, *SMALL], ["render", *ANY, "--size", "160x90"], ["docs"]):
            for out in ("file", "file/below"):
                with self.subTest(f"{command[0]} {out}"):
                    self.refuse(*command, "--out", out, says=["file", "directory"])
        self.assertEqual([p.name for p in self.dir.iterdir()], ["file"])
        self.assertEqual((self.dir / "file").read_text(), "I was here first")

    def test_a_folder_with_records_is_refused_and_stays_as_it_is(self):
        self.succeed("run", *ANY, *SMALL, "--out", "out")
        before = {name: (self.dir / "out" / name).read_bytes() for name in self.names(self.dir / "out")}
        self.refuse("run", *ANY, *SMALL, "--out", "out", says=["out", "--resume"])
        self.assertEqual({name: (self.dir / "out" / name).read_bytes() for name in self.names(self.dir / "out")}, before)

    def test_of_two_runs_into_one_folder_one_is_refused(self):
        arguments = ["run", *ANY[:4], "--light", "point", "--light", "sun", "--technique", "shadow_map", "--processes", "3", "--repetitions", "3", "--size", "320x180",
                     "--out", "out"]
        first, second = (self.start(*arguments) for _ in range(2))
        ends = [(run.communicate(timeout=120), run.returncode) for run in (first, second)]
        self.assertEqual(sorted(status for _, status in ends), [0, 2], ends)
        refusal = next(streams[1] for streams, status in ends if status == 2)
        self.assertRegex(refusal, "(?m)^gnomon: .*(another run|--resume)")
        self.assertEqual(len(records(self.dir / "out")), 4)

    def test_a_file_that_cannot_grow_fails_the_row_and_leaves_no_half_picture(self):
        # 320 x 180 floats are 230,400 bytes, more than any table; a G-buffer is eight times that and comes from the cache.
        size = [*SMALL[:-1], "320x180"]
        self.succeed("run", *ANY, *size, "--out", "first")
        done = self.gnomon("run", *ANY, *size, "--out", "out", preexec_fn=limit_files(200_000))
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        row = records(self.dir / "out")[0]
        self.assertEqual(row["status"], "failed")
        self.assertRegex(row["reason"], "cannot be written: File too large")
        self.assertEqual([n for n in self.names(self.dir / "out") if not n.startswith("table.")], ["records.jsonl", "run.json"])

    def test_records_that_do_not_fit_stop_the_run(self):
        run = ["run", *ANY, "--technique", "shadow_map:resolution={64,128,256,512,1024}", *SMALL]
        self.succeed(*run, "--out", "first")
        # What the folder says of the run fits, some records do, all do not; unless the tree of the build differs by much from its commit.
        limit = (self.dir / "first/run.json").stat().st_size + 64
        if (self.dir / "first/records.jsonl").stat().st_size <= limit:
            self.skipTest("the changes of this build's tree are longer than the records")
        done = self.gnomon(*run, "--out", "out", preexec_fn=limit_files(limit))
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertRegex(done.stderr, r"(?m)^gnomon: the record of \w+ .* could not be written: .*records\.jsonl")
        text = (self.dir / "out/records.jsonl").read_text()
        self.assertTrue(text == "" or text.endswith("\n"), text[-80:])  # no half line
        self.assertLess(len(text), limit)
        self.assertFalse((self.dir / "out/.scratch").exists())
        self.succeed(*run, "--out", "out", "--resume", "--retry-failed")
        self.assertEqual(len(records(self.dir / "out")), 6)

    def test_render_writes_all_or_nothing(self):
        self.succeed("render", *ANY, "--size", "160x90", "--out", "first")
        for limit in (100, 2_000, 20_000):
            with self.subTest(limit):
                done = self.gnomon("render", *ANY, "--size", "160x90", "--out", "out", preexec_fn=limit_files(limit))
                self.assertIn(done.returncode, (1, 2))
                self.assertRegex(done.stderr, r"^gnomon: .*cannot be written: .*\n$")
                self.assertEqual([p.name for p in self.dir.iterdir()], ["first"])

    def test_standard_output_that_is_full_is_said(self):
        self.succeed("run", *ANY, *SMALL, "--out", "out")
        for arguments in (["list"], ["list", "scenes", "--json"], ["table", "out", "--format", "json"]):
            with self.subTest(" ".join(arguments)), open("/dev/full", "w") as full:
                done = subprocess.run(self.command(*arguments), cwd=self.dir, env=self.environment, text=True, stdout=full,
                                      stderr=subprocess.PIPE)
                self.assertEqual((done.returncode, done.stderr),
                                 (2, "gnomon: standard output cannot be written: No space left on device\n"))

    def test_docs_writes_no_half_page(self):
        done = self.gnomon("docs", "--out", "pages", preexec_fn=limit_files(300))
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"^gnomon: pages/.*\.md cannot be written: File too large\n$")
        self.assertEqual(self.names(self.dir), [])


if __name__ == "__main__":
    unittest.main()
