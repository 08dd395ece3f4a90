# SPDX-License-Identifier: Apache-2.0
"""Doxygen's filter for the Markdown pages: $x$ and $$x$$ outside code become Doxygen's formulas; lines stay lines.

    python3 formulas.py PAGE.md
"""

import re
import sys

CODE_OR_FORMULA = re.compile(
    r"(?P<code>^(```|~~~).*?^\2|^( {4}|\t)[^\n]*|`[^`\n]+`)|\$\$(?P<display>.+?)\$\$|\$(?P<inline>[^$\n]+?)\$",
    re.DOTALL | re.MULTILINE)


def formula(match):
    if match["code"]:
        return match[0]
    if match["display"]:
        return r"\f[" + match["display"] + r"\f]"
    return r"\f$" + match["inline"] + r"\f$"


with open(sys.argv[1], encoding="utf-8") as page:
    sys.stdout.write(CODE_OR_FORMULA.sub(formula, page.read()))
