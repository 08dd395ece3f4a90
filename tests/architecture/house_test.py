# SPDX-License-Identifier: Apache-2.0
"""The rules of house.py on small trees: each is silent on what is right and names what is wrong."""

import hashlib
import tempfile
import unittest
from pathlib import Path

import house

SPDX = "// SPDX-License-Identifier: Apache-2.0\n"


class House(unittest.TestCase):
    def offences(self, rule, tree):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in tree.items():
                path = Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return rule(Path(folder))

    def test_a_room_includes_rooms_further_left_only(self):
        tree = {"geometry/types.hpp": "", "nsgs/nsgs.hpp": '#include "geometry/types.hpp"\n',
                "integrators/schemes/moreau_jean.cpp": '#include "nsgs/nsgs.hpp"\n#include "geometry/types.hpp"\n'}
        self.assertEqual(self.offences(house.includes, tree), [])
        tree["geometry/types.hpp"] = '\n#  include "nsgs/nsgs.hpp"\n'
        self.assertEqual(self.offences(house.includes, tree),
                         ['geometry/types.hpp:2: geometry may not include "nsgs/nsgs.hpp"'])

    def test_the_solver_knows_no_shape(self):
        tree = {"geometry/check.hpp": "", "geometry/se3.hpp": "", "mechanics/state.hpp": "",
                "nsgs/a.cpp": '#include "geometry/check.hpp"\n#include "geometry/se3.hpp"\n',
                "mechanics/b.cpp": '#include "nsgs/a.cpp"\n'}
        self.assertEqual(self.offences(house.includes, tree),
                         ['mechanics/b.cpp:1: mechanics may not include "nsgs/a.cpp"',
                          'nsgs/a.cpp:2: nsgs may not include "geometry/se3.hpp"'])

    def test_includes_are_spelled_from_the_root(self):
        tree = {"lmd/cone.hpp": "", "lmd/cone.cpp": '#include "cone.hpp"\n'}
        self.assertEqual(self.offences(house.includes, tree),
                         ['lmd/cone.cpp:1: there is no "cone.hpp" seen from the root'])

    def test_a_hall_includes_halls_further_left_only(self):
        tree = {"integrators/pose/rows.hpp": "", "integrators/step_report.hpp": "", "integrators/run.hpp": "",
                "integrators/run.cpp": '#include "integrators/prove/judge.hpp"\n',
                "integrators/prove/judge.hpp": '#include "integrators/pose/rows.hpp"\n#include "integrators/step_report.hpp"\n',
                "integrators/schemes/loop.hpp": '#include "integrators/prove/judge.hpp"\n',
                "integrators/events/reference.cpp": '#include "integrators/prove/judge.hpp"\n'}
        self.assertEqual(self.offences(house.halls, tree), [])
        tree["integrators/pose/rows.hpp"] = '#include "integrators/prove/judge.hpp"\n#include "integrators/run.hpp"\n'
        tree["integrators/events/reference.cpp"] += '#include "integrators/schemes/loop.hpp"\n'
        self.assertEqual(self.offences(house.halls, tree),
                         ["integrators/events/reference.cpp:2: hall events may not include hall schemes",
                          "integrators/pose/rows.hpp:1: hall pose may not include hall prove",
                          "integrators/pose/rows.hpp:2: hall pose may not include run.hpp, which stands above the halls"])

    def test_functions_are_short(self):
        body = "  f();\n" * (house.LONGEST_FUNCTION - 2)
        tree = {"nsgs/a.cpp": f"void f() {{\n{body}}}\n\nnamespace {{\n{body}{body}}}\n", "tests/a.cpp": f"f() {{\n{body}{body}}}\n"}
        self.assertEqual(self.offences(house.short_functions, tree), [])
        tree["nsgs/a.cpp"] += f"\nstruct A {{\n{body}{body}}};\n\nint g(int a,\n      int b) {{\n{body}}}\n"
        tree["examples/b.cpp"] = f"void f() {{\n{body}  f();\n}}\n"
        self.assertEqual(self.offences(house.short_functions, tree),
                         [f"nsgs/a.cpp:{5 * house.LONGEST_FUNCTION}: a function of {house.LONGEST_FUNCTION + 1} lines",
                          f"examples/b.cpp:1: a function of {house.LONGEST_FUNCTION + 1} lines"])

    def test_a_room_shows_few_headers(self):
        headers = [f"h{i}.hpp" for i in range(house.MOST_PUBLIC_HEADERS["integrators"])]
        plan = "aussois_library(integrators SOURCES a.cpp HEADERS %s)\n"
        tree = {"integrators/CMakeLists.txt": plan % " ".join(headers)}
        self.assertEqual(self.offences(house.few_public_headers, tree), [])
        tree["integrators/CMakeLists.txt"] = plan % " ".join(headers + ["more.hpp"])
        self.assertEqual(self.offences(house.few_public_headers, tree),
                         ["integrators/CMakeLists.txt:1: 13 public headers, at most 12 are wanted"])

    def test_a_source_includes_its_own_header_first(self):
        tree = {"lmd/a.hpp": "", "lmd/a.cpp": '#include "lmd/a.hpp"\n', "lmd/alone.cpp": "#include <vector>\n",
                "lmd/b.hpp": "", "lmd/b.cpp": '#include <vector>\n#include "lmd/b.hpp"\n', "lmd/c.hpp": "", "lmd/c.cpp": ""}
        self.assertEqual(self.offences(house.own_header_first, tree),
                         ['lmd/b.cpp:1: does not include "lmd/b.hpp" first',
                          'lmd/c.cpp:1: does not include "lmd/c.hpp" first'])

    def test_public_headers_include_nothing_heavy_and_nothing_private(self):
        tree = {"io/CMakeLists.txt": "aussois_library(io\n  SOURCES a.cpp file.hpp\n  HEADERS a.hpp\n  HEAVY hdf5::hdf5)\n",
                "io/a.hpp": '#include <Eigen/Core>\n#include <vector>\n#include <hdf5.h>\n#include "io/file.hpp"\n',
                "io/a.cpp": "#include <hdf5.h>\n", "io/file.hpp": "#include <hdf5.h>\n"}
        self.assertEqual(self.offences(house.public_headers, tree),
                         ["io/a.hpp:3: a public header may not include hdf5.h",
                          "io/a.hpp:4: a public header may not include io/file.hpp"])

    def test_every_source_of_a_room_is_listed(self):
        tree = {"nsgs/CMakeLists.txt": "aussois_library(nsgs SOURCES cone.cpp\n  HEADERS cone.hpp)\n",
                "nsgs/cone.cpp": "", "nsgs/cone.hpp": "", "nsgs/one.hpp": ""}
        self.assertEqual(self.offences(house.listed, tree), ["nsgs/one.hpp:1: not listed in nsgs/CMakeLists.txt"])

    def test_a_type_is_defined_once(self):
        tree = {"lmd/a.hpp": "struct Trial {\n  struct Part {};\n};\nstruct Later;\nstruct Row<int> {};\n",
                "lmd/b.cpp": "namespace {\nstruct Trial {};\n}  // namespace\nstruct Later {};\n",
                "nsgs/c.cpp": "struct Part {};\nclass Outer::Trial {};\nstruct Row<double> {};\n"}
        self.assertEqual(self.offences(house.one_definition, tree), [])
        tree["nsgs/d.hpp"] = "enum class Trial : int { a };\n"
        self.assertEqual(self.offences(house.one_definition, tree),
                         ["nsgs/d.hpp:1: Trial is defined already in lmd/a.hpp:1"])

    def test_velocities_are_found_by_the_layout(self):
        tree = {"mechanics/layout.hpp": "return 6 * body;\n", "lmd/a.cpp": "x = 6 * b;\n",
                "integrators/a.cpp": "v.segment<6>(first_velocity(b));\nconst int at = 36 * b + 0.6 * b;\n"}
        self.assertEqual(self.offences(house.velocity_places, tree), [])
        for text in ("v.segment<3>(6 * Eigen::Index(b));", "v[6 * s.body + 2] = 1;", "const int at = 6 * body;"):
            tree["examples/b.cpp"] = text
            self.assertEqual(len(self.offences(house.velocity_places, tree)), 1, text)

    def test_ids_are_no_ints(self):
        tree = {"mechanics/a.hpp": "BodyId body{};\nint gap_columns(int bodies);\n", "nsgs/a.hpp": "int body = 0;\n"}
        self.assertEqual(self.offences(house.strong_ids, tree), [])
        for text in ("int body = -1;", "void f(int shape);", "int joint_1 = 0, axis = 0;"):
            tree["reduction/b.hpp"] = text
            self.assertEqual(len(self.offences(house.strong_ids, tree)), 1, text)

    def test_cited_equations_stand_once_in_the_manual(self):
        tree = {"doc/theory/nsgs.md": "$$ a = b \\tag{NSGS-1} $$\n", "nsgs/a.hpp": "// (NSGS-1), in UTF-8 (UTF-8)\n"}
        self.assertEqual(self.offences(house.equations, tree), [])
        tree["nsgs/a.hpp"] += "// (NSGS-1) to (NSGS-3)\n"
        tree["doc/theory/other.md"] = "\\tag{NSGS-1}\n"
        self.assertEqual(self.offences(house.equations, tree),
                         ["doc/theory/other.md:1: (NSGS-1) stands already in doc/theory/nsgs.md:1",
                          "nsgs/a.hpp:2: (NSGS-3) stands nowhere in the manual"])

    def test_cited_numbers_stand_in_the_manual(self):
        tree = {"doc/theory/a.md": "T-4.1 to T-4.3, T-4.12 and A-5\n", "doc/b.md": "R-5\n",
                "tests/a.cpp": "// T-4.2. (T-4.12) of A-5, (CA-7), UTF-8\nf(\"A-1\");\n"}
        self.assertEqual(self.offences(house.numbers, tree), [])
        tree["tests/a.cpp"] += "f();  // R-5, T-4.1\n/// T-4.4, A-5.1\n"
        self.assertEqual(self.offences(house.numbers, tree),
                         ["tests/a.cpp:3: R-5 stands nowhere in doc/theory", "tests/a.cpp:4: T-4.4 stands nowhere in doc/theory",
                          "tests/a.cpp:4: A-5.1 stands nowhere in doc/theory"])

    def test_sources_start_with_their_licence(self):
        tree = {"a.hpp": SPDX, "b.py": "#!/usr/bin/env python3\n# SPDX-License-Identifier: Apache-2.0\n",
                "c.cpp": "\n" + SPDX, "build/d.cpp": "", ".e/f.cpp": "", "CMakeLists.txt": "project(x)\n"}
        self.assertEqual(self.offences(house.licence, tree),
                         ["CMakeLists.txt:1: no line SPDX-License-Identifier: Apache-2.0",
                          "c.cpp:1: no line SPDX-License-Identifier: Apache-2.0"])

    def test_links_lead_somewhere(self):
        tree = {"README.md": "[a](doc/a.md) [b](doc/a.md#the-time-step) [c](https://example.org/x.md) $W[i](q)$\n",
                "doc/a.md": "# The *time* step!\n[up](../README.md)\n"}
        self.assertEqual(self.offences(house.links, tree), [])
        tree["doc/a.md"] += "[x](b.md)\n![y](#nowhere)\n"
        self.assertEqual(self.offences(house.links, tree),
                         ["doc/a.md:3: b.md does not exist", "doc/a.md:4: a.md has no heading #nowhere"])

    def test_every_page_is_found_from_the_index(self):
        tree = {"doc/index.md": "[a](theory/a.md)\n", "doc/theory/a.md": "", "README.md": ""}
        self.assertEqual(self.offences(house.pages, tree), [])
        tree["doc/theory/b.md"] = ""
        self.assertEqual(self.offences(house.pages, tree), ["doc/theory/b.md:1: doc/index.md has no link to it"])

    def test_cited_works_stand_in_the_bibliography(self):
        tree = {"doc/references.bib": "@book{Acary2008, title = {x}}\n",
                "doc/a.md": "[Acary2008] [Acary2008, ch. 10] [Moreau1988a]\n", "nsgs/a.hpp": "// x[i], [Jean1999]\n"}
        self.assertEqual(self.offences(house.references, tree),
                         ["doc/a.md:1: Moreau1988a does not stand in doc/references.bib",
                          "nsgs/a.hpp:1: Jean1999 does not stand in doc/references.bib"])

    def test_tests_that_pages_name_exist(self):
        tree = {"tests/unit/a.cpp": "TEST(Ball, Bounces) {}\nTEST_P(EveryScheme, HoldsAJoint) {}\n",
                "doc/a.md": "`Ball.Bounces`, `Ball.*`, `Schemes/EveryScheme.Holds*`, `normal.law`, `Ball.radius`\n"}
        self.assertEqual(self.offences(house.tests, tree), [])
        tree["doc/a.md"] += "`Ball.Rests`, `Box.*`\n`EveryScheme.Keeps*`\n"
        self.assertEqual(self.offences(house.tests, tree),
                         ["doc/a.md:2: there is no test Ball.Rests", "doc/a.md:2: there is no test Box.*",
                          "doc/a.md:3: there is no test EveryScheme.Keeps*"])

    def test_cases_of_the_verification_list_that_pages_name_exist(self):
        tree = {"examples/verification/a.cpp": '{.name = "A1.ball"}\n', "doc/a.md": "`A1.ball`, `A1.ball.energy`, `B4.ball`, `A1.cube.energy`\n"}
        self.assertEqual(self.offences(house.tests, tree), ["doc/a.md:1: the verification list has no case B4.ball",
                                                            "doc/a.md:1: the verification list has no case A1.cube"])

    def test_nine_sentences_of_ten_are_short(self):
        short, long = "This is a sentence of seven words. ", "A " + "very " * 40 + "long one. "
        tree = {"doc/a.md": "# " + long + "\n" + short * 19 + long + "\n| " + long + "|\n```\n" + long * 9 + "\n```\n"}
        self.assertEqual(self.offences(house.short_sentences, tree), [])
        tree["doc/b.md"] = long * 3
        self.assertEqual(len(self.offences(house.short_sentences, tree)), 4)

    def test_things_are_no_persons(self):
        tree = {"a.md": "A user who reads this.\n", "nsgs/a.cpp": "int nobody = 0;  // whose impulse\n"}
        self.assertEqual(self.offences(house.persons, tree), [])
        tree["a.md"] += "Nobody prints it.\n"
        tree["nsgs/a.hpp"] = "int a;  // for whom\n/// whoever, somebody\n"
        self.assertEqual(self.offences(house.persons, tree),
                         ["a.md:2: Nobody is a person; say what it is", "nsgs/a.hpp:1: whom is a person; say what it is",
                          "nsgs/a.hpp:2: whoever is a person; say what it is",
                          "nsgs/a.hpp:2: somebody is a person; say what it is"])

    def test_tutorials_quote_their_programs(self):
        tree = {"examples/first/01_a.cpp": SPDX + "int main() {}\n", "examples/first/02_b.cpp": SPDX + "// b\n",
                "doc/tutorials/01_a.md": "# A\n```cpp\nint main() {}\n```\n", "doc/tutorials/02_b.md": "```cpp\n// b\n```",
                "README.md": "x\n```cpp\nint main() {}\n```\n"}
        self.assertEqual(self.offences(house.tutorials, tree), [])
        tree["examples/first/02_b.cpp"] += "// more\n"
        tree["README.md"] = "int main() {}\n"
        self.assertEqual(self.offences(house.tutorials, tree),
                         ["README.md:1: does not quote examples/first/01_a.cpp",
                          "doc/tutorials/02_b.md:1: does not quote examples/first/02_b.cpp"])

    def test_cells_of_orders_are_counted(self):
        says = "gives 3 cells\n| 2 | 1 | 0 | 0 |\nIn 1 of them the certificate shortened steps\n"
        tree = {"doc/theory/orders.md": "| case | a | b |\n|---|---|---|\n| `x` | 1.00 1.00 c | - |\n| `y` | (0.57) 1.00 | exact |\n",
                "doc/theory/convergence.md": says}
        self.assertEqual(self.offences(house.orders_are_counted, tree), [])
        tree["doc/theory/orders.md"] += "| `z` | **0.1** | 1.00 |\n"
        self.assertEqual(len(self.offences(house.orders_are_counted, tree)), 2)

    def test_the_page_is_built_from_its_sources(self):
        tree = {"io/viewer/main.js": "run();\n", "io/viewer/page.html": "<head>\n"}
        digest = hashlib.sha256(b"main.js\0run();\n\0page.html\0<head>\n\0").hexdigest()
        own = hashlib.sha256(b"<head>\n").hexdigest()
        page = f"<head>\n<!-- built from sources {digest}, page {own} -->\n"
        tree["io/viewer/dist/template.html"] = page
        self.assertEqual(self.offences(house.viewer_is_built, tree), [])
        tree["io/viewer/dist/template.html"] = page + "<p>"
        self.assertEqual(len(self.offences(house.viewer_is_built, tree)), 1)
        tree["io/viewer/dist/template.html"] = page
        tree["io/viewer/main.js"] = "run(1);\n"
        self.assertEqual(len(self.offences(house.viewer_is_built, tree)), 1)


if __name__ == "__main__":
    unittest.main()
