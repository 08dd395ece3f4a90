# SPDX-License-Identifier: Apache-2.0
"""What a driver starts from stands in its help, and is what it runs with."""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

START = {"run_scene": 0.5, "drop_part": 0.5, "peer_scene": 1, "replay_assembly": 1, "sliding_block": 1, "cube_toss": 1}


class SchemeFlags(DriverTest):
    def test_help_names_the_theta_that_a_driver_starts_from(self):
        for driver, theta in START.items():
            with self.subTest(driver):
                text = " ".join(self.drive(driver, "--help").stdout.split())
                self.assertEqual(float(re.search(r"--theta NUMBER.*?default ([0-9.]+)", text)[1]), theta)

    def test_a_driver_runs_by_the_theta_of_its_help(self):
        for driver, arguments in (("run_scene", ("--scene", "rocking_block", "--time", "0.01")), ("drop_part", ("--time", "1")),
                                  ("peer_scene", ("--scene", "tower", "--time", "0.02")),
                                  ("sliding_block", ("--levels", "3")), ("cube_toss", ("--synthetic", "1", "--substeps", "1"))):
            with self.subTest(driver):
                run = self.drive(driver, *arguments, "--quiet", "-o", driver, "--summary", "summary.json")
                self.assertEqual(run.returncode, 0, run.stderr)
                told = run.stdout + json.dumps(json.loads((self.folder / "summary.json").read_text()))
                self.assertIn(f"moreau_jean theta {START[driver]:g}", told)

    def test_sliding_block_judges_its_order_at_its_default(self):
        self.assertEqual(self.drive("sliding_block", "--levels", "3").returncode, 0)
        # Steps longer than the whole slide: no order is seen.
        self.assertEqual(self.drive("sliding_block", "--levels", "3", "--h0", "0.1", "--speed", "0.01").returncode, 1)


if __name__ == "__main__":
    unittest.main()
