# SPDX-License-Identifier: Apache-2.0
"""tools/run_tests on a build of five tests: what passed is not repeated, what did not run is listed with its reason."""

import os
import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

TOOL = Path(__file__).resolve().parents[2] / "tools/run_tests"
SKIPS = r"""/source/a_test.cpp:12: Skipped
no folder of shared data

[  SKIPPED ] A.skips (0 ms)"""
TESTS = f"""
add_test(a.passes "{{0}}/program")
add_test(a.fails "/bin/sh" "-c" "test -e {{0}}/mended")
add_test(a.skips "/bin/echo" [==[{SKIPS}]==])
set_tests_properties(a.skips PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED")
add_test(b.skips "/bin/echo" "test_b (B.test_b) ... skipped 'no h5py'")
set_tests_properties(b.skips PROPERTIES SKIP_REGULAR_EXPRESSION "skipped")
add_test(b.takes_long "/bin/true")
set_tests_properties(b.takes_long PROPERTIES LABELS "slow;long" DISABLED ON)
"""


class RunTests(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="aussois-")
        self.addCleanup(folder.cleanup)
        self.build = Path(folder.name)
        self.program("exit 0")
        (self.build / "CTestTestfile.cmake").write_text(TESTS.format(self.build))

    def program(self, body):
        (self.build / "program").write_text(f"#!/bin/sh\n{body}\n")
        (self.build / "program").chmod(0o755)

    def check(self, *arguments, code, tool=TOOL):
        run = subprocess.run([tool, *arguments], capture_output=True, text=True)
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        return run.stdout

    def test_says_what_did_not_run_and_why(self):
        said = self.check(self.build, code=1)
        self.assertIn("\ndid not run: 3\n", said)
        self.assertIn("\n     1  skipped: no folder of shared data: a.skips\n", said)
        self.assertIn("\n     1  skipped: no h5py: b.skips\n", said)
        self.assertIn("\n     1  disabled: many minutes (label long), run by ./check --all: b.takes_long\n", said)

    def test_repeats_nothing_that_passed_on_this_build(self):
        self.assertIn("1: a.passes", self.check("--all", self.build, code=1))
        (self.build / "mended").touch()
        again = self.check("--all", self.build, code=0)
        self.assertIn("1 of 5 tests passed on this very build before", again)
        self.assertNotIn("Test #1: a.passes", again)
        self.assertIn("Test #2: a.fails", again)
        self.assertRegex(again, r"\nall +2 +0 +3 +\d+\n")
        self.assertRegex(again, r"\n  skipped +0 s  b.takes_long\n")
        filtered = self.check("--all", self.build, "-R", "fails|b.skips", code=0)
        self.assertIn("1 of 2 tests passed on this very build before", filtered)
        self.assertNotIn("a.fails ..", filtered)
        self.assertIn("Test #4: b.skips", filtered)
        self.assertNotIn("Test #", self.check("--all", self.build, "-R", "fails", code=0))
        self.program("exit 0  # another program")
        self.assertIn("Test #1: a.passes", self.check("--all", self.build, code=0))
        self.assertIn("Test #1: a.passes", self.check(self.build, code=0))  # without --all everything runs

    def test_repeats_what_reads_a_page_that_changed(self):
        source = self.build / "source"
        (source / "tools").mkdir(parents=True)
        tool = Path(shutil.copy(TOOL, source / "tools"))
        (self.build / "CTestTestfile.cmake").write_text(f'add_test(reads "grep" "-q" "true" "{source}/page.md")')
        for text, code in (("true", 0), ("false", 1), ("true", 0)):
            (source / "page.md").write_text(text)
            self.check("--all", self.build, code=code, tool=tool)
        self.assertIn("1 of 1 tests passed on this very build before", self.check("--all", self.build, code=0, tool=tool))
        for command in (["init", "-q"], ["add", "page.md", "tools"]):
            subprocess.run(["git", "-C", source, *command], check=True)
        (source / "results.csv").write_text("1")  # a driver wrote it
        self.assertIn("1 of 1 tests passed on this very build before", self.check("--all", self.build, code=0, tool=tool))
        (source / "page.md").write_text("true again")
        self.assertIn("Test #1: reads", self.check("--all", self.build, code=0, tool=tool))

    def test_keeps_what_passed_before_it_was_interrupted(self):
        (self.build / "CTestTestfile.cmake").write_text(
            f'add_test(first "{self.build}/program")\nadd_test(second "/bin/sh" "-c" "test -e {self.build}/mended || sleep 60")')
        run = subprocess.Popen([TOOL, "--all", self.build], stdout=subprocess.PIPE, text=True, start_new_session=True)
        for line in run.stdout:
            if "Start 2" in line:
                break
        os.killpg(run.pid, signal.SIGINT)  # as Ctrl-C does
        self.assertEqual(run.wait(timeout=30), 130)
        run.stdout.close()
        (self.build / "mended").touch()
        again = self.check("--all", self.build, code=0)
        self.assertNotIn("Test #1", again)
        self.assertIn("Test #2", again)

    def test_repeats_tests_that_share_a_name(self):
        (self.build / "CTestTestfile.cmake").write_text("subdirs(a b)\n")
        for folder, command in (("a", "true"), ("b", "false")):
            (self.build / folder).mkdir()
            (self.build / folder / "CTestTestfile.cmake").write_text(f"add_test(same /bin/{command})\n")
        for _ in range(2):
            self.assertIn("Test #2", self.check("--all", self.build, code=1))

    def test_a_filter_that_finds_nothing_is_an_error(self):
        self.check(self.build, "-R", "no_such_test", code=1)


if __name__ == "__main__":
    unittest.main()
