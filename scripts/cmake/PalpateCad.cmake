# palpate_find_cad([REQUIRED|QUIET]): OpenCASCADE's imported targets TK…, OpenCASCADE_FOUND, OpenCASCADE_INCLUDE_DIR
# and, for what 7.8 calls differently, PALPATE_CAD_STEP and PALPATE_CAD_IGES, in the folder that calls. Its targets name what its viewer is linked with (X11, GL,
# fontconfig, …), whose development files its packages don't bring and nobody here needs: its shared libraries
# find theirs by themselves.
macro(palpate_find_cad)
  find_package(OpenCASCADE ${ARGN})
  foreach(library IN LISTS OpenCASCADE_LIBRARIES)
    if(NOT TARGET ${library})   # of a package that is not installed
      continue()
    endif()
    get_target_property(linked ${library} INTERFACE_LINK_LIBRARIES)
    if(linked)
      list(FILTER linked INCLUDE REGEX "^TK")
      set_target_properties(${library} PROPERTIES INTERFACE_LINK_LIBRARIES "${linked}")
    endif()
  endforeach()
  if(TARGET TKDESTEP)
    set(PALPATE_CAD_STEP TKDESTEP)
    set(PALPATE_CAD_IGES TKDEIGES)
  else()
    set(PALPATE_CAD_STEP TKXDESTEP)
    set(PALPATE_CAD_IGES TKXDEIGES)
  endif()
endmacro()
