# `cmake --install BUILD --prefix P` gives the library (find_package(palpate)) and the program;
# `cpack` gives a bundle of the program with its shared libraries inside, for other x86-64 Linux machines;
# `cpack -G DEB` gives a Debian package (PalpateDebian.cmake).
include(CMakePackageConfigHelpers)
include(InstallRequiredSystemLibraries)

set(palpate_libraries)
foreach(name model shaders scene native gpu cpu_ref driver service)
  if(TARGET palpate_${name})
    list(APPEND palpate_libraries palpate_${name})
  endif()
endforeach()

install(TARGETS ${palpate_libraries} EXPORT palpateTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
# The programs that read files for the library and the program; each finds them there.
set(palpate_importers palpate-import)
if(TARGET palpate-import-cad)
  list(APPEND palpate_importers palpate-import-cad)
endif()
foreach(importer ${palpate_importers})
  target_link_options(${importer} PRIVATE -Wl,--disable-new-dtags)
endforeach()
# The latter: a wheel.
set_target_properties(${palpate_importers} PROPERTIES INSTALL_RPATH "$ORIGIN/../../lib/palpate" BUILD_RPATH
  "$ORIGIN/libs")
install(TARGETS ${palpate_importers} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/palpate COMPONENT
  library)
set(PALPATE_IMPORT_PATH "${CMAKE_INSTALL_LIBEXECDIR}/palpate/palpate-import")
install(EXPORT palpateTargets NAMESPACE palpate:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/palpate COMPONENT
  library)

# The public headers keep their folders, so that "model/lattice/pose.h" means the same here and there.
include(PublicHeaders)
palpate_public_headers(palpate_headers)
set(inputs "\"${PROJECT_SOURCE_DIR}/docs/API.md\"")
foreach(header IN LISTS palpate_headers)
  get_filename_component(folder "${header}" DIRECTORY)
  install(FILES "${header}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/palpate/${folder}" COMPONENT library)
  string(APPEND inputs " \\\n  \"${PROJECT_SOURCE_DIR}/${header}\"")
endforeach()
# Their pages: cmake --build BUILD --target api_docs
configure_file("${CMAKE_CURRENT_LIST_DIR}/Doxyfile.in" "${PROJECT_BINARY_DIR}/Doxyfile" @ONLY)
find_program(PALPATE_DOXYGEN doxygen)
mark_as_advanced(PALPATE_DOXYGEN)
if(PALPATE_DOXYGEN)
  add_custom_target(api_docs COMMAND "${PALPATE_DOXYGEN}" "${PROJECT_BINARY_DIR}/Doxyfile" WORKING_DIRECTORY
    "${PROJECT_BINARY_DIR}" VERBATIM)
endif()

configure_package_config_file(scripts/cmake/palpateConfig.cmake.in "${PROJECT_BINARY_DIR}/palpateConfig.cmake"
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/palpate PATH_VARS PALPATE_IMPORT_PATH)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake" COMPATIBILITY
  SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/palpateConfig.cmake" "${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/palpate COMPONENT library)

# The shared library for C: palpate.h stands by itself, so that `#include <palpate.h>` finds it without a
# folder.
install(TARGETS palpate_c LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(FILES service/library/palpate.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
# palpate_write_pkg_config(FILE LIBDIR): from LIBDIR/pkgconfig, in lib or lib/x86_64-linux-gnu, up to the
# prefix, wherever that is moved.
function(palpate_write_pkg_config file PALPATE_PC_LIBDIR)
  file(RELATIVE_PATH PALPATE_PC_UP "/${PALPATE_PC_LIBDIR}" "/")
  configure_file(scripts/cmake/palpate.pc.in "${file}" @ONLY)
endfunction()
palpate_write_pkg_config("${PROJECT_BINARY_DIR}/palpate.pc" ${CMAKE_INSTALL_LIBDIR})
install(FILES "${PROJECT_BINARY_DIR}/palpate.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT
  library)

# Packages whose headers or texts become part of the program.
set(palpate_compiled_in libcli11-dev libglm-dev nlohmann-json3-dev libboost1.74-dev libxxhash-dev)

# palpate_install_manual(COMPONENT): manual pages and completions, which the program writes from its own
# options. A program for another machine can't make them here.
function(palpate_install_manual component)
  if(CMAKE_CROSSCOMPILING)
    return()
  endif()
  set(manual "${PROJECT_BINARY_DIR}/manual")
  if(NOT TARGET palpate_manual)
    add_custom_command(OUTPUT "${manual}/made"
      COMMAND ${CMAKE_COMMAND} -E make_directory "${manual}/completions"
      COMMAND palpate man --out "${manual}/man1"
      COMMAND palpate completions bash > "${manual}/completions/palpate"
      COMMAND palpate completions zsh > "${manual}/completions/_palpate"
      COMMAND palpate completions fish > "${manual}/completions/palpate.fish"
      COMMAND ${CMAKE_COMMAND} -E touch "${manual}/made"
      DEPENDS palpate COMMENT "Writing manual pages and completions" VERBATIM)
    add_custom_target(palpate_manual ALL DEPENDS "${manual}/made")
  endif()
  set(zsh share/zsh/site-functions)
  if(component STREQUAL debian)   # where Debian's zsh looks for what packages bring
    set(zsh share/zsh/vendor-completions)
  endif()
  install(DIRECTORY "${manual}/man1" DESTINATION share/man COMPONENT ${component} OPTIONAL)
  install(FILES "${manual}/completions/palpate" DESTINATION share/bash-completion/completions COMPONENT
    ${component} OPTIONAL)
  install(FILES "${manual}/completions/_palpate" DESTINATION ${zsh} COMPONENT ${component} OPTIONAL)
  install(FILES "${manual}/completions/palpate.fish" DESTINATION share/fish/vendor_completions.d COMPONENT
    ${component} OPTIONAL)
endfunction()

# palpate_install_sbom(COMPONENT FOLDER): the list of what went into the programs, at the versions of this
# machine.
function(palpate_install_sbom component folder)
  set(programs "")
  foreach(program palpate ${palpate_importers})
    string(APPEND programs " \"$<TARGET_FILE:${program}>\"")
  endforeach()
  install(CODE "
    execute_process(COMMAND \"${PROJECT_SOURCE_DIR}/scripts/sbom\" --version ${PROJECT_VERSION}
      --out \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${folder}/sbom.spdx.json\" ${programs} COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
endfunction()

if(TARGET palpate)
  # DT_RPATH, not DT_RUNPATH: it also serves the libraries that our libraries need, which carry no path of
  # their own.
  target_link_options(palpate PRIVATE -Wl,--disable-new-dtags)
  set_target_properties(palpate PROPERTIES INSTALL_RPATH "$ORIGIN/../lib/palpate")
  install(TARGETS palpate RUNTIME_DEPENDENCY_SET palpate_runtime RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
    COMPONENT bundle)
  install(TARGETS ${palpate_importers} RUNTIME_DEPENDENCY_SET palpate_runtime RUNTIME DESTINATION
    libexec/palpate COMPONENT bundle)
  # The C library and the loader belong to the machine; everything else travels, the Vulkan loader too
  # (drivers do not).
  install(RUNTIME_DEPENDENCY_SET palpate_runtime COMPONENT bundle DESTINATION lib/palpate
    PRE_EXCLUDE_REGEXES "^ld-linux" "^libc\\.so" "^libm\\.so" "^libpthread" "^libdl\\.so" "^librt\\.so"
    POST_EXCLUDE_REGEXES "/ld-linux" "/libc\\.so" "/libm\\.so")
  palpate_install_manual(bundle)
  install(DIRECTORY scenes DESTINATION share/palpate COMPONENT bundle)
  install(CODE "
    set(LIBRARIES \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/lib/palpate\")
    set(OUT \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share/palpate/licences\")
    set(ARCHITECTURE \"${CMAKE_LIBRARY_ARCHITECTURE}\")
    set(PACKAGES ${palpate_compiled_in})
    file(MAKE_DIRECTORY \"\${OUT}\")
    include(\"${PROJECT_SOURCE_DIR}/scripts/cmake/CollectLicences.cmake\")" COMPONENT bundle)
  install(FILES README.md LICENSE CHANGELOG.md THIRD_PARTY_NOTICES.md SECURITY.md CITATION.cff
    driver/udev/70-palpate.rules DESTINATION share/palpate COMPONENT bundle)
  if(TARGET equivalence)
    # For a GPU that nobody here has had: asks it for all stored answers, and how fast it is.
    set_target_properties(equivalence PROPERTIES INSTALL_RPATH "$ORIGIN/../../lib/palpate")
    target_link_options(equivalence PRIVATE -Wl,--disable-new-dtags)
    install(TARGETS equivalence RUNTIME_DEPENDENCY_SET palpate_runtime RUNTIME DESTINATION libexec/palpate
      COMPONENT bundle)
    install(FILES tests/equivalence/hashes.json DESTINATION share/palpate COMPONENT bundle)
    install(PROGRAMS scripts/gpu-check DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT bundle)
  endif()
  install(FILES service/deploy/palpate.service service/deploy/nginx.conf DESTINATION share/palpate/deploy
    COMPONENT bundle)
  palpate_install_sbom(bundle share/palpate)
  include(PalpateDebian)
endif()

set(CPACK_GENERATOR TGZ)
set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_SYSTEM_NAME "linux-${CMAKE_SYSTEM_PROCESSOR}")
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL bundle)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_COMPONENT_INCLUDE_TOPLEVEL_DIRECTORY ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PROJECT_CONFIG_FILE "${PROJECT_SOURCE_DIR}/scripts/cmake/CPackGenerator.cmake")
include(CPack)
