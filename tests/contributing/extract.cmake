# Takes a file from a code block of CONTRIBUTING.md, and adds the line that goes
# with it to a copy of a table.
#
#   cmake -D PAGE=CONTRIBUTING.md -D FILE=core/cues/steadiness.cc
#         -D TABLE=core/cues/cue_groups.inc "-D LINE=TACTUS_CUES(SteadinessCues)"
#         -D SOURCE=ROOT -D OUT=FOLDER -P extract.cmake
file(READ ${PAGE} page)
string(FIND "${page}" "```cpp\n// ${FILE}\n" begin)
string(FIND "${page}" "`${LINE}`" named)
if(begin EQUAL -1 OR named EQUAL -1)
  message(FATAL_ERROR "${PAGE} has no code of ${FILE}, or not the line ${LINE}")
endif()
string(SUBSTRING "${page}" ${begin} -1 code)
string(REGEX REPLACE "^```cpp\n" "" code "${code}")
string(FIND "${code}" "```" end)
string(SUBSTRING "${code}" 0 ${end} code)
file(WRITE ${OUT}/${FILE} "${code}")
file(READ ${SOURCE}/${TABLE} table)
file(WRITE ${OUT}/${TABLE} "${table}${LINE}\n")
