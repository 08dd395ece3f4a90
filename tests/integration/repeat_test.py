# SPDX-License-Identifier: Apache-2.0
"""A run repeats: the same bits in summary, steps.csv and run.h5 when it is run again, with two threads, and when it was
stopped half way and resumed. Only times of the clock and the command line may differ."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PARTS, PEG, DriverTest

INTERRUPTED = 130


class Repeat(DriverTest):
    def content(self, out):
        """{name: bits} of everything that a run has computed."""
        h5py, found = self.hdf5(), {}

        def keep(name, item):
            if isinstance(item, h5py.Dataset) and not name.startswith("timing/"):
                found[name] = (item.shape, str(item.dtype), item[()].tobytes() if item.dtype != object else list(item[()]))
            for key, value in item.attrs.items():
                if key != "command_line":
                    found[f"{name}@{key}"] = value

        with h5py.File(self.folder / out / "run.h5") as run:
            keep("", run)
            run.visititems(keep)
        found["summary.json"] = {key: value for key, value in self.summary(out).items() if key != "cpu_s"}
        found.update({f"steps.csv {name}": values for name, values in self.columns(out).items() if name[:3] != "ms_"})
        return found

    def same(self, expected, out):
        found = self.content(out)
        self.assertEqual([], [name for name in expected.keys() | found.keys() if expected.get(name) != found.get(name)], out)

    def repeats(self, *scene):
        self.replay("once", *scene)
        once, steps = self.content("once"), self.summary("once")["steps"]
        self.assertGreater(steps, 50)
        self.assertGreater(once["contact/gap"][0][0], 100, "a run without contacts proves nothing")
        self.replay("again", *scene)
        self.same(once, "again")
        self.replay("threads", *scene, "--threads", 2)
        self.same(once, "threads")
        self.replay("resumed", *scene, "--stop-after", steps // 2, code=INTERRUPTED)
        self.assertEqual(set(path.name for path in (self.folder / "resumed").iterdir()),
                         {"checkpoint.h5", "run.h5.tmp", "steps.csv.tmp"})
        self.replay("resumed", *scene, "--resume", "--threads", 2)
        self.same(once, "resumed")
        self.assertFalse((self.folder / "resumed/checkpoint.h5").exists())

    def test_peg_in_socket(self):
        self.repeats(*PEG)

    def test_peg_with_its_lead(self):
        self.repeats(*PEG, "--flexible", PARTS / "peg_lead.json")

    def test_every_third_step_recorded(self):
        self.repeats(*PEG, "--every", 3)

    def test_bolt_nut(self):
        self.repeats("--builtin", "bolt_nut", "--stride", 40, "--speed", 0.5, "--hold", 0.2)

    def test_own_tslot(self):
        self.repeats("--data", self.data(), "--pair", "own_tslot")

    def test_press_p1p2(self):
        self.repeats("--data", self.data(), "--pair", "press_p1p2")

    def test_alpha20(self):
        self.repeats("--data", self.data(), "--pair", "alpha20")

    def test_factory_peg_round_loose(self):
        self.repeats("--data", self.data(), "--pair", "factory_peg_round_loose")

    def test_beginning_of_factory_m16_loose(self):
        self.repeats(*self.beginning("factory_m16_loose", 3))

    def test_factory_m16_loose(self):
        self.repeats("--data", self.data(), "--pair", "factory_m16_loose")

    def moves_alike_with_levels(self, pair):
        """Their contacts only watch (LOD-6), so all bits are the same but those of the certificate and of the options."""
        certificate = {"step/min_base_distance", "step/certificate_rounds", "gauge/value", "steps.csv min_base_distance"}
        runs = []
        for levels in (0, 4):
            self.replay(pair, "--data", self.data(), "--pair", pair, "--detail-levels", levels)
            run = {name: bits for name, bits in self.content(pair).items() if name not in certificate and "@" not in name}
            run["summary.json"] = {key: value for key, value in run["summary.json"].items() if key not in ("scheme", "options")}
            runs.append(run)
        self.assertEqual([], [name for name in runs[0].keys() | runs[1].keys() if runs[0].get(name) != runs[1].get(name)], pair)
        self.assertGreater(len(runs[0]["steps.csv t"]), 50)

    def test_levels_change_no_motion(self):
        for pair in ("alpha20", "spot_link_dock"):
            self.moves_alike_with_levels(pair)

    def test_levels_change_no_motion_of_any_pair_without_a_thread(self):
        for pair in ("own_tslot", "press_p1p2", "factory_peg_round_loose", "piston_head", "piston_crank", "press_p3p4", "box_finger",
                     "gear_mesh", "alpha15", "screw_387266", "own_bearing", "factory_gear_medium", "featuretype_dock"):
            with self.subTest(pair=pair):
                self.moves_alike_with_levels(pair)

    def test_other_options_give_other_bits(self):
        """The comparison is able to fail."""
        self.replay("once", *PEG)
        self.replay("other", *PEG, "--mu", 0.21)
        with self.assertRaises(AssertionError):
            self.same(self.content("once"), "other")


if __name__ == "__main__":
    unittest.main()
