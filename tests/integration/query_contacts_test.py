# SPDX-License-Identifier: Apache-2.0
"""query_contacts: what it prints about a pose is true of the pose, a path is its poses, bad input is named."""

import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PARTS, DriverTest, box_obj, slit_obj

USAGE, FILES, NOT_ACCEPTED = 2, 3, 1
PARTS_OF_PEG = ("--a", PARTS / "peg.obj", "--b", PARTS / "socket.obj")
COLUMNS = ["pose", "contacts", "min_gap", "ms", "node_pairs", "leaf_pairs"]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


class QueryContacts(DriverTest):
    def ask(self, *arguments, code=0):
        """stdout, and the JSON of the query."""
        run = self.drive("query_contacts", *arguments, "--json", "result.json")
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run.stdout, json.loads((self.folder / "result.json").read_text())

    def refused(self, code, words, *arguments):
        run = self.drive("query_contacts", *arguments, "--quiet", timeout=60)
        self.assertEqual(run.returncode, code, run.stderr)
        self.assertRegex(run.stderr, r"\Aquery_contacts: [^\n]*\n\Z")
        for word in words:
            self.assertIn(word, run.stderr)
        self.assertEqual(self.files(), {})

    def test_peg_in_socket_has_sixteen_contacts_at_its_play(self):
        """Ten wide in a socket with 0.05 mm of play a side, lower end above the bottom by 0.5 mm: four walls, each with
        the two corners of the chamfer and the two crossings at the rim."""
        text, result = self.ask(*PARTS_OF_PEG, "--pose", "0,0,0.5,1,0,0,0", "--threshold", 2e-4)
        self.assertEqual(len(result["contacts"]), 16)
        for contact in result["contacts"]:
            self.assertAlmostEqual(contact["gap"], 5e-5, 12)
            self.assertAlmostEqual(contact["normal"][2], 0, 12)
            self.assertEqual(contact["kinematics"], "ok")
        self.assertIn("16 contacts within 200 um, smallest gap 50 um", text)
        self.assertEqual(sum(line.split()[0].isdigit() for line in text.splitlines() if line.strip()), 16)

    def test_gaps_points_and_normals_fit_together(self):
        for builtin in ("box_on_plate", "cylinder_standing", "cylinder_lying", "peg", "gear"):
            _, result = self.ask("--builtin", builtin)
            self.assertGreater(len(result["contacts"]), 1, builtin)
            for c in result["contacts"]:
                between = [a - b for a, b in zip(c["point_a"], c["point_b"])]
                self.assertAlmostEqual(math.hypot(*c["normal"]), 1, 12)
                self.assertAlmostEqual(dot(between, c["normal"]), c["gap"], 10)
                self.assertLessEqual(c["gap"], result["options"]["threshold"])
                self.assertGreaterEqual(c["angle_margin"], 0)
                for feature in (c["feature_a"], c["feature_b"]):
                    self.assertEqual(len(feature["barycentric"]), feature["dim"] + 1)
                    self.assertAlmostEqual(sum(feature["barycentric"]), 1, 9)
            self.assertEqual(result["min_gap"], min(c["gap"] for c in result["contacts"]))

    def test_builtins_have_the_contacts_of_the_manual(self):
        for builtin, count in (("box_on_plate", 4), ("cylinder_standing", 24), ("cylinder_lying", 2)):
            _, result = self.ask("--builtin", builtin)
            self.assertEqual(len(result["contacts"]), count, builtin)

    def test_dilations_come_off_the_gaps(self):
        pose = ("--pose", "0,0,0.5,1,0,0,0", "--threshold", 2e-4)
        _, bare = self.ask(*PARTS_OF_PEG, *pose)
        _, dilated = self.ask(*PARTS_OF_PEG, *pose, "--dilation-a", 1e-5, "--dilation-b", 2e-5)
        self.assertEqual(dilated["a"]["dilation"], 1e-5)
        self.assertAlmostEqual(bare["min_gap"] - dilated["min_gap"], 3e-5, 14)

    def test_a_path_is_its_poses(self):
        path = ("--path", PARTS / "peg_out.csv", "--threshold", 2e-4)
        text, result = self.ask(*PARTS_OF_PEG, *path, "--csv", "poses.csv", "--threads", 2)
        rows = [line.split(",") for line in (self.folder / "poses.csv").read_text().splitlines()]
        self.assertEqual(rows[0], COLUMNS)
        self.assertEqual(len(rows) - 1, len(result["poses"]))
        for word in ("contacts", "min_gap", "node_pairs", "median", "p95"):
            self.assertIn(word, text)
        gaps = sorted(pose["min_gap"] for pose in result["poses"] if pose["min_gap"] is not None)
        self.assertEqual(result["summary"]["min_gap"]["min"], gaps[0])
        self.assertEqual(result["summary"]["min_gap"]["median"], gaps[math.ceil(len(gaps) / 2) - 1])
        self.assertEqual(result["summary"]["contacts"]["max"], max(pose["contacts"] for pose in result["poses"]))
        x, y, z, qw, qx, qy, qz = result["poses"][5]["pose"]
        pose = ",".join(map(repr, (1e3 * x, 1e3 * y, 1e3 * z, qw, qx, qy, qz)))
        _, alone = self.ask(*PARTS_OF_PEG, "--pose", pose, "--threshold", 2e-4)
        self.assertEqual(len(alone["contacts"]), result["poses"][5]["contacts"])
        self.assertAlmostEqual(alone["min_gap"], result["poses"][5]["min_gap"], 14)

    def test_threads_change_nothing(self):
        one, many = (self.ask("--builtin", "gear", "--threads", n)[1]["contacts"] for n in (1, 3))
        self.assertEqual(one, many)

    def test_pictures_are_pages(self):
        self.ask("--builtin", "peg", "--picture", "pages/peg.html")
        page = (self.folder / "pages" / "peg.html").read_text()
        self.assertIn("<html", page)
        self.assertGreater(len(page), 100000)

    def test_overlapping_bases_are_told(self):
        run = self.drive("query_contacts", *PARTS_OF_PEG, "--pose", "1,0,0.5,1,0,0,0")
        self.assertEqual(run.returncode, NOT_ACCEPTED)
        self.assertIn("the bases of peg and socket touch", run.stderr)
        _, result = self.ask(*PARTS_OF_PEG, "--pose", "1,0,0.5,1,0,0,0", code=NOT_ACCEPTED)
        self.assertIs(result["bases_touch"], True)
        _, result = self.ask(*PARTS_OF_PEG, "--pose", "1,0,0.5,1,0,0,0", "--unchecked")
        self.assertIsNone(result["bases_touch"])

    def test_the_smallest_gap_is_held_against_the_distance_of_the_bases(self):
        _, result = self.ask("--builtin", "box_on_plate")
        self.assertIs(result["covered"], True)
        _, result = self.ask("--builtin", "box_on_plate", "--unchecked")
        self.assertIsNone(result["covered"])
        _, result = self.ask(*PARTS_OF_PEG, "--pose", "0,0,100,1,0,0,0", "--threshold", "1e-4")
        self.assertIsNone(result["covered"])  # too far apart for contacts

    def test_a_part_inside_the_other_is_told(self):
        (self.folder / "cube.obj").write_text(box_obj(4))
        cube = ("--a", "cube.obj", "--b", PARTS / "socket.obj")
        _, result = self.ask(*cube, "--pose", "0,0,10,1,0,0,0")
        self.assertIs(result["nested"], False)
        _, result = self.ask(*cube, "--pose", "10,0,10,1,0,0,0", code=NOT_ACCEPTED)
        self.assertEqual((result["nested"], result["bases_touch"], result["contacts"]), (True, False, []))
        _, result = self.ask(*cube, "--pose", "10,0,10,1,0,0,0", "--unchecked")
        self.assertIsNone(result["nested"])
        (self.folder / "path.csv").write_text("x,y,z,qw,qx,qy,qz\n0,0,10,1,0,0,0\n10,0,10,1,0,0,0\n-9,0,9,1,0,0,0\n")
        run = self.drive("query_contacts", *cube, "--path", "path.csv", "--json", "result.json")
        self.assertEqual(run.returncode, NOT_ACCEPTED)
        self.assertIn("cube lies inside the solid of socket at pose 1, the first of 2 of 3 poses", run.stderr)
        poses = json.loads((self.folder / "result.json").read_text())["poses"]
        self.assertEqual([pose["nested"] for pose in poses], [False, True, True])

    def test_bad_input_is_named(self):
        at = (*PARTS_OF_PEG, "--pose")
        self.refused(USAGE, ["--pose = 1,2,3", "seven numbers"], *at, "1,2,3")
        self.refused(USAGE, ["--pose = 0,0,0,2,0,0,0"], *at, "0,0,0,2,0,0,0")
        self.refused(USAGE, ["--pose = nan,0,0,1,0,0,0"], *at, "nan,0,0,1,0,0,0")
        self.refused(USAGE, ["seven numbers"], *at, "0,0,0,1,0,0,0,1")
        self.refused(USAGE, ["--pose", "--path"], *PARTS_OF_PEG)
        self.refused(USAGE, ["--pose", "--path"], *at, "0,0,0,1,0,0,0", "--path", PARTS / "peg_out.csv")
        self.refused(USAGE, ["--a with --b", "--builtin"])
        self.refused(USAGE, ["--a and --b"], "--a", PARTS / "peg.obj")
        self.refused(USAGE, ["--builtin = cube", "box_on_plate"], "--builtin", "cube")
        self.refused(USAGE, ["--alpha-ee = 1 must be at least --alpha = ", "[deg]"], "--builtin", "peg", "--alpha-ee", 1)
        self.refused(USAGE, ["--threshold", "-1"], "--builtin", "peg", "--threshold", -1)
        self.refused(FILES, ["--a nowhere.obj: no such file"], "--a", "nowhere.obj", "--b", PARTS / "socket.obj")
        self.refused(FILES, ["--path nowhere.csv"], *PARTS_OF_PEG, "--path", "nowhere.csv")

    def test_a_cache_gives_the_same_contacts_and_says_what_it_did(self):
        pose = (*PARTS_OF_PEG, "--pose", "0,0,0.5,1,0,0,0", "--threshold", 2e-4)
        cache = ("--cache", "shapes")
        _, bare = self.ask(*pose)
        first, prepared = self.ask(*pose, *cache)
        self.assertRegex(first, r"cache: peg, mesh: prepared, kept in shapes/[0-9a-f]{16}\.h5\n")
        self.assertRegex(first, r"cache: peg: prepared, kept in shapes/[0-9a-f]{16}\.h5\n")
        second, loaded = self.ask(*pose, *cache)
        self.assertRegex(second, r"cache: peg, mesh: loaded from .*\ncache: socket, mesh: loaded from ")
        self.assertRegex(second, r"cache: peg: loaded from .*\ncache: socket: loaded from ")
        self.assertEqual(bare["contacts"], prepared["contacts"])
        self.assertEqual(bare["contacts"], loaded["contacts"])
        for file in (self.folder / "shapes").iterdir():
            file.write_bytes(file.read_bytes()[:-1])
        run = self.drive("query_contacts", *pose, *cache, "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(run.stderr.count("damaged: its checksum does not fit; prepared again"), 4, run.stderr)
        self.assertIn("loaded from", self.ask(*pose, *cache)[0])

    def test_a_cache_that_cannot_be_is_a_warning(self):
        run = self.drive("query_contacts", "--builtin", "peg", "--cache", PARTS / "peg.obj")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("warning: ", run.stderr)
        self.assertIn("not kept", run.stderr)

    def test_vertices_put_on_their_chain_are_a_note(self):
        """In whichever driver prepares the shape; a mesh without such vertices has none."""
        (self.folder / "slit.obj").write_text(slit_obj())
        (self.folder / "box.obj").write_text(box_obj(0.2))
        (self.folder / "path.csv").write_text("x,y,z,qw,qx,qy,qz\n0,0,0.62,1,0,0,0\n0.1,0,0.62,1,0,0,0\n")
        note = "slit: 1 vertex put on straight chains, moved by up to 0.8 um"
        _, result = self.ask("--a", "box.obj", "--b", "slit.obj", "--scale", 1, "--pose", "0,0,0.62,1,0,0,0",
                             "--dilation-a", 1e-3, "--dilation-b", 1e-3)
        self.assertEqual((result["a"]["notes"], result["b"]["notes"]), ([], [note]))
        self.replay("out", "--fixed", "slit.obj", "--moving", "box.obj", "--path", "path.csv", "--scale", 1,
                    "--mode", "kinematic")
        self.assertEqual(self.summary("out")["notes"], [note])
        run = self.drive("drop_part", "--mesh", "slit.obj", "--scale", 1, "--dilation", 1e-3, "--time", 0.002, "--quiet")
        self.assertEqual(run.stderr.splitlines()[0], f"warning: {note}")

    def test_pairs_of_the_data(self):
        _, result = self.ask("--data", self.data(), "--pair", "own_tslot", "--quiet")
        self.assertGreater(result["summary"]["contacts"]["max"], 10)
        self.assertFalse(any(pose["bases_touch"] for pose in result["poses"]))


if __name__ == "__main__":
    unittest.main()
