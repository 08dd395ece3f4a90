# SPDX-License-Identifier: Apache-2.0
"""What every driver that steps has: an audit of each step, problems in files, and work that goes on where it stopped."""

import json
import os
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

NOT_ACCEPTED, USAGE, MISSING, INTERRUPTED = 1, 2, 3, 130


class StudyFlags(DriverTest):
    def run_driver(self, driver, *arguments, code=0):
        run = self.drive(driver, *arguments, "--quiet")
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def interrupted(self, driver, *arguments, when):
        """Ctrl-C as soon as the file `when` is there."""
        command = [Path(os.environ["AUSSOIS_DRIVERS"], driver), *map(str, arguments), "--quiet"]
        process = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 120
        while not (self.folder / when).exists() and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.001)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=120)
        self.assertEqual(process.returncode, INTERRUPTED, error)

    def json(self, name):
        return json.loads((self.folder / name).read_text())

    def results(self, out):
        return {name: text for name, text in self.files().items() if name.startswith(f"{out}/results/")}

    def violates(self, driver, *arguments, result, audit):
        """A kept audit is reported like one that was just made, and a violation is the exit code."""
        path = self.folder / result
        kept = json.loads(path.read_text())
        self.assertEqual(audit(kept)["violations"], 0)
        audit(kept)["violations"] = 3
        path.write_text(json.dumps(kept))
        run = self.run_driver(driver, *arguments, code=NOT_ACCEPTED)
        self.assertIn(", 3 violations\n", run.stdout)


class PeerSceneFlags(StudyFlags):
    FALL = ("--mu", 0.25, "--time", 0.9, "--certify", 5)

    def content(self, out):
        h5py, found = self.hdf5(), {}

        def keep(name, item):
            if isinstance(item, h5py.Dataset) and not name.startswith("timing/"):
                found[name] = item[()].tobytes() if item.dtype != object else list(item[()])

        with h5py.File(self.folder / out / "run.h5") as run:
            run.visititems(keep)
        return found

    def test_a_run_that_is_resumed_is_judged_with_the_same_bits_and_ends_at_the_same_step(self):
        self.run_driver("peer_scene", *self.FALL, "-o", "whole", "--summary", "whole.json")
        whole = self.json("whole.json")
        self.assertGreater(whole["fall_time"], 0)
        self.assertLess(whole["t"], 0.9)  # half a second after the fall
        self.assertGreater(whole["t"], whole["fall_time"] + 0.5 - 1e-9)
        for stop in (20, 60, whole["steps"]):  # before the fall, after it, at the end
            out = f"after_{stop}"
            self.run_driver("peer_scene", *self.FALL, "-o", out, "--stop-after", stop, code=INTERRUPTED)
            self.run_driver("peer_scene", *self.FALL, "-o", out, "--resume", "--summary", "resumed.json")
            self.assertEqual({**self.json("resumed.json"), "cpu_s": 0}, {**whole, "cpu_s": 0})
            files = self.files()
            for name in ("steps.csv", "before.dat", "after.dat"):
                self.assertEqual(files[f"{out}/{name}"], files[f"whole/{name}"], name)
        for stop in (20, 60, whole["steps"]):
            self.assertEqual(self.content(f"after_{stop}"), self.content("whole"))

    def test_every_measure_survives_a_restart(self):
        for scene, stop in (("rolling", 11), ("bouncing_08", 120), ("666", 110)):
            length = ("--scene", scene, "--time", 1.3 if scene != "rolling" else 0.3)
            self.run_driver("peer_scene", *length, "-o", "whole", "--summary", "whole.json")
            self.run_driver("peer_scene", *length, "-o", "parts", "--stop-after", stop, code=INTERRUPTED)
            self.run_driver("peer_scene", *length, "-o", "parts", "--resume", "--summary", "parts.json")
            self.assertGreater(self.json("whole.json")["error"], 0, scene)
            self.assertEqual(self.json("whole.json")["error"], self.json("parts.json")["error"], scene)

    def test_has_the_flags_of_a_run(self):
        run = self.run_driver("peer_scene", "--scene", "tower", "--time", 0.1, "--certify", 10, "--every", 5, "--dump-problem", "steps",
                              "--dump-steps", "3", "--summary", "s.json")
        self.assertIn("certify: 10 steps, each at 10 places", run.stdout)
        summary = self.json("s.json")
        self.assertEqual((summary["steps"], summary["certify_violations"]), (10, 0))
        self.assertIn("moreau_jean theta 1", summary["scheme"])  # that of the comparison
        self.assertEqual(self.columns("out")["step"], ["5", "10"])
        self.assertLessEqual({"steps/peer_scene_tower_000003.hdf5", "out/run.h5", "out/replay.html", "out/after.dat"}, set(self.files()))
        run = self.run_driver("peer_scene", "--scene", "tower", "--time", 0.05, "--theta", 0.5, "--summary", "s.json")
        self.assertIn("moreau_jean theta 0.5", self.json("s.json")["scheme"])


