# SPDX-License-Identifier: Apache-2.0
"""Problems in files: solved, judged here once more by a residual of our own, profiled, and dumped by the drivers that step."""

import json
import math
import os
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PEG, DriverTest

NOT_ACCEPTED, USAGE, FILES, INTERRUPTED = 1, 2, 3, 130
FIELDS = {"problem", "contacts", "solver", "status", "iterations", "natural_map_residual", "scaled_residual",
          "worst_normal_velocity", "worst_cone_violation", "cpu_s"}


def projected(r, mu):
    """The nearest point of the cone |r_T| <= mu r_N."""
    normal, tangent = r[0], math.hypot(*r[1:])
    if tangent <= mu * normal:
        return r
    if mu * tangent <= -normal:
        return [0.0] * len(r)
    n = (normal + mu * tangent) / (1 + mu * mu)
    return [n, *(mu * n * x / tangent for x in r[1:])]


def scaled_residual(W, q, r, mu, d):
    """(NSGS-9) from the data and r alone, in the plainest form; W: its entries (row, column, value)."""
    u, diagonal = list(q), [0.0] * len(q)
    for i, j, x in W:
        u[i] += x * r[j]
        diagonal[i] += x * (i == j)
    wrong = reference = 0.0
    for c in range(len(q) // d):
        rows = range(c * d, c * d + d)
        s = math.sqrt(sum(diagonal[i] for i in rows) / d)
        r_c, u_c = [r[i] * s for i in rows], [u[i] / s for i in rows]
        u_c[0] += mu[c] * math.hypot(*u_c[1:])
        wrong += sum((a - b) ** 2 for a, b in zip(r_c, projected([a - b for a, b in zip(r_c, u_c)], mu[c])))
        reference += sum((q[i] / s) ** 2 for i in rows)
    return math.sqrt(wrong / reference)


class Problems(DriverTest):
    def write_local(self, name, W, q, mu, d=3):
        """A local problem in FCLIB's layout, as another program would write it: triplets."""
        h5py = self.hdf5()
        entries = [(i, j, x) for i, row in enumerate(W) for j, x in enumerate(row) if x]
        with h5py.File(self.folder / name, "w") as file:
            group = file.create_group("fclib_local")
            group.create_dataset("spacedim", data=[d], dtype="i4")
            for key, value in (("m", len(q)), ("n", len(q)), ("nz", len(entries)), ("nzmax", len(entries))):
                group.create_dataset("W/" + key, data=[value], dtype="i4")
            for key, column, kind in (("i", 0, "i4"), ("p", 1, "i4"), ("x", 2, "f8")):
                group.create_dataset("W/" + key, data=[e[column] for e in entries], dtype=kind)
            group.create_dataset("vectors/q", data=q, dtype="f8")
            group.create_dataset("vectors/mu", data=mu, dtype="f8")

    def write_samples(self):
        """Two coupled contacts that stick or slide, the same in the plane, and one that opens."""
        W = [[2 if i == j else 0.5 / (1 + abs(i - j)) for j in range(6)] for i in range(6)]
        self.write_local("space.hdf5", W, [-1, 0.5, 2, -2, 0.1, 0], [0.3, 0.8])
        self.write_local("plane.hdf5", [row[:4] for row in W[:4]], [-1, 3, -0.5, 0.1], [0.3, 0.8], d=2)
        self.write_local("open.hdf5", [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [1, 1, 0], [0.5])

    def solve(self, *arguments, code=0):
        """stdout, and {problem: object} of the JSON."""
        run = self.drive("solve_friction_problem", *arguments, "--json", "result.json")
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        result = json.loads((self.folder / "result.json").read_text())
        self.assertEqual(len({one["problem"] for one in result}), len(result))
        return run.stdout, {one["problem"]: one for one in result}

    def judge(self, path):
        """The scaled residual of the solution in a file with a local problem, computed here."""
        with self.hdf5().File(path) as file:
            group, d = file["fclib_local"], int(file["fclib_local/spacedim"][0])
            q, mu, r = (x[:].tolist() for x in (group["vectors/q"], group["vectors/mu"], file["solution/r"]))
            starts, rows, values = (group["W/" + key][:].tolist() for key in "pix")
            self.assertEqual(group["W/nz"][0], -1)
        W = [(rows[k], j, values[k]) for j in range(len(q)) for k in range(starts[j], starts[j + 1])]
        return scaled_residual(W, q, r, mu, d)


class SolveFrictionProblem(Problems):
    def test_tells_of_each_problem_and_is_right_about_it(self):
        self.write_samples()
        text, result = self.solve("space.hdf5", "plane.hdf5", "open.hdf5", "--tolerance", 1e-10, "--save", "answers")
        self.assertEqual(list(result), ["space", "plane", "open"])
        for name, one in result.items():
            self.assertLessEqual(FIELDS, set(one))
            self.assertEqual((one["status"], one["solved"], one["form"], one["solver"]), ("converged", True, "local", "auto"))
            self.assertLessEqual(one["scaled_residual"], 1e-10)
            own = self.judge(self.folder / "answers" / f"{name}.hdf5")
            self.assertLessEqual(own, 1e-10)
            self.assertAlmostEqual(own, one["scaled_residual"], delta=1e-14)
            self.assertGreaterEqual(one["cpu_s"], 0)
            self.assertIn(name, text)
        self.assertEqual(result["open"]["worst_cone_violation"], 0)
        self.assertEqual([result[name]["contacts"] for name in result], [2, 2, 1])
        self.assertIn("auto: 3 of 3 problems solved to 1e-10", text)

    def test_closed_form_of_decoupled_contacts(self):
        """W = I: q = (-1, 2, 0) with mu = 0.5 slides, q = (-1, 0.1, 0) sticks, q = (1, ...) opens."""
        unit = [[float(i == j) for j in range(9)] for i in range(9)]
        self.write_local("three.hdf5", unit, [-1, 2, 0, -1, 0.1, 0, 1, 3, 0], [0.5] * 3)
        self.solve("three.hdf5", "--tolerance", 1e-12, "--save", "answers")
        with self.hdf5().File(self.folder / "answers" / "three.hdf5") as file:
            r = list(file["solution/r"])
        for is_, should in zip(r, [1, -0.5, 0, 1, -0.1, 0, 0, 0, 0]):
            self.assertAlmostEqual(is_, should, delta=1e-11)

    def test_a_bad_file_does_not_stop_the_others(self):
        self.write_samples()
        (self.folder / "text.hdf5").write_text("no HDF5")
        text, result = self.solve("space.hdf5", "text.hdf5", "missing.hdf5", "open.hdf5", code=FILES)
        self.assertEqual([one["status"] for one in result.values()], ["converged", "unreadable", "unreadable", "converged"])
        self.assertIn("text.hdf5: not an HDF5 file", result["text"]["reason"])
        self.assertEqual(result["missing"]["reason"], "missing.hdf5: no such file")
        self.assertIn("2 of 4 problems solved", text)

    def test_what_does_not_converge_is_told(self):
        self.write_samples()
        _, result = self.solve("space.hdf5", "--solver", "nsgs", "--max-iterations", 1, "--tolerance", 1e-14,
                               code=NOT_ACCEPTED)
        self.assertEqual((result["space"]["status"], result["space"]["solved"]), ("max_iterations", False))
        self.assertGreater(result["space"]["scaled_residual"], 1e-14)

    def test_numbers_that_are_none_are_a_status(self):
        self.write_local("nan.hdf5", [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [-1, math.nan, 0], [0.5])
        _, result = self.solve("nan.hdf5", code=NOT_ACCEPTED)
        self.assertEqual((result["nan"]["status"], result["nan"]["scaled_residual"]), ("not_finite", None))

    def test_a_solution_needs_no_iteration(self):
        self.write_samples()
        self.solve(".", "--tolerance", 1e-11, "--save", "answers")
        _, result = self.solve("answers", "--tolerance", 1e-10, "--start", "solution")
        self.assertEqual({(one["start"], one["iterations"]) for one in result.values()}, {("solution", 0)})
        _, result = self.solve("answers", "--start", "guess")
        self.assertEqual({one["start"] for one in result.values()}, {"zero"})  # there is none

    def test_usage(self):
        for words, arguments in ((["FILE"], ()), (["--tolerance", "in (0, 1)"], ("x.hdf5", "--tolerance", 2)),
                                 (["nsgs", "newtonian"], ("x.hdf5", "--solver", "newtonian")),
                                 (["--start", "warm"], ("x.hdf5", "--start", "warm"))):
            run = self.drive("solve_friction_problem", *arguments)
            self.assertEqual(run.returncode, USAGE, run.stderr)
            for word in words:
                self.assertIn(word, run.stderr)
        (self.folder / "empty").mkdir()
        self.assertEqual(self.drive("solve_friction_problem", "empty").returncode, FILES)
        self.assertIn("FILE...", self.drive("solve_friction_problem", "--help").stdout)

    def test_an_interruption_keeps_what_is_done(self):
        self.write_samples()
        command = [Path(os.environ["AUSSOIS_DRIVERS"], "solve_friction_problem"), *["space.hdf5"] * 200,
                   "--repeat", "20000", "--tolerance", "1e-12", "--json", "result.json"]
        run = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(1)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, INTERRUPTED, out + err)
        result = json.loads((self.folder / "result.json").read_text())
        self.assertTrue(0 < len(result) < 200, len(result))
        self.assertIn("interrupted", out)

    def test_the_library_is_solved(self):
        """Every problem of the shared library, to 1e-8; those in local form judged here once more from r alone."""
        folder = self.data() / "fclib"
        _, result = self.solve(folder, "--save", "answers")
        self.assertEqual(len(result), 43)
        self.assertEqual([name for name, one in result.items() if not one["solved"]], [])
        judged = 0
        for name, one in result.items():
            if one["form"] == "local" and one["rows"] < 5 * one["contacts"]:  # without rolling
                self.assertLessEqual(self.judge(self.folder / "answers" / f"{name}.hdf5"), 1e-8, name)
                judged += 1
        self.assertEqual(judged, 30)


class SolverProfile(Problems):
    def profile(self, *arguments, code=0):
        run = self.drive("solver_profile", *arguments, "--solvers", "auto,nsgs", "--tolerances", "1e-4,1e-9")
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def results(self):
        """{name: its JSON} of all results."""
        return {path.name: json.loads(path.read_text()) for path in (self.folder / "out" / "results").iterdir()}

    def test_draws_a_profile_per_tolerance_and_solves_nothing_twice(self):
        self.write_samples()
        self.profile(".")
        self.assertEqual(len(self.results()), 3 * 2 * 2)
        self.assertEqual({(one["status"], one["solved"]) for one in self.results().values()}, {("converged", True)})
        self.assertEqual({(one["problem"], one["options"]["solver.method"], one["options"]["solver.tolerance"]) for one in self.results().values()},
                         {(problem, solver, tolerance) for problem in ("plane", "open", "space")
                          for solver in ("auto", "nsgs") for tolerance in (1e-4, 1e-9)})
        for tolerance in ("1e-04", "1e-09"):
            head, *rows = [line.split(",") for line in
                           (self.folder / "out" / f"profile_{tolerance}.csv").read_text().splitlines()]
            self.assertEqual(head, ["tau", "auto", "nsgs"])
            tau, auto, nsgs = ([float(row[i]) for row in rows] for i in range(3))
            self.assertEqual((tau[0], tau), (1, sorted(tau)))
            self.assertGreaterEqual(auto[0] + nsgs[0], 1 - 1e-12)  # each problem has a fastest
            self.assertEqual((auto[-1], nsgs[-1]), (1, 1))
            self.assertTrue((self.folder / "out" / f"profile_{tolerance}.gp").exists())
        before = self.results()
        self.assertIn("12 of 12 results were already in out/results", self.profile(".").stdout)
        self.assertEqual(self.results(), before)
        self.assertNotIn("already in", self.profile(".", "--max-iterations", 9999).stdout)  # other results
        self.assertEqual(len(self.results()), 24)

    def test_a_damaged_result_is_done_again(self):
        self.write_samples()
        self.profile(".")
        half, strange, gone, *_ = sorted((self.folder / "out" / "results").iterdir())
        half.write_bytes(half.read_bytes()[:100])
        strange.write_bytes(strange.read_bytes().replace(b'"solved": true', b'"solved": "so"'))
        gone.unlink()
        self.assertIn("9 of 12 results were already in out/results", self.profile(".").stdout)
        self.assertEqual([one["status"] for one in self.results().values()], ["converged"] * 12)

    def test_continues_after_an_interruption(self):
        self.write_samples()
        command = [Path(os.environ["AUSSOIS_DRIVERS"], "solver_profile"), ".", "--solvers", "auto,nsgs",
                   "--tolerances", "1e-4,1e-9", "--repeat", "100000000"]
        run = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(0.5)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=20)  # it does not wait for the solver
        self.assertEqual(run.returncode, INTERRUPTED, out + err)
        self.profile(".")
        self.assertEqual(len(self.results()), 12)

    @unittest.skipUnless(sys.platform == "linux", "a child ends with its parent on Linux")
    def test_a_kill_ends_the_solver_too(self):
        self.write_samples()
        command = [Path(os.environ["AUSSOIS_DRIVERS"], "solver_profile"), "space.hdf5", "--repeat", "100000000",
                   "--time-limit", "1e6", "--quiet"]
        run = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        children = Path(f"/proc/{run.pid}/task/{run.pid}/children")
        end = time.monotonic() + 60
        while not (solvers := children.read_text().split()) and time.monotonic() < end:
            time.sleep(0.005)
        time.sleep(0.2)  # it is at work
        run.kill()
        run.wait()
        self.assertEqual(len(solvers), 1)
        alive = lambda: Path(f"/proc/{solvers[0]}/stat").exists() and ") Z " not in Path(f"/proc/{solvers[0]}/stat").read_text()
        end = time.monotonic() + 20
        while alive() and time.monotonic() < end:
            time.sleep(0.01)
        self.assertFalse(alive())

    def test_a_kill_loses_nothing_that_was_done(self):
        self.write_samples()
        command = [Path(os.environ["AUSSOIS_DRIVERS"], "solver_profile"), ".", "--solvers", "auto,nsgs",
                   "--tolerances", "1e-4,1e-9", "--repeat", "20000", "--quiet"]
        run = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 60
        while not list(self.folder.glob("out/results/*.json")) and time.monotonic() < end:
            time.sleep(0.005)
        run.kill()
        run.wait()
        done = {path: path.read_bytes() for path in self.folder.glob("out/results/*.json")}
        self.assertTrue(done)
        self.assertIn(f"{len(done)} of 12 results were already in out/results", self.profile(".").stdout)
        self.assertEqual({path: path.read_bytes() for path in done}, done)

    def test_time_is_limited_and_a_failure_is_never_within_a_factor(self):
        self.write_samples()
        self.profile("space.hdf5", "--repeat", 100000000, "--time-limit", 0.05, code=NOT_ACCEPTED)
        self.assertEqual({(one["status"], one["scaled_residual"], one["contacts"]) for one in self.results().values()},
                         {("time_limit", "nan", 2)})
        table = (self.folder / "out" / "profile_1e-09.csv").read_text().splitlines()
        self.assertEqual(table[1], "1,0,0")
        self.profile("space.hdf5", "--time-limit", 10)  # more patience: solved again
        self.assertEqual([one["status"] for one in self.results().values()], ["converged"] * 4)

    def test_bad_files_are_left_out_and_told(self):
        self.write_samples()
        (self.folder / "text.hdf5").write_text("no HDF5")
        run = self.profile("text.hdf5", "open.hdf5", code=FILES)
        self.assertIn("left out: text.hdf5: not an HDF5 file", run.stderr)
        self.assertEqual(len(self.results()), 4)


class DumpProblem(Problems):
    def replayed(self, folder, tolerance):
        """Each dumped problem solved from its guess: r has the same bits; v, which the step knows by its own way, to rounding."""
        _, result = self.solve(folder, "--start", "guess", "--tolerance", tolerance, "--save", "again")
        h5py = self.hdf5()
        for name, one in result.items():
            self.assertEqual((one["start"], one["form"]), ("guess", "global"))
            with h5py.File(self.folder / folder / f"{name}.hdf5") as was, \
                    h5py.File(self.folder / "again" / f"{name}.hdf5") as is_:
                self.assertEqual(was["solution/r"][:].tobytes(), is_["solution/r"][:].tobytes(), name)
                v = was["solution/v"][:]
                self.assertLess(abs(v - is_["solution/v"][:]).max(), 1e-14 * (1 + abs(v).max()), name)
        return result

    def test_a_fall_replays_with_the_same_bits(self):
        for out in ("a", "b"):
            run = self.drive("drop_part", "--time", 0.25, "--quiet", "-o", out, "--dump-problem", f"{out}/steps",
                             "--dump-steps", "110-200")
            self.assertIn(run.returncode, (0, NOT_ACCEPTED), run.stderr)  # it does not rest yet
        files = self.files()
        names = [name for name in files if name.startswith("a/steps/")]
        self.assertGreater(len(names), 10)
        for name in names:
            self.assertEqual(files[name], files["b" + name[1:]], name)
        result = self.replayed("a/steps", 1e-8)
        self.assertTrue(all(one["solved"] for one in result.values()))
        _, judged = self.solve("a/steps", "--start", "solution")
        self.assertEqual({one["iterations"] for one in judged.values()}, {0})

    def test_an_assembly_replays_with_the_same_bits(self):
        self.replay("out", *PEG, "--dump-problem", "steps", "--dump-steps", "every 40", "--tolerance", 1e-9)
        self.assertGreater(len(list((self.folder / "steps").iterdir())), 3)
        self.replayed("steps", 1e-9)

    def test_sliding_dumps_each_level(self):
        run = self.drive("sliding_block", "--levels", 3, "--quiet", "--dump-problem", "steps", "--dump-steps", "5")
        self.assertIn(run.returncode, (0, NOT_ACCEPTED), run.stderr)
        self.assertEqual(sorted(path.name for path in (self.folder / "steps").iterdir()),
                         [f"sliding_block_level_{level}_000005.hdf5" for level in (1, 2, 3)])
        self.replayed("steps", 1e-12)

    def test_bad_choices_are_refused_before_anything_runs(self):
        for driver in (["drop_part"], ["sliding_block"], ["replay_assembly", *PEG]):
            run = self.drive(*driver, "--dump-problem", "steps", "--dump-steps", "some")
            self.assertEqual(run.returncode, USAGE)
            self.assertIn("--dump-steps 'some' must be all, unsolved", run.stderr)
        run = self.drive("replay_assembly", *PEG, "--mode", "kinematic", "--dump-problem", "steps")
        self.assertEqual(run.returncode, USAGE)
        self.assertIn("--dump-problem needs --mode dynamic", run.stderr)
        self.assertEqual(self.files(), {})


if __name__ == "__main__":
    unittest.main()
