#!/usr/bin/python3 -IB
"""scripts/setup: the names of each release, and what it says of a package that a release does not have. Nothing is installed."""

import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PATIENCE, ROOT, ProgramTest  # noqa: E402

# What stands in for apt: `installed` and `absent` are lists of packages in the folder above.
TOOLS = {
    "dpkg-query": 'for name; do if grep -qxF -- "$name" ../installed; then echo "installed $name"; fi; done',
    "apt-cache": 'shift; for name; do if ! grep -qxF -- "$name" ../absent; then printf "%s:\\n  Installed: (none)\\n  Candidate: 1\\n" "$name"; fi; done',
    "apt-get": 'echo "$@" >>../calls',
    "sudo": 'exec "$@"',
    "npm": "",
    "cmake": 'echo "cmake version $(cat ../cmake)"',
}


class Setup(ProgramTest):
    def setUp(self):
        super().setUp()
        if not shutil.which("dpkg"):
            self.skipTest("there is no dpkg")
        (self.dir / "scripts").mkdir()
        for name in ("scripts/setup", "scripts/lib.sh", "CMakeLists.txt"):
            shutil.copy(ROOT / name, self.dir / name)
        (self.dir / "tools").mkdir()
        for name, text in TOOLS.items():
            tool = self.dir / "tools" / name
            tool.write_text(f'#!/bin/bash\ncd "{self.dir}/tools"\n{text}\n')
            tool.chmod(0o755)
        for name in ("installed", "absent", "calls"):
            (self.dir / name).touch()
        (self.dir / "cmake").write_text("3.25.1")

    def run_setup(self, *arguments, status=0):
        done = subprocess.run([self.dir / "scripts/setup", *arguments], env=dict(os.environ, PATH=f"{self.dir}/tools:{os.environ['PATH']}"),
                              cwd="/", stdin=subprocess.DEVNULL, text=True, capture_output=True, timeout=PATIENCE)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def names(self, *arguments):
        return self.run_setup("--list", *arguments).stdout.split()

    def test_names_are_those_of_the_release(self):
        for release, version in (("debian 12", 14), ("debian 13", 19), ("ubuntu 22.04", 14), ("ubuntu 24.04", 18)):
            names = self.names("--check", "--release", release)
            self.assertEqual([name for name in names if name.startswith("libclang-rt-")], [f"libclang-rt-{version}-dev"], release)
            self.assertEqual("g++-12" in names, release == "ubuntu 22.04", release)

    def test_the_program_alone_needs_less(self):
        program, whole = self.names("--program"), self.names()
        self.assertLess(set(program), set(whole))
        self.assertEqual({"libgtest-dev", "librapidcheck-dev", "libglfw3-dev", "libimgui-dev"}, set(whole) - set(program))
        self.assertIn("libembree-dev", program)

    def test_what_a_release_lacks_is_named_and_the_rest_is_installed(self):
        (self.dir / "absent").write_text("libembree-dev\nunzip\n")
        (self.dir / "installed").write_text("git\n")
        said = self.run_setup("--release", "ubuntu 22.04", status=1).stderr
        self.assertIn("ubuntu 22.04 has no package libembree-dev: it is for rays.", said)
        self.assertTrue(said.endswith("ubuntu 22.04 has no package unzip\n"), said)
        install = (self.dir / "calls").read_text().splitlines()[-1].split()
        self.assertIn("libtbb-dev", install)
        for name in ("libembree-dev", "unzip", "git"):
            self.assertNotIn(name, install)

    def test_where_nothing_is_missing_nothing_is_called(self):
        (self.dir / "installed").write_text("\n".join(self.names()))
        self.run_setup()
        self.assertEqual((self.dir / "calls").read_text(), "")

    def test_an_old_cmake_is_told(self):
        for version, status in (("3.22.1", 1), ("3.25.0", 0), ("3.31.6", 0), ("4.1.0", 0)):
            (self.dir / "cmake").write_text(version)
            said = self.run_setup(status=status).stderr
            self.assertEqual(f"CMake {version} is too old: 3.25 or newer is needed" in said, bool(status), said)

    def test_bad_words_are_refused(self):
        for words in (["--nonsense"], ["--release"]):
            self.assertIn("is not an argument of it", self.run_setup(*words, status=2).stderr)


if __name__ == "__main__":
    unittest.main()
