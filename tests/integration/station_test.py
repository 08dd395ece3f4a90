# SPDX-License-Identifier: Apache-2.0
"""A session is kept and repeated with the same bits, whatever ends it; what is wrong is named."""

import json
import os
import signal
import struct
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PARTS, PEG, DriverTest

GRAB = {"kind": "grab"}


class Station(DriverTest):
    def script(self, commands, name="hand.json"):
        (self.folder / name).write_text(commands if isinstance(commands, str) else json.dumps(commands))
        return "--script", name, "--no-browser"

    def station(self, *arguments, out="out", code=0):
        run = self.drive("assembly_station", *PEG, *arguments, "--quiet", "-o", out)
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def assess(self, session, *arguments, out="again", code=0):
        run = self.drive("assess_path", "--session", session, *arguments, "--quiet", "-o", out, "--summary",
                         f"{out}/summary.json")
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def test_repeats_every_take_with_the_same_bits(self):
        self.station("--script", PARTS / "peg_by_hand.json", "--no-browser")
        self.assess("out/session.h5")
        for name in ("ticks.csv", "path.csv"):
            self.assertEqual((self.folder / "out" / name).read_bytes(), (self.folder / "again" / name).read_bytes())
        self.assess("out/session.h5", "--take", 0, "--threads", 2, out="first")
        summary = self.summary("first")
        self.assertEqual(summary["differs"], -1)
        self.assertGreater(summary["contact_force"], 0)  # it leans on the hole
        self.assertGreaterEqual(summary["hashes"], summary["ticks"] // 64)

    def test_compares_a_session_with_its_repetition_and_with_another_take(self):
        self.station("--script", PARTS / "peg_by_hand.json", "--no-browser")
        self.assess("out/session.h5")
        self.assess("out/session.h5", "--take", 0, out="first")
        none = ("--force-tolerance", 0, "--clearance-tolerance", 0)
        same = self.drive("compare_paths", "out", "again", *none)
        self.assertEqual(same.returncode, 0, same.stderr)
        self.assertIn("the same numbers in every row", same.stdout)
        other = self.drive("compare_paths", "out", "first", *none, "--summary", "out/compared.json")
        self.assertEqual(other.returncode, 1, other.stderr)
        self.assertGreater(json.loads((self.folder / "out/compared.json").read_text())["contact_force_difference"], 0)
        self.assertIn("ticks.csv", self.drive("compare_paths", "out", "nowhere").stderr)

    def test_maps_what_it_nears_and_sweeps(self):
        run = self.drive("assess_path", *PEG, "--map", "--swept", 24, "--every", 10, "--quiet", "-o", "out", "--summary", "out/summary.json")
        self.assertEqual(run.returncode, 0, run.stderr)
        summary = self.summary("out")
        self.assertGreater(summary["swept_volume"], 0)
        self.assertGreaterEqual(summary["map_least"], summary["clearance"] - 1e-9)  # its vertices are points of the mesh
        self.assertIn("quality", (self.folder / "out/clearance.ply").read_text()[:400])
        self.assertTrue((self.folder / "out/swept.obj").read_text().startswith("v "))

    def test_demonstration_goes_back_and_hits(self):
        run = self.station("--demo-script", "--no-browser")
        self.assertIn("take 0", run.stdout)
        self.assertIn("touch", run.stdout)
        self.assertIn("take 1", run.stdout)
        self.assess("out/session.h5", "--take", 0)

    def test_way_of_the_part_is_a_path_that_is_replayed(self):
        self.station("--script", PARTS / "peg_by_hand.json", "--no-browser", "--every", 20)
        out = self.drive("replay_assembly", *PEG[:4], "--path", "out/path.csv", "--scale", 1, "--mode", "kinematic", "-o", "kin")
        self.assertNotEqual(out.returncode, 2, out.stderr)

    def long_station(self):
        """A session that is under way, with ticks on the disk."""
        arguments = self.script([GRAB] + 50 * [{"kind": "move", "by": [0, 0, 1e-4], "time": 10}])
        process = subprocess.Popen([Path(os.environ["AUSSOIS_DRIVERS"], "assembly_station"), *map(str, PEG), *arguments, "--quiet"],
                                   cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.kill)
        growing = self.folder / "out/session.h5.tmp"
        begin, sizes = time.monotonic(), set()
        while len(sizes) < 4:
            self.assertLess(time.monotonic() - begin, 300)
            self.assertIsNone(process.poll())
            if growing.exists():
                sizes.add(growing.stat().st_mtime_ns)
            time.sleep(0.05)
        return process

    def test_keeps_a_session_that_is_interrupted(self):
        process = self.long_station()
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(60), 130)
        self.assess("out/session.h5")
        self.assertGreaterEqual(self.summary("again")["ticks"], 64)

    def test_keeps_a_session_that_is_killed(self):
        process = self.long_station()
        process.kill()
        process.wait()
        self.assess("out/session.h5.tmp")
        self.assertGreaterEqual(self.summary("again")["ticks"], 64)

    def test_names_a_part_that_has_changed(self):
        socket = self.folder / "socket.obj"
        socket.write_bytes((PARTS / "socket.obj").read_bytes())
        run = self.drive("assembly_station", "--fixed", "socket.obj", *PEG[2:], "--demo-script", "--no-browser", "--quiet")
        self.assertEqual(run.returncode, 0, run.stderr)
        socket.write_text(socket.read_text() + "# changed\n")
        self.assertIn("the parts have changed", self.assess("out/session.h5", code=3).stderr)

    def test_names_what_is_wrong_in_a_script(self):
        for commands, message in (
                ("[", "hand.json: "),
                ("{}", "must be a list of commands"),
                ([{"kind": "push"}], "command 1: kind = push"),
                ([GRAB, {"kind": "move", "by": [0, 0]}], "command 2.by must be three numbers"),
                ([{"kind": "wait", "time": -1}], "command 1.time = -1 must lie in [0, 10000]"),
                ([{"kind": "wait", "time": 1, "grip": 0}], "command 1.'grip' is unknown")):
            with self.subTest(message):
                self.assertIn(message, self.station(*self.script(commands), code=3).stderr)
        for commands, message in (
                ([{"kind": "move", "time": 1}], "command 1: move: the hand must hold the part"),
                ([{"kind": "seek", "back": 1}], "command 1: seek: back"),
                ([{"kind": "set", "name": "friction", "value": 1}], "parameter 'friction' must be one of: tick, mu"),
                ([{"kind": "set", "name": "mu", "value": -1}], "mu = -1")):
            with self.subTest(message):
                self.assertIn(message, self.station(*self.script(commands), code=2).stderr)

    def test_asks_for_a_script(self):
        self.assertIn("--no-browser", self.station("--no-browser", code=2).stderr)


