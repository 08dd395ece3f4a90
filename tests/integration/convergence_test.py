# SPDX-License-Identifier: Apache-2.0
"""Convergence studies as a user makes them: files, exit codes, interruption, shards."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import DriverTest

NOT_ACCEPTED, USAGE, INTERRUPTED = 1, 2, 130
SMALL = ("--levels", 3, "--phases", 1, "--quiet")
TOP = ("--case", "free_top", "--h0", 0.02, *SMALL)
BRAKE = ("--case", "incline_20_up", *SMALL)  # a second for all schemes


class Convergence(DriverTest):
    def converge(self, *arguments, code=0):
        run = self.drive("convergence", *arguments)
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def studies(self, folder):
        return {name: content for name, content in self.files().items() if name.startswith(folder + "/") and name.endswith(".json")}

    def test_list_names_every_case_and_scheme(self):
        lines = self.converge("--list").stdout
        for word in ("ball_e05", "rocking_block", "free_top", "moreau_jean theta 0.5 combined"):
            self.assertIn(word, lines)
        self.assertEqual(self.files(), {})

    def test_json_holds_errors_that_give_the_orders(self):
        self.converge(*TOP, "--json", "study.json")
        study = json.loads((self.folder / "study.json").read_text())
        levels = study["levels_done"]
        self.assertEqual(len(levels), 3)
        self.assertTrue(study["as_expected"])
        ratios = [a["q_max"] / b["q_max"] for a, b in zip(levels, levels[1:])]
        steps = [a["h_s"] / b["h_s"] for a, b in zip(levels, levels[1:])]
        for ratio, step in zip(ratios, steps):
            self.assertAlmostEqual(ratio, step**2, delta=0.1 * step**2)
        self.assertAlmostEqual(study["order"]["q_max"], 2, delta=0.05)

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is not installed")
    def test_a_picture_shows_the_orders(self):
        self.converge(*TOP)
        pictures = [content for name, content in self.files().items() if name.endswith(".png")]
        self.assertEqual(len(pictures), 1)
        self.assertTrue(pictures[0].startswith(b"\x89PNG\r\n") and len(pictures[0]) > 5000)

    def test_a_missed_order_is_an_exit_code(self):
        # Steps of three tenths of a second are no steps for a ball that comes to rest in 1.35 s.
        run = self.converge("--case", "ball_e05", "--h0", 0.3, *SMALL, code=NOT_ACCEPTED)
        self.assertIn("0 of 1 met", run.stdout)

    def test_studies_that_are_there_are_not_done_again(self):
        self.converge(*TOP, "-o", "a")
        before = self.studies("a")
        self.assertIn("1 of 1 were already in a", self.converge(*TOP, "-o", "a").stdout)
        self.assertEqual(self.studies("a"), before)
        self.assertNotIn("already", self.converge(*TOP, "-o", "a", "--tolerance", 1e-10).stdout)
        self.assertNotEqual(self.studies("a"), before)

    def test_studies_of_other_settings_are_others(self):
        implicit = (*TOP, "-o", "a", "--newton-iterations")  # one name
        self.converge(*implicit, 40)
        self.assertNotIn("already", self.converge(*implicit, 41).stdout)
        self.assertIn("1 of 1 were already in a", self.converge(*implicit, 41).stdout)
        self.assertNotIn("already", self.converge(*implicit, 41, "--min-h", 1e-9).stdout)
        settings = json.loads(next(iter(self.studies("a").values())))["settings"]
        self.assertIn("--min-h 1e-09\n", settings)

    def test_settings_that_nobody_reads_are_refused(self):
        for flags, words in ((["--scheme", "generalised_alpha", "--gamma", 0.5], ["--gamma", "generalised_alpha"]),
                             (["--all", "--theta", 1], ["--theta", "--all"])):
            run = self.converge(*TOP, *flags, code=USAGE)
            for word in words:
                self.assertIn(word, run.stderr)
            self.assertEqual(self.files(), {})

    def test_shards_and_threads_make_the_same_table(self):
        self.converge("--all", *BRAKE, "-o", "whole", "--threads", 1)
        for k in (1, 2):
            self.converge("--all", *BRAKE, "-o", "parts", "--shard", f"{k}/2", "--threads", 2)
        run = self.converge("--all", *BRAKE, "-o", "parts")
        whole, parts = self.studies("whole"), self.studies("parts")
        self.assertGreater(len(whole), 6)
        self.assertIn(f"{len(whole)} of {len(whole)} were already in parts", run.stdout)
        self.assertEqual([whole[name] for name in sorted(whole)], [parts[name] for name in sorted(parts)])
        self.assertEqual((self.folder / "whole/convergence.md").read_bytes(),
                         (self.folder / "parts/convergence.md").read_bytes())

    def test_a_farm_of_three_makes_the_same_table(self):
        run = self.drive("convergence", "--all", *BRAKE, "-o", "alone", "--farm")
        if run.returncode == USAGE:
            self.assertIn("AUSSOIS_WITH_MPI", run.stderr)
            self.assertEqual(self.files(), {})
            self.skipTest("a build without MPI")
        command = ["mpirun", "-n", "3", "--oversubscribe", Path(os.environ["AUSSOIS_DRIVERS"], "convergence"), "--all",
                   *BRAKE, "-o", "farm", "--farm"]
        root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}  # in a container
        run = subprocess.run([str(word) for word in command], cwd=self.folder, env=os.environ | root, timeout=300,
                             capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        alone, farm = self.studies("alone"), self.studies("farm")
        self.assertEqual([alone[name] for name in sorted(alone)], [farm[name] for name in sorted(farm)])
        self.assertEqual(run.stdout.count("met the orders of theory"), 1)
        self.assertIn(f"{len(farm)} of {len(farm)} were already in farm", run.stdout)

    def test_goes_on_after_an_interruption(self):
        command = [Path(os.environ["AUSSOIS_DRIVERS"], "convergence"), "--all", "--case", "free_top", "--levels", "4",
                   "--phases", "1", "--quiet", "--threads", "1", "-o", "all"]
        process = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 120
        while not self.studies("all") and time.monotonic() < deadline:
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=120)
        self.assertEqual(process.returncode, INTERRUPTED)
        done = self.studies("all")
        self.assertGreater(len(done), 0)
        self.assertFalse((self.folder / "all/convergence.md").exists())
        run = self.converge(*command[1:])
        self.assertLess(len(done), len(self.studies("all")), "stopped half-way")
        self.assertIn(f"{len(done)} of {len(self.studies('all'))} were already in all", run.stdout)
        self.assertEqual({name: self.studies("all")[name] for name in done}, done)

    def test_every_scheme_reaches_its_order_on_every_case(self):
        run = self.converge("--all", "--quiet", "-o", "table")
        met, of, less, unjudged, missed = map(int, re.search(
            r"convergence: (\d+) of (\d+) met.*?; (\d+) met less.*?; (\d+) not judged; (\d+) missed",
            run.stdout).groups())
        self.assertEqual((met + less, unjudged, missed), (of, 0, 0))
        self.assertEqual((met, less), (545, 23))  # what doc/theory/convergence.md says

    def test_finer_meshes_of_an_element_reach_its_order(self):
        meshes = ("--meshes", "--case", "E12.frequencies", "-o", "m", "--quiet")
        run = self.converge(*meshes, "--json", "m.json")
        self.assertIn("convergence: 1 of 1 met the orders of theory", run.stdout)
        study, = json.loads((self.folder / "m.json").read_text())
        self.assertEqual(study["sizes"], [8, 16, 32, 64])
        for coarse, fine in zip(study["errors"], study["errors"][1:]):
            self.assertAlmostEqual(coarse / fine, 4, delta=0.3)
        self.assertIn("| `E12.frequencies` |", (self.folder / "m/meshes.md").read_text())
        before = self.studies("m")
        self.assertIn("1 of 1 were already in m", self.converge(*meshes).stdout)
        self.assertEqual(self.studies("m"), before)

    def test_the_page_of_orders_has_what_the_meshes_give(self):
        if not os.environ.get("AUSSOIS_DATA_DIR"):
            self.skipTest("no AUSSOIS_DATA_DIR, and with it no exact solutions")
        self.converge("--meshes", "-o", "m", "--quiet")
        page = (Path(__file__).resolve().parents[2] / "doc/theory/orders.md").read_text()
        self.assertIn((self.folder / "m/meshes.md").read_text(), page)

    def test_less_than_order_one_is_told_and_not_counted_as_met(self):
        run = self.converge("--case", "ball_e0", "--theta", 1, "--normal-law", "moreau", "--h0", 1e-3, "--levels", 3)
        self.assertIn("convergence: 0 of 1 met", run.stdout)
        self.assertIn("; 1 met less than one, as theory predicts;", run.stdout)
        study = json.loads(next(iter(self.studies("out").values())))
        self.assertEqual(study["verdict"], "met, less than order one is promised")
        self.assertIn("sqrt h", study["why"]["v_graph"])
        self.assertEqual(study["expected"]["v_graph"], 0.5)

    def test_bad_input_is_refused_without_a_trace(self):
        for words, arguments in (
                (["--case NAME"], []),
                (["perpetuum", "ball_e0"], ["--case", "perpetuum"]),
                (["no restitution"], ["--case", "ball_e05", "--normal-law", "gap_over_step"]),
                (["--shard 2/2", "--all"], ["--case", "free_top", "--shard", "2/2"]),
                (["--meshes", "free_top"], ["--meshes", "--case", "free_top"]),
                (["--theta", "--meshes"], ["--meshes", "--theta", "1"]),
                (["--all", "--meshes"], ["--meshes", "--all"]),
                (["--min-h = 0.01", "shortest step"], ["--case", "free_top", "--min-h", "0.01"]),
                (["--min-h", "-1"], ["--case", "free_top", "--min-h", "-1"]),
                (["3/2"], ["--all", "--shard", "3/2"]),
                (["1/2x"], ["--all", "--shard", "1/2x"]),
                (["--theta", "1.5"], ["--case", "free_top", "--theta", "1.5"]),
                (["--levels", "2"], ["--case", "free_top", "--levels", "2"]),
                (["euler", "moreau_jean"], ["--case", "free_top", "--scheme", "euler"]),
                (["event_driven", "doc/theory/event_driven.md"], ["--case", "free_top", "--scheme", "event_driven"])):
            run = self.converge(*arguments, code=USAGE)
            self.assertRegex(run.stderr, r"\Aconvergence: [^\n]*\n\Z")
            for word in words:
                self.assertIn(word, run.stderr)
            self.assertEqual(self.files(), {})


if __name__ == "__main__":
    unittest.main()
