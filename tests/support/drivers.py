# SPDX-License-Identifier: Apache-2.0
"""What the tests of the drivers share: run one as a user does, in a folder of its own, and look at what it leaves.

Environment: AUSSOIS_DRIVERS, the folder of the programs; AUSSOIS_DATA_DIR, shared meshes and paths, or empty.
"""

import csv
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PARTS = SOURCE / "examples" / "data"
PEG = ("--fixed", PARTS / "socket.obj", "--moving", PARTS / "peg.obj", "--path", PARTS / "peg_out.csv")


def box_obj(side):
    """A cube around the origin as the text of an OBJ file."""
    corners = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    faces = ((1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6))
    return "".join(f"v {side * x / 2} {side * y / 2} {side * z / 2}\n" for x, y, z in corners) + "".join(
        f"f {a} {b} {c}\nf {a} {c} {d}\n" for a, b, c, d in faces)


def slit_obj():
    """A cube of side one as the text of an OBJ file; a vertex of its border lies 0.8e-6 inside of its edge."""
    corners = [(x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]
    faces = "134 142 126 165 378 384 157 173 759 569 987 249 489 629".split()
    return "".join("v %.9g %.9g %.9g\n" % v for v in corners + [(0.4999992, 0, 0.5)]) + "".join(
        "f " + " ".join(f) + "\n" for f in faces)


class DriverTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="aussois-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def drive(self, driver, *arguments, timeout=None):
        """The finished process of `driver`, run in the folder of the test. Sanitizers have nothing to say."""
        run = subprocess.run([Path(os.environ["AUSSOIS_DRIVERS"], driver), *map(str, arguments)], cwd=self.folder,
                             stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=timeout)
        self.assertNotRegex(run.stderr, "Sanitizer|runtime error:")
        return run

    def replay(self, out, *arguments, code=0):
        """Runs replay_assembly into the folder `out` with its summary."""
        run = self.drive("replay_assembly", *arguments, "--quiet", "-o", out, "--summary", f"{out}/summary.json")
        self.assertEqual(run.returncode, code, run.stderr + run.stdout)
        return run

    def files(self):
        """{name: content} of all files in the folder of the test."""
        return {str(path.relative_to(self.folder)): path.read_bytes()
                for path in sorted(self.folder.rglob("*")) if path.is_file()}

    def summary(self, out):
        return json.loads((self.folder / out / "summary.json").read_text())

    def columns(self, out, table="steps.csv"):
        """{column: its numbers as text}; the text tells doubles apart to the last bit."""
        rows = [line.split(",") for line in (self.folder / out / table).read_text().splitlines()]
        return {name: list(values) for name, *values in zip(*rows)}

    def data(self):
        """The folder of shared data; without it the test is skipped."""
        if not os.environ.get("AUSSOIS_DATA_DIR"):
            self.skipTest("AUSSOIS_DATA_DIR names no folder of shared data")
        return Path(os.environ["AUSSOIS_DATA_DIR"])

    def beginning(self, pair, poses):
        """The arguments of a replay of the first `poses` poses of a pair of the shared data."""
        data = self.data()
        with open(data / "assembly/pairs.csv", newline="") as pairs:
            row = next(row for row in csv.DictReader(pairs) if row["name"] == pair)
        path = self.folder / f"{pair}_{poses}.csv"
        path.write_text("".join((data / "assembly" / row["trajectory"]).read_text().splitlines(True)[:1 + poses]))
        return ("--fixed", data / f"meshes/{row['fixed']}.obj", "--moving", data / f"meshes/{row['moving']}.obj", "--path", path)

    def hdf5(self):
        """The module h5py; without it the test is skipped."""
        try:
            import h5py
        except ImportError:
            self.skipTest("no h5py")
        return h5py
