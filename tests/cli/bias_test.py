#!/usr/bin/python3 -IB
"""Biases with numbers of their own: where a preset is refused and how, what rows it gives, and that suite `bias` has every rule."""

import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import NUMBERS, ProgramTest, records  # noqa: E402

SUN_ALONE = ("godot", "unity", "unreal")
ALL_LIGHTS = ("adaptive", "oriented", "bevy", "filament", "three_js")
# A sun, and a box of 2 mm: shorter than the 2 cm of bevy.
SMALL_SCENE = """
[[shape]]
kind = "box"
min = [-0.001, 0, -0.001]
max = [0.001, 0.001, 0.001]

[[light]]
name = "sun"
kind = "directional"
direction = [0.3, -1, 0.2]

[[view]]
name = "main"
eye = [0.004, 0.003, 0.005]
target = [0, 0, 0]
"""


class Bias(ProgramTest):
    def test_a_preset_is_refused_under_a_light_that_it_does_not_define(self):
        for name in SUN_ALONE:
            done = self.gnomon("render", "--scene", "contact", "--light", "point", "--technique", f"shadow_map:bias={name}",
                               "--size", "64x36", "--out", "out")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"bias={name} has no number for a point light: its", done.stderr)

    def test_a_preset_longer_than_the_scene_is_refused(self):
        (self.dir / "small.toml").write_text(SMALL_SCENE)
        done = self.gnomon("render", "--scene", "small.toml", "--technique", "shadow_map:bias=bevy", "--size", "64x36", "--out", "out")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("bias=bevy is 0.02 m toward the light, longer than the scene, whose diagonal is 0.003 m", done.stderr)

    def test_rows_of_presets_are_measured_or_say_why_not(self):
        rules = ",".join((*ALL_LIGHTS, *SUN_ALONE))
        self.succeed("run", "--scene", "contact", "--light", "point", "--light", "sun", "--technique", f"shadow_map:bias={{{rules}}}",
                     *NUMBERS, "--out", "out")
        rows = {(row["light"], row["parameters"]["bias"]): row for row in records(self.dir / "out")}
        self.assertEqual(len(rows), 2 * (len(ALL_LIGHTS) + len(SUN_ALONE)))
        for (light, rule), row in rows.items():
            is_defined = light == "sun" or rule in ALL_LIGHTS
            self.assertEqual(row["status"], "ok" if is_defined else "unsupported", (light, rule))
            self.assertIn("" if is_defined else f"bias={rule} has no number", row["reason"] or "")

    def rules(self):
        """All choices, as the refusal of another one lists them."""
        done = self.gnomon("render", "--scene", "contact", "--technique", "shadow_map:bias=none_such", "--out", "out")
        self.assertEqual(done.returncode, 2, done.stderr)
        return set(re.search(r"shadow_map\.bias = none_such is outside ([\w |]*\w)", done.stderr)[1].split(" | "))

    def test_suite_bias_has_every_rule_at_every_resolution(self):
        rules = self.rules()
        self.assertGreaterEqual(rules, {*ALL_LIGHTS, *SUN_ALONE})
        lines = self.succeed("run", "bias", "--dry-run").splitlines()
        for rule in rules:
            # The default is not written.
            own = r"[:,]bias=" + rule if rule != "slope" else r"shadow_map(?!.*[:,]bias=)"
            resolutions = {match[1] for line in lines if re.search(own, line) and (match := re.search(r"resolution=(\d+)", line))}
            self.assertEqual(resolutions, {"512", "1024", "2048"}, rule)


if __name__ == "__main__":
    unittest.main()
