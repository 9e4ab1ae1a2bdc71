#include "model/cache/content_key.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "model/files/own_file.h"

namespace palpate {

struct KeyBuilder::State {
  alignas(64) XXH3_state_t xxh;
};

std::string ContentKey::hex() const { return fmt::format("{:016x}{:016x}", high, low); }

KeyBuilder::KeyBuilder() : state_(std::make_unique<State>()) { XXH3_128bits_reset(&state_->xxh); }
KeyBuilder::~KeyBuilder() = default;

void KeyBuilder::bytes(const void* data, std::size_t size) {
  if (size > 0) XXH3_128bits_update(&state_->xxh, data, size);
}

bool KeyBuilder::file(const std::string& path) {
  // Read, not mapped: a file that somebody shortens meanwhile must not end the program.
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(path.c_str(), "rbe"), &std::fclose);
  if (!in) return false;
  std::array<char, 1 << 16> block;
  std::uint64_t size = 0;
  while (const std::size_t n = std::fread(block.data(), 1, block.size(), in.get())) {
    bytes(block.data(), n);
    size += n;
  }
  value(size);
  return std::ferror(in.get()) == 0;
}

ContentKey KeyBuilder::finish() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(&state_->xxh);
  return {hash.high64, hash.low64};
}

const ContentKey& program_key() {
  static const ContentKey key = [] {
    KeyBuilder builder;
    return builder.file(own_file()) ? builder.finish() : ContentKey{};
  }();
  return key;
}

}  // namespace palpate
