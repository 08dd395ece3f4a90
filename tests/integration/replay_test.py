# SPDX-License-Identifier: Apache-2.0
"""The main job: replays end at the end of their path, without a refused step, a failed solve or an overlap."""

import csv
import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PARTS, PEG, DriverTest

HOLD = 0.1  # the default of --hold [s]
THREADS = ("own_bolt_nut", "own_bolt_nut_fine", "factory_m16_loose")  # many turns, a thousand contacts


class Replay(DriverTest):
    def ends_well(self, *scene):
        self.assertNotIn("energy rose", self.replay("out", *scene, "--certify", "2").stderr)  # (LED-4)
        summary, steps = self.summary("out"), self.columns("out")
        numbers = {name: list(map(float, values)) for name, values in steps.items()}
        self.assertEqual(summary["refused_steps"], 0)
        self.assertEqual(summary["solver_failures"], 0)
        self.assertAlmostEqual(numbers["t"][-1], summary["path_time"] + HOLD, 9)
        self.assertEqual(len(numbers["t"]), summary["steps"])
        self.assertGreater(summary["min_base_distance"], 0)
        self.assertGreater(min(numbers["min_base_distance"]), 0)
        allowed = -(0.04 + 2e-3) * 2 * summary["dilation"]  # (CA-6), and what planes are off by (LMD-14)
        self.assertGreaterEqual(summary["min_gap"], allowed)
        self.assertGreaterEqual(min(numbers["min_gap"]), allowed)
        self.assertLessEqual(2 * summary["dilation"], 2 / 3 * summary["clearance"] * (1 + 1e-12))
        self.assertGreater(summary["max_contacts"], 0)
        self.assertLess(summary["energy_residual"], 1e-9)
        self.assertEqual(summary["certify_steps"], summary["steps"])
        self.assertEqual((summary["certify_violations"], summary["certify_uncovered"], summary["certify_nested"]), (0, 0, 0))
        self.assertFalse(list((self.folder / "out").glob("*.tmp")))

    def ends_well_on(self, pair):
        self.ends_well("--data", self.data(), "--pair", pair)
        self.assertEqual(self.summary("out")["pair"], pair)

    def test_peg_in_socket(self):
        self.ends_well(*PEG)

    def test_own_tslot(self):
        self.ends_well_on("own_tslot")

    def test_press_p1p2(self):
        self.ends_well_on("press_p1p2")

    def test_alpha20(self):
        self.ends_well_on("alpha20")

    def test_beginning_of_factory_m16_loose(self):
        """Five eighths of a turn of nine, all threads engaged."""
        self.ends_well(*self.beginning("factory_m16_loose", 6))
        self.assertGreater(min(map(int, self.columns("out")["contacts_found"])), 1000)

    def test_a_small_part_arrives_by_default(self):
        """A tenth of the peg hangs free at the end: at 20 Hz its weight pulls it g / omega^2 = 0.62 mm off."""
        small = (*PEG, "--scale", "1e-4")
        self.ends_well(*small)
        summary = self.summary("out")
        self.assertGreater(summary["frequency"], 20)
        self.assertAlmostEqual(summary["sag"], 9.803407 / (2 * math.pi * summary["frequency"]) ** 2, 9)
        run = self.replay("soft", *small, "--frequency", "20", code=1)
        self.assertRegex(run.stderr, r"the part did not arrive: .* its weight of \S+ N alone pulls it up to "
                                     r"0\.6208 mm off the path \(--frequency = 20 Hz\)")

    def test_a_part_of_centimetres_keeps_its_coupling(self):
        self.replay("out", *PEG, "--mode", "kinematic")
        self.assertEqual(self.summary("out")["frequency"], 20)

    def test_the_number_of_steps_is_told_before_the_first(self):
        run = self.drive("replay_assembly", *PEG, "-o", "out", "--summary", "out/summary.json")
        self.assertEqual(run.returncode, 0, run.stderr)
        told = run.stdout.index(" steps to take")
        self.assertLess(told, run.stdout.index("smallest gap"))
        taken = self.summary("out")["steps"]
        self.assertEqual(int(run.stdout[:told].split()[-1]), taken)  # none is cut
        self.assertEqual(run.stderr, "")  # no terminal, and done within ten seconds

    def test_wires_and_points_are_parts(self):
        """They touch nothing where they hang in the socket: a zigzag of two edges and a ball, whose mass is by hand."""
        (self.folder / "wire.obj").write_text("v 0 0 5\nv 1 0 8\nv 1 1 9\nl 1 2 3\n")
        (self.folder / "point.obj").write_text("v 0 0 10\np 1\n")
        (self.folder / "path.csv").write_text("x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n0,0,1,1,0,0,0\n")
        for name in ("wire", "point"):
            run = self.drive("replay_assembly", "--fixed", PEG[1], "--moving", f"{name}.obj", "--path", "path.csv", "--dilation",
                             "1e-4", "--threshold", "1e-4", "--mode", "kinematic", "-o", "out", "--summary", "out/summary.json")
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn("2 poses, no contact", run.stdout)
            self.assertNotIn("sheets", run.stderr)
        summary = self.summary("out")
        self.assertEqual(summary["mass_source"], "balls and capsules")
        self.assertAlmostEqual(summary["mass"], 7850 * 4 / 3 * math.pi * 1e-12, 18)

    def test_a_lead_follows_the_peg(self):
        """It hangs in its clip, pulls at the peg at rest, and no step overlaps more than it may."""
        lead = (*PEG, "--flexible", PARTS / "peg_lead.json")
        self.ends_well(*lead)
        summary, steps = self.summary("out"), self.columns("out")
        self.assertAlmostEqual(summary["peak_tension"], max(map(float, steps["tension"])), 12)
        self.assertAlmostEqual(summary["min_bend_radius"], min(map(float, steps["bend_radius"])), 12)
        self.assertGreater(summary["peak_tension"], 0.01)  # its weight below the top, half of its 5 mN, and more
        self.assertGreater(summary["min_bend_radius"], 2e-3)  # it bends more gently than on itself
        self.assertLess(summary["min_bend_radius"], 20e-3)  # it turns by half a circle between parts 36 mm apart
        bare = self.replay("bare", *PEG)
        self.assertEqual(bare.returncode, 0)
        self.assertNotIn("tension", self.columns("bare"))
        pull, bare_pull = (float(self.columns(out)["force"][-1]) for out in ("out", "bare"))
        self.assertGreater(abs(pull - bare_pull), 0.5e-3)  # a tenth of its weight
        self.assertLess(abs(pull - bare_pull), summary["peak_tension"])
        h5py = self.hdf5()
        with h5py.File(self.folder / "out" / "run.h5") as run:
            names = [name.decode() if isinstance(name, bytes) else name for name in run["body/name"][()]]
            pairs = {frozenset(pair) for pair in run["contact/pair"][()].tolist()}
        self.assertIn(frozenset((names.index("lead"), names.index("lead clip 1"))), pairs)

    def test_a_lead_that_no_part_moves_adds_nothing_to_the_force_on_the_peg(self):
        """Both ends on the socket, far from the peg; and clips may be on the moving part."""
        far = {"section": {"radius": 1e-3, "young": 2e7, "density": 1400, "bending_stiffness": 1e-5, "damping_time": 0.02},
               "elements": 30, "via": [[0, 0.035, 0.01]],
               "from": {"part": "fixed", "at": [-0.01, 0.018, 0.01], "along": [0, 1, 0]},
               "to": {"part": "fixed", "at": [0.012, 0.018, 0.01], "along": [0, -1, 0]}}
        self.replay("bare", *PEG)
        (self.folder / "far.json").write_text(json.dumps(far))
        self.replay("far", *PEG, "--flexible", "far.json")
        alone, with_lead = self.summary("bare"), self.summary("far")
        self.assertAlmostEqual(with_lead["peak_contact_force"], alone["peak_contact_force"], 6)
        self.assertAlmostEqual(with_lead["peak_force"], alone["peak_force"], 6)
        lead = json.loads((PARTS / "peg_lead.json").read_text())
        ring = {"part": "moving", "at": [0, 0, 0.035], "along": [0, 0, 1], "hole": 0.002, "thickness": 0.001}
        (self.folder / "two.json").write_text(json.dumps([{**lead, "via": [ring, *lead["via"]]}, {**far, "name": "far"}]))
        self.replay("two", *PEG, "--flexible", "two.json")
        self.assertEqual(self.summary("two")["refused_steps"], 0)

    def test_a_cable_of_too_few_elements_is_warned_of(self):
        lead = json.loads((PARTS / "peg_lead.json").read_text())
        warnings = {}
        for elements in (14, 80):
            (self.folder / "lead.json").write_text(json.dumps({**lead, "elements": elements}))
            run = self.replay("out", *PEG, "--flexible", "lead.json")
            warnings[elements] = [note for note in self.summary("out")["notes"] if "lead turns by" in note]
            self.assertEqual([line for line in run.stderr.splitlines() if "lead turns by" in line],
                             [f"warning: {note}" for note in warnings[elements]])
        self.assertRegex(warnings[14][0], r"\Alead turns by 0\.56 rad at node 3: .*; use at least 27 elements\Z")
        self.assertEqual(warnings[80], [])

    def test_two_points_have_the_clearance_of_their_nearest_pose(self):
        """They have no size that could bound it."""
        for name, x in (("fixed", 0), ("moving", 4)):
            (self.folder / f"{name}.obj").write_text(f"v {x} 0 0\np 1\n")
        (self.folder / "path.csv").write_text("x,y,z,qw,qx,qy,qz\n0,3,0,1,0,0,0\n0,0,0,1,0,0,0\n")
        run = self.drive("replay_assembly", "--fixed", "fixed.obj", "--moving", "moving.obj", "--path", "path.csv",
                         "--mode", "kinematic", "-o", "out", "--summary", "out/summary.json")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertAlmostEqual(self.summary("out")["clearance"], 4e-3, 15)  # not 5 mm, and not 0
        for told, distance in zip(self.columns("out", "poses.csv")["base_distance"], (5e-3, 4e-3), strict=True):
            self.assertAlmostEqual(float(told), distance, 15)

    def pairs(self):
        with open(Path(self.data()) / "assembly/pairs.csv", newline="", encoding="utf-8") as file:
            pairs = [row["name"] for row in csv.DictReader(file)]
        self.assertEqual(len(pairs), 18)
        return pairs

    def test_every_pair_without_a_thread_ends_well(self):
        """Contacts are missing nowhere on its way: (LMD-14) where each step ends, among all that ends_well asks."""
        for pair in self.pairs():
            if pair not in THREADS:
                with self.subTest(pair=pair):
                    self.ends_well_on(pair)

    def test_own_bolt_nut(self):
        self.ends_well_on("own_bolt_nut")

    def test_own_bolt_nut_fine(self):
        self.ends_well_on("own_bolt_nut_fine")

    def test_factory_m16_loose(self):
        self.ends_well_on("factory_m16_loose")

    def test_a_probe_lands_beside_a_vertex_inside_a_chain_of_a_real_nut(self):
        """Over that vertex, and 20 nm aside. Where face and chain were not of one geometry, the first touched nothing."""
        data = Path(self.data())
        for path in ("sit_nut_mm.csv", "sit_nut2_mm.csv"):
            with self.subTest(path=path):
                self.replay("out", "--fixed", data / "meshes/nut_387266.obj", "--moving", data / "audit/rs_nut_387266_probe.obj",
                            "--path", data / "audit" / path, "--gravity", "6.69507489,-6.90587651,1.9289743", "--dilation", "2e-5",
                            "--speed", "0.05", "--misalignment", "0", "--frequency", "0.05", "--hold", "0.05", "--certify", "10",
                            code=1)  # it rests on the nut, and does not follow
                summary = self.summary("out")
                self.assertGreater(summary["max_contacts"], 0)
                self.assertEqual((summary["refused_steps"], summary["certify_violations"], summary["certify_uncovered"]), (0, 0, 0))

    def test_every_recorded_pose_of_every_pair_is_covered(self):
        """(LMD-14) along all paths, with the dilations that replays take by default."""
        for pair in self.pairs():
            with self.subTest(pair=pair):
                self.replay(pair, "--data", self.data(), "--pair", pair, "--mode", "kinematic")
                summary = self.summary(pair)
                self.assertEqual(summary["uncovered_poses"], 0)
                self.assertGreater(summary["min_base_distance"], 0)

    def test_kinematic_gaps_are_the_clearances_of_the_recorded_poses(self):
        """At a recorded pose the smallest gap is the distance of the base complexes less the two dilations."""
        self.replay("out", *PEG, "--mode", "kinematic")
        summary, poses = self.summary("out"), self.columns("out", "poses.csv")
        near = 0
        for gap, distance in zip(map(float, poses["min_gap"]), map(float, poses["base_distance"])):
            if distance < 2 * summary["clearance"]:
                self.assertAlmostEqual(gap + 2 * summary["dilation"], distance, 9)
                near += 1
        self.assertGreater(near, 10)
        self.assertAlmostEqual(summary["min_base_distance"], summary["clearance"], 12)
        self.assertGreater(summary["cpu_s"], 1.1e-3 * sum(map(float, poses["ms_query"])))  # queries are not all

    def test_a_cache_changes_nothing_but_what_the_summary_says_of_it(self):
        runs = []
        for out in ("first", "second"):
            self.replay(out, *PEG, "--mode", "kinematic", "--cache", "shapes")
            poses = self.columns(out, "poses.csv")
            del poses["ms_query"]
            runs.append(poses)
        self.assertEqual(*runs)
        for word, out in (("prepared, kept in shapes/", "first"), ("loaded from shapes/", "second")):
            lines = self.summary(out)["cache"]
            self.assertEqual(len(lines), 6)  # of both parts the mesh, the shape for the clearance, and the dilated one
            for line in lines:
                self.assertIn(word, line)


if __name__ == "__main__":
    unittest.main()
