# Writes OUTPUT from INPUT with the git state of ROOT; "unknown" outside a checkout. Untouched when nothing changed.
set(SOURCE_STATE "unknown")
if(GIT)
  execute_process(COMMAND ${GIT} describe --always --dirty --tags WORKING_DIRECTORY ${ROOT} OUTPUT_VARIABLE state
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(SOURCE_STATE "${state}")
  endif()
endif()
configure_file(${INPUT} ${OUTPUT} @ONLY)
