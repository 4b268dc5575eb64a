#pragma once
// Content hashes (128-bit XXH3), for cache keys, provenance and image identity.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace hl {

class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;
  Hasher& bytes(const void* data, size_t size);
  Hasher& text(std::string_view s);  ///< length first, so that neighbours cannot run together
  template <class T>
  Hasher& value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    return bytes(&v, sizeof v);
  }
  template <class T>
  Hasher& array(std::span<const T> v) {
    static_assert(std::is_trivially_copyable_v<T>);
    value<uint64_t>(v.size());
    return bytes(v.data(), v.size_bytes());
  }
  template <class T>
  Hasher& array(const std::vector<T>& v) { return array(std::span<const T>(v)); }
  std::string hex() const;  ///< 32 hexadecimal digits

 private:
  void* state_;
};

std::string hashOf(std::string_view bytes);

}  // namespace hl
