# SPDX-License-Identifier: Apache-2.0
"""reduction_gallery: what its pictures show is what the reducers promise."""

import json
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


if __name__ == "__main__":
    unittest.main()
