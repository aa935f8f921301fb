# Writes gnomon_commit.h when commit or sources have changed; run at every build.
#
# GNOMON_COMMIT: "-dirty" behind it where what the program is built from is not what the commit holds: files are changed, or new in
# folders from which the build takes every file that it finds. Changes of pages, tests and results make no other program.
# GNOMON_SOURCES: hash of all sources by which a row is measured but those of techniques: contract, kit, device, measuring.
# GNOMON_TECHNIQUE_SOURCES: {"ID", "hash"} of each technique's file and of its folder, where it has one.
# GNOMON_CHANGES: bytes, each with a comma behind it, of what a dirty tree differs by from its commit: `git diff`, new files whole.
set(git ${CMAKE_COMMAND} -E env GIT_OPTIONAL_LOCKS=0 git -C ${SOURCE})
set(built techniques scenes harness bench/suites)
set(described CMakeLists.txt CMakePresets.json)
execute_process(COMMAND ${git} describe --always --abbrev=10 OUTPUT_VARIABLE commit
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
set(changes)
if(failed)
  set(commit unknown)
else()
  execute_process(COMMAND ${git} ls-files --others --exclude-standard -- ${built} OUTPUT_VARIABLE untracked ERROR_QUIET)
  execute_process(COMMAND ${git} diff HEAD --no-color --no-ext-diff -- ${described} ${built} OUTPUT_VARIABLE changes ERROR_QUIET)
  if(NOT "${untracked}${changes}" STREQUAL "")
    string(APPEND commit "-dirty")
    string(REGEX MATCHALL "[^\n]+" untracked "${untracked}")
    foreach(file ${untracked})
      execute_process(COMMAND ${git} diff --no-color --no-ext-diff --no-index -- /dev/null ${file} OUTPUT_VARIABLE new ERROR_QUIET)
      string(APPEND changes "${new}")
    endforeach()
  endif()
endif()
string(LENGTH "${changes}" length)
if(length GREATER 1000000)
  set(changes "The tree differs from its commit by ${length} bytes of text, which are not kept.\n")
endif()
string(HEX "${changes}" changes)
string(REGEX REPLACE "(..)" "0x\\1," changes "${changes}")

# hash_of(RESULT FILE...): of names below the tree and contents, 16 digits.
function(hash_of result)
  set(text)
  list(FILTER ARGN EXCLUDE REGEX "/[.]|~$|__pycache__")  # what editors and Python leave
  foreach(file ${ARGN})
    set(hash)
    if(EXISTS "${file}" AND NOT IS_DIRECTORY "${file}")  # a name with a semicolon falls apart
      file(SHA256 "${file}" hash)
    endif()
    string(REPLACE "${SOURCE}/" "" name "${file}")
    string(APPEND text "${name} ${hash}\n")
  endforeach()
  string(SHA256 hash "${text}")
  string(SUBSTRING ${hash} 0 16 hash)
  set(${result} ${hash} PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE files ${SOURCE}/harness/include/* ${SOURCE}/harness/kit/* ${SOURCE}/harness/device/* ${SOURCE}/harness/measure/*
  ${SOURCE}/harness/python/*.py)
hash_of(sources ${files})
set(techniques)
file(GLOB files ${SOURCE}/techniques/*.cpp)
foreach(file ${files})
  get_filename_component(id ${file} NAME_WE)
  file(GLOB_RECURSE parts ${SOURCE}/techniques/${id}/*)
  hash_of(hash ${file} ${parts})
  string(APPEND techniques "{\"${id}\", \"${hash}\"}, ")
endforeach()

set(text "#define GNOMON_COMMIT \"${commit}\"\n#define GNOMON_SOURCES \"${sources}\"\n")
string(APPEND text "#define GNOMON_TECHNIQUE_SOURCES ${techniques}\n#define GNOMON_CHANGES ${changes}\n")
if(EXISTS ${OUT})
  file(READ ${OUT} old)
endif()
if(NOT "${old}" STREQUAL "${text}")
  file(WRITE ${OUT} "${text}")
endif()
