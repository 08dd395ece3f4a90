# SPDX-License-Identifier: Apache-2.0
"""Executes one documented run in an empty folder: it succeeds and leaves just the results that examples/README.md
promises, whole.

    python3 run_line.py DRIVER [argument...]
"""

import os
import re
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PARTS, DriverTest

# data/ is that of examples/
COMMAND = [str(PARTS.parent / word) if word.startswith("data/") else word for word in sys.argv[1:]]
WRITES = [Path(word).name for flag, word in zip(COMMAND, COMMAND[1:]) if flag in ("--json", "--csv", "--picture")]
FAMILIES = ("arch", "box_stack", "bridge", "chain", "gyroscopic", "impacts", "kapla_tower", "masonry_wall",
            "mass_ratio", "mixed_laws", "redundant_joints", "sphere_pile")
STUDY = f"{'forced_46' if 'forced_46' in COMMAND else 'free_top'}_moreau_jean_theta_{'1' if '--theta' in COMMAND else '0.5'}_combined"
MESH_STUDIES = ["E12.frequencies", "E14.ring"]
if os.environ.get("AUSSOIS_DATA_DIR"):  # these compare with shared series
    MESH_STUDIES += ["E2.bend_of_45_degrees", "E6.elastica", "F8.hollow_ball__hexahedra__Lame_s_constants_equal_",
                     "F8.hollow_ball__hexahedra__nearly_incompressible_"]
RESULTS = {
    "cube_toss": {"tosses.csv", "histogram.csv", "histogram.gp", *(["histogram.png"] if shutil.which("gnuplot") else []),
                  *(f"{word}.html" for flag, word in zip(COMMAND, COMMAND[1:]) if flag == "--replay"),
                  *(f"synthetic/toss_{i + 1:03}.csv" for flag, n in zip(COMMAND, COMMAND[1:]) if flag == "--synthetic"
                    for i in range(int(n))),
                  *(f"results/{name}" for name in (
                      ("fit_STAGE_NUMBER.json", "seen_001.json", "unseen_001.json") if "--fit" in COMMAND else
                      [f"all_{i + 1:03}.json" for flag, n in zip(COMMAND, COMMAND[1:]) if flag == "--synthetic"
                       for i in range((int(n) + 15) // 16)]))},  # batches of 16
    "peg_plate": {"scores.md", "verdicts.txt", "seed_1/training.json",
                  *(f"seed_1/surface_0.3/{name}" for name in (
                      "choices.csv", "choices.gp", "forces.csv", "forces.gp", "lessons.json", "mlc_argmin.txt", "mlc_ranked.txt", "mlc_soft.txt",
                      "options.json", "pressure.csv", "result.json", *(f"samples/{i:03}.csv" for i in range(16)),
                      *(["choices.png", "forces.png"] if shutil.which("gnuplot") else [])))},
    "convergence": {f"{study}.{kind}" for study in (MESH_STUDIES if "--meshes" in COMMAND else [STUDY])
                    for kind in ("json", "csv", "gp", *(["png"] if shutil.which("gnuplot") else []))}
                   | ({"meshes.md"} if "--meshes" in COMMAND else set()),
    "sliding_block": {"sliding_block.csv", "sliding_block.gp",
                      *(f"results/level_{i + 1}.json" for i in range(4 if "--levels" in COMMAND else 7))},
    "verify": set() if "--list" in COMMAND else {"verified.json", "verify/A4.unequal_balls.json"},
    "haptic_trial": {"haptic_trial.csv"},
    "assembly_station": {"session.h5", "run.h5", "ticks.csv", "path.csv", "replay.html", "report.html"},
    "assess_path": {"run.h5", "ticks.csv", "path.csv", "replay.html", "report.html", "assessment.json"},
    "compare_paths": {"compared.csv"},
    "prepare_part": {"part.html", "eroded.obj"},
    "run_scene": {"run.h5", "steps.csv", *([] if "bricard" in COMMAND else ["replay.html"])},  # it has no shapes
    "reduction_gallery": {f"reduction_{part}.svg" for part in ("cylinder", "torus", "gear", "peg")},
    "peer_scene": {"run.h5", "steps.csv", "replay.html", "before.dat", "after.dat", "peer_scene.gp", *(["peer_scene.png"] if shutil.which("gnuplot") else [])},
    "drop_part": {"replay.html", "run.h5", "steps.csv"},
    "replay_assembly": {"replay.html", "run.h5", "poses.csv" if "kinematic" in COMMAND else "steps.csv"},
    "query_contacts": set(WRITES),
    "solve_friction_problem": set(WRITES),
    "generate_friction_problems": {f"problems/{family}_n{size}_s{seed}.hdf5"
                                   for family in FAMILIES for size in (20, 100) for seed in (1, 2)},
    "solver_profile": {*(f"results/DIGEST_{solver}_{tolerance}_OPTIONS.json" for solver in ("auto", "nsgs")
                         for tolerance in ("1e-04", "1e-08")),
                       *(f"profile_{tolerance}.{kind}" for tolerance in ("1e-04", "1e-08")
                         for kind in ("csv", "gp", *(["png"] if shutil.which("gnuplot") else [])))},
}


class RunLine(DriverTest):
    def test_runs_as_documented(self):
        run = self.drive(*COMMAND)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertTrue(run.stdout.splitlines()[-1].strip(), "ends with one clear line")
        files = self.files()
        def any_name(name):
            for digits, word in (("/[0-9a-f]{16}_", "/DIGEST_"), (r"_[0-9a-f]{16}\.json", "_OPTIONS.json"),
                                 (r"/fit_\d_\d{3}", "/fit_STAGE_NUMBER")):
                name = re.sub(digits, word, name)
            return name

        self.assertEqual({any_name(name) for name in files},
                         {f"out/{name}" for name in RESULTS[COMMAND[0]]})
        for name, content in files.items():
            self.assertGreater(len(content), 40, name)
            if name.endswith(".html"):
                self.assertTrue(content.rstrip().endswith(b"</html>"))
        if "out/run.h5" in files:
            self.assertTrue(files["out/run.h5"].startswith(b"\x89HDF\r\n\x1a\n"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
