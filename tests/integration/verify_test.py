# SPDX-License-Identifier: Apache-2.0
"""verify: rows as text and JSON, in one order whatever finishes first; goes on where it was; says what does not hold."""

import json
import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import SOURCE, DriverTest

PAGE = SOURCE / "doc/theory/verification_list.md"


class Verify(DriverTest):
    def verify(self, *arguments, code=0):
        run = self.drive("verify", *arguments)
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        return run.stdout

    def rows(self, *arguments, code=0):
        self.verify(*arguments, "--json", "rows/rows.json", "--quiet", code=code)
        return json.loads((self.folder / "rows/rows.json").read_text())["cases"]

    def test_rows_say_what_holds(self):
        said = self.verify("--case", "A4.unequal_balls")
        self.assertIn("A4.unequal_balls: balls of 3, 2 and 1 kg", said)
        self.assertRegex(said, r"\n  holds +at_once +\S+ <= 1e-12 m/s +worst speed, .*\(closed form; agreed\)\n")
        self.assertIn("\nverify: 2 rows hold, 0 fail, 0 are skipped\n", said)

    def test_json_has_them_in_the_order_of_the_list(self):
        one, two = (self.rows("--case", "A4", "--threads", threads, "-o", f"of_{threads}") for threads in (1, 2))
        self.assertEqual(one, two)
        self.assertEqual([row["case"] for row in one[:3]],
                         ["A4.equal_balls.at_once", "A4.equal_balls.in_turn", "A4.three_balls.speed (moreau)"])
        contacts = next(row for row in one if row["case"] == "A4.column.contacts")
        self.assertEqual((contacts["sense"], contacts["figure"], contacts["bound"], contacts["unit"]), ("=", 1000, 1000, "-"))
        for row in one:
            self.assertIs(row["pass"], True)
            if row["sense"] == "<=":
                self.assertLessEqual(row["figure"], row["bound"])

    def test_it_goes_on_where_it_was(self):
        first = self.rows("--case", "A4.three_balls")
        self.assertIn("2 of 3 were already in out", self.verify("--group", "A4.three_balls,A4.unequal_balls"))
        result = self.folder / "out/verify/A4.three_balls_moreau.json"
        result.write_text(result.read_text()[:-10])  # damaged: done again
        self.assertIn("1 of 2 were already in out", self.verify("--case", "A4.three_balls"))
        self.assertEqual(self.rows("--case", "A4.three_balls"), first)

    def test_what_does_not_hold_is_the_exit_code(self):
        self.verify("--case", "A4.unequal_balls", "--quiet")
        result = self.folder / "out/verify/A4.unequal_balls.json"
        kept = json.loads(result.read_text())
        kept["figures"]["in_turn"] = 1e-3
        result.write_text(json.dumps(kept))
        self.assertIn("verify: 1 rows hold, 1 fail", self.verify("--case", "A4.unequal_balls", code=1))
        self.assertEqual([row["pass"] for row in self.rows("--case", "A4.unequal_balls", code=1)], [True, False])

    def test_without_shared_data_rows_are_skipped_and_not_kept(self):
        os.environ["AUSSOIS_DATA_DIR"], data = "", os.environ.get("AUSSOIS_DATA_DIR", "")
        self.addCleanup(os.environ.__setitem__, "AUSSOIS_DATA_DIR", data)
        rows = self.rows("--case", "B4.ellipsoid", code=3)  # nothing ran
        self.assertEqual({(row["figure"], row["pass"]) for row in rows}, {(None, None)})
        said = self.verify("--case", "B4.ellipsoid", code=3)
        self.assertIn("skipped: AUSSOIS_DATA_DIR names no folder with references/", said)
        self.assertRegex(said, rf"\n{len(rows)} rows skipped: AUSSOIS_DATA_DIR names no folder with references/\S+\n"
                               rf"verify: 0 rows hold, 0 fail, {len(rows)} are skipped\n$")
        self.assertEqual(list((self.folder / "out/verify").iterdir()), [])

    def test_guards_are_counted(self):
        rows = [row for row in self.rows("--case", "B6.too_long_steps") if "guard" in row["source"]]
        self.assertIn(f"\n{len(rows)} of the rows that hold are guards", self.verify("--case", "B6.too_long_steps"))

    def test_what_ran_decides_where_other_rows_were_skipped(self):
        os.environ["AUSSOIS_DATA_DIR"], data = "", os.environ.get("AUSSOIS_DATA_DIR", "")
        self.addCleanup(os.environ.__setitem__, "AUSSOIS_DATA_DIR", data)
        self.assertIn("verify: 2 rows hold, 0 fail, 5 are skipped", self.verify("--case", "B4.ellipsoid", "A4.unequal_balls"))

    def test_a_series_that_is_no_table_is_named_with_its_line(self):
        series = self.folder / "data/references/contensou_disc_coefficients.csv"
        series.parent.mkdir(parents=True)
        os.environ["AUSSOIS_DATA_DIR"], data = str(self.folder / "data"), os.environ.get("AUSSOIS_DATA_DIR", "")
        self.addCleanup(os.environ.__setitem__, "AUSSOIS_DATA_DIR", data)
        for rows, word in (("a,b\n1,2\n1,x\n", ":3: b = 'x' must be a number"), ("a,b\n1\n", ":2: 1 values must be 2"), ("a,b\n", "no row")):
            series.write_text(rows)
            run = self.drive("verify", "--case", "B4.ellipsoid")
            self.assertEqual(run.returncode, 3, run.stderr)
            self.assertIn(f"{series.name}{word}" if word[0] == ":" else word, run.stderr)

    def test_names_are_given_one_by_one_or_between_commas(self):
        asked = [line.split(": ")[0] for line in self.verify("--list", "--case", "A4.column,A4.three_balls").splitlines() if line[0] != " "]
        self.assertEqual(asked, ["A4.three_balls (moreau)", "A4.three_balls (combined)", "A4.column"])
        for words in (("--case", "A4.column", "A4.three_balls"), ("--case", "A4.column", "--case", "A4.three_balls"),
                      ("--case", "A4.column", "--group", "A4.three_balls"), ("--group", "A4.column,", "A4.three_balls")):
            said = self.verify("--list", *words)
            self.assertEqual([line.split(": ")[0] for line in said.splitlines() if line[0] != " "], asked)
        groups = [self.verify("--list", *words) for words in (("--group", "A,B"), ("--group", "A", "B"), ("--group", "A", "--group", "B"))]
        self.assertEqual(len(set(groups)), 1)
        self.assertIn("\nB1.incline", groups[0])
        one = self.verify("--list", "--case", "A5.paper (event_driven, 10 starts)")  # its comma stands in brackets
        self.assertTrue(one.startswith("A5.paper (event_driven, 10 starts): "))
        self.assertEqual(sum(line[0] != " " for line in one.splitlines()), 1)

    def test_the_list_has_every_case_and_runs_none(self):
        cases = [line for line in self.verify("--list").splitlines() if not line.startswith(" ")]
        self.assertGreater(len(cases), 200)
        self.assertTrue(cases[0].startswith("A1.elastic_ball_at_the_midpoint: "))
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_bad_input_is_named(self):
        for arguments, word in (((), "give --group A"), (("--case", "A4.no_such"), "no group or case 'A4.no_such'"),
                                (("--group", "A,Z"), "no group or case 'Z'"), (("--group", ""), "give --group A"),
                                (("--case", "A4", "--page", PAGE), "--page needs --all"), (("--threads", 0), "--threads")):
            run = self.drive("verify", *arguments)
            self.assertEqual(run.returncode, 2, arguments)
            self.assertIn(word, run.stderr)
        (self.folder / "bare.md").write_text("no marks\n")
        run = self.drive("verify", "--all", "--page", "bare.md")
        self.assertEqual(run.returncode, 3)
        self.assertIn("bare.md", run.stderr)
        self.assertEqual(self.drive("verify", "--all", "--page", "no.md").returncode, 3)


if __name__ == "__main__":
    unittest.main()
