// A tool triangle as it was loaded. The including shader declares uint64_t tool_records[]: ToolRecord, six
// words of 64 bits each.
#ifndef PALPATE_LIB_TOOL_RECORD
#define PALPATE_LIB_TOOL_RECORD
struct RecordCorners {
  ivec3 a, b, c;               // tool lattice frame
  uint32_t id;
};

// Two words at a time: llvmpipe's loads cost by number, not by width.
RecordCorners record_at(uint32_t place) {
  const uint64_t r0 = tool_records[6u * place], r1 = tool_records[6u * place + 1u],
                 r2 = tool_records[6u * place + 2u], r3 = tool_records[6u * place + 3u],
                 r4 = tool_records[6u * place + 4u], r5 = tool_records[6u * place + 5u];
  return RecordCorners(ivec3(int32_t(r0), int32_t(r0 >> 32), int32_t(r1)),
                       ivec3(int32_t(r2), int32_t(r2 >> 32), int32_t(r3)),
                       ivec3(int32_t(r4), int32_t(r4 >> 32), int32_t(r5)), uint32_t(r1 >> 32));
}
#endif
