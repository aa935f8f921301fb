#!/usr/bin/python3 -IB
"""Files as people have them: each is read right, or refused with the reason, or says what it left out. tests/data/cases holds small
ones of the kinds that were once read wrongly, most of them the box 0 .. 1 of 12 triangles."""

import json
import re
import shutil
import sys
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import DATA, ProgramTest  # noqa: E402

CASES = DATA / "cases"
BOX = [[0, 0, 0], [1, 1, 1]]

# What is read: triangles, bounds, words of a note for each thing that was left out.
READ = {
    "bom_refused/bom.gltf": (12, BOX),
    "bom_refused/bom.obj": (12, BOX),
    "bom_refused/bom.ply": (12, BOX),
    "degenerate_not_counted/dup_corner.obj": (12, BOX, "2 triangles without area are dropped"),
    "degenerate_not_counted/scale_zero.gltf": (4, [[0, 0, 0], [0, 1, 1]], "8 triangles without area are dropped"),
    "gltf_animation/equal_times.gltf": (12, BOX, "1 animation moves meshes", "1 key of animations has the time of the key before"),
    "gltf_animation/float_weights.gltf": (12, None, "8 vertices have weights of joints whose sum is not 1", "1 animation moves meshes"),
    "gltf_animation/moves_no_mesh.gltf": (12, BOX, "1 animation moves no mesh and is left out"),
    "gltf_animation/one_key.gltf": (12, BOX, "1 animation moves meshes"),
    "gltf_animation/skin_without_ibm.gltf": (12, BOX, "1 animation moves meshes"),
    "gltf_morph_weights/morph_weight1.gltf": (12, [[0, 0, 0], [1, 4, 1]]),
    "gltf_quantized/quant_short.gltf": (12, BOX),
    "gltf_required_extension/gpu_instancing.gltf": (36, [[0, 0, 0], [7, 1, 1]]),
    "gltf_skin_pose/skin_armature_scale.gltf": (12, BOX),
    "gltf_skin_without_ibm/skin.glb": (8, [[0, 0, 0], [2, 1, 8]]),
    "gltf_unused_vertex/unused_vertex.gltf": (12, BOX),
    "gltf_uri_percent/uri_percent.gltf": (12, BOX),
    "obj_freeform_lost/mixed_freeform.obj": (12, BOX, "1 free-form curve or surface is left out"),
    "obj_inline_comment/comment_face.obj": (12, BOX),
    "obj_inline_comment/comment_face_num.obj": (12, BOX),
    "obj_inline_comment/vcomment_num.obj": (12, BOX),
    "obj_lines_lost/bom_shift.obj": (12, BOX),
    "obj_lines_lost/colours4.obj": (12, BOX),
    "obj_lines_lost/indent.obj": (12, BOX),
    "obj_lines_lost/indent_one_vertex.obj": (12, BOX),
    "obj_lines_lost/indent_some_faces.obj": (12, BOX),
    "obj_lines_lost/rgba_one_vertex.obj": (12, BOX),
    "obj_lines_lost/vcomment_one_4.obj": (12, BOX),
    "off_forms/comment_in_faces.off": (12, BOX),
    "off_forms/comment_in_vertices.off": (12, BOX),
    "off_forms/joined_header.off": (12, BOX),
    "off_forms/no_edges.off": (12, BOX),
    "ply_first_byte_lf/bin_first_byte_lf.ply": (12, None),
    "ply_other_element/camera_3_first.ply": (12, BOX, "1 element is left out: 'camera'"),
    "ply_other_element/camera_between.ply": (12, BOX, "1 element is left out: 'camera'"),
    "ply_other_element/camera_first_bin.ply": (12, BOX, "1 element is left out: 'camera'"),
    "ply_other_element/camera_simple_first.ply": (12, BOX, "1 element is left out: 'camera'"),
    "ply_tristrips/tristrips.ply": (4, [[0, 0, 0], [1, 2, 0]]),
    "ply_tristrips/tristrips_and_face.ply": (5, [[0, 0, 0], [1, 2, 0]]),
    "ply_tristrips/tristrips_restart.ply": (3, [[0, 0, 0], [1, 2, 0]]),
    "stl_ascii_forms/bom.stl": (12, BOX),
    "stl_ascii_forms/hash_name.stl": (12, BOX),
    "stl_ascii_forms/lead_space.stl": (12, BOX),
    "stl_ascii_forms/mixedcase.stl": (12, BOX),
    "stl_ascii_forms/name_endsolid.stl": (12, BOX),
    "stl_ascii_forms/name_facet.stl": (12, BOX),
    "stl_ascii_forms/upper.stl": (12, BOX),
}