class SlidingBlockFlags(StudyFlags):
    def test_levels_that_are_there_are_not_done_again(self):
        levels = ("--levels", 3, "-o", "out", "--summary", "s.json")
        slide = (*levels, "--certify", 5)
        first = self.run_driver("sliding_block", *slide)
        summary, results = self.json("s.json"), self.results("out")
        self.assertEqual(len(results), 3)
        self.assertEqual((summary["certify_violations"], summary["certify_samples"]), (0, 5))
        again = self.run_driver("sliding_block", *slide)
        self.assertEqual(again.stdout, "3 of 3 levels were already in out/results\n" + first.stdout)
        self.assertEqual((self.json("s.json"), self.results("out")), (summary, results))
        more = self.run_driver("sliding_block", "--levels", 4, "--certify", 5, "-o", "out")
        self.assertIn("3 of 4 levels", more.stdout)
        for other in (("--mu", 0.31), ("--speed", 0.9), ("--tolerance", 1e-11), ("--reducer", "none"), ()):
            run = self.run_driver("sliding_block", *levels, "--certify", 5 if other else 6, *other)
            self.assertNotIn("already", run.stdout, other)
        (self.folder / "out/results/level_4.json").unlink()
        self.run_driver("sliding_block", *slide)
        self.violates("sliding_block", *slide, result="out/results/level_2.json", audit=lambda kept: kept["audit"])
        (self.folder / "out/results/level_2.json").write_text("{ damaged")
        self.assertIn("2 of 3 levels", self.run_driver("sliding_block", *slide).stdout)
        self.assertEqual((self.json("s.json"), self.results("out")), (summary, results))

    def test_goes_on_after_an_interruption(self):
        slide = ("--levels", 9)
        self.interrupted("sliding_block", *slide, "-o", "parts", when="parts/results/level_3.json")
        done = self.results("parts")
        self.assertGreaterEqual(len(done), 3)
        self.assertNotIn("parts/sliding_block.csv", self.files())
        run = self.run_driver("sliding_block", *slide, "-o", "parts")
        self.assertIn(f"{len(done)} of 9 levels were already in parts/results", run.stdout)
        self.run_driver("sliding_block", *slide, "-o", "whole")
        files = self.files()
        self.assertEqual(files["parts/sliding_block.csv"], files["whole/sliding_block.csv"])

    def test_problems_that_are_wanted_are_made_again(self):
        slide = ("--levels", 3, "--dump-problem", "steps", "--dump-steps", "5")
        for _ in range(2):
            self.assertNotIn("already", self.run_driver("sliding_block", *slide).stdout)
            for level in (1, 2, 3):
                (self.folder / f"steps/sliding_block_level_{level}_000005.hdf5").unlink()


class CubeTossFlags(StudyFlags):
    def without_clock(self, name):
        return {key: value for key, value in self.json(name).items() if key != "cpu_s"}

    def test_tosses_that_are_there_are_not_done_again(self):
        tosses = ("--synthetic", 18, "--substeps", 2, "--threads", 2, "-o", "out", "--summary", "s.json")
        toss = (*tosses, "--certify", 3)
        first = self.run_driver("cube_toss", *toss)
        summary, table = self.json("s.json"), self.files()["out/tosses.csv"]
        self.assertEqual(summary["certify_violations"], 0)
        self.assertGreater(summary["certify_steps"], 18 * 100)
        self.assertEqual(len(self.results("out")), 2)  # batches of 16
        again = self.run_driver("cube_toss", *toss)
        self.assertEqual(again.stdout, "18 of 18 tosses were already in out/results\n" + first.stdout)
        self.assertEqual((self.json("s.json"), self.files()["out/tosses.csv"]), (summary, table))
        for other in (("--mu", 0.2), ("--noise", 1e-3), ("--matching", "none"), ("--cut", 1e-3), ()):
            run = self.run_driver("cube_toss", *tosses, "--certify", 3 if other else 0, *other)
            self.assertNotIn("already", run.stdout, other)
        self.run_driver("cube_toss", *toss)
        self.violates("cube_toss", *toss, result="out/results/all_002.json", audit=lambda kept: kept["runs"][1]["audit"])

    def test_a_fit_goes_on_after_an_interruption(self):
        fit = ("--synthetic", 6, "--substeps", 2, "--certify", 2, "--fit", "--summary", "s.json", "-o")
        self.interrupted("cube_toss", *fit, "parts", when="parts/results/fit_1_003.json")
        done = len(self.results("parts"))
        run = self.run_driver("cube_toss", *fit, "parts")
        self.assertRegex(run.stdout, rf"\A{done} of \d+ points of the fit were already in parts/results\n")
        parts = self.without_clock("s.json")
        self.run_driver("cube_toss", *fit, "whole", "--threads", 2)
        self.assertEqual(parts, self.without_clock("s.json"))
        files = self.files()
        self.assertEqual(files["parts/tosses.csv"], files["whole/tosses.csv"])
        self.assertGreater(parts["certify_steps"], parts["fit_steps"])

    def test_problems_have_the_names_of_their_tosses(self):
        toss = ("--synthetic", 2, "--substeps", 1, "--dump-problem", "steps", "--dump-steps", "every 40")
        self.run_driver("cube_toss", *toss)
        names = [name for name in self.files() if name.startswith("steps/")]
        for number in (1, 2):
            self.assertIn(f"steps/cube_toss_all_toss_00{number}_000080.hdf5", names)
        self.assertNotIn("already", self.run_driver("cube_toss", *toss).stdout)
        run = self.run_driver("cube_toss", "--synthetic", 2, "--dump-problem", "steps", "--scheme", "event_driven", code=USAGE)
        self.assertIn("event_driven solves no one-step problem", run.stderr)


