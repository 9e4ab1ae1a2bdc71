# `cpack -G DEB` gives palpate_VERSION_ARCHITECTURE.deb. Its libraries are Debian's own packages, which
# dpkg-shlibdeps finds; nothing of the bundle's lib/palpate is in it. Included by PalpateInstall.cmake.
install(TARGETS palpate RUNTIME DESTINATION bin COMPONENT debian)
install(TARGETS ${palpate_importers} RUNTIME DESTINATION libexec/palpate COMPONENT debian)
install(DIRECTORY scenes DESTINATION share/palpate COMPONENT debian)
install(FILES service/deploy/palpate.service DESTINATION lib/systemd/system COMPONENT debian)
install(FILES driver/udev/70-palpate.rules DESTINATION lib/udev/rules.d COMPONENT debian)
install(FILES service/deploy/nginx.conf DESTINATION share/doc/palpate/examples COMPONENT debian)
install(FILES README.md SECURITY.md CITATION.cff THIRD_PARTY_NOTICES.md scripts/debian/copyright DESTINATION
  share/doc/palpate COMPONENT debian)
install(FILES CHANGELOG.md DESTINATION share/doc/palpate RENAME changelog COMPONENT debian)
# The library for C, and Python's package over it.
set(palpate_deb_libdir "lib/${CMAKE_LIBRARY_ARCHITECTURE}")
install(TARGETS palpate_c LIBRARY DESTINATION ${palpate_deb_libdir} COMPONENT debian)
install(FILES service/library/palpate.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT debian)
palpate_write_pkg_config("${PROJECT_BINARY_DIR}/debian/palpate.pc" ${palpate_deb_libdir})
install(FILES "${PROJECT_BINARY_DIR}/debian/palpate.pc" DESTINATION ${palpate_deb_libdir}/pkgconfig COMPONENT
  debian)
install(DIRECTORY service/python/palpate DESTINATION lib/python3/dist-packages COMPONENT debian PATTERN
  __pycache__ EXCLUDE)
install(PROGRAMS scripts/debian/palpate-sweep DESTINATION bin COMPONENT debian)
palpate_install_manual(debian)
install(CODE "
  set(PREFIX \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
  # The path to a bundle's own libraries: here there are none.
  foreach(program bin/palpate ${palpate_deb_libdir}/$<TARGET_FILE_NAME:palpate_c> ${palpate_importers})
    if(NOT program MATCHES \"/\")
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
# Only who uses Python needs it; sweeps need Dask, drawings matplotlib.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "python3-numpy, python3-distributed, python3-zarr, python3-matplotlib")
# The first line is the project's description.
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "palpate finds where a tool touches a mock-up of triangles, exactly, works out
the force and torque that a hand should feel, and keeps a 1 kHz haptic device
fed with them. It answers at the command line, over HTTP, in C and in Python,
on a GPU through Vulkan or in native code.")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/scripts/debian/postinst"
  "${PROJECT_SOURCE_DIR}/scripts/debian/prerm" "${PROJECT_SOURCE_DIR}/scripts/debian/postrm"
  "${PROJECT_SOURCE_DIR}/scripts/debian/triggers")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
