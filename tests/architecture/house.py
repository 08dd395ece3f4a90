# SPDX-License-Identifier: Apache-2.0
"""The rules of the house that a compiler does not know. Each rule takes the root of a checkout and returns what breaks
it, as lines "file:line: what"; the order of the rooms is the one of doc/architecture.md.

    python3 house.py ROOT RULE        prints the offences of one rule; exit code 1 if there are any
"""

import fnmatch
import hashlib
import os
import re
import sys
from pathlib import Path

ROOMS = ["geometry", "lmd", "reduction", "mechanics", "integrators", "ports", "io", "station"]
MAY_INCLUDE = {room: set(ROOMS[: i + 1]) for i, room in enumerate(ROOMS)}
MAY_INCLUDE["nsgs"] = {"nsgs"}
for room in ("integrators", "ports", "io", "station"):
    MAY_INCLUDE[room].add("nsgs")
# The solver knows numbers and errors, but nothing that has a shape (doc/decisions/0003).
ALSO = {"nsgs": {"geometry/types.hpp", "geometry/check.hpp", "geometry/named.hpp", "geometry/settings.hpp"}}
# The halls of a room: each includes itself and those further left.
HALLS = {"integrators": ["pose", "prove", "tell", "schemes", "events"]}
LONGEST_FUNCTION = 60  # lines
MOST_PUBLIC_HEADERS = {"integrators": 12}
MOST_WORDS = 30  # of nine sentences in ten

NOT_EQUATIONS = {"UTF-8"}


def files(root, *suffixes):
    """Files below `root` whose names end so, without hidden folders, build trees and results; sorted."""
    found = []
    for folder, subfolders, names in os.walk(root):
        subfolders[:] = sorted(s for s in subfolders if s not in ("build", "out", "node_modules") and s[0] != ".")
        found += [Path(folder, name) for name in sorted(names) if name.endswith(suffixes)]
    return found


def lines(root, paths, pattern):
    """(place, match) for every match of `pattern`, line by line; place is "file:line", relative to the root."""
    for path in paths:
        for number, text in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            for match in re.finditer(pattern, text):
                yield f"{path.relative_to(root)}:{number}", match


def comments(root, paths):
    """(place, text) of every comment that begins with //; place is "file:line", relative to the root."""
    return ((place, match[1]) for place, match in lines(root, paths, r"//(.*)"))


def sources(root, *suffixes):
    return [path for path in files(root, *suffixes) if path.relative_to(root).parts[0] in MAY_INCLUDE]


def includes(root):
    """A room includes itself and rooms further left, spelled from the root."""
    bad = []
    for place, match in lines(root, sources(root, ".hpp", ".cpp"), r'^\s*#\s*include\s*"([^"]+)"'):
        header, room = match[1], place.split("/")[0]
        if not (root / header).is_file():
            bad.append(f'{place}: there is no "{header}" seen from the root')
        elif header.split("/")[0] not in MAY_INCLUDE[room] and header not in ALSO.get(room, ()):
            bad.append(f'{place}: {room} may not include "{header}"')
    return bad


def halls(root):
    """A hall includes itself, halls further left, and files of its room that include no hall; schemes and events do not
    know each other."""
    bad = []
    for room, order in HALLS.items():
        paths = [path for path in sources(root, ".hpp", ".cpp") if path.relative_to(root).parts[0] == room]
        found = list(lines(root, paths, rf'^\s*#\s*include\s*"{room}/(?:(\w+)/)?(\w+)\.hpp"'))
        above = {place.split(":")[0].split("/")[1].split(".")[0] for place, match in found
                 if match[1] and place.count("/") == 1}
        for place, match in found:
            hall = place.split("/")[1] if place.count("/") == 2 else None
            if hall is None:
                continue
            allowed = set(order[: order.index(hall) + 1]) - ({"schemes"} if hall == "events" else set())
            if match[1] and match[1] not in allowed:
                bad.append(f"{place}: hall {hall} may not include hall {match[1]}")
            elif not match[1] and match[2] in above:
                bad.append(f"{place}: hall {hall} may not include {match[2]}.hpp, which stands above the halls")
    return bad


