# SPDX-License-Identifier: Apache-2.0
"""Bad input ends with one line that names file and line, or field, value and bound; with the exit code of its kind
(2 usage, 3 files); and without a trace in the folder."""

import os
import re
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PARTS, PEG, SOURCE, DriverTest, box_obj

USAGE, FILES, INTERRUPTED = 2, 3, 130


class BadInput(DriverTest):
    def refused(self, code, words, driver, *arguments):
        before = self.files()
        run = self.drive(driver, *arguments, timeout=120)
        self.assertEqual(run.returncode, code, run.stderr)
        self.assertRegex(run.stderr, rf"\A{driver}: [^\n]*\n\Z", "one line, from the program")
        for word in words:
            self.assertIn(word, run.stderr)
        self.assertEqual(self.files(), before)
        return run

    def refused_replay(self, code, words, *arguments):
        return self.refused(code, words, "replay_assembly", *arguments)

    def changed(self, name, old, new):
        """A copy of one of our own input files with `old`, which stands there once, replaced."""
        text = (PARTS / name).read_text()
        self.assertEqual(text.count(old), 1)
        path = self.folder / name
        path.write_text(text.replace(old, new))
        return path

    def with_peg(self, *arguments):
        """Our own pair, quietly, with some of its files or options replaced (the last word counts)."""
        words = list(map(str, PEG))
        for flag, value in zip(arguments[::2], arguments[1::2]):
            if flag in words:
                words[words.index(flag) + 1] = str(value)
            else:
                words += [flag, str(value)]
        return [*words, "--quiet"]

    # files

    def test_missing_mesh(self):
        self.refused_replay(FILES, ["--moving nowhere.obj: no such file"], *self.with_peg("--moving", "nowhere.obj"))
        self.refused(FILES, ["--mesh nowhere.obj: no such file"], "drop_part", "--mesh", "nowhere.obj")

    def test_missing_path(self):
        self.refused_replay(FILES, ["--path nowhere.csv: no such file"], *self.with_peg("--path", "nowhere.csv"))

    def test_a_folder_is_no_mesh(self):
        self.refused(FILES, [str(self.folder)], "drop_part", "--mesh", self.folder)

    def test_face_index_out_of_range(self):
        peg = self.changed("peg.obj", "f 9 11 12", "f 9 11 13")
        line = peg.read_text().splitlines().index("f 9 11 13") + 1
        words = [f"{peg}:{line}: ", "13", "12"]  # the index, and the number of vertices
        self.refused_replay(FILES, words, *self.with_peg("--moving", peg))
        self.refused(FILES, words, "drop_part", "--mesh", peg)

    def test_coordinate_that_is_not_a_number(self):
        socket = self.changed("socket.obj", "v 15 15 20", "v 15 nan 20")
        line = socket.read_text().splitlines().index("v 15 nan 20") + 1
        self.refused_replay(FILES, [f"{socket}:{line}: ", "nan", "finite"], *self.with_peg("--fixed", socket))

    def test_quaternion_that_is_not_unit(self):
        path = self.changed("peg_out.csv", "0,0,0,0.5,1,0,0,0", "0,0,0,0.5,1.1,0,0,0")
        line = path.read_text().splitlines().index("0,0,0,0.5,1.1,0,0,0") + 1
        self.refused_replay(FILES, [f"{path}:{line}: |(qw, qx, qy, qz)| = 1.1", "must lie within 1e-6 of 1"],
                            *self.with_peg("--path", path))

    def test_path_through_the_partner(self):
        path = self.changed("peg_out.csv", "0,0,0,0.5,1,0,0,0", "0,3,0,0.5,1,0,0,0")
        line = path.read_text().splitlines().index("0,3,0,0.5,1,0,0,0") + 1
        run = self.refused_replay(FILES, [f"{path}:{line}: pose 0 of the path: peg and socket are in contact at ("],
                                  *self.with_peg("--path", path))
        self.assertNotIn("more", run.stderr)
        place = [float(x) for x in re.search(r"at \((.*)\) m", run.stderr)[1].split(",")]
        self.assertTrue(5e-3 <= place[0] <= 8e-3 + 1e-9, place)  # the peg pushed 3 mm into the wall x > 5 mm

    def test_path_with_several_poses_through_the_partner(self):
        rows = (PARTS / "peg_out.csv").read_text().splitlines()
        path = self.folder / "path.csv"
        start = rows.index("0,0,0,0.5,1,0,0,0")
        path.write_text("\n".join(rows[:start] + ["0,3,0,0.5,1,0,0,0"] * 5 + rows[start:]) + "\n")
        self.refused_replay(FILES, [f"{path}:{start + 1}: ", f"; 5 of {len(rows) - start + 5} poses are wrong"],
                            *self.with_peg("--path", path))

    def test_part_inside_the_partner(self):
        """In the wall of the socket no face would see it; in the hole it is where it belongs. A lump of two counts."""
        (self.folder / "cube.obj").write_text(box_obj(4))
        (self.folder / "path.csv").write_text("x,y,z,qw,qx,qy,qz\n10,0,10,1,0,0,0\n10,1,10,1,0,0,0\n")
        files = ("--fixed", PARTS / "socket.obj", "--moving", "cube.obj", "--path", "path.csv", "--quiet")
        for mode in ("dynamic", "kinematic"):
            self.refused_replay(FILES, ["pose 0 of the path: cube lies inside the solid of socket"], *files, "--mode", mode)
        (self.folder / "path.csv").write_text("x,y,z,qw,qx,qy,qz\n0,0,10,1,0,0,0\n10,0,10,1,0,0,0\n")
        self.refused_replay(FILES, ["pose 1 of the path: cube lies inside"], *files)
        lines = box_obj(4).splitlines()
        beside = [f"v {float(x) + 30} {y} {z}" for _, x, y, z in map(str.split, lines[:8])]
        faces = ["f " + " ".join(str(int(v) + 8) for v in line.split()[1:]) for line in lines[8:]]
        (self.folder / "cube.obj").write_text("\n".join(lines + beside + faces) + "\n")
        self.refused_replay(FILES, ["pose 1 of the path: 1 of 2 pieces of cube lie inside the solid of socket, one at"],
                            *files)

    def test_every_broken_mesh_of_ours(self):
        """What the unit tests of the readers refuse, a driver refuses with the same line."""
        meshes = [path for path in sorted((SOURCE / "tests/data/broken").iterdir()) if path.suffix != ".csv"]
        self.assertGreater(len(meshes), 40)
        for mesh in meshes:
            with self.subTest(mesh=mesh.name):
                self.refused(FILES, [str(mesh)], "drop_part", "--mesh", mesh, "--time", "0.01")

    def test_every_broken_path_of_ours(self):
        paths = sorted((SOURCE / "tests/data/broken").glob("*.csv"))
        self.assertGreater(len(paths), 8)
        for path in paths:
            with self.subTest(path=path.name):
                self.refused_replay(FILES, [f"{path}:"], *self.with_peg("--path", path))

    def test_broken_meshes_of_the_shared_data(self):
        """They are read or refused: no crash, no hang, no sanitizer. What is refused leaves no trace."""
        meshes = sorted((self.data() / "meshes/broken").iterdir())
        self.assertGreater(len(meshes), 0)
        for mesh in meshes:
            with self.subTest(mesh=mesh.name):
                run = self.drive("drop_part", "--mesh", mesh, "--scale", "1e-3", "--time", "0.01", "-o", mesh.name,
                                 "--quiet", timeout=120)
                if run.returncode in (0, 1):  # 1: after 10 ms it still falls
                    self.assertTrue((self.folder / mesh.name / "replay.html").exists())
                else:
                    self.assertIn(run.returncode, (USAGE, FILES), run.stderr)
                    self.assertRegex(run.stderr, r"drop_part: [^\n]*\n\Z")
                    self.assertFalse((self.folder / mesh.name).exists())

    def test_cables_that_make_no_sense(self):
        changes = (('"radius": 1e-3, ', "", "section.radius is missing"),
                   ('"poisson": 0.45', '"poisson": 0.5', "section.poisson = 0.5 must lie in (-1, 0.5)"),
                   ('"elements": 80', '"elements": 80.5', "elements = 80.5 must be a whole number"),
                   ('"elements": 80', '"elements": 1', "elements = 1 must lie in [2, 10000]"),
                   ('"part": "moving"', '"part": "peg"', "from.part = 'peg' must be fixed or moving"),
                   ('"along": [-1, 0, 0]', '"along": [0, 0, 0]', "to.along must not be zero"),
                   ('"along": [-1, 0, 0]', '"along": [-1, 0]', "to.along must be three numbers"),
                   ('"hole": 0.003', '"hole": 0.001', "via[2].hole = 0.001 must exceed the cable's radius, 0.001"),
                   ('"along": [-1, 0, 0]', '"along": [1e300, 0, 0]', "to.along = 1e+300 must lie in [-1000, 1000]"),
                   ('"at": [0.0175', '"at": [17500', "to.at = 17500 must lie in [-1000, 1000]"),
                   ('"name": "lead"', '"title": "lead"', "'title' is unknown"),
                   ('"name": "lead"', '"name": "peg"', "two bodies are named 'peg'"),
                   ('"name": "lead"', '"name": "a/b"', "name = 'a/b' must be"),
                   ('"name": "lead"', '"elements": 8', "'elements' stands twice in one object"),
                   ('"elements": 80,', '"elements": 80', "line 5"))
        for old, new, words in changes:
            path = self.changed("peg_lead.json", old, new)
            self.refused_replay(FILES, [f"{path}: ", words], *self.with_peg("--flexible", path))
        path = self.changed("peg_lead.json", "[0.03, 0, 0.055]", "[0, 0, 0.01]")
        self.refused_replay(FILES, ["peg", "lead"], *self.with_peg("--flexible", path))
        self.refused_replay(USAGE, ["--flexible"], *self.with_peg("--flexible", PARTS / "peg_lead.json", "--mode", "kinematic"))

    # options

    def test_negative_dilation(self):
        for driver in ("replay_assembly", "drop_part"):
            self.refused(USAGE, ["--dilation", "-1e-5", "must be in ["], driver, "--dilation", "-1e-5")

    def test_dilation_that_does_not_fit(self):
        run = self.refused_replay(USAGE, [], *self.with_peg("--dilation", "6e-4"))
        self.assertRegex(run.stderr, r"--dilation = 0\.0006 m must be less than half of the smallest clearance, "
                                     r"2\.\d{1,5}e-05 m$")

    def test_option_without_its_value(self):
        files = ("--builtin", "peg", "--picture")
        self.refused(USAGE, ["--picture needs a value, not -o"], "query_contacts", *files, "-o", "gear")
        self.refused(USAGE, ["--picture needs a value"], "query_contacts", *files)

    def test_number_that_is_none(self):
        self.refused_replay(USAGE, ["--mu", "'nan' is not a number"], "--mu", "nan")
        self.refused_replay(USAGE, ["--gravity = 0,0,nan", "three numbers"], *self.with_peg("--gravity", "0,0,nan"))

    def test_unknown_option(self):
        for driver in ("replay_assembly", "drop_part", "sliding_block"):
            self.refused(USAGE, ["--no-such-option", "--help"], driver, "--no-such-option")

    def test_unknown_pair(self):
        (self.folder / "assembly").mkdir()
        (self.folder / "assembly/pairs.csv").write_text("name,fixed,moving,trajectory\npeg,socket,peg,peg_out.csv\n")
        self.refused_replay(USAGE, ["--pair = no_such_pair must be one of peg"], "--data", ".", "--pair", "no_such_pair")

    def test_unknown_builtin(self):
        self.refused_replay(USAGE, ["--builtin = no_such_part must be bolt_nut"], "--builtin", "no_such_part")
        self.refused(USAGE, ["--builtin", "'no_such_part' must be one of box, bolt"], "drop_part", "--builtin", "no_such_part")

    def test_no_scene_or_two(self):
        self.refused_replay(USAGE, ["give one of"])
        self.refused_replay(USAGE, ["give one of"], *self.with_peg("--builtin", "bolt_nut"))

    def test_slope_on_which_the_block_never_stops(self):
        self.refused(USAGE, ["--angle = ", "below the friction angle"], "sliding_block", "--angle", "30", "--mu", "0.3")

    # output

    def test_unwritable_output(self):
        (self.folder / "taken").write_text("a file, not a folder\n")
        for driver, scene in (("replay_assembly", self.with_peg()), ("drop_part", []), ("sliding_block", ["--levels", "3"])):
            self.refused(FILES, ["taken"], driver, *scene, "--quiet", "-o", "taken/out")

    def test_unwritable_summary(self):
        (self.folder / "taken").write_text("a file, not a folder\n")
        for driver, scene in (("replay_assembly", self.with_peg()), ("drop_part", []), ("sliding_block", ["--levels", "3"])):
            self.refused(FILES, ["taken"], driver, *scene, "--quiet", "--summary", "taken/s.json")

    # restart

    def test_resume_without_checkpoint(self):
        self.refused_replay(FILES, ["out/checkpoint.h5"], *self.with_peg("-o", "out"), "--resume")

    def test_resume_with_other_options(self):
        stopped = self.drive("replay_assembly", *self.with_peg("--stop-after", "20"))
        self.assertEqual(stopped.returncode, INTERRUPTED, stopped.stderr)
        self.assertEqual(set(self.files()), {"out/checkpoint.h5", "out/run.h5.tmp", "out/steps.csv.tmp"})
        self.refused_replay(FILES, ["out/checkpoint.h5", "fingerprint"], *self.with_peg("--mu", "0.3"), "--resume")
        whole = self.drive("replay_assembly", *self.with_peg(), "--resume")  # the refusal has spoilt nothing
        self.assertEqual(whole.returncode, 0, whole.stderr)

    def test_resume_by_another_build(self):
        """The program with one byte more is another one: refused with both versions, unless the user insists."""
        self.hdf5()
        for driver, scene in (("replay_assembly", self.with_peg()),
                              ("run_scene", ["--scene", "tower", "--time", "0.1", "--quiet"])):
            with self.subTest(driver):
                program = Path(os.environ["AUSSOIS_DRIVERS"], driver)
                other = self.folder / f"other_{driver}"
                other.write_bytes(program.read_bytes() + b"\0")
                other.chmod(0o755)
                self.drive(driver, *scene, "-o", "whole")
                stopped = self.drive(driver, *scene, "--stop-after", 2)
                self.assertEqual(stopped.returncode, INTERRUPTED, stopped.stderr)
                before = self.files()
                run = self.drive(other, *scene, "--resume")
                self.assertEqual(run.returncode, FILES, run.stderr)
                self.assertRegex(run.stderr, r"\A\w+: out/checkpoint.h5: /@program: [^\n]*written by aussois [^\n]*, program "
                                 r"[0-9a-f]{16}, this is aussois [^\n]*, program [0-9a-f]{16}[^\n]*--resume-anyway\n\Z")
                self.assertEqual(self.files(), before)
                run = self.drive(other, *scene, "--resume-anyway")
                self.assertEqual(run.returncode, 0, run.stderr)
                self.assertIn("continued by aussois", run.stderr)
                with self.hdf5().File(self.folder / "out/run.h5") as h5:
                    self.assertRegex(h5["notes"].attrs["continued_by"].decode(), "program [0-9a-f]{16} after step 2 of aussois")
                self.assertEqual((self.folder / "out/steps.csv").read_bytes().count(b"\n"),
                                 (self.folder / "whole/steps.csv").read_bytes().count(b"\n"))

    def test_two_runs_in_one_folder(self):
        """The second is refused while the first is at work, which ends as if there had been none."""
        scene = ["--scene", "tower", "--time", "1", "--quiet"]
        first = subprocess.Popen([Path(os.environ["AUSSOIS_DRIVERS"], "run_scene"), *scene], cwd=self.folder,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(first.wait)
        self.addCleanup(first.kill)
        while first.poll() is None and not (self.folder / "out/steps.csv.tmp").exists():
            time.sleep(0.001)
        first.send_signal(signal.SIGSTOP)
        self.refused(FILES, ["out/run.h5.tmp", "another run is writing it"], "run_scene", *scene)
        self.refused(FILES, ["checkpoint.h5"], "run_scene", *scene, "--resume")
        first.send_signal(signal.SIGCONT)
        self.assertEqual(first.wait(), 0)
        self.assertTrue((self.folder / "out/run.h5").exists() and (self.folder / "out/steps.csv").exists())

    def test_flags_that_only_the_other_mode_reads(self):
        for flags in (["--scheme", "passive_midpoint"], ["--theta", 0.5], ["--tolerance", 1e-9], ["--reducer", "none"], ["--certify", 3],
                      ["--stop-after", 2], ["--dump-problem", "steps"], ["--every", 2], ["--speed", 0.1], ["--force-limit", 5],
                      ["--hold", 1], ["--h", 1e-3], ["--mu", 0.1], ["--mass", 1], ["--gravity", "0,0,-9.81"]):
            self.refused_replay(USAGE, [f"{flags[0]} needs --mode dynamic"], *self.with_peg("--mode", "kinematic"), *flags)
        self.refused_replay(USAGE, ["--threshold needs --mode kinematic"], *self.with_peg(), "--threshold", 1e-4)

    def test_flags_that_only_another_flag_makes_read(self):
        for flag, value in (("--mu", 0.1), ("--stones", 5), ("--thickness", 0.1), ("--tilt", 1), ("--scatter", 1e-4)):
            self.refused(USAGE, [f"{flag} needs --scene arch"], "peer_scene", "--scene", "tower", flag, value)
        self.refused(USAGE, ["--selector-body needs --selector"], "run_scene", "--scene", "pressed_peg", "--selector-body", 1)
        for driver in (("run_scene", "--scene", "arch"), ("sliding_block",), ("convergence",), ("cube_toss", "--synthetic", 2)):
            self.refused(USAGE, ["--dump-steps needs --dump-problem"], *driver, "--dump-steps", "3")
        for flag in ("--seed", "--noise"):
            self.refused(USAGE, [f"{flag} needs --synthetic"], "cube_toss", "--data", self.folder, flag, 0)
        for flag, value in (("--from-mu", 0.2), ("--from-restitution", 0.2), ("--test", self.folder)):
            self.refused(USAGE, [f"{flag} needs --fit"], "cube_toss", "--synthetic", 2, flag, value)
        self.refused(USAGE, ["--board is what --measure-board finds"], "cube_toss", "--synthetic", 2, "--fit", "--measure-board", "--board", 1e-3)

    def test_a_restitution_that_the_law_does_not_read(self):
        self.refused(USAGE, ["restitution = 0.5", "gap_over_step"], "run_scene", "--scene", "ball_e05", "--normal-law", "gap_over_step")
        self.refused(USAGE, ["--restitution = 0.2 must be 0"], "drop_part", "--normal-law", "gap_over_step")

    def test_resume_where_nothing_can_be_resumed(self):
        self.refused_replay(USAGE, ["--resume needs --mode dynamic"], *self.with_peg("--mode", "kinematic"), "--resume")
        self.refused(FILES, ["out/checkpoint.h5"], "peer_scene", "--resume")
        self.refused(USAGE, ["--resume"], "sliding_block", "--resume")


class OpenMesh(DriverTest):
    def test_is_used_as_sheets_with_a_warning(self):
        """A peg with a hole in its lid bounds no volume: its surface is used as it is, its mass is that of its hull."""
        text = (PARTS / "peg.obj").read_text()
        (self.folder / "open.obj").write_text(text.replace("f 9 11 12\n", ""))
        closed = self.replay("closed", *PEG)
        opened = self.replay("open", *PEG[:2], "--moving", "open.obj", *PEG[4:])
        sheets = "used as two-sided sheets, because it is not a solid: 3 border edges"
        self.assertNotIn(sheets, closed.stderr)
        self.assertIn(f"warning: open: {sheets}", opened.stderr)
        self.assertEqual(self.summary("closed")["mass_source"], "solid")
        self.assertEqual(self.summary("open")["mass_source"], "convex hull")
        self.assertAlmostEqual(self.summary("open")["mass"] / self.summary("closed")["mass"], 1, 12)  # convex anyway


if __name__ == "__main__":
    unittest.main()