# What is refused: words of the reason.
REFUSED = {
    "gltf_animation/joints_out_of_range.gltf": ["skin 0 names node 7 of 2"],
    "gltf_animation/matrix_node.gltf": ["animation 0, channel 0 moves node 0", "has a matrix"],
    "gltf_animation/no_keys.gltf": ["animation 0, channel 0", "no keys", "one at least"],
    "gltf_animation/node_out_of_range.gltf": ["animation 0, channel 0 names node 5 of 1"],
    "gltf_animation/output_short.gltf": ["animation 0, channel 0", "2 keys with tangents and 2 elements of output; 6 are wanted"],
    "gltf_animation/rotation_zero.gltf": ["animation 0, channel 0, key 1", "rotation = (0, 0, 0, 0)"],
    "gltf_animation/sampler_out_of_range.gltf": ["animation 0, channel 0 names sampler 2 of 1"],
    "gltf_animation/time_nan.gltf": ["animation 0, channel 0, key 1", "time = nan", "0 or more"],
    "gltf_animation/time_negative.gltf": ["animation 0, channel 0, key 0", "time = -1", "0 or more"],
    "gltf_animation/times_back.gltf": ["animation 0, channel 0, key 2", "time = 0.5 is below 1", "must ascend"],
    "gltf_animation/two_channels.gltf": ["animation 0, channel 1 moves the translation of node 0", "one for each property"],
    "gltf_animation/unknown_interpolation.gltf": ["animation 0, channel 0", "'BEZIER'", "LINEAR, STEP, CUBICSPLINE"],
    "gltf_animation/unknown_path.gltf": ["animation 0, channel 0", "'color'", "translation, rotation, scale, weights"],
    "gltf_animation/value_infinite.gltf": ["animation 0, channel 0, key 1", "value = inf"],
    "gltf_bad_indices/count_not_multiple.gltf": ["mesh 0, primitive 0", "35 indices make no triangles"],
    "gltf_bad_indices/index_out_of_range.gltf": ["mesh 0, primitive 0", "names vertex 8", "0 .. 7"],
    "gltf_bad_indices/index_restart.gltf": ["mesh 0, primitive 0", "65535", "restarts"],
    "gltf_required_extension/min_version.gltf": ["2.1", "2.0"],
    "gltf_required_extension/unknown_required.gltf": ["ACME_geometry_v2", "KHR_mesh_quantization"],
    "obj_number_tail/number_0x10.obj": [":8", "'0x10' is not a number"],
    "obj_number_tail/number_1.5D+03.obj": [":8", "'1.5D+03' is not a number"],
}


