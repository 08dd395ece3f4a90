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
  "$examples/query_contacts" --builtin "$1" --rows 0 --quiet --picture "$pages/$1.html"
  node "$doc/../io/viewer/shot.mjs" "$pages/$1.html" "$doc/images/contacts_$1.png" 0 "
    const set = (id, value) => { const e = document.getElementById(id); e.value = value; e.dispatchEvent(new Event('input')); };
    // The stage alone: what surrounds it stays in place, unseen (shot.mjs presses a button, plots want a size).
    for (const part of ['aside', '#info', 'footer']) document.querySelector(part).style.opacity = 0;
    document.querySelector('#stage').style.cssText = 'position: fixed; inset: 44px 0 0 0; z-index: 1; background: white';
    dispatchEvent(new Event('resize'));
    document.getElementById('normals').click();
    document.getElementById('path').click();
    $2"
}
figure box_on_plate "replay.scene.look('iso', 'moving');"
figure cylinder_standing ""
figure cylinder_lying ""
figure peg "set('opacity', 1); set('axis', '+y'); set('cut', 'fixed');"
figure gear "set('axis', '+z'); set('cut', 'all'); set('depth', 0.36); set('opacity', 1);"
