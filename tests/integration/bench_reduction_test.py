# SPDX-License-Identifier: Apache-2.0
"""bench_reduction: its numbers fit together, and bad input is named. Times are not judged here."""

import json
import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

BENCH = Path("../bench/bench_reduction")  # beside the drivers, in builds with benchmarks


class BenchReduction(DriverTest):
    def setUp(self):
        super().setUp()
        if not Path(os.environ["AUSSOIS_DRIVERS"], BENCH).exists():
            self.skipTest("built without AUSSOIS_BUILD_BENCH")

    def test_says_what_is_lost_and_what_it_costs(self):
        run = self.drive(BENCH, "--largest", 1000, "--pairs", 1, "--json", "b.json")
        self.assertIn(run.returncode, (0, 1), run.stderr)
        result = json.loads((self.folder / "b.json").read_text())
        self.assertEqual(run.returncode == 0, result["pass"])
        rules = result["rules"]
        self.assertEqual(rules[0], "patch_of_four")
        for family in ("rim", "grid", "l", "scattered"):
            margin = dict(zip(rules, result[f"{family}_margin"]))
            self.assertGreaterEqual(margin["hull_margin"], 0.9 - 1e-9, family)
            self.assertGreaterEqual(margin["hull_margin"], margin["patch_of_four"] - 1e-12, family)
            self.assertAlmostEqual(margin["hull_exact"], 1, 9)
            self.assertLess(margin["load_carrier"], 0.8, family)
            self.assertTrue(all(us > 0 for us in result[f"{family}_us"]))
            rows = (self.folder / f"out/bench_reduction_{family}.csv").read_text().splitlines()
            self.assertEqual(len(rows), 1 + len(rules))
        self.assertLessEqual(dict(zip(rules, result["grid_margin"]))["paper_exact"], 1e-9)
        self.assertEqual(result["contacts"], [10, 100, 1000])

    def test_bad_input_is_named(self):
        run = self.drive(BENCH, "--largest", 3, timeout=60)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("--largest", run.stderr)
        self.assertEqual(self.files(), {})


if __name__ == "__main__":
    unittest.main()