class Cases(ProgramTest):
    def describe(self, name):
        return json.loads(self.succeed("describe", CASES / name, "--json"))

    def test_what_is_read_has_its_triangles_and_bounds_and_says_what_it_left_out(self):
        for name, (triangles, bounds, *left_out) in READ.items():
            with self.subTest(name):
                scene = self.describe(name)
                self.assertEqual(scene["triangles"], triangles)
                if bounds:
                    self.assertEqual([scene["bounds"]["min"], scene["bounds"]["max"]], bounds)
                notes = [note for note in scene["notes"] if not re.search(r"no (view|light) given", note)]
                self.assertEqual(len(notes), len(left_out), notes)
                for words, note in zip(left_out, notes):
                    self.assertIn(words, note)

    def test_what_is_refused_says_where_and_why(self):
        for name, words in REFUSED.items():
            with self.subTest(name):
                self.refuse("describe", CASES / name, says=[name.rsplit("/", 1)[1], *words])

    def test_every_file_of_meshes_is_in_these_lists(self):
        elsewhere = re.compile(r"png_alpha|exr_windows|near_plane|direction_length|gltf_(light|same|spot)")
        files = {str(file.relative_to(CASES)) for file in CASES.glob("*/*")
                 if file.suffix not in {".toml", ".bin", ".mtl"} and not elsewhere.match(str(file.relative_to(CASES)))}
        self.assertEqual(files, set(READ) | set(REFUSED))

    def test_lights_and_cameras_stand_at_their_nodes(self):
        def places(name, kind, key):
            return [[round(value, 3) for value in item[key]] for item in self.describe(name)[kind]]

        self.assertEqual(places("gltf_light_shared/light_shared.gltf", "lights", "position"), [[0, 5, 0], [4, 5, 0]])
        self.assertEqual(sorted(position[0] for position in places("gltf_light_shared/street_lamps.gltf", "lights", "position")),
                         [round(0.1 * k, 3) for k in range(40)])
        same = "gltf_same_node_name/"
        self.assertEqual(places(same + "light_same_name.gltf", "lights", "position"), [[0, 5, 0], [4, 5, 0]])
        self.assertEqual(places(same + "light_name_of_other_node.gltf", "lights", "position"), [[4, 5, 0]])
        for name in ("camera_same_name.gltf", "camera_shared.gltf"):
            self.assertEqual(places(same + name, "views", "eye"), [[0.5, 0.5, 5], [0.5, 0.5, 9]])

    def test_a_spot_of_90_degrees_is_read_as_nearly_one(self):
        scene = self.describe("gltf_spot_90/spot_pi2.gltf")
        self.assertAlmostEqual(scene["lights"][0]["outer_degrees"], 89.9, 4)
        self.assertTrue(any("spot of 90 degrees" in note for note in scene["notes"]), scene["notes"])

    def test_masks_are_placed_by_their_windows_and_alpha_multiplies_nothing(self):
        def wrong(scene, *mask):
            return json.loads(self.succeed("score", "--scene", CASES / scene, *mask, "--json"))[0]["metrics"]["wrong_rate"]

        windows, alpha = CASES / "exr_windows", CASES / "png_alpha"
        self.assertEqual(wrong("exr_windows/b.toml", "--mask", windows / "overscan.exr", "--channel", "R"), 0)
        for name in ("crop.exr", "shifted.exr"):
            self.refuse("score", "--scene", windows / "b.toml", "--mask", windows / name, "--channel", "R", says=[name, "window"])
        for name in ("ga_alpha0.png", "trns.png"):
            mask = ["--light", "p", "--channel", "Y", "--mask", alpha / name]
            self.assertEqual(wrong("png_alpha/b.toml", *mask), 0, name)

    def test_vertices_that_no_face_uses_frame_nothing(self):
        scene = CASES / "gltf_unused_vertex/unused_vertex.gltf"
        self.succeed("export", "--scene", scene, "--size", "16x9", "--out", "true")
        arrays = json.loads((self.dir / "true/scene.json").read_text())["arrays"]
        positions, triangles = (numpy.load(self.dir / "true" / arrays[name]["file"]) for name in ("position", "triangle"))
        used, triangles = numpy.unique(triangles, return_inverse=True)
        self.assertEqual(len(used), 8)
        lines = ["v %r %r %r" % tuple(map(float, positions[k])) for k in used]
        self.write("box.obj", "\n".join(lines + ["f %d %d %d" % tuple(t + 1) for t in triangles.reshape(-1, 3)]) + "\n")
        classes = []
        for name in (scene, "box.obj"):
            self.succeed("render", "--scene", name, "--technique", "svbsp", "--size", "160x90", "--out", "out")
            classes.append(json.loads((self.dir / "out/record.json").read_text())[0]["classes"])
            shutil.rmtree(self.dir / "out")
        self.assertEqual(*classes)
        self.assertGreater(classes[0]["T"], 2000)


if __name__ == "__main__":
    unittest.main()
