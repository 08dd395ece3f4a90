# SPDX-License-Identifier: Apache-2.0
"""prepare_part as a user runs it: the numbers of its report, what it refuses and with which exit code."""

import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PARTS, DriverTest, slit_obj


class PreparePart(DriverTest):
    def prepare(self, *arguments, code=0):
        run = self.drive("prepare_part", *arguments, "--json", "part.json")
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run, json.loads((self.folder / "part.json").read_text())

    def test_counts_and_measures_of_an_l(self):
        _, part = self.prepare("--builtin", "l", "--erode", "--dilation", "1e-3")
        self.assertEqual((part["regions"], part["chains"], part["face"]), (8, 18, 20))
        self.assertEqual((part["v_corner"], part["e_crease"], part["silent"]), (10, 17, 3), "two pits and one groove")
        cells = [part["active_vertices_" + c] for c in
                 ("both", "neither", "only_moravanszky_terdiman", "only_tangent_cone")]
        self.assertEqual((part["active_edges"], cells), (17, [10, 2, 0, 0]))
        self.assertEqual(part["erosion"], "done")
        self.assertLess(part["face_error"], 1e-12 * part["size"])
        self.assertAlmostEqual(part["edge_rounding"], 1e-3 * (math.sqrt(2) - 1), delta=1e-15)
        self.assertAlmostEqual(part["rounding"], 1e-3 * (math.sqrt(3) - 1), delta=1e-15)

    def test_a_vertex_inside_a_chain_is_put_on_it_and_told(self):
        (self.folder / "slit.obj").write_text(slit_obj())
        run, part = self.prepare("--mesh", self.folder / "slit.obj", "--scale", "1", "--dilation", "1e-3")
        self.assertEqual(part["straightened_vertices"], 1)
        self.assertAlmostEqual(part["straightened_by"], 8e-7, delta=1e-12)
        self.assertRegex(run.stdout, r"vertices put on straight chains\s+1, moved by up to 0\.8")

    def test_the_eroded_mesh_reads_back_in_the_units_of_the_file(self):
        mesh = PARTS / "socket.obj"
        self.prepare("--mesh", mesh, "--dilation", "5e-5", "--erode")

        def box(path):
            rows = [line.split()[1:4] for line in path.read_text().splitlines() if line.startswith("v ")]
            columns = list(zip(*[map(float, row) for row in rows]))
            return [(min(c), max(c)) for c in columns]

        for (lo, hi), (low, high) in zip(box(mesh), box(self.folder / "out" / "eroded.obj")):
            self.assertAlmostEqual(low - lo, 0.05, delta=1e-12)
            self.assertAlmostEqual(hi - high, 0.05, delta=1e-12)

    def test_a_thin_part_is_refused_with_its_thickness(self):
        run, part = self.prepare("--builtin", "l", "--erode", "--dilation", "6e-3", code=1)
        self.assertIn("0.01 m thick", run.stderr)
        self.assertIn("sheet", run.stderr)
        self.assertIn("erodes by up to 4900 um", run.stderr)
        self.assertEqual(part["erodible_depth"], 4.9e-3, "the largest of two digits below half the thickness")
        self.assertNotEqual(part["erosion"], "done")
        self.assertEqual(set(self.files()), {"out/part.html", "part.json"})
        run, _ = self.prepare("--builtin", "l", "--erode", "--dilation", "6e-3", "--fallback", "none")
        self.assertIn("the dilation adds to its size", run.stderr)

    def test_an_open_mesh_is_shown_and_not_eroded(self):
        sheet = self.folder / "sheet.obj"
        sheet.write_text("v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nf 1 2 3\nf 1 3 4\n")
        _, part = self.prepare("--mesh", sheet)
        self.assertEqual((part["solid"], part["regions"], part["e_wide"], part["v_wide"]), (False, 1, 4, 4))
        run, part = self.prepare("--mesh", sheet, "--erode", code=1)
        self.assertNotIn("erodible_depth", part, "no depth helps an open mesh")

    def test_a_fine_mesh_is_warned_about(self):
        run, part = self.prepare("--builtin", "ball", "--alpha", "20")
        self.assertIn("finer than the contacts need", run.stderr)
        self.assertLess(part["median_bend_degrees"], 20 / 3)


if __name__ == "__main__":
    unittest.main()
