# SPDX-License-Identifier: Apache-2.0
"""The peg-and-plate study as a user runs it: stages, files, restarts, refusals; all of it under the label long."""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

USAGE, MISSING = 2, 3
ALL = ("generate", "train", "evaluate")
SMALL = ("--set", "edge_0.1", "--count", 2, "--leans", 3, "--iterations", 20, "--quiet")
FOLDER = "out/seed_1/edge_0.1"


class PegPlate(DriverTest):
    def peg_plate(self, *arguments, codes=(0, 1)):
        """A study as small as this one may miss its acceptance."""
        run = self.drive("peg_plate", *arguments)
        self.assertIn(run.returncode, codes, run.stderr + run.stdout)
        return run

    def test_each_stage_leaves_its_files(self):
        self.peg_plate("generate", *SMALL)
        self.assertEqual({name for name in self.files()},
                         {f"{FOLDER}/options.json"} | {f"{FOLDER}/samples/00{i}.csv" for i in range(3)})
        self.peg_plate("train", *SMALL)
        self.assertLess({f"{FOLDER}/mlc_{mode}.txt" for mode in ("argmin", "soft", "ranked")}, set(self.files()))
        run = self.peg_plate("evaluate", *SMALL)
        table = self.files()["out/scores.md"].decode()
        self.assertIn("synthetic", table)
        self.assertIn(table, run.stdout)
        for name in ("upright", "best_fixed", "mlc_soft", "oracle"):
            self.assertRegex(table, rf"\| {name} \| \d+\.\d\d \|")
        verdicts = self.files()["out/verdicts.txt"].decode()
        self.assertEqual(re.findall("A-2", verdicts), ["A-2"] * 3)
        self.assertEqual(re.findall("A-5 .*  (met|MISSED)", verdicts), ["met"] * 3)
        check = json.loads(self.files()["out/seed_1/training.json"])
        self.assertLess(0, check["gradient_error"])
        self.assertLess(check["gradient_error"], 1e-7)
        self.assertEqual(check["weights_that_differ"], 0)
        self.assertAlmostEqual(check["loss"] / check["reference_loss"], 1, delta=0.05)

    def test_an_interrupted_study_goes_on_to_the_same_bytes(self):
        self.peg_plate(*ALL, *SMALL, "--threads", 1)
        whole = self.files()
        for name in ("samples/001.csv", "lessons.json", "mlc_soft.txt", "result.json"):
            (self.folder / FOLDER / name).unlink()
        self.peg_plate(*ALL, *SMALL, "--threads", 2)
        self.assertEqual(self.files(), whole)
        for name in ("seed_1/training.json", "seed_1/edge_0.1/result.json"):  # damaged
            (self.folder / "out" / name).write_text('{"seed": 1,')
        self.peg_plate(*ALL, *SMALL)
        self.assertEqual(self.files(), whole)

    def test_a_folder_of_another_study_is_refused(self):
        self.peg_plate("generate", *SMALL)
        run = self.peg_plate("train", *SMALL, "--rho", 0.01, codes=(USAGE,))
        self.assertIn("rho = 0.001, not 0.01", run.stderr)

    def test_what_is_missing_or_unknown_is_named(self):
        self.assertIn("000.csv", self.peg_plate("train", *SMALL, codes=(MISSING,)).stderr)
        self.assertIn("train first", self.peg_plate("evaluate", *SMALL, codes=(MISSING,)).stderr)
        self.assertIn("generate, train or evaluate", self.peg_plate("learn", *SMALL, codes=(USAGE,)).stderr)

    def test_five_seeds_meet_all(self):
        """The whole study of doc/theory/peg_plate.md."""
        run = self.peg_plate(*ALL, "--seeds", 5, "--quiet", codes=(0,))
        verdicts = re.findall(r"^A-\d .* of 5 seeds  (met|MISSED)$", run.stdout, re.MULTILINE)
        self.assertEqual(verdicts, ["met"] * 30)


if __name__ == "__main__":
    unittest.main()
