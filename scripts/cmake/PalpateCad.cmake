# palpate_find_cad([REQUIRED|QUIET]): OpenCASCADE's imported targets TK…, OpenCASCADE_FOUND and
# OpenCASCADE_INCLUDE_DIR, in the folder that calls. Its targets name what its viewer is linked with (X11, GL,
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
endmacro()
