# SPDX-License-Identifier: Apache-2.0
"""run.h5 of a real run tells, to a reader that knows only doc/run_file.md and h5py, what steps.csv tells."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PEG, DriverTest


class RunFile(DriverTest):
    def test_is_read_with_h5py(self):
        h5py = self.hdf5()
        import numpy as np
        self.replay("out", *PEG, "--theta", 1)  # so that the pull of a step is that at its end
        csv = {name: np.array(values, float) for name, values in self.columns("out").items()}
        with h5py.File(self.folder / "out/run.h5") as run:
            self.assertEqual(run.attrs["format"], b"aussois-run")
            self.assertEqual([name.decode() for name in run["body/name"]], ["socket", "peg"])
            self.assertEqual(run["mesh/peg/faces"].shape, (20, 3))
            self.assertEqual(list(run["body/fixed"]), [1, 0])

            # a row for the start, and one for each step
            t, h = run["state/time"][:], run["step/h"][:]
            self.assertEqual(list(run["state/step"]), list(range(len(csv["step"]) + 1)))
            self.assertTrue(np.array_equal(t[1:], csv["t"]))
            self.assertTrue(np.array_equal(run["step/min_gap"][1:], csv["min_gap"]))
            self.assertTrue(np.array_equal(run["step/contacts_found"][1:], csv["contacts_found"]))
            pull = run["coupling/force"][1:]
            self.assertTrue(np.allclose(np.linalg.norm(pull, axis=1), csv["force"], rtol=1e-14, atol=0))
            self.assertTrue(np.allclose(np.linalg.norm(run["state/pose"][:, :, 3:], axis=2), 1, rtol=0, atol=1e-12))

            # contacts: unit normals between the points of both surfaces; they push, and stay in the friction cone
            offset = run["contact/offset"][:]
            self.assertEqual((offset[0], len(offset)), (0, len(t) + 1))
            self.assertTrue((np.diff(offset.astype(np.int64)) == np.r_[0, csv["contacts"]]).all())
            gap, normal, impulse = run["contact/gap"][:], run["contact/normal"][:], run["contact/impulse"][:]
            self.assertEqual(len(gap), offset[-1])
            self.assertGreater(len(gap), 1000)
            self.assertTrue(np.allclose(np.linalg.norm(normal, axis=1), 1, rtol=0, atol=1e-12))
            between = run["contact/point"][:] - run["contact/point_b"][:]
            self.assertTrue(np.allclose(np.einsum("ij,ij->i", between, normal), gap, rtol=0, atol=1e-9))
            push = np.einsum("ij,ij->i", impulse, normal)
            slide = np.linalg.norm(impulse - push[:, None] * normal, axis=1)
            mu, scale = 0.2, push.max()
            self.assertGreater(scale, 0)
            self.assertGreaterEqual(push.min(), -1e-9 * scale)
            self.assertLessEqual((slide - mu * push).max(), 1e-6 * scale)

            # momentum of the peg, which is body 1: its change is the impulse of weight, pull and contacts, step by step
            on_peg = np.where(run["contact/pair"][:, :1] == 1, 1.0, -1.0) * impulse
            sums = np.r_[np.zeros((1, 3)), np.cumsum(on_peg, axis=0)]
            contacts = np.diff(sums[offset.astype(np.int64)], axis=0)[1:]
            mass, gravity = run["body/mass"][1], np.array([-5.66, -5.66, -5.66])
            change = mass * np.diff(run["state/velocity"][:, 1, :3], axis=0)
            applied = h[1:, None] * (mass * gravity + pull) + contacts
            self.assertLess(np.abs(change - applied).max(), 1e-10 * np.abs(h[1:, None] * pull).max())  # rounding


if __name__ == "__main__":
    unittest.main()
