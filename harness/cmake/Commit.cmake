# Writes gnomon_commit.h when the commit has changed; run at every build. A tree that is not what the commit holds is "-dirty":
# changed files, and new ones that git does not know in the folders from which the build takes every file that it finds.
set(git ${CMAKE_COMMAND} -E env GIT_OPTIONAL_LOCKS=0 git -C ${SOURCE})
execute_process(COMMAND ${git} describe --always --dirty --abbrev=10 OUTPUT_VARIABLE commit
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit unknown)
elseif(NOT commit MATCHES "-dirty$")
  execute_process(COMMAND ${git} ls-files --others --exclude-standard -- techniques scenes harness bench/suites
    OUTPUT_VARIABLE untracked ERROR_QUIET)
  if(untracked)
    string(APPEND commit "-dirty")
  endif()
endif()
set(text "#define GNOMON_COMMIT \"${commit}\"\n")
if(EXISTS ${OUT})
  file(READ ${OUT} old)
endif()
if(NOT "${old}" STREQUAL "${text}")
  file(WRITE ${OUT} "${text}")
endif()
