#!/usr/bin/python3 -IB
"""What surrounds a run does not spoil it: closed descriptors, limits, links and pipes where files are meant, processes that a technique
leaves behind, words that are commands elsewhere."""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import GONE, PATIENCE, PROGRAM_SHEET, ProgramTest, records, wait_until  # noqa: E402

ROW = ["run", "--scene", "single_triangle", "--light", "sun", "--processes", "1", "--repetitions", "1", "--size", "80x45"]
ANSWERS = """
for line in sys.stdin:
    r = json.loads(line)
    a = fault(r)
    if a is None:
        if r["do"] == "resolve":
            h, w = r["mask"]["shape"]
            with open(r["mask"]["file"], "r+b") as f:
                f.write(struct.pack("<f", 1.0) * (w * h))
        a = {"protocol": 1} if r["do"] == "hello" else {"support": "full"} if r["do"] == "supports" else {"ms": 0.0}
    print(json.dumps(a), flush=True)
"""


class Surroundings(ProgramTest):
    def program(self, name, fault="    return None", more=""):
        """A technique that is a program, with a body of fault(request): what it answers in place of what it should, or None."""
        self.write(f"{name}.toml", PROGRAM_SHEET.format(id=name) + more)
        self.write(f"{name}.py", f"import json, os, struct, subprocess, sys, time\n\ndef fault(r):\n{fault}\n{ANSWERS}")
        return ["--program", f"{name}.toml", *ROW, "--technique", name]

    def marked(self, seconds):
        """Processes `sleep SECONDS`: a number that nobody else waits for."""
        done = subprocess.run(["pgrep", "-f", "-x", f"/bin/sleep {seconds}"], capture_output=True, text=True)
        return [int(line) for line in done.stdout.split()]

    def assert_none_left(self, seconds):
        try:
            wait_until(lambda: not self.marked(seconds), f"/bin/sleep {seconds} to be gone", GONE)
        finally:
            for process in self.marked(seconds):
                os.kill(process, signal.SIGKILL)

    # Descriptors, limits and files

    def test_closed_standard_descriptors_are_no_place_for_records(self):
        for closed in ("2>&-", ">&- 2>&-", "<&- 2>&-", "<&- >&- 2>&-"):
            with self.subTest(closed):
                shutil.rmtree(self.dir / "out", ignore_errors=True)
                words = self.command(*ROW, "--technique", "unshadowed", "--technique", "embree_rays", "--out", "out")
                subprocess.run(["/bin/sh", "-c", f'exec "$@" {closed}', "sh", *words], cwd=self.dir, env=self.environment,
                               stdout=subprocess.DEVNULL, timeout=PATIENCE)
                self.assertEqual([row["status"] for row in records(self.dir / "out")], ["ok", "ok"])

    def test_a_limit_of_file_sizes_is_an_error_with_words(self):
        for limit in (0, 4096):
            shutil.rmtree(self.dir / "out", ignore_errors=True)
            done = self.gnomon(*ROW, "--technique", "unshadowed", "--out", "out",
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
            self.assertIn(done.returncode, (1, 2), done.stderr)
            self.assertIn("File too large", done.stdout + done.stderr)

    def test_too_few_files_that_may_be_open_cost_rows_and_no_time(self):
        for most in (6, 12, 18, 24, 40):
            with self.subTest(most):
                shutil.rmtree(self.dir / "out", ignore_errors=True)
                done = self.gnomon(*ROW, "--technique", "unshadowed", "--out", "out",
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (most, most)))
                self.assertIn(done.returncode, (0, 1, 2), done.stderr)
                for row in records(self.dir / "out"):
                    self.assertTrue(row["status"] == "ok" or "files" in row["reason"], row["reason"])

    def test_a_reader_that_goes_ends_the_program_by_no_signal(self):
        reader, writer = os.pipe()
        os.close(reader)  # before it can have written all
        done = subprocess.run(self.command("list", "techniques"), stdout=writer, stderr=subprocess.PIPE, text=True, env=self.environment,
                              timeout=PATIENCE, check=False)
        os.close(writer)
        self.assertEqual((done.returncode, done.stderr), (2, ""))

    def test_links_in_cache_and_run_are_replaced_and_not_followed(self):
        self.succeed(*ROW, "--technique", "unshadowed", "--out", "a")
        precious = self.write("precious.txt", "precious\n")
        cache = Path(self.environment["GNOMON_CACHE"])
        for frame in [*(cache / "frames").glob("*.gbuffer"), *(cache / "frames").glob("*.reference")]:
            frame.unlink()
            frame.symlink_to(precious)
        self.succeed(*ROW, "--technique", "unshadowed", "--out", "b")
        (self.dir / "c").mkdir()
        mask = records(self.dir / "a")[0]["mask"]
        (self.dir / "c" / mask).parent.mkdir()
        for name in (mask, "table.md"):
            (self.dir / "c" / name).symlink_to(precious)
        self.succeed(*ROW, "--technique", "unshadowed", "--out", "c")
        self.assertEqual(precious.read_text(), "precious\n")
        self.assertFalse((self.dir / "c" / mask).is_symlink())

    @unittest.skipUnless(os.geteuid() == 0, "who is not root cannot give a folder away")
    def test_the_cache_of_another_user_is_read_and_not_written(self):
        cache = self.dir / "cache"
        self.environment["GNOMON_CACHE"] = str(cache)
        self.succeed(*ROW, "--technique", "unshadowed", "--out", "a")
        for path in [cache, *cache.rglob("*")]:
            os.chown(path, 12345, 12345)
        before = {str(path): path.stat() for path in [cache, *cache.rglob("*")]}
        self.succeed(*ROW, "--technique", "unshadowed", "--light", "point", "--out", "b")
        after = {str(path): path.stat() for path in [cache, *cache.rglob("*")]}
        facts = [{name: (s.st_ino, s.st_size, s.st_mtime_ns) for name, s in some.items()} for some in (before, after)]
        self.assertEqual(*facts)
        mask = records(self.dir / "a")[0]["mask"]
        self.assertEqual((self.dir / "a" / mask).read_bytes(), (self.dir / "b" / records(self.dir / "b")[0]["mask"]).read_bytes())

    def test_pipes_in_the_cache_are_no_files(self):
        cache = self.dir / "cache"
        cache.mkdir()
        os.mkfifo(cache / "history.jsonl")
        self.environment["GNOMON_CACHE"] = str(cache)
        self.succeed(*ROW, "--technique", "unshadowed", "--out", "out")
        self.assertTrue((cache / "history.jsonl").is_fifo())

    # Processes

    def test_what_a_technique_starts_ends_with_the_run(self):
        escape = ('    if r["do"] == "build":\n        subprocess.Popen(["/usr/bin/env", "-i", "/bin/sleep", "71721"], '
                  "start_new_session=True, stdin=-3, stdout=-3, stderr=-3)")
        self.succeed(*self.program("escapes", escape), "--out", "out")
        self.assert_none_left(71721)

    def test_what_a_technique_starts_ends_with_a_killed_run(self):
        waits = ('    if r["do"] == "build":\n        subprocess.Popen(["/usr/bin/env", "-i", "/bin/sleep", "71722"], '
                 "start_new_session=True, stdin=-3, stdout=-3, stderr=-3)\n        time.sleep(100)")
        words = self.program("waits", waits)
        for number in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT):
            with self.subTest(number.name):
                shutil.rmtree(self.dir / "out", ignore_errors=True)
                run = self.start(*words, "--quiet", "--out", "out")
                wait_until(lambda: self.marked(71722), "the program to start something")
                run.send_signal(number)
                self.assertEqual(run.wait(PATIENCE), -number)
                run.communicate()
                self.assert_none_left(71722)

    def test_who_kills_what_keeps_it_ends_too(self):
        betrays = ('    if r["do"] == "build":\n        subprocess.Popen(["/usr/bin/env", "-i", "/bin/sleep", "71724"], '
                   "start_new_session=True, stdin=-3, stdout=-3, stderr=-3)\n"
                   '        worker = open(f"/proc/{os.getppid()}/stat").read().rsplit(")", 1)[1].split()\n'
                   "        os.kill(int(worker[1]), 9)\n        time.sleep(100)")
        done = self.gnomon(*self.program("betrays", betrays), "--out", "out")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assert_none_left(71724)

    def test_what_a_need_asks_for_leaves_nothing(self):
        words = self.program("needs", more='[[need]]\nruns = ["/bin/sh", "-c", "/bin/sleep 71723 & exit 0"]\ninstall = "x"\n')
        started = time.monotonic()
        self.succeed(*words, "--dry-run")  # its output is a pipe, which ends when everybody has let it go
        self.assertLess(time.monotonic() - started, PATIENCE)
        self.assert_none_left(71723)

    def test_of_what_a_program_says_the_end_is_kept(self):
        says = ('    if r["do"] == "build":\n        for k in range(200):\n            os.write(2, b"e" * (1 << 20))\n'
                '        os.write(2, b"\\nlast words\\n")\n        os._exit(3)')

        def shared():
            lines = Path("/proc/meminfo").read_text().splitlines()
            return next(int(line.split()[1]) >> 10 for line in lines if line.startswith("Shmem:"))

        before, most = shared(), 0
        run = self.start(*self.program("says", says), "--quiet", "--out", "out")
        while run.poll() is None:
            most = max(most, shared())
            time.sleep(0.02)
        run.communicate()
        self.assertLess(most - before, 150)  # megabytes, beside what others do
        self.assertIn("last words", records(self.dir / "out")[0]["reason"])

    def test_what_a_program_shortens_costs_its_row(self):
        shortens = ('    if r["do"] == "resolve":\n        for folder, _, files in os.walk(os.path.dirname(os.path.dirname(os.path.dirname('
                    'r["mask"]["file"])))):\n            for name in files:\n                os.truncate(os.path.join(folder, name), 0)')
        done = self.gnomon(*self.program("shortens", shortens), "--technique", "unshadowed", "--timeout", "20", "--out", "out")
        self.assertIn(done.returncode, (0, 1), done.stderr)  # it may write its mask anew
        rows = {row["technique"]: row["status"] for row in records(self.dir / "out")}
        self.assertEqual(rows["unshadowed"], "ok")

    # Words

    def test_escapes_reach_no_terminal(self):
        fails = '    if r["do"] == "build":\n        return {"error": "\\x1b[2J \\r overwritten"}'
        done = self.gnomon(*self.program("fails", fails), "--out", "out")
        said = done.stdout + done.stderr + self.succeed("table", "out")
        self.assertNotIn("\x1b", said)
        self.assertIn(r"\x1b[2J", records(self.dir / "out")[0]["reason"])
        row = records(self.dir / "out")[0]
        for key, text in (("scene", "\x1b[2Jx"), ("label", "\x1b]0;title\x07"), ("reason", "a\x9bb")):
            (self.dir / "out/records.jsonl").write_text(json.dumps({**row, key: text}) + "\n")
            for arguments in (["table", "out"], ["table", "out", "--format", "tex"], ["analyze", "out", "best"]):
                done = self.gnomon(*arguments)
                self.assertFalse(set("\x1b\x07\x9b") & set(done.stdout + done.stderr), (key, arguments))
        self.write("fails.toml", (self.dir / "fails.toml").read_text().replace('"T"', '"\\u001b[31mT"'))
        self.refuse("--program", "fails.toml", "list", "techniques", says=["title", "control characters"])

    def test_names_of_figures_are_names(self):
        if not shutil.which("gnuplot"):
            self.skipTest("gnuplot is not installed")
        self.succeed(*ROW, "--technique", "shadow_map:resolution=64", "--out", "out")
        for name in ("|touch made;x.svg", "a b='c'.svg", "Jörg #1.svg", "-x.svg"):
            self.succeed("figure", "out", "front", "--out", f"figures/{name}" if name != "-x.svg" else "./-x.svg")
        self.assertFalse((self.dir / "made").exists() or (self.dir / "figures/made").exists())
        self.assertEqual(len(list((self.dir / "figures").iterdir())), 3)

    def test_fields_of_csv_are_no_formulas(self):
        self.succeed(*ROW, "--technique", "unshadowed", "--out", "out")
        row = records(self.dir / "out")[0]
        for label in ("=cmd|'/C calc'!A0", "@SUM(1)", "+1+cmd|' /C calc'!A0"):
            (self.dir / "out/records.jsonl").write_text(json.dumps({**row, "label": label}) + "\n")
            text = self.succeed("table", "out", "--format", "csv", "--columns", "label", "technique")
            self.assertTrue(text.splitlines()[-1].startswith("\"'"), text)

    def test_a_command_is_a_list_of_texts(self):
        self.program("number")
        sheet = self.dir / "number.toml"
        sheet.write_text(sheet.read_text().replace('"-IB"', "5"))
        self.refuse("--program", "number.toml", "describe", "number", says=["command", "word 2 is no text", "number.toml:6"])


if __name__ == "__main__":
    unittest.main()
