#!/usr/bin/python3 -IB
"""What a person sees: a bar that redraws itself on a terminal, plain lines elsewhere, and a clean table."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HARD, NUMBERS, PATIENCE, SMALL, ProgramTest  # noqa: E402

RUN = ["run", *HARD, "--scene", "single_triangle", "--scene", "soup:count=50", "--technique", "unshadowed", "--technique", "shadow_map",
       "--processes", "2", "--repetitions", "2", "--size", "160x90", "--out", "out"]
ERASE = "\r\x1b[K"
BAR = re.compile(r"^\[(#*)(\.*)\] +(\d+) %")


class Terminal(ProgramTest):
    def setUp(self):
        super().setUp()
        self.environment.pop("COLUMNS", None)  # of the terminal that the tests are run on

    def on_terminal(self, columns, *arguments, **streams):
        """Everything the program sends to a terminal of so many columns, with the terminal's line ends undone."""
        owner, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
        run = subprocess.Popen(self.command(*arguments), cwd=self.dir, env=self.environment, stdin=slave,
                               stdout=streams.get("stdout", slave), stderr=slave)
        os.close(slave)
        received = b""
        while True:
            try:
                chunk = os.read(owner, 65536)
            except OSError:  # the last writer has closed its end
                chunk = b""
            if not chunk:
                break
            received += chunk
        os.close(owner)
        self.assertEqual(run.wait(PATIENCE), 0, received)
        return received.decode().replace("\r\n", "\n")

    @staticmethod
    def screen(text):
        """What stays on the screen: of each line, what follows its last erasure."""
        return [line.split(ERASE)[-1] for line in text.split("\n")]

    def test_the_bar_redraws_itself_and_goes_away(self):
        text = self.on_terminal(100, *RUN)
        bars = [BAR.match(piece) for piece in text.split(ERASE)[1:]]
        drawn = [bar for bar in bars if bar]
        self.assertGreaterEqual(len(drawn), 3, text)
        shares = [int(bar[3]) for bar in drawn]
        self.assertEqual(shares, sorted(shares))
        for bar in drawn:
            self.assertEqual(len(bar[1]) + len(bar[2]), 20)
            self.assertEqual(len(bar[1]), int(bar[3]) * 20 // 100)
        for piece in text.split(ERASE)[1:-1]:
            self.assertLess(len(piece), 100)
            self.assertNotIn("\n", piece)
        screen = self.screen(text)
        self.assertEqual([line for line in screen if BAR.match(line) or "\r" in line or "\x1b" in line], [])
        self.assertTrue(any(line.startswith("8 rows: 8 ok") for line in screen), text)

    def test_the_bar_says_what_reference_is_traced(self):
        lamp = '[[light]]\nname = "lamp"\nkind = "disc"\ncenter = [0.5, 4, 0]\nnormal = [0, -1, 0]\nradius = 0.5\n'
        self.write("lamp.toml", 'scene = "single_triangle"\n' + lamp)
        cores = os.sched_getaffinity(0)
        os.sched_setaffinity(0, {min(cores)})  # so that it takes a second anywhere
        try:
            certify = self.on_terminal(100, "certify", "--scene", "lamp.toml", "--size", "320x180")
            run = self.on_terminal(100, "run", "--scene", "lamp.toml", "--technique", "unshadowed", "--processes", "1", "--repetitions", "1",
                                   "--size", "321x180", "--out", "out")
        finally:
            os.sched_setaffinity(0, cores)
        shares = [int(share) for share in re.findall(r"\[[#.]{20}\] +(\d+) % .{16}reference of lamp.toml, lamp", certify)]
        self.assertEqual(shares, sorted(shares))
        self.assertTrue(any(0 < share < 100 for share in shares), certify)
        screen = self.screen(certify)
        self.assertEqual([line for line in screen if BAR.match(line)], [])
        self.assertTrue(any(line.endswith(": certified") for line in screen), certify)
        self.assertRegex(run, r"\[\.{20}\]   0 % .{16}reference of lamp.toml, lamp: \d+ %, ")

    def test_the_table_fits_the_terminal(self):
        self.succeed(*RUN)
        for columns in (80, 120, 200):
            with self.subTest(columns):
                table = self.on_terminal(columns, "table", "out").split("\n")
                body = [line for line in table if line.startswith(("unshadowed", "shadow_map", "technique", "---"))]
                self.assertGreaterEqual(len(body), 10)
                self.assertLessEqual(max(map(len, table)), columns)
        self.environment["COLUMNS"] = "90"  # says more than the terminal
        table = self.on_terminal(200, "table", "out").split("\n")
        self.assertLessEqual(max(map(len, table)), 90)
        self.assertGreater(max(map(len, table)), 70)
        self.assertLessEqual(max(map(len, self.on_terminal(200, "table", "out", "--width", "60").split("\n"))), 60)
        self.assertEqual(self.on_terminal(80, "table", "out", "--wide"), self.succeed("table", "out"))

    def test_the_table_of_a_scene_that_moves_fits_a_narrow_terminal(self):
        self.succeed("run", "--scene", "jumping_boxes:count=3", "--animation", "jump", "--frames", "3", "--light", "panel", *NUMBERS,
                     "--technique", "denoised_rays:memory=accumulate", "--technique", "denoised_rays", "--out", "out")
        table = self.on_terminal(80, "table", "out").split("\n")
        body = [line for line in table if line.startswith(("denoised_rays", "technique", "---"))]
        self.assertEqual(len(body), 4)
        self.assertLessEqual(max(map(len, body)), 80)
        self.assertIn("motion", body[0])
        self.assertIn("floor", body[0])

    def test_a_terminal_for_progress_and_a_file_for_the_table(self):
        with open(self.dir / "stdout", "w") as stdout:
            text = self.on_terminal(100, *RUN, stdout=stdout)
        self.assertEqual([line for line in self.screen(text) if line], [])
        table = (self.dir / "stdout").read_text()
        self.assertNotIn("\x1b", table)
        self.assertRegex(table, r"(?m)^8 rows: 8 ok")

    def test_without_a_terminal_progress_is_plain_lines_on_stderr(self):
        done = self.gnomon(*RUN)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotRegex(done.stdout + done.stderr, "[\r\x1b]")
        self.assertGreaterEqual(len(done.stderr.splitlines()), 1)
        for line in done.stderr.splitlines():
            self.assertRegex(line, r"^ *\d+ %  .*(point|sun) (unshadowed|shadow_map) \(process \d/2\)$")
        self.assertRegex(done.stdout.splitlines()[1] + done.stdout.splitlines()[0], "technique|support")
        self.assertNotIn("process 1/2", done.stdout)

    def test_quiet_says_nothing(self):
        done = self.gnomon("run", "--scene", "single_triangle", "--technique", "unshadowed", *HARD, *SMALL, "--quiet", "--out", "out")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_reader_that_leaves_early_is_no_error_of_ours(self):
        run = self.start("list", "scenes", "--json")
        run.stdout.close()
        run.wait(PATIENCE)
        self.assertEqual(run.stderr.read(), "")
        run.stderr.close()


if __name__ == "__main__":
    unittest.main()
