# SPDX-License-Identifier: Apache-2.0
"""Scenes of the library as a user runs them: files, summaries, restarts, refusals."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PARTS, DriverTest

NOT_ACCEPTED, USAGE, MISSING, INTERRUPTED = 1, 2, 3, 130


class RunScene(DriverTest):
    def run_scene(self, *arguments, code=0):
        run = self.drive("run_scene", *arguments)
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def test_list_names_scenes_of_every_kind(self):
        lines = self.run_scene("--list").stdout.splitlines()
        names = [line.split()[0] for line in lines]
        self.assertEqual(names, sorted(set(names)))
        for name in ("ball_e05", "arch", "bricard", "tippe_top"):
            self.assertIn(name, names)
        self.assertEqual(self.files(), {})

    def test_every_scene_takes_its_first_steps_and_no_audit_objects(self):
        for line in self.run_scene("--list").stdout.splitlines():
            name, h = line.split()[0], line.rsplit("h = ", 1)[1].split()[0]
            run = self.drive("run_scene", "--scene", name, "--time", 10 * float(h), "--certify", 2, "--quiet", "-o", name)
            self.assertEqual(run.returncode, 0, f"{name}: {run.stderr}{run.stdout}")

    def test_every_scheme_reads_the_settings_that_are_its_own(self):
        scene = ("--scene", "ball_e05", "--time", "0.02", "--quiet", "--summary", "s.json")
        for scheme, flags, told in (("schatzman_paoli", ("--force-theta", 1), "theta 1"),
                                    ("passive_midpoint", ("--not-passive",), "not passive"),
                                    ("event_driven", ("--ode-relative", 1e-6), "relative 1e-06"),
                                    ("event_driven", ("--ode-absolute", 1e-7), "absolute 1e-07")):
            self.run_scene(*scene, "--scheme", scheme, *flags, "-o", "out")
            self.assertIn(told, json.loads((self.folder / "s.json").read_text())["scheme"])
            run = self.run_scene(*scene, "--scheme", "generalised_alpha", *flags, "-o", "refused", code=USAGE)
            for word in (flags[0], scheme, "generalised_alpha"):
                self.assertIn(word, run.stderr)

    def test_a_restart_changes_no_bit(self):
        scene = ("--scene", "bricard", "--h", "2e-3", "--time", "0.1", "--quiet")
        self.run_scene(*scene, "-o", "whole")
        self.run_scene(*scene, "-o", "parts", "--stop-after", 20, code=INTERRUPTED)
        self.assertIn("parts/checkpoint.h5", self.files())
        self.run_scene(*scene, "-o", "parts", "--resume")
        files = self.files()
        self.assertEqual(files["whole/steps.csv"], files["parts/steps.csv"])
        self.assertNotIn("parts/checkpoint.h5", files)

    def test_a_learned_selector_chooses_the_contacts_of_a_peg(self):
        """Five contacts at most instead of 32 (three, the deepest, one that came back), and the peg stays where it is."""
        scene = ("--scene", "pressed_peg", "--quiet")
        self.run_scene(*scene, "--reducer", "none", "-o", "all", "--summary", "all.json")
        self.run_scene(*scene, "--selector", PARTS / "peg_selector.txt", "-o", "learned", "--summary", "learned.json")
        self.assertGreaterEqual(min(map(float, self.columns("all")["contacts"])), 32)
        self.assertLessEqual(max(map(float, self.columns("learned")["contacts"])), 5)
        # What was left out comes back when it closes by a hundredth of the dilations, 0.1 mm each, in a step.
        for out, most in (("all", 1e-9), ("learned", 2e-6)):
            self.assertLess(json.loads((self.folder / f"{out}.json").read_text())["max_displacement"], most)

    def test_a_selector_that_is_not_one_is_refused_by_file_and_line(self):
        scene = ("--scene", "pressed_peg")
        text = (PARTS / "peg_selector.txt").read_text().replace("hidden 8", "hidden eight")
        (self.folder / "broken.txt").write_text(text)
        run = self.run_scene(*scene, "--selector", "broken.txt", code=MISSING)
        self.assertRegex(run.stderr, r"\Arun_scene: \S*broken.txt:3: [^\n]*eight[^\n]*\n\Z")
        (self.folder / "network.txt").write_text(text[:text.index("keep")].replace("eight", "8"))
        run = self.run_scene(*scene, "--selector", "network.txt", code=MISSING)
        self.assertIn("the file ends before keep and places", run.stderr)
        self.run_scene(*scene, "--selector", "nowhere.txt", code=MISSING)
        run = self.run_scene(*scene, "--reducer", "selector", code=USAGE)
        self.assertIn("--selector must be given with reducer selector", run.stderr)
        run = self.run_scene(*scene, "--selector", PARTS / "peg_selector.txt", "--selector-body", 7, code=USAGE)
        self.assertIn("--selector-body = 7 must be less than 2", run.stderr)

    def test_a_restart_with_other_settings_is_refused(self):
        scene = ("--scene", "tower", "--time", "0.1", "--quiet")
        self.run_scene(*scene, "--stop-after", 2, code=INTERRUPTED)
        for other in (["--reducer", "none"], ["--patch-friction"], ["--update", "cayley"], ["--newton-iterations", 9],
                      ["--min-h", "1e-9"], ["--every", 2], ["--certify", 3]):
            before = self.files()
            run = self.drive("run_scene", *scene, *other, "--resume")
            self.assertNotEqual(run.returncode, 0, other)
            self.assertIn("checkpoint", run.stderr)
            self.assertEqual(self.files(), before)
        self.run_scene(*scene, "--resume")

    def test_energy_that_contacts_give_is_told(self):
        pile = ("--scene", "666_elastic", "--time", "0.5", "--h", "0.01", "--quiet", "--summary", "s.json")
        for scheme, gains in (("schatzman_paoli", True), ("generalised_alpha", False)):
            run = self.run_scene(*pile, "--scheme", scheme)
            summary = json.loads((self.folder / "s.json").read_text())
            self.assertEqual(summary["energy_rises"] > 0, gains)
            self.assertEqual(summary["impulse_gain"] > 1e3, gains)  # J, of 34 kJ
            self.assertEqual("contacts added energy" in run.stderr, gains)

    def test_energy_that_a_run_gains_little_by_little_is_told(self):
        """One per cent in a thousand steps by the explicit trapezoidal rule, through a restart too; none at the midpoint."""
        top = ("--scene", "free_top", "--time", "100", "--quiet", "--summary", "s.json", "--scheme")
        summary = lambda: json.loads((self.folder / "s.json").read_text())
        self.run_scene(*top, "d1_minus_linear", "--stop-after", 400, code=INTERRUPTED)
        run = self.run_scene(*top, "d1_minus_linear", "--resume")
        self.assertRegex(run.stderr, r"energy rose by \S+ J without a source")
        parts = summary()
        self.run_scene(*top, "d1_minus_linear", "-o", "whole")
        self.assertEqual(parts["energy_gain"], summary()["energy_gain"])
        self.assertGreater(parts["energy_gain"], 5e-3 * parts["energy_at_start"])
        self.assertEqual(parts["energy_rises"], 0)
        run = self.run_scene(*top, "passive_midpoint")
        self.assertNotIn("energy rose", run.stderr)
        self.assertLess(summary()["energy_gain"], 1e-12)

    def test_summary_tells_what_the_certificate_is_worth(self):
        self.run_scene("--scene", "tower", "--time", "0.1", "--certify", 10, "--quiet", "--summary", "s.json")
        summary = json.loads((self.folder / "s.json").read_text())
        self.assertEqual((summary["refused_steps"], summary["solver_failures"]), (0, 0))
        self.assertEqual((summary["certify_steps"], summary["certify_violations"]), (summary["steps"], 0))
        self.assertGreater(summary["certify_min_distance"], 0)
        self.assertLess(summary["max_displacement"], 1e-8)
        self.assertEqual((summary["certify_nested"], summary["certify_skipped"]), (0, []))
        self.assertEqual((summary["passing_pairs"], summary["driven_overlaps"], summary["driven_overlap_t"]), (0, 0, None))
        run = self.run_scene("--scene", "ball_e05", "--time", "0.01", "--certify", 2, "--quiet", "--summary", "s.json")
        self.assertIn("no two bodies came within twice their dilations, 0 violations", run.stdout)
        self.assertIsNone(json.loads((self.folder / "s.json").read_text())["certify_min_distance"])

    def test_every_scheme_is_certified_and_what_cannot_touch_has_nothing_to_show(self):
        for scheme in ("event_driven", "generalised_alpha", "moreau_jean_projected"):
            self.run_scene("--scene", "tower", "--scheme", scheme, "--time", "0.03", "--certify", 10, "--quiet",
                           "--summary", "s.json")
            summary = json.loads((self.folder / "s.json").read_text())
            self.assertEqual((summary["certify_steps"], summary["certify_violations"]), (summary["steps"], 0))
        run = self.run_scene("--scene", "bricard", "--time", "0.01", "--certify", 10, "--quiet", "--summary", "s.json")
        self.assertIn("nothing to check", run.stdout)
        self.assertEqual(json.loads((self.folder / "s.json").read_text())["certify_steps"], 0)

    def test_a_replay_has_bodies_or_is_not_there(self):
        self.run_scene("--scene", "arch", "--time", "0.02", "--quiet")
        self.assertIn("out/replay.html", self.files())
        run = self.run_scene("--scene", "woodpecker", "--time", "1e-4", "--quiet")
        self.assertEqual(set(self.files()), {"out/run.h5", "out/steps.csv"})
        self.assertIn("no replay: no body of this scene has a shape", run.stdout)

    def test_a_needle_of_ten_rad_a_step_does_not_pass_the_sheet(self):
        """Its tips cross the overlap that is granted in 0.04 us (doc/theory/toys.md, A5)."""
        for scheme in ("moreau_jean", "passive_midpoint"):
            self.run_scene("--scene", "needle", "--scheme", scheme, "--h", "1e-3", "--min-h", "1e-12", "--certify", 100,
                           "--quiet", "--summary", "s.json")
            summary = json.loads((self.folder / "s.json").read_text())
            self.assertEqual((summary["refused_steps"], summary["certify_violations"]), (0, 0))
            self.assertAlmostEqual(summary["t"], 1e-3, delta=1e-15)
            refused = self.run_scene("--scene", "needle", "--scheme", scheme, "--h", "1e-3", "--min-h", "1e-4", "--quiet",
                                     code=NOT_ACCEPTED)
            self.assertIn("no step of at least 0.0001 s was accepted: bodies 0 and 1", refused.stderr)

    def test_steps_tell_the_work_of_every_contact_law(self):
        self.run_scene("--scene", "tippe_top", "--time", "0.01", "--quiet")
        head, *rows = (self.folder / "out/steps.csv").read_text().splitlines()
        work = [i for i, name in enumerate(head.split(",")) if name.startswith("work:mu ")]
        self.assertGreaterEqual(len(work), 1)
        self.assertLess(sum(float(row.split(",")[i]) for row in rows for i in work), 0)

    def test_steps_tell_the_work_of_every_joint(self):
        self.run_scene("--scene", "squeezer", "--theta", "0.5", "--time", "0.005", "--quiet")
        head, *lines = (self.folder / "out/steps.csv").read_text().splitlines()
        names, rows = head.split(","), [[float(x) for x in line.split(",")] for line in lines]
        work = [i for i, name in enumerate(names) if name.startswith("work:joint:")]
        self.assertGreaterEqual(len(work), 7)
        stored = [row[names.index("kinetic")] + row[names.index("laws")] for row in rows]
        given = sum(row[i] for row in rows[1:] for i in work)  # by the motor: bodies and spring have it
        self.assertAlmostEqual(given, stored[-1] - stored[0], delta=1e-3 * given)

    def test_profile_tells_where_steps_go_and_changes_no_bit(self):
        scene = ("--scene", "arch", "--time", "0.02", "--quiet", "--summary", "s.json")
        plain = self.run_scene(*scene, "-o", "plain").stdout
        self.assertNotIn("profile_stages", json.loads((self.folder / "s.json").read_text()))
        told = self.run_scene(*scene, "-o", "told", "--profile").stdout
        summary = json.loads((self.folder / "s.json").read_text())
        stopped = self.run_scene(*scene, "-o", "stopped", "--profile", "--stop-after", 2, code=INTERRUPTED).stdout
        stages = summary["profile_stages"]
        self.assertEqual(stages[-3:], ["other", "recording", "step"])
        for clock in ("wall", "cpu"):
            p50, p99, most, mean = (summary[f"profile_{clock}_ms_{name}"] for name in ("p50", "p99", "max", "mean"))
            for stage, *figures in zip(stages, p50, p99, most):
                self.assertEqual(figures, sorted(figures), stage)
            self.assertAlmostEqual(sum(mean[:-2]), mean[-1], 9)  # all but recording
            self.assertGreater(mean[-1], 0)
        for stage in stages:
            for table in (told, stopped):
                self.assertRegex(table, rf"(?m)^{stage} +\d")
            self.assertNotRegex(plain, rf"(?m)^{stage} +\d")
        self.assertEqual(summary["steps"], len((self.folder / "told/steps.csv").read_text().splitlines()) - 1)
        timeless = [[line.split(",")[:6] for line in (self.folder / name / "steps.csv").read_text().splitlines()]
                    for name in ("plain", "told")]
        self.assertEqual(*timeless)

    def test_bad_input_is_refused_without_a_trace(self):
        for words, arguments in ((["--scene", "perpetuum", "arch"], ["--scene", "perpetuum"]),
                                 (["--scene"], []),
                                 (["--h", "-1"], ["--scene", "arch", "--h", "-1"]),
                                 (["--min-h", "2"], ["--scene", "needle", "--min-h", "2"]),
                                 (["--min-h = 0.5"], ["--scene", "needle", "--min-h", "0.5"]),
                                 (["--impact-order = sequential", "--normal-law"],
                                  ["--scene", "needle", "--impact-order", "sequential", "--normal-law", "gap_over_step"]),
                                 (["--min-h", "event_driven"],
                                  ["--scene", "needle", "--scheme", "event_driven", "--min-h", "1e-12"]),
                                 (["euler"], ["--scene", "arch", "--scheme", "euler"]),
                                 (["--impact-law", "generalised_alpha", "moreau_jean"],
                                  ["--scene", "arch", "--scheme", "generalised_alpha", "--impact-law", "poisson"])):
            run = self.run_scene(*arguments, code=USAGE)
            self.assertRegex(run.stderr, r"\Arun_scene: [^\n]*\n\Z")
            for word in words:
                self.assertIn(word, run.stderr)
            self.assertEqual(self.files(), {})


if __name__ == "__main__":
    unittest.main()
