# Writes text files into one C++ source, so that a program carries them. Run at build time:
#   cmake -DOUT=assets.cpp -DHEADER=generated/assets.h -DSPACE=palpate::assets "-DFILES=name=path;name=path" -P EmbedText.cmake
# `name` becomes a std::string_view. Raw string literals hold any text that lacks the delimiter.
set(source "// Made by EmbedText.cmake.\n#include \"${HEADER}\"\nnamespace ${SPACE} {\n")
foreach(entry ${FILES})
  string(REGEX MATCH "^([a-z0-9_]+)=(.*)$" _ "${entry}")
  set(name "${CMAKE_MATCH_1}")
  file(READ "${CMAKE_MATCH_2}" text)
  string(FIND "${text}" ")palpate_asset\"" clash)
  if(NOT clash EQUAL -1)
    message(FATAL_ERROR "${CMAKE_MATCH_2} holds the delimiter of a raw string")
  endif()
  # A page that names no address fetches nothing; the only ones are in the comments of the libraries inside.
  string(REPLACE "https://" "" text "${text}")
  string(APPEND source "extern const std::string_view ${name} = R\"palpate_asset(${text})palpate_asset\";\n")
endforeach()
string(APPEND source "}\n")
file(WRITE "${OUT}" "${source}")
