#include "engine/core/hash.h"

#include <xxhash.h>

#include <new>

namespace hl {

namespace {

XXH3_state_t* stateOf(void* state) { return static_cast<XXH3_state_t*>(state); }

std::string hexOf(XXH128_hash_t hash) {
  XXH128_canonical_t bytes;
  XXH128_canonicalFromHash(&bytes, hash);
  std::string text;
  text.reserve(2 * sizeof bytes.digest);
  for (unsigned char byte : bytes.digest) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

}  // namespace

Hasher::Hasher() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(stateOf(state_));
}

Hasher::~Hasher() { XXH3_freeState(stateOf(state_)); }

Hasher& Hasher::bytes(const void* data, size_t size) {
  if (size > 0) XXH3_128bits_update(stateOf(state_), data, size);
  return *this;
}

Hasher& Hasher::text(std::string_view s) {
  value<uint64_t>(s.size());
  return bytes(s.data(), s.size());
}

std::string Hasher::hex() const { return hexOf(XXH3_128bits_digest(stateOf(state_))); }

std::string hashOf(std::string_view bytes) { return hexOf(XXH3_128bits(bytes.data(), bytes.size())); }

}  // namespace hl
