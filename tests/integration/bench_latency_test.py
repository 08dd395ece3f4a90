# SPDX-License-Identifier: Apache-2.0
"""bench_latency: its numbers fit together, and bad input is named. Times are not judged here."""

import json
import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PEG, DriverTest

BENCH = Path("../bench/bench_latency")  # beside the drivers, in builds with benchmarks


class BenchLatency(DriverTest):
    def setUp(self):
        super().setUp()
        if not Path(os.environ["AUSSOIS_DRIVERS"], BENCH).exists():
            self.skipTest("built without AUSSOIS_BUILD_BENCH")

    def test_tells_percentiles_that_ascend(self):
        run = self.drive(BENCH, *PEG, "--tick", 1e-3, "--seconds", 0.2, "--json", "b.json", "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        told = json.loads((self.folder / "b.json").read_text())
        self.assertEqual((told["ticks"], told["refused"]), (200, 0))
        for row in ("cpu_ms", "wall_ms", "contacts", "steps", "allocations", "switches"):
            values = [told[row][part] for part in ("p50", "p90", "p99", "p999", "max")]
            self.assertEqual(values, sorted(values), row)
        self.assertGreater(told["allocations"]["p50"], 0)
        self.assertGreater(told["cpu_ms"]["p50"], 0)

    def test_bad_input_is_named(self):
        for words, arguments in (("give one of", ()), ("--threads must be 1", ("--builtin", "bolt_nut", "--threads", 2)), ("--seconds", (*PEG, "--seconds", 0))):
            run = self.drive(BENCH, *arguments, timeout=60)
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(words, run.stderr)


if __name__ == "__main__":
    unittest.main()
