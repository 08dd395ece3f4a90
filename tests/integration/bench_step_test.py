# SPDX-License-Identifier: Apache-2.0
"""bench_step: its numbers fit together, and bad input is named. Times are not judged here."""

import json
import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

BENCH = Path("../bench/bench_step")  # beside the drivers, in builds with benchmarks
STAGES = ["broad_phase", "search", "reduction", "kinematics", "assembly", "solve", "certificate", "other", "recording", "step"]


class BenchStep(DriverTest):
    def setUp(self):
        super().setUp()
        if not Path(os.environ["AUSSOIS_DRIVERS"], BENCH).exists():
            self.skipTest("built without AUSSOIS_BUILD_BENCH")

    def test_tells_the_same_in_json_and_text(self):
        run = self.drive(BENCH, "--steps", 12, "--fcl-poses", 2, "--json", "b.json", "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        (pair,) = json.loads((self.folder / "b.json").read_text())["pairs"]
        self.assertEqual((pair["pair"], pair["steps"]), ("bolt_nut", 12))
        self.assertIn(f"bolt_nut: 12 steps, {pair['contacts']:.0f} contacts", run.stdout)
        self.assertEqual(list(pair["stages"]), STAGES)
        for stage, figures in pair["stages"].items():
            self.assertLessEqual(figures["ms_p50"], figures["ms_p99"], stage)
            self.assertLessEqual(figures["ms_p99"], figures["ms_max"], stage)
            self.assertLessEqual(figures["ms_mean"], figures["ms_max"], stage)
        whole = sum(figures["ms_mean"] for stage, figures in pair["stages"].items() if stage not in ("step", "recording"))
        self.assertAlmostEqual(whole, pair["ms_mean"], 9)
        self.assertGreater(pair["stages"]["certificate"]["ms_mean"], 0)
        self.assertEqual({key: pair[key] for key in pair["stages"]["step"]}, pair["stages"]["step"])
        if pair["ms_fcl"] is not None:
            self.assertAlmostEqual(pair["ratio_to_fcl"], pair["ms_mean"] / pair["ms_fcl"], 12)

    def test_bad_input_is_named(self):
        for words, arguments in (("--pair needs --data", ("--pair", "own_tslot")),
                                 ("--threads must be 1", ("--threads", 2)),
                                 ("--steps", ("--steps", -1))):
            run = self.drive(BENCH, *arguments, timeout=60)
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(words, run.stderr)
            self.assertEqual(self.files(), {})


if __name__ == "__main__":
    unittest.main()
