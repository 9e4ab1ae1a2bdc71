// A tool triangle as it was loaded. The including shader declares TEXELS tool_records: ToolRecord, three
// texels each.
#ifndef PALPATE_LIB_TOOL_RECORD
#define PALPATE_LIB_TOOL_RECORD
struct RecordCorners {
  ivec3 a, b, c;               // tool lattice frame
  uint32_t id;
};

RecordCorners record_at(uint32_t place) {
  const uvec4 a = tool_records(3u * place), b = tool_records(3u * place + 1u), c = tool_records(3u * place + 2u);
  return RecordCorners(ivec3(a.xyz), ivec3(b.xyz), ivec3(c.xyz), a.w);
}

uint32_t record_id(uint32_t place) { return tool_records(3u * place).w; }
uint32_t record_flags(uint32_t place) { return tool_records(3u * place + 1u).w; }
#endif