class ProfileFlags(StudyFlags):
    """--profile tells of the steps of all runs, and changes none."""

    def test_of_studies_tells_where_all_steps_go_and_changes_nothing(self):
        for name, study in (("sliding_block", ("--levels", 3)), ("cube_toss", ("--synthetic", 2, "--substeps", 1)),
                            ("reduction_gallery", ())):
            plain = self.run_driver(name, *study, "-o", f"{name}_plain", "--summary", "plain.json").stdout
            self.assertNotRegex(plain, r"(?m)^solve +\d")
            run = self.run_driver(name, *study, "-o", f"{name}_told", "--profile", "--summary", "told.json")
            self.assertRegex(run.stdout, r"(?m)^\d+ steps taken\nms a step ")
            self.assertRegex(run.stdout, r"(?m)^solve +\d")
            plain, told = self.json("plain.json"), self.json("told.json")
            self.assertEqual(told["profile_stages"][-1], "step", name)
            self.assertGreater(told["profile_wall_ms_mean"][-1], 0, name)
            results = {key: value for key, value in told.items() if not key.startswith("profile_") and key != "cpu_s"}
            self.assertEqual(results, {key: value for key, value in plain.items() if key != "cpu_s"}, name)

    def test_of_a_study_of_convergence_is_a_file(self):
        study = ("--case", "incline_20_up", "--levels", 3, "--phases", 1, "--profile", "-o", "out")
        self.assertRegex(self.run_driver("convergence", *study).stdout, r"(?m)^solve +\d")
        profile = self.json("out/profile.json")
        self.assertEqual(len(profile["profile_cpu_ms_p99"]), len(profile["profile_stages"]))
        again = self.run_driver("convergence", *study).stdout  # nothing is done again
        self.assertNotIn("steps taken", again)


class ConvergenceFlags(StudyFlags):
    SMALL = ("--case", "incline_20_up", "--levels", 3, "--phases", 1)

    def test_every_step_of_every_run_is_audited_and_the_audit_is_kept(self):
        study = (*self.SMALL, "-o", "out", "--certify", 4)
        first = self.run_driver("convergence", *study, "--json", "s.json")
        kept = self.json("s.json")
        self.assertEqual((kept["audit"]["steps"], kept["audit"]["violations"]), (kept["steps"], 0))
        self.assertIn("certify: ", first.stdout)
        again = self.run_driver("convergence", *study)
        self.assertEqual(again.stdout, "1 of 1 were already in out\n" + first.stdout)
        self.assertNotIn("already", self.run_driver("convergence", *study[:-1], 5).stdout)
        self.run_driver("convergence", *study)
        result = next(name for name in self.files() if name.startswith("out/") and name.endswith(".json"))
        self.violates("convergence", *study, result=result, audit=lambda kept: kept["audit"])

    def test_problems_have_the_names_of_their_runs(self):
        self.run_driver("convergence", "--case", "incline_30", "--levels", 3, "--phases", 2, "--dump-problem", "steps", "--dump-steps", "2")
        names = [name for name in self.files() if name.startswith("steps/")]
        self.assertEqual(len(names), 6)
        self.assertIn("steps/convergence_incline_30_moreau_jean_theta_0.5_combined_level_3_phase_2_000002.hdf5", names)


if __name__ == "__main__":
    unittest.main()
