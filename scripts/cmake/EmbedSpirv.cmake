# Writes one SPIR-V module as a C++ array of words. Called by PalpateShaders.cmake: spirv, source, name,
# header.
file(READ "${spirv}" hex HEX)
# SPIR-V files are little-endian: four bytes make a word.
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${hex}")
string(REGEX REPLACE
  "(0x........,0x........,0x........,0x........,0x........,0x........,0x........,0x........,)" "\\1\n" words
  "${words}")
file(WRITE "${source}"
  "#include \"${header}\"\n\nnamespace palpate::spirv {\nstatic const std::uint32_t ${name}_words[] = {\n${words}};\n"
  "const ShaderCode ${name}{\"${name}\", ${name}_words, sizeof ${name}_words};\n}  // namespace palpate::spirv\n")
