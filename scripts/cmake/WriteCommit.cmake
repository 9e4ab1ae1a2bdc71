# Writes the commit that is being built into a header, if it changed. Called by service/CMakeLists.txt:
# SOURCE, OUT.
execute_process(COMMAND git -C "${SOURCE}" describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown")   # no git, or a source tree without its history
endif()
file(CONFIGURE OUTPUT "${OUT}" CONTENT "#define PALPATE_COMMIT \"${commit}\"\n" @ONLY)
