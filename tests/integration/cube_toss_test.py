# SPDX-License-Identifier: Apache-2.0
"""Tosses of a cube as a user rolls them out: keys of the summary against the table of tosses, refusals."""

import json
import math
import statistics
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

USAGE, MISSING = 2, 3
EDGE = 0.1048  # [m]


class CubeToss(DriverTest):
    def cube_toss(self, *arguments, code=0):
        run = self.drive("cube_toss", *arguments, "--quiet")
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def check(self, out, summary, prefix=""):
        """Mean, deviation and median of (TOSS-2), made again from the table."""
        table = self.columns(out, "tosses.csv")
        for key, unit, column in (("position_error_percent", 1, "position_error_percent"),
                                  ("rotation_error_deg", 1, "rotation_error_deg")):
            values = [unit * float(x) for x in table[column]]
            for name, of in (("mean", statistics.fmean), ("sd", statistics.stdev), ("median", statistics.median)):
                self.assertAlmostEqual(summary[f"{prefix}{key}_{name}"], of(values), delta=1e-9 * max(values), msg=f"{key}_{name}")
                self.assertGreater(summary[f"{prefix}{key}_{name}"], 0)

    def test_the_summary_tells_what_the_table_does(self):
        self.cube_toss("--synthetic", 6, "--substeps", 3, "--json", "toss.json", "-o", "out")
        summary = json.loads((self.folder / "toss.json").read_text())
        self.check("out", summary)
        self.assertEqual([summary[key] for key in ("tosses", "synthetic", "mu", "restitution", "substeps", "reducer", "failures")],
                         [6, True, 0.18, 0, 3, "hull_margin", 0])
        self.assertTrue(math.isfinite(summary["loss_mean"]))

    def test_a_fit_tells_of_both_halves(self):
        self.cube_toss("--synthetic", 6, "--substeps", 2, "--fit", "--json", "fit.json", "-o", "out")
        summary = json.loads((self.folder / "fit.json").read_text())
        self.check("out", summary)  # the table is that of the half that was not seen
        self.assertGreater(summary["fit_points"], 5)
        self.assertGreater(summary["fit_steps"], summary["fit_points"])
        for key in ("seen_position_error_percent_mean", "seen_rotation_error_deg_mean", "mu", "restitution", "board_m", "fit_error_m"):
            self.assertTrue(math.isfinite(summary[key]), key)

    def test_a_fit_is_judged_on_another_folder(self):
        """All tosses of --data are seen, and those of --test are not: the same world, thrown with other seeds."""
        for seed, folder in ((1, "first"), (50, "second")):
            self.cube_toss("--synthetic", 3, "--seed", seed, "--substeps", 1, "-o", folder)
        self.cube_toss("--data", "first/synthetic", "--test", "second/synthetic", "--fit", "--substeps", 2, "--json",
                       "fit.json", "-o", "out")
        summary = json.loads((self.folder / "fit.json").read_text())
        self.assertEqual((summary["tosses"], summary["unseen"]), (6, 3))
        self.assertEqual(self.columns("out", "tosses.csv")["toss"], ["50", "51", "52"])
        self.check("out", summary)
        for flags in (("--test", "second/synthetic"), ("--swap",), ("--measure-board",),
                      ("--fit", "--swap", "--test", "second/synthetic"), ("--from-mu", "0.2"), ("--fit", "--mu", "0.2")):
            self.cube_toss("--data", "first/synthetic", *flags, code=USAGE)

    def test_cut_corners_let_reducers_remove_contacts(self):
        for cut in (0, 2e-3):
            self.cube_toss("--synthetic", 2, "--substeps", 2, "--cut", cut, "--json", "toss.json", "-o", "out")
            summary = json.loads((self.folder / "toss.json").read_text())
            self.assertEqual(max(self.columns("out", "tosses.csv")["most_contacts"]), "8" if cut else "4")
        self.assertGreater(summary["reduced_steps"], 50)

    def test_recorded_tosses_have_the_keys_of_the_protocol(self):
        tosses = self.data() / "cube_toss"
        if not tosses.is_dir():
            self.skipTest(f"no {tosses}")
        self.cube_toss("--data", tosses, "--substeps", 1, "--json", "toss.json", "-o", "out")
        summary = json.loads((self.folder / "toss.json").read_text())
        self.check("out", summary)
        self.assertEqual(summary["tosses"], 347)
        self.assertLess(summary["position_error_percent_mean"], 15.4)  # 14.0 and a tenth more for one substep
        self.assertLess(summary["rotation_error_deg_mean"], 18.7)

    def test_what_is_wrong_is_named(self):
        self.assertIn("--data", self.cube_toss(code=USAGE).stderr)
        self.cube_toss("--data", "nowhere", code=MISSING)
        self.assertIn("toss_999", self.cube_toss("--synthetic", 2, "--replay", "toss_999", code=USAGE).stderr)


if __name__ == "__main__":
    unittest.main()
