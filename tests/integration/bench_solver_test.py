# SPDX-License-Identifier: Apache-2.0
"""bench_solver: its numbers fit together, and bad input is named. Times are not judged here."""

import json
import math
import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PARTS, DriverTest

BENCH = Path("../bench/bench_solver")  # beside the drivers, in builds with benchmarks
SLIDING = PARTS / "problems" / "sliding_block_level_1_000005.hdf5"


class BenchSolver(DriverTest):
    def setUp(self):
        super().setUp()
        if not Path(os.environ["AUSSOIS_DRIVERS"], BENCH).exists():
            self.skipTest("built without AUSSOIS_BUILD_BENCH")

    def bench(self, *arguments):
        run = self.drive(BENCH, *arguments, "--budget", 0, "--json", "b.json", "--quiet", timeout=300)
        self.assertIn(run.returncode, (0, 1), run.stderr)
        return run, json.loads((self.folder / "b.json").read_text())

    def test_tells_the_same_in_table_json_and_csv(self):
        run, result = self.bench(PARTS / "problems", "--time-limit", 0.1)
        self.assertEqual(run.returncode == 0, result["summary"]["pass"])
        problems = result["problems"]
        self.assertEqual(len(problems), len(list((PARTS / "problems").glob("*.hdf5"))))
        self.assertEqual(result["summary"]["unsolved"]["value"], 0)
        for problem in problems:
            self.assertIn(problem["problem"], run.stdout)
            self.assertGreater(problem["contacts"], 0)
            for ours, tolerance in (("ours", 1e-8), ("ours_coarse", 1e-4)):
                self.assertTrue(problem[ours]["solved"])
                self.assertLessEqual(problem[ours]["residual"], tolerance)
                self.assertGreater(problem[ours]["ms"], 0)
            self.assertEqual(problem["form"] == "global", problem["ms_from_bodies"] is not None)
        header, *rows = (self.folder / "out/bench_solver.csv").read_text().split()
        self.assertEqual(header.split(",")[:4], ["problem", "contacts", "ms", "ms_siconos"])
        contacts = [int(row.split(",")[1]) for row in rows]
        self.assertEqual(contacts, sorted(contacts))
        ms = {row.split(",")[0]: float(row.split(",")[2]) for row in rows}
        self.assertEqual(ms, {problem["problem"]: problem["ms"] for problem in problems})

    def test_the_best_of_siconos_is_the_fastest_that_our_residual_accepts(self):
        run, result = self.bench(SLIDING, "--time-limit", 0.2)
        (problem,) = result["problems"]
        if not problem["siconos"]:
            self.assertIn("no peer", run.stderr)
            self.skipTest("built without Siconos")
        solved = {name: solver for name, solver in problem["siconos"].items() if solver["solved"]}
        for name, solver in solved.items():
            self.assertLessEqual(solver["residual"], 1e-8, name)
            self.assertGreater(solver["ms"], 0, name)
        self.assertIn("nsgs", solved)
        self.assertGreater(len(solved), 5)
        best = min(solved, key=lambda name: solved[name]["ms"])
        self.assertEqual(problem["siconos_solver"], best)
        self.assertTrue(math.isclose(problem["ratio"], problem["ms"] / solved[best]["ms"], rel_tol=1e-12))
        self.assertLessEqual(problem["siconos_coarse"]["nsgs"]["residual"], 1e-4)

    def test_bad_input_is_named(self):
        for words, arguments, code in (("--threads must be 1", (SLIDING, "--threads", 2), 2),
                                       ("--coarse", (SLIDING, "--tolerance", 1e-3), 2),
                                       ("at least one FILE", (), 2),
                                       ("nowhere.hdf5", ("nowhere.hdf5",), 3)):
            run = self.drive(BENCH, *arguments, timeout=60)
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertIn(words, run.stderr)


if __name__ == "__main__":
    unittest.main()
