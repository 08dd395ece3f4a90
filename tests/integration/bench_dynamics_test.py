# SPDX-License-Identifier: Apache-2.0
"""bench_dynamics and peer_scene: numbers fit together, bad input is named. Times are not judged here."""

import json
import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

BENCH = Path("../bench/bench_dynamics")  # beside the drivers, in builds with benchmarks


class BenchDynamics(DriverTest):
    def setUp(self):
        super().setUp()
        if not Path(os.environ["AUSSOIS_DRIVERS"], BENCH).exists():
            self.skipTest("built without AUSSOIS_BUILD_BENCH")

    def test_tells_the_same_in_table_verdicts_and_json(self):
        run = self.drive(BENCH, "--scene", "tower,bouncing_08,rolling_xy", "--length", 0.01, "--rounds", 2, "--timed", 0.02,
                         "--json", "b.json", "--quiet", timeout=300)
        self.assertIn(run.returncode, (0, 1), run.stderr)
        result = json.loads((self.folder / "b.json").read_text())
        self.assertEqual([(s["scene"], s["h"]) for s in result["scenes"]],
                         [("tower", 0.01), ("tower", 0.001), ("bouncing_08", 0.001), ("rolling_xy", 0.001)])
        self.assertEqual(run.returncode == 0, result["summary"]["pass"])
        for scene in result["scenes"]:
            engines = scene["engines"]
            if scene["scene"].startswith("bouncing"):  # balls that fall 4.9 m: what is timed has impacts in it
                self.assertGreater(scene["t_timed"], 2 * (2 * 4.9 / 9.81) ** 0.5)
            else:
                self.assertAlmostEqual(scene["t_timed"], 0.02)
            for peer in set(engines) - {"aussois"}:
                self.assertIn(peer.rstrip("+") + ("" if peer.endswith("+") else "+"), engines)
            self.assertEqual(next(iter(engines)), "aussois")
            for engine in engines.values():
                self.assertGreater(engine["us"], 0)
                self.assertGreaterEqual(engine["us_slowest"], engine["us"])
                if "bullet" in engines:
                    self.assertAlmostEqual(engine["ratio"], engine["us"] / engines["bullet"]["us"])
            self.assertTrue(result["summary"][f"{scene['scene']}_{scene['h']:g}_error"]["pass"])

    def test_names_a_scene_that_there_is_not(self):
        run = self.drive(BENCH, "--scene", "tower,pisa")
        self.assertEqual(run.returncode, 2)
        self.assertIn("pisa must be one of rolling", run.stderr)


class PeerScene(DriverTest):
    def test_an_arch_stands_above_its_least_friction_and_falls_below(self):
        for mu, falls in ((0.35, False), (0.25, True)):
            run = self.drive("peer_scene", "--mu", mu, "--time", 0.6, "--summary", "s.json", "--quiet")
            self.assertEqual(run.returncode, 0, run.stderr)
            summary = json.loads((self.folder / "s.json").read_text())
            self.assertEqual(summary["fall_time"] > 0, falls)
            self.assertEqual(summary["error"] > 0.1, falls)
            for name in ("before.dat", "after.dat"):
                lines = (self.folder / "out" / name).read_text().split("\n\n")
                self.assertEqual(len([line for line in lines if line.strip()]), 25)


if __name__ == "__main__":
    unittest.main()
