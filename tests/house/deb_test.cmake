# Packs the Debian package and looks at what is in it: files, dependencies, scripts. Then its programs run
# from where it was unpacked, in an empty environment.
function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "failed (${code}): ${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${WORK_DIR}")
file(MAKE_DIRECTORY "${WORK_DIR}")
must(${CPACK} -G DEB --config "${BUILD_DIR}/CPackConfig.cmake" -B "${WORK_DIR}")
file(GLOB package "${WORK_DIR}/*.deb")
if(NOT package MATCHES "/palpate_[0-9.]+_[a-z0-9]+\\.deb$")
  message(FATAL_ERROR "not one package by Debian's rule: '${package}'")
endif()

set(libdir usr/lib/${ARCHITECTURE})
# Files: these, and nothing outside their folders; all are root's, none is anyone's to write, none sets an
# identity.
must(dpkg-deb --contents "${package}")
set(listing "${output}")
foreach(file usr/bin/palpate usr/libexec/palpate/palpate-import usr/share/man/man1/palpate.1.gz
  usr/share/man/man1/palpate-run.1.gz usr/share/bash-completion/completions/palpate
    usr/share/zsh/vendor-completions/_palpate usr/share/fish/vendor_completions.d/palpate.fish
    usr/lib/systemd/system/palpate.service usr/lib/udev/rules.d/70-palpate.rules
    usr/share/palpate/scenes/contacts.json usr/share/doc/palpate/copyright usr/share/doc/palpate/changelog.gz
    usr/share/doc/palpate/THIRD_PARTY_NOTICES.md
    usr/share/doc/palpate/sbom.spdx.json usr/share/doc/palpate/licences/libcli11-dev usr/include/palpate.h
    ${libdir}/libpalpate.so.0 ${libdir}/pkgconfig/palpate.pc
    usr/lib/python3/dist-packages/palpate/scene.py usr/lib/python3/dist-packages/palpate/py.typed
    usr/bin/palpate-sweep)
  if(NOT listing MATCHES " \\./${file}( -> [^\n]*)?\n")
    message(FATAL_ERROR "missing from the package: ${file}\n${listing}")
  endif()
endforeach()
if(CAD AND NOT listing MATCHES " \\./usr/libexec/palpate/palpate-import-cad\n")
  message(FATAL_ERROR "missing from the package: palpate-import-cad")
endif()
string(REGEX REPLACE "\n$" "" listing "${listing}")
string(REPLACE "\n" ";" listing "${listing}")
foreach(line IN LISTS listing)
  if(NOT line MATCHES "^[-dl][rwxsS-]+ root/root .* \\./(usr/(bin|libexec|lib|share)?.*)?$")
    message(FATAL_ERROR "where a package of this kind has nothing, or not root's: ${line}")
  elseif(NOT line MATCHES "^l" AND line MATCHES "^.....w|^........w|^...[sS]|^......[sS]")
    message(FATAL_ERROR "others may write it, or it sets an identity: ${line}")
  elseif(line MATCHES "/lib/palpate|\\.(so|a|h)(\\.|$)|cmake|__pycache__" AND NOT line MATCHES
    "/include/palpate\\.h$|/${ARCHITECTURE}/libpalpate\\.so")
    message(FATAL_ERROR "belongs to the bundle or to the C++ libraries: ${line}")
  endif()
endforeach()

# Dependencies: what the programs are linked with, by package; no compiler, no header, and drivers recommended
# only.
foreach(field Package Version Architecture Depends Recommends Description Installed-Size)
  must(dpkg-deb --field "${package}" ${field})
  string(STRIP "${output}" ${field})
  if("${${field}}" STREQUAL "")
    message(FATAL_ERROR "the package has no ${field}")
  endif()
endforeach()
foreach(name libc6 libvulkan1 libembree3 libfmt9 libssl3 libusb-1.0-0 libassimp5 lib3mf1)
  if(NOT ", ${Depends}" MATCHES ", ${name}")
    message(FATAL_ERROR "depends not on ${name}: ${Depends}")
  endif()
endforeach()
if(Depends MATCHES "-dev|mesa|g\\+\\+|cmake|python" OR NOT Recommends MATCHES
  "mesa-vulkan-drivers \\| vulkan-icd")
  message(FATAL_ERROR "depends: ${Depends}\nrecommends: ${Recommends}")
endif()
must(dpkg-deb --control "${package}" "${WORK_DIR}/control")
foreach(script postinst prerm postrm)
  must(sh -n "${WORK_DIR}/control/${script}")
endforeach()

must(dpkg-deb --extract "${package}" "${WORK_DIR}/root")
set(root "${WORK_DIR}/root/usr")
must(python3 "${CMAKE_CURRENT_LIST_DIR}/sbom_judge.py" "${root}/share/doc/palpate/sbom.spdx.json"
  "${SOURCE_DIR}" "${root}/bin/palpate" "${root}/libexec/palpate/palpate-import")
file(GLOB programs "${root}/bin/palpate" "${root}/libexec/palpate/*"
  "${root}/lib/${ARCHITECTURE}/libpalpate.so.0")
foreach(program IN LISTS programs)
  must(readelf -d "${program}")
  if(output MATCHES "RPATH|RUNPATH")
    message(FATAL_ERROR "${program} looks for libraries in a folder of its own")
  endif()
  must(readelf -S "${program}")
  if(output MATCHES "\\.debug_info|\\.symtab")
    message(FATAL_ERROR "${program} is not stripped")
  endif()
endforeach()
must(env -i "${root}/bin/palpate" --version)
must(env -i "${root}/bin/palpate" query "${root}/share/palpate/scenes/contacts.json" --backend cpu --pose
  "0 0 0 0 0 0 1")
file(WRITE "${WORK_DIR}/triangle.off" "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
must(env -i "${root}/bin/palpate" info "${WORK_DIR}/triangle.off")
file(WRITE "${WORK_DIR}/upright.off" "OFF\n3 1 0\n0 0 -1\n0 0 1\n0.1 0.1 1\n3 0 1 2\n")
file(WRITE "${WORK_DIR}/triangle.json"
  "{\"static\": [{\"mesh\": \"triangle.off\"}], \"tool\": {\"mesh\": \"upright.off\"}}")

# A C program built with what the package brings, and Python, which finds the package's library itself.
set(loader "LD_LIBRARY_PATH=${root}/lib/${ARCHITECTURE}")
must(env "PKG_CONFIG_PATH=${root}/lib/${ARCHITECTURE}/pkgconfig" pkg-config --cflags --libs palpate)
separate_arguments(flags UNIX_COMMAND "${output}")
must(${CXX} -x c -std=c11 "${SOURCE_DIR}/docs/examples/c/nearest.c" -o "${WORK_DIR}/nearest" ${flags})
must(env -i ${loader} "${WORK_DIR}/nearest" "${root}/share/palpate/scenes/contacts.json" 0.3)
must(env -i "PYTHONPATH=${root}/lib/python3/dist-packages" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c "
import palpate
scene = palpate.Scene('${WORK_DIR}/triangle.json')
assert scene.touches([[0.2, 0.2, 0, 0, 0, 0, 1], [0, 0, 9, 0, 0, 0, 1]]).tolist() == [True, False]
assert palpate.__file__.startswith('${root}'), palpate.__file__")
must(env -i "PYTHONPATH=${root}/lib/python3/dist-packages" PYTHONDONTWRITEBYTECODE=1
  "${root}/bin/palpate-sweep" --help)
