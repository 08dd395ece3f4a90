#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The pictures of contacts in doc/theory/lmd.md, from query_contacts through a headless browser.
#
#     doc/contact_figures.sh build/release/examples        (after `npm install` in io/viewer)
set -eu
examples=$(cd "$1" && pwd)
doc=$(cd "$(dirname "$0")" && pwd)
pages=$(mktemp -d)
trap 'rm -rf "$pages"' EXIT

# figure NAME SCRIPT: the page of a builtin pair, dressed by SCRIPT, as doc/images/contacts_NAME.png
figure() {
  (cd "$pages" && "$examples/query_contacts" --builtin "$1" --quiet --picture "$1.html" > /dev/null)
  node "$doc/../io/viewer/shot.mjs" "$pages/$1.html" "$doc/images/contacts_$1.png" 0 "
    const set = (id, value) => { const e = document.getElementById(id); e.value = value; e.dispatchEvent(new Event('input')); };
    // The stage alone: what surrounds it stays in place, unseen (shot.mjs presses a button, plots want a size).
    for (const part of ['aside', '#info', 'footer']) document.querySelector(part).style.opacity = 0;
    document.querySelector('#stage').style.cssText = 'position: fixed; inset: 44px 0 56px 0; z-index: 1; background: white';
    dispatchEvent(new Event('resize'));
    document.getElementById('normals').click();
    document.getElementById('path').click();
    $2"
}
figure box_on_plate ""
figure cylinder_standing ""
figure cylinder_lying ""
figure peg "set('axis', '-y'); set('opacity', 1);"
figure gear "document.getElementById('normals').click(); set('axis', '-y'); set('cut', 'all'); set('opacity', 1); set('size', -0.2);"