class Way(DriverTest):
    def assess(self, *arguments, code=0):
        run = self.drive("assess_path", *PEG, *arguments, "--quiet", "-o", "out", "--summary", "out/summary.json")
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def test_arrives_and_says_what_it_took(self):
        self.assess("--misalignment", 1, "--gravity", "0,0,-9.81")
        summary = self.summary("out")
        self.assertEqual(summary["verdict"], "arrived")
        self.assertGreater(summary["clearance"], 0)
        self.assertGreater(summary["contact_force"], 0)

    def test_bounds_are_told(self):
        self.assertIn("come nearer than", self.assess("--clearance-min", 0.5, code=1).stderr)
        self.assertIn("a force exceeds", self.assess("--force-max", 1e-9, code=1).stderr)

    def test_is_blocked_by_a_wall(self):
        """A path that leads through the socket: the part stops at it and says so."""
        wall = self.folder / "through.csv"
        lines = [line for line in (PARTS / "peg_out.csv").read_text().splitlines() if not line.startswith("#")]
        first = dict(zip(lines[0].split(","), lines[1].split(",")))
        rows = [lines[0]]
        for k in range(11):
            row = dict(first, x=str(float(first["x"]) + 1.0 * k))
            if "t" in row:
                row["t"] = str(0.1 * k)
            if "index" in row:
                row["index"] = str(k)
            rows.append(",".join(row[name] for name in lines[0].split(",")))
        wall.write_text("\n".join(rows) + "\n")
        run = self.drive("assess_path", *PEG[:4], "--path", wall, "--force-limit", 2, "--hold", 0.5, "-o", "out", "--summary", "out/summary.json")
        self.assertEqual(run.returncode, 1, run.stderr)
        self.assertIn("are in contact", run.stderr)
        summary = self.summary("out")
        self.assertEqual(summary["verdict"], "blocked")
        self.assertGreater(summary["clearance"], 0)  # never through it
        self.assertGreater(summary["lag"], 5e-3)


