# SPDX-License-Identifier: Apache-2.0
"""bench_lmd: its numbers fit together, and bad input is named. Times are not judged here."""

import json
import math
import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

BENCH = Path("../bench/bench_lmd")  # beside the drivers, in builds with benchmarks


class BenchLmd(DriverTest):
    def setUp(self):
        super().setUp()
        if not Path(os.environ["AUSSOIS_DRIVERS"], BENCH).exists():
            self.skipTest("built without AUSSOIS_BUILD_BENCH")

    def test_tells_the_same_in_json_and_text(self):
        run = self.drive(BENCH, "--poses", 2, "--repeats", 1, "--ablation", "--json", "b.json", "--quiet")
        self.assertIn(run.returncode, (0, 1), run.stderr)
        result = json.loads((self.folder / "b.json").read_text())
        self.assertEqual(run.returncode == 0, result["summary"]["pass"])
        (pair,) = result["pairs"]
        self.assertEqual(pair["pair"], "bolt_nut")
        self.assertGreater(pair["ms_query"], 0)
        self.assertGreater(pair["bytes_per_triangle"], 50)
        near, middle, far = pair["thresholds"]
        self.assertEqual((near["threshold"], middle["threshold"], far["threshold"]), (0.001, 0.01, 0.05))
        self.assertEqual(pair["contacts"], middle["contacts"])
        self.assertLessEqual(near["contacts"], middle["contacts"])
        self.assertLessEqual(middle["contacts"], far["contacts"])
        self.assertGreater(middle["contacts"], 1000, "every facet of the thread has its contact")
        for query in pair["thresholds"]:
            self.assertLessEqual(query["contacts"], query["exact_tests"])
            self.assertLessEqual(query["exact_tests"], query["leaf_pairs"])
        if pair["ms_fcl"] is not None:
            self.assertAlmostEqual(pair["ratio_to_fcl"], pair["ms_query"] / pair["ms_fcl"], 12)
            mean = result["summary"]["geometric_mean_ratio_to_fcl"]
            self.assertAlmostEqual(mean["value"], pair["ratio_to_fcl"], 12)
            self.assertRegex(run.stdout.splitlines()[-1], "geometric mean: .* (PASS|short)$")
        without = pair["without"]
        self.assertEqual(set(without), {"nothing", "cones", "directions", "boxes", "quick", "instructions"})
        for test, query in without.items():
            self.assertEqual(query["contacts"], without["nothing"]["contacts"], test)
            self.assertGreaterEqual(query["node_pairs"], without["nothing"]["node_pairs"], test)
        self.assertGreater(without["quick"]["exact_tests"], 10 * without["nothing"]["exact_tests"])
        self.assertGreater(without["boxes"]["leaf_pairs"], without["nothing"]["leaf_pairs"])
        header, row = (self.folder / "out/bench_lmd.csv").read_text().split()
        self.assertEqual(header, "pair,ms_query,ms_fcl,ms_cgal,contacts")
        name, ms, *_, contacts = row.split(",")
        self.assertEqual((name, float(ms), float(contacts)), ("bolt_nut", pair["ms_query"], pair["contacts"]))
        self.assertTrue(math.isfinite(float(ms)))

    def test_bad_input_is_named(self):
        for words, arguments in (("must contain 0.01", ("--thresholds", "0.02")),
                                 ("x must be a number", ("--thresholds", "0.01,x")),
                                 ("--pair needs --data", ("--pair", "own_tslot")),
                                 ("--threads must be 1", ("--threads", 2))):
            run = self.drive(BENCH, *arguments, timeout=60)
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(words, run.stderr)
            self.assertEqual(self.files(), {})


if __name__ == "__main__":
    unittest.main()
