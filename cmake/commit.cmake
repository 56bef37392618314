# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DSOURCE=<folder> -DOUT=<file> -P commit.cmake: writes a header that defines PAMR_COMMIT, the commit of the sources
# ("a1b2c3d", "a1b2c3d with changes", or nothing where it is not known), if that differs from what OUT says. Run at every build,
# since a commit changes no source.
file(STRINGS ${SOURCE}/cmake/archived_commit.txt commit LIMIT_COUNT 1)
if(commit MATCHES "Format") # no archive, so that git knows
  set(commit "")
  execute_process(COMMAND git -c safe.directory=* -C ${SOURCE} rev-parse --show-toplevel
    OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  file(REAL_PATH ${SOURCE} source)
  if(NOT failed AND top STREQUAL source) # not a project that holds these sources
    execute_process(
      COMMAND git -c safe.directory=* --no-optional-locks -C ${SOURCE} describe --always --abbrev=7 --exclude=* "--dirty= with changes"
      OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  endif()
endif()
set(text "// Made by cmake/commit.cmake.\n#define PAMR_COMMIT \"${commit}\"\n")
if(EXISTS ${OUT})
  file(READ ${OUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUT} "${text}")
endif()
