# Writes one shader's SPIR-V modules as C++ arrays of words. Called by PalpateShaders.cmake: spirv, texels,
# source, name, header. `texels` is left out where it is the same.
function(words_of file out)
  file(READ "${file}" hex HEX)
  # SPIR-V files are little-endian: four bytes make a word.
  string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${hex}")
  string(REGEX REPLACE
    "(0x........,0x........,0x........,0x........,0x........,0x........,0x........,0x........,)" "\\1\n" words
    "${words}")
  set(${out} "${words}" PARENT_SCOPE)
endfunction()

words_of("${spirv}" plain)
words_of("${texels}" with_texels)
set(arrays "static const std::uint32_t ${name}_words[] = {\n${plain}};\n")
set(members "\"${name}\", ${name}_words, sizeof ${name}_words")
if(NOT plain STREQUAL with_texels)
  string(APPEND arrays "static const std::uint32_t ${name}_texels[] = {\n${with_texels}};\n")
  string(APPEND members ", ${name}_texels, sizeof ${name}_texels")
endif()
file(WRITE "${source}"
  "#include \"${header}\"\n\nnamespace palpate::spirv {\n${arrays}const ShaderCode ${name}{${members}};\n}  // namespace palpate::spirv\n")
