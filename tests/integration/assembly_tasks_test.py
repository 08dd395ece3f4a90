# SPDX-License-Identifier: Apache-2.0
"""Assemblies whose outcome is known, each at three speeds: the verdict does not depend on how fast the hand moves."""

import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PEG, DriverTest

SIZE, PLAY, DEEP = 10.0, 0.1, 12.0  # of pegs across, of a peg in its hole on each side, of a hole [mm]


def polygon(n, radius, turn=0.0):
    return [(radius * math.cos(2 * math.pi * k / n + turn), radius * math.sin(2 * math.pi * k / n + turn)) for k in range(n)]


def prism(section, low, high, first=1):
    """A prism as OBJ; its first vertex has the number `first`."""
    n = len(section)
    lines = [f"v {x:.17g} {y:.17g} {z:.17g}" for z in (low, high) for x, y in section]
    at = lambda k, top: first + k % n + n * top
    for k in range(1, n - 1):
        lines += [f"f {at(0, 0)} {at(k + 1, 0)} {at(k, 0)}", f"f {at(0, 1)} {at(k, 1)} {at(k + 1, 1)}"]
    for k in range(n):
        lines += [f"f {at(k, 0)} {at(k + 1, 0)} {at(k + 1, 1)}", f"f {at(k, 0)} {at(k + 1, 1)} {at(k, 1)}"]
    return "\n".join(lines) + "\n"


def socket(section, low, high):
    """What surrounds a hole from z = low to high: a ring around the section; below it a plate."""
    n, outer = len(section), [(2.5 * x, 2.5 * y) for x, y in section]
    lines = [f"v {x:.17g} {y:.17g} {z:.17g}" for loop in (section, outer) for z in (low, high) for x, y in loop]
    at = lambda k, out, top: 1 + k % n + n * top + 2 * n * out
    quad = lambda a, b, c, d: [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    for k in range(n):
        lines += quad(at(k, 0, 0), at(k, 0, 1), at(k + 1, 0, 1), at(k + 1, 0, 0))  # the hole
        lines += quad(at(k, 1, 0), at(k + 1, 1, 0), at(k + 1, 1, 1), at(k, 1, 1))
        lines += quad(at(k, 0, 1), at(k, 1, 1), at(k + 1, 1, 1), at(k + 1, 0, 1))  # the mouth
        lines += quad(at(k, 0, 0), at(k + 1, 0, 0), at(k + 1, 1, 0), at(k, 1, 0))
    return "\n".join(lines) + "\n" + prism(outer, low - 5, low - 1, first=4 * n + 1)


def ways(*heights, turn=0.0, aside=0.0):
    """A path along z at these heights of the peg's middle, turned about z."""
    w, z = math.cos(turn / 2), math.sin(turn / 2)
    return "x,y,z,qw,qx,qy,qz\n" + "".join(f"{aside},0,{h:.17g},{w:.17g},0,0,{z:.17g}\n" for h in heights)


HALF = DEEP / 2
IN = [DEEP + HALF + 1 - 0.5 * k for k in range(int(2 * DEEP) + 1)]  # from above the mouth to a millimetre above the bottom
SQUARE, ROUND, HEX = (4, math.pi / 4), (24, 0.0), (6, 0.0)


class Tasks(DriverTest):
    def task(self, shape, path, fits=True, **bounds):
        (n, turn), grown = shape, PLAY if fits else -PLAY
        (self.folder / "peg.obj").write_text(prism(polygon(n, SIZE / 2, turn), -HALF, HALF))
        (self.folder / "socket.obj").write_text(socket(polygon(n, SIZE / 2 + grown, turn), 0, DEEP))
        (self.folder / "path.csv").write_text(path)
        return self.assess("--fixed", "socket.obj", "--moving", "peg.obj", "--path", "path.csv", **bounds)

    def assess(self, *parts, verdict):
        """The summaries at three speeds."""
        out = []
        for speed in (0.01, 0.02, 0.04):
            run = self.drive("assess_path", *parts, "--speed", speed, "--force-limit", 0.5, "--torque-limit", 1e-3, "--hold", 0.4, "--quiet", "-o", "out",
                             "--summary", "out/summary.json")
            self.assertIn(run.returncode, (0, 1), run.stderr)
            summary = self.summary("out")
            self.assertEqual(summary["verdict"], verdict, f"{speed}: {run.stdout}")
            self.assertGreater(summary["clearance"], 0)
            out.append(summary)
        if verdict == "blocked":
            for summary in out:  # the hand presses with all it has
                self.assertAlmostEqual(max(summary["hand_force"] / 0.5, summary["hand_torque"] / 1e-3), 1, delta=0.05)
        return out

    def test_a_square_peg_goes_into_its_hole(self):
        self.task(SQUARE, ways(*IN), verdict="arrived")

    def test_a_round_peg_goes_into_its_hole(self):
        self.task(ROUND, ways(*IN), verdict="arrived")

    def test_a_hexagonal_peg_goes_into_its_hole_off_its_axis(self):
        self.task(HEX, ways(*IN, aside=0.05), verdict="arrived")

    def test_a_peg_is_drawn_out(self):
        self.assess(*PEG, verdict="arrived")

    def test_a_round_peg_turns_in_its_hole(self):
        poses = "x,y,z,qw,qx,qy,qz\n" + "".join(
            f"0,0,{HALF + 1 + 0.05 * k},{math.cos(k / 60)},0,0,{math.sin(k / 60)}\n" for k in range(40))
        self.task((96, 0.0), poses, verdict="arrived")

    def test_a_square_peg_turned_by_half_a_right_angle_is_blocked(self):
        self.task(SQUARE, ways(*IN, turn=math.pi / 4), verdict="blocked")

    def test_a_peg_that_is_too_thick_is_blocked(self):
        self.task(ROUND, ways(*IN), fits=False, verdict="blocked")

    def test_a_peg_stops_at_the_bottom(self):
        self.task(SQUARE, ways(*IN, *[IN[-1] - 0.5 * k for k in range(1, 20)]), verdict="blocked")

    def test_a_hexagonal_peg_turned_in_its_hole_is_blocked(self):
        poses = "x,y,z,qw,qx,qy,qz\n" + "".join(
            f"0,0,{HALF + 1},{math.cos(k / 80)},0,0,{math.sin(k / 80)}\n" for k in range(60))
        self.task(HEX, poses, verdict="blocked")


if __name__ == "__main__":
    unittest.main()