def short_functions(root):
    """No function of the library, a driver or a bench is longer than LONGEST_FUNCTION lines, its braces included."""
    bad = []
    programs = [path for room in ("examples", "bench") for path in files(root / room, ".hpp", ".cpp")]
    for path in sources(root, ".hpp", ".cpp") + programs:
        start = None
        for number, text in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            if re.match(r"[A-Za-z].*\(", text) and not re.match(r"(namespace|struct|class|enum|union|using|typedef)\b", text):
                start = number
            elif text == "}" and start:
                if number - start + 1 > LONGEST_FUNCTION:
                    bad.append(f"{path.relative_to(root)}:{start}: a function of {number - start + 1} lines")
                start = None
            elif text.startswith("};") or re.match(r"(namespace|struct|class|enum|union)\b", text):
                start = None
    return bad


def few_public_headers(root):
    """A room shows no more headers than MOST_PUBLIC_HEADERS says."""
    return [f"{room}/CMakeLists.txt:1: {len(shown)} public headers, at most {most} are wanted"
            for room, most in MOST_PUBLIC_HEADERS.items()
            if len(shown := plan(root, room).get("HEADERS", ())) > most]


def own_header_first(root):
    """A source includes the header of its name before any other: so every header that has one is seen to compile alone."""
    bad = []
    for path in sources(root, ".cpp"):
        name = path.relative_to(root).as_posix()
        header = name[:-3] + "hpp"
        first = re.search(r'^\s*#\s*include\s*[<"]([^>"]+)', path.read_text(encoding="utf-8"), re.MULTILINE)
        if (root / header).is_file() and (first is None or first[1] != header):
            bad.append(f'{name}:1: does not include "{header}" first')
    return bad


def plan(root, room):
    """{"SOURCES": [...], "HEADERS": [...], ...} of the aussois_library call in a room's CMakeLists.txt."""
    path = root / room / "CMakeLists.txt"
    call = re.search(r"aussois_library\(([^)]*)\)", path.read_text(encoding="utf-8")) if path.is_file() else None
    lists, words = {}, []
    for word in call[1].split() if call else ():
        if word.isupper():
            words = lists.setdefault(word, [])
        else:
            words.append(word)
    return lists


def public_headers(root):
    """What users include needs the standard library, Eigen and other public headers; heavy libraries stay inside."""
    public = [root / room / name for room in MAY_INCLUDE for name in plan(root, room).get("HEADERS", ())]
    public = [path for path in public if path.is_file()]
    bad = []
    for place, match in lines(root, public, r'^\s*#\s*include\s*([<"])([^>"]+)[>"]'):
        light = re.fullmatch(r"[a-z0-9_]+|Eigen/\w+", match[2]) if match[1] == "<" else root / match[2] in public
        if not light:
            bad.append(f"{place}: a public header may not include {match[2]}")
    return bad


def listed(root):
    """Every source of a room stands in its CMakeLists.txt, and every header does: public ones as HEADERS, others as
    SOURCES. None is forgotten by build and install."""
    bad = []
    for path in sources(root, ".hpp", ".cpp"):
        room, _, name = path.relative_to(root).as_posix().partition("/")
        lists = plan(root, room)
        if name not in lists.get("SOURCES", []) + lists.get("HEADERS", []):
            bad.append(f"{room}/{name}:1: not listed in {room}/CMakeLists.txt")
    return bad


def one_definition(root):
    """A type outside of anonymous namespaces is defined once in the whole tree: what has the name of another links with
    it, and crashes."""
    home, bad = {}, []
    for path in files(root, ".hpp", ".cpp"):
        anonymous = False
        for number, text in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            if text.startswith("namespace {"):
                anonymous = True
            elif text.startswith("}  // namespace") and not text[len("}  // namespace"):].strip():
                anonymous = False
            match = re.match(
                r"(?:struct|class|enum(?: class)?|union) (?:alignas\(\d+\) )?(\w+)(?: final)?(?: :[^:].*)?(?: \{.*)?$", text)
            if not match or anonymous:
                continue
            place = f"{path.relative_to(root)}:{number}"
            if match[1] in home:
                bad.append(f"{place}: {match[1]} is defined already in {home[match[1]]}")
            home[match[1]] = place
    return bad


