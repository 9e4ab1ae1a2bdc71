# `cpack -G DEB` gives palpate_VERSION_ARCHITECTURE.deb. Its libraries are Debian's own packages, which dpkg-shlibdeps finds; nothing of the bundle's
# lib/palpate is in it. Included by PalpateInstall.cmake.
install(TARGETS palpate RUNTIME DESTINATION bin COMPONENT debian)
install(TARGETS ${palpate_importers} RUNTIME DESTINATION libexec/palpate COMPONENT debian)
install(DIRECTORY scenes DESTINATION share/palpate COMPONENT debian)
install(FILES service/deploy/palpate.service DESTINATION lib/systemd/system COMPONENT debian)
install(FILES driver/udev/70-palpate.rules DESTINATION lib/udev/rules.d COMPONENT debian)
install(FILES service/deploy/nginx.conf DESTINATION share/doc/palpate/examples COMPONENT debian)
install(FILES README.md SECURITY.md CITATION.cff THIRD_PARTY_NOTICES.md scripts/debian/copyright DESTINATION share/doc/palpate COMPONENT debian)
install(FILES CHANGELOG.md DESTINATION share/doc/palpate RENAME changelog COMPONENT debian)
palpate_install_manual(debian)
install(CODE "
  set(PREFIX \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
  # The path to a bundle's own libraries: here there are none.
  foreach(program bin/palpate ${palpate_importers})
    if(NOT program STREQUAL \"bin/palpate\")
      set(program \"libexec/palpate/\${program}\")
    endif()
    file(RPATH_REMOVE FILE \"\${PREFIX}/\${program}\")
  endforeach()
  set(LIBRARIES \"\")
  set(OUT \"\${PREFIX}/share/doc/palpate/licences\")
  set(PACKAGES ${palpate_compiled_in})
  include(\"${PROJECT_SOURCE_DIR}/scripts/cmake/CollectLicences.cmake\")
  # As Debian wants them: without a time, so that the same sources give the same bytes.
  file(GLOB texts \"\${PREFIX}/share/man/man1/*.1\" \"\${PREFIX}/share/doc/palpate/changelog\")
  execute_process(COMMAND gzip -9nf \${texts} COMMAND_ERROR_IS_FATAL ANY)" COMPONENT debian)
palpate_install_sbom(debian share/doc/palpate)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The palpate authors <palpate@localhost>")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Without a Vulkan driver `--backend cpu` and `ref` answer all the same.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "mesa-vulkan-drivers | vulkan-icd")
# The first line is the project's description.
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "palpate finds where a tool touches a mock-up of triangles, exactly, works out
the force and torque that a hand should feel, and keeps a 1 kHz haptic device
fed with them. It answers at the command line and over HTTP, on a GPU through
Vulkan or in native code.")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/scripts/debian/postinst" "${PROJECT_SOURCE_DIR}/scripts/debian/prerm" "${PROJECT_SOURCE_DIR}/scripts/debian/postrm")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
