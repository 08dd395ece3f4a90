# SPDX-License-Identifier: Apache-2.0
"""reduction_gallery: what its pictures show is what the reducers promise."""

import json
import math
import os
import sys
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

RED = "#c53030"  # of what is kept


class ReductionGallery(DriverTest):
    def test_draws_what_is_kept_of_four_parts(self):
        run = self.drive("reduction_gallery", "--quiet", "--summary", "s.json")
        self.assertEqual(run.returncode, 0, run.stderr + run.stdout)
        summary = json.loads((self.folder / "s.json").read_text())
        for part in ("cylinder", "torus", "gear", "peg"):
            picture = ElementTree.parse(self.folder / f"out/reduction_{part}.svg").getroot()
            red = sum(e.get("fill") == RED for e in picture.iter("{http://www.w3.org/2000/svg}circle"))
            everything, *kept = summary[f"{part}_kept"]
            self.assertEqual(red, sum(kept), part)
            self.assertGreaterEqual(everything, 24)
            self.assertTrue(all(k < everything for k in kept[:3]), part)
            self.assertEqual(summary[f"{part}_margin"][0], 1)
        again = self.drive("reduction_gallery", "--quiet", "-o", "again")
        self.assertEqual(again.returncode, 0)
        for part in ("cylinder", "gear"):
            name = f"reduction_{part}.svg"
            self.assertEqual((self.folder / "out" / name).read_bytes(), (self.folder / "again" / name).read_bytes())

    # A ring of twelve tips and the middle, seen from above once y is up.
    def test_draws_a_part_of_a_file(self):
        corners = [(math.cos(math.pi * i / 6), math.sin(math.pi * i / 6)) for i in range(12)]
        points = [(x, y, z) for y in (0, 0.4) for z, x in [(0, 0), *corners]]
        faces = []
        for i in range(12):
            a, b = 2 + i, 2 + (i + 1) % 12
            faces += [(1, b, a), (14, a + 13, b + 13), (a, b, b + 13), (a, b + 13, a + 13)]
        mesh = self.folder / "disc.obj"
        mesh.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in points) + "".join(f"f {a} {b} {c}\n" for a, b, c in faces))
        run = self.drive("reduction_gallery", "--mesh", "disc.obj", "--scale", "0.05", "--up", "y", "--quiet", "--summary", "s.json")
        self.assertEqual(run.returncode, 0, run.stderr + run.stdout)
        summary = json.loads((self.folder / "s.json").read_text())
        self.assertGreaterEqual(summary["disc_kept"][0], 12)
        self.assertTrue((self.folder / "out/reduction_disc.svg").exists())
        self.assertFalse((self.folder / "out/reduction_gear.svg").exists())
        self.assertEqual(self.drive("reduction_gallery", "--mesh", "none.obj").returncode, 3)

    def test_draws_the_shared_gear(self):
        gear = Path(os.environ.get("AUSSOIS_DATA_DIR", "")) / "meshes/gear_608.obj"
        if not gear.is_file():
            self.skipTest("no meshes/gear_608.obj in AUSSOIS_DATA_DIR")
        run = self.drive("reduction_gallery", "--mesh", str(gear), "--scale", "0.05", "--up", "y", "--quiet", "--summary", "s.json")
        self.assertEqual(run.returncode, 0, run.stderr + run.stdout)
        summary = json.loads((self.folder / "s.json").read_text())
        everything, *kept = summary["gear_608_kept"]
        self.assertGreaterEqual(everything, 36)
        self.assertTrue(all(k < everything for k in kept))


if __name__ == "__main__":
    unittest.main()