def velocity_places(root):
    """Where the velocities of a body stand, and where they lead, is said in mechanics: no room behind it counts in sixes or moves a pose."""
    behind = [path for path in sources(root, ".hpp", ".cpp")
              if path.relative_to(root).parts[0] in ("integrators", "io")]
    behind += [path for folder in ("examples", "bench") for path in files(root / folder, ".hpp", ".cpp")]
    sixes = lines(root, behind, r"(?:\[|\(|= |, )6 \* ?(?:Eigen::Index|\w*[bB]od\w*|b\b|i\b|k\b|k[A-Z]\w*|\w\.\w+)")
    moved = lines(root, behind, r"\bpose_at\(")
    return [f"{place}: say first_velocity, body_part, linear_part or angular_part (mechanics/layout.hpp)"
            for place, _ in sixes] + [f"{place}: say retract (mechanics/motion.hpp)" for place, _ in moved]


def strong_ids(root):
    """In the headers of the rooms that know bodies, a body, shape, joint, block or gap is named by its id, not by an int."""
    headers = [path for path in sources(root, ".hpp")
               if path.relative_to(root).parts[0] in ("lmd", "reduction", "mechanics", "integrators")]
    bare = lines(root, headers, r"\bint (?:body|shape|joint|block|gap)(?:_\w+)?\b(?! *\()")
    return [f"{place}: say BodyId, ShapeId, JointId, BlockId or GapId" for place, _ in bare]


def equations(root):
    r"""Every equation cited in code, such as (MJ-4), stands in the manual as \tag{MJ-4}, and stands there once."""
    bad, home = [], {}
    for place, match in lines(root, files(root / "doc", ".md"), r"\\tag\{([A-Z]+-\d+[a-z]?)\}"):
        if match[1] in home:
            bad.append(f"{place}: ({match[1]}) stands already in {home[match[1]]}")
        home[match[1]] = place
    cited = lines(root, files(root, ".hpp", ".cpp"), r"\(([A-Z]+-\d+[a-z]?)\)")
    bad += [f"{place}: ({match[1]}) stands nowhere in the manual"
            for place, match in cited if match[1] not in home and match[1] not in NOT_EQUATIONS]
    return bad


def numbers(root):
    """Every test, reading or acceptance cited in a comment by its number, such as T-4.2 or A-5, stands in a page below
    doc/theory: by itself or within a range, such as T-4.1 to T-4.7."""
    manual = "\n".join(path.read_text(encoding="utf-8") for path in files(root / "doc/theory", ".md"))
    number = r"\b[RTA]-\d+(?:\.\d+)?\b"
    known = set(re.findall(number, manual))
    for kind, first, last in re.findall(r"\b([RTA]-(?:\d+\.)?)(\d+) to \1(\d+)\b", manual):
        known.update(f"{kind}{i}" for i in range(int(first), int(last) + 1))
    return [f"{place}: {cited} stands nowhere in doc/theory" for place, text in comments(root, files(root, ".hpp", ".cpp"))
            for cited in re.findall(number, text) if cited not in known]


def licence(root):
    """Every source starts with its licence (a script: after the line that names its interpreter)."""
    def is_script(path):
        return "." not in path.name and path.stat().st_mode & 0o100 and path.read_bytes()[:2] == b"#!"

    line = re.compile(r"(#![^\n]*\n)?(//|#|%) SPDX-License-Identifier: Apache-2\.0\n")
    code = files(root, ".hpp", ".cpp", ".py", ".js", ".mjs", ".sh", ".cmake", "CMakeLists.txt")
    return [f"{path.relative_to(root)}:1: no line SPDX-License-Identifier: Apache-2.0"
            for path in code + [p for p in files(root, "") if is_script(p)]
            if not line.match(path.read_text(encoding="utf-8"))]


