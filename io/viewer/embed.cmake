# SPDX-License-Identifier: Apache-2.0
# cmake -DFROM=template.html -DTO=replay_template.cpp -DNAME=kReplayTemplate -P embed.cmake: a text as an array of string literals.
# Pieces stay below the 65536 characters that every compiler takes; the text is plain ASCII, so they may be cut anywhere.
cmake_minimum_required(VERSION 3.25)
file(READ ${FROM} page)
string(LENGTH "${page}" length)
set(code "// Generated from ${FROM}.\n#include <string_view>\nnamespace aussois {\nextern const std::string_view ${NAME}[];\nextern const int ${NAME}Pieces;\nconst std::string_view ${NAME}[] = {\n")
set(pieces 0)
set(from 0)
while(from LESS length)
  string(SUBSTRING "${page}" ${from} 60000 piece)
  string(APPEND code "R\"~page~(" "${piece}" ")~page~\",\n")
  math(EXPR from "${from} + 60000")
  math(EXPR pieces "${pieces} + 1")
endwhile()
string(APPEND code "};\nconst int ${NAME}Pieces = ${pieces};\n}  // namespace aussois\n")
file(WRITE ${TO} "${code}")