class Many(DriverTest):
    """Sweeps and folders of paths."""

    def sweep(self, *arguments, out="out", code=0):
        run = self.drive("assess_path", *PEG[:4], *arguments, "--quiet", "-o", out)
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def rows(self, out="out"):
        lines = (self.folder / out / "assessments.csv").read_text().splitlines()
        return [dict(zip(lines[0].split(","), line.split(","))) for line in lines[1:]]

    def test_sweep_has_all_combinations_and_is_done_once(self):
        arguments = (*PEG[4:], "--sweep", "mu=0,0.3", "--sweep", "misalignment=0,1", "--gravity", "0,0,-9.81")
        self.sweep(*arguments)
        rows = self.rows()
        self.assertEqual([(row["mu"], row["misalignment"]) for row in rows], [("0", "0"), ("0", "1"), ("0.3", "0"), ("0.3", "1")])
        self.assertEqual({row["verdict"] for row in rows}, {"arrived"})
        self.assertGreater(float(rows[3]["contact_losses"]), float(rows[1]["contact_losses"]))  # friction costs
        table = (self.folder / "out/assessments.csv").read_bytes()
        again = self.sweep(*arguments)
        self.assertIn("4 of 4 assessments were already", again.stdout)
        self.assertEqual((self.folder / "out/assessments.csv").read_bytes(), table)
        for shard in ("1/2", "2/2"):
            self.sweep(*arguments, "--shard", shard, out="shards")
        self.sweep(*arguments, out="shards")
        self.assertEqual((self.folder / "shards/assessments.csv").read_bytes(), table)
        self.sweep(*arguments, "--threads", 1, out="alone")
        self.assertEqual((self.folder / "alone/assessments.csv").read_bytes(), table)

    def test_says_the_same_however_many_rows_it_records(self):
        """And as a row of a sweep, which records none."""
        arguments = (*PEG[4:], "--gravity", "0,0,-9.81", "--misalignment", 1)
        numbers = []
        for every in (1, 20):
            self.sweep(*arguments, "--every", every, "--summary", "out/summary.json")
            numbers.append(self.summary("out"))
        self.sweep(*arguments, "--sweep", "mu=0.2", out="many")
        (row,) = self.rows("many")
        self.assertGreater(numbers[0]["contact_losses"], 0)
        for name in ("clearance", "hand_force", "contact_force", "hand_work", "contact_losses", "length"):
            self.assertEqual(numbers[0][name], numbers[1][name], name)
            self.assertEqual(numbers[0][name], float(row[name]), name)

    def test_takes_the_paths_of_planners(self):
        folder = self.folder / "planned"
        folder.mkdir()
        lines = [line for line in PEG[5].read_text().splitlines() if not line.startswith("#")]
        names = lines[0].split(",")
        poses = [[float(dict(zip(names, line.split(",")))[n]) for n in ("x", "y", "z", "qw", "qx", "qy", "qz")] for line in lines[1:]]
        (folder / "a.csv").write_text("\n".join(lines) + "\n")
        (folder / "b.path").write_text("".join(" ".join(map(repr, p[:3] + p[4:] + p[3:4])) + "\n" for p in poses) + "\n")
        header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({len(poses)}, 7), }}".ljust(117) + "\n"
        (folder / "c.npy").write_bytes(b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header.encode() +
                                       struct.pack(f"<{7 * len(poses)}d", *(x for p in poses for x in p)))
        (folder / "d.csv").write_text(lines[0] + "\n" + "".join(f"{k},{k},0,0.5,1,0,0,0\n" for k in range(12)))  # through the wall
        (folder / "e.csv").write_text("nothing\n")
        self.sweep(*PEG[4:], "--paths", folder, "--force-limit", 2, code=1)
        rows = {row["path"]: row for row in self.rows()}
        self.assertEqual([rows[name]["verdict"] for name in ("a.csv", "b.path", "c.npy")], 3 * ["arrived"])
        for name in ("b.path", "c.npy"):  # the same poses
            self.assertEqual(rows[name]["length"], rows["a.csv"]["length"])
        self.assertEqual(rows["d.csv"]["verdict"], "blocked")
        self.assertGreater(float(rows["d.csv"]["clearance"]), 0)
        self.assertIn("e.csv:1", rows["e.csv"]["problem"])

    def test_names_what_is_wrong(self):
        for arguments, message in ((("--sweep", "mu"), "must begin with NAME="), (("--sweep", "mu=a"), "must be NAME=VALUE"),
                                   (("--sweep", "friction=1"), "'friction' must be one of"), (("--sweep", "mu=-1"), "mu = -1"),
                                   (("--sweep", "mu=0", "--shard", "3/2"), "--shard 3/2"), (("--shard", "1/2"), "--shard needs --sweep")):
            with self.subTest(message):
                self.assertIn(message, self.sweep(*PEG[4:], *arguments, code=2).stderr)

    def test_report_says_what_was_asked(self):
        self.sweep(*PEG[4:], "--misalignment", 1, "--gravity", "0,0,-9.81", "--clearance-min", 2e-5, "--force-max", 50, code=1)
        page = (self.folder / "out/report.html").read_text()
        for text in ("arrived", "clearance below 20 um", "a force above 50 N", "largest force of the hand", "replay.html"):
            self.assertIn(text, page)


if __name__ == "__main__":
    unittest.main()