def anchor(heading):
    """The fragment that a heading gets: lower case, no punctuation, hyphens for spaces."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def links(root):
    """Every relative link and picture of the Markdown pages leads to a file, and to a heading where it names one."""
    bad = []
    for place, match in lines(root, files(root, ".md"), r"\]\(([^)\s]*[./#][^)\s]*)\)"):
        target, _, fragment = match[1].partition("#")
        if re.match(r"[a-z]+:", target):
            continue
        page = root / place.rpartition(":")[0]
        goal = (page.parent / target) if target else page
        if not goal.exists():
            bad.append(f"{place}: {target} does not exist")
        elif fragment and goal.suffix == ".md" and fragment not in map(
                anchor, re.findall(r"^#+ (.*)$", goal.read_text(encoding="utf-8"), re.MULTILINE)):
            bad.append(f"{place}: {goal.name} has no heading #{fragment}")
    return bad


def pages(root):
    """Every page below doc can be found from doc/index.md."""
    index = (root / "doc/index.md").read_text(encoding="utf-8")
    return [f"{path.relative_to(root)}:1: doc/index.md has no link to it" for path in files(root / "doc", ".md")
            if path.name != "index.md" and f"({path.relative_to(root / 'doc').as_posix()})" not in index]


def references(root):
    """Every work cited by its key, such as [Acary2008] or [Acary2008, ch. 10], stands in doc/references.bib."""
    bibliography = (root / "doc/references.bib").read_text(encoding="utf-8")
    known = set(re.findall(r"^@\w+\{(\w+),", bibliography, re.MULTILINE))
    cited = lines(root, files(root, ".md", ".hpp", ".cpp"), r"\[([A-Z]\w+(?:19|20)\d\d[a-z]?)(?:, [^\]]*)?\]")
    return [f"{place}: {match[1]} does not stand in doc/references.bib" for place, match in cited if match[1] not in known]


def tests(root):
    """Every test that a page names, such as `Suite.Test`, `Suite.Begins*` or `Suite.*`, and every case of the
    verification list, such as `A4.column` or its row `A4.column.weight`, exists."""
    known = {f"{match[1]}.{match[2]}"
             for _, match in lines(root, files(root / "tests", ".cpp"), r"^\s*TEST(?:_P|_F)?\((\w+), (\w+)")}
    named = lines(root, files(root / "doc", ".md"), r"`(?:\w+/)?([A-Z]\w+\.(?:[A-Z]\w*)?\*?)`")
    bad = [f"{place}: there is no test {match[1]}" for place, match in named if not fnmatch.filter(known, match[1])]
    cases = {match[1] for _, match in lines(root, files(root / "examples", ".cpp"), r'"([A-H]\d+\.\w+)"')}
    named = lines(root, files(root / "doc", ".md"), r"`([A-H]\d+\.[a-z]\w*)(?:\.\w+)?`")
    return bad + [f"{place}: the verification list has no case {match[1]}" for place, match in named if match[1] not in cases]


def sentences(text):
    """The prose of a page, sentence by sentence: without code, formulas, tables and headings."""
    text = re.sub(r"```.*?```|\$\$.*?\$\$", "\n", text, flags=re.DOTALL)
    paragraphs = [[]]
    for line in map(str.strip, text.splitlines()):
        if not line or line[0] in "#|<":
            paragraphs.append([])
        elif re.match(r"([*-]|\d+\.) ", line):
            paragraphs.append([line])
        else:
            paragraphs[-1].append(line)
    for paragraph in map(" ".join, paragraphs):
        plain = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", paragraph)
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", plain)
        plain = re.sub(r"`[^`]*`|\$[^$]*\$", "X", plain)
        yield from (s for s in re.split(r"(?<=[.!?:;])\s+(?=[A-Z*\[(])", plain) if len(re.findall(r"[\w'-]+", s)) > 2)


def short_sentences(root):
    """Nine of ten sentences of the manual have fewer than MOST_WORDS words."""
    found = sorted((len(re.findall(r"[\w'-]+", sentence)), path.relative_to(root).as_posix(), sentence)
                   for path in files(root / "doc", ".md") for sentence in sentences(path.read_text(encoding="utf-8")))
    if not found or found[9 * (len(found) - 1) // 10][0] < MOST_WORDS:
        return []
    return [f"{page}:1: {words} words: {sentence[:80]}" for words, page, sentence in reversed(found) if words >= MOST_WORDS]


def persons(root):
    """Pages and comments do not take things for persons: what a function or a file does has no place for these words."""
    prose = [(place, match[0]) for place, match in lines(root, files(root, ".md"), r".+")]
    prose += comments(root, files(root, ".hpp", ".cpp", ".js", ".mjs"))
    return [f"{place}: {word} is a person; say what it is" for place, text in prose
            for word in re.findall(r"\b(?:nobody|somebody|whoever|whom)\b", text, re.IGNORECASE)]


def tutorials(root):
    """Each program of examples/first has a page in doc/tutorials that quotes it to the letter; README quotes the first, which has
    at most 30 lines."""
    bad = []
    for path in sorted((root / "examples/first").glob("*.cpp")):
        code = path.read_text(encoding="utf-8").partition("\n")[2]
        pages = [root / f"doc/tutorials/{path.stem}.md"] + ([root / "README.md"] if path.stem.startswith("01_") else [])
        bad += [f"{page.relative_to(root)}:1: does not quote {path.relative_to(root)}" for page in pages
                if not page.is_file() or f"```cpp\n{code}```" not in page.read_text(encoding="utf-8")]
        if path.stem.startswith("01_") and code.count("\n") >= 30:
            bad.append(f"{path.relative_to(root)}:1: has more than 30 lines")
    return bad


def viewer_is_built(root):
    """The page that is committed was built from the sources beside it, and not edited: it names both digests (io/viewer/build.mjs)."""
    viewer = root / "io/viewer"
    sha = hashlib.sha256()
    for path in sorted(viewer.iterdir()):
        if re.search(r"\.(js|mjs|css|html|txt)$|^package(-lock)?\.json$", path.name):
            sha.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    page = viewer / "dist/template.html"
    text = page.read_text(encoding="utf-8") if page.is_file() else ""
    named = re.search(r"\n<!-- built from sources (\w+), page (\w+) -->", text)
    if named and named[1] == sha.hexdigest():
        own = hashlib.sha256(text.replace(named[0], "", 1).encode()).hexdigest()
        return [] if named[2] == own else ["io/viewer/dist/template.html:1: edited by hand: change its sources and build it"]
    return ["io/viewer/dist/template.html:1: not built from these sources: npm run build in io/viewer"]


def live_page_is_built(root):
    """The page of a station was built from the sources beside it, and not edited: dist/built.txt has both digests (station/page/build.mjs)."""
    page, viewer = root / "station/page", root / "io/viewer"
    sources, own = hashlib.sha256(), hashlib.sha256()
    named = [(path.name, path) for path in sorted(page.iterdir()) if re.search(r"\.(js|mjs|css|html)$", path.name)]
    named += [(f"../../io/viewer/{name}", viewer / name) for name in ("format.js", "scene.js", "package-lock.json")]
    for name, path in named:
        sources.update(name.encode() + b"\0" + path.read_bytes() + b"\0")
    for name in ("live.html", "live.css", "live.js", "live_worker.js"):
        path = page / "dist" / name
        own.update(name.encode() + b"\0" + (path.read_bytes() if path.is_file() else b"") + b"\0")
    built = page / "dist/built.txt"
    told = built.read_text().split() if built.is_file() else []
    if told[1:2] != [sources.hexdigest()]:
        return ["station/page/dist/built.txt:1: not built from these sources: node build.mjs in station/page"]
    return [] if told[3:4] == [own.hexdigest()] else ["station/page/dist/built.txt:2: edited by hand: change the sources and build"]


def orders_are_counted(root):
    """What doc/theory/convergence.md says of the cells of orders.md is what stands there."""
    table = (root / "doc/theory/orders.md").read_text(encoding="utf-8").split("\n## Beams and solids")[0]
    rows = [line.strip("|").split("|")[1:] for line in table.splitlines() if line.startswith("| `")]
    cells = [cell.strip() for row in rows for cell in row if cell.strip() not in ("", "-")]
    less = sum("(" in cell for cell in cells)
    missed = sum("**" in cell for cell in cells)
    page = (root / "doc/theory/convergence.md").read_text(encoding="utf-8")
    return [f'doc/theory/convergence.md:1: must say "{text}"'
            for text in (f"gives {len(cells)} cells", f"| {len(cells) - less - missed} | {less} | 0 | {missed} |",
                         f"In {sum(cell.endswith(' c') for cell in cells)} of them the certificate shortened steps")
            if text not in page]


RULES = {rule.__name__: rule for rule in (includes, halls, short_functions, few_public_headers, own_header_first, public_headers,
                                          listed, one_definition, velocity_places, strong_ids, equations, numbers, licence, links, pages, references,
                                          tests, short_sentences, persons, tutorials, viewer_is_built, live_page_is_built,
                                          orders_are_counted)}


def main():
    bad = RULES[sys.argv[2]](Path(sys.argv[1]).resolve())
    print("\n".join(bad) or "nothing to say")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
