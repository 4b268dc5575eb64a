#pragma once
// Plain values as bytes and back, for our own files. Little-endian hosts alone, as everything that the engine runs on is.
#include <bit>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace hl {

static_assert(std::endian::native == std::endian::little);

class ByteWriter {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  void text(std::string_view s) { value<uint64_t>(s.size()), bytes_.append(s); }
  template <class T>
  void array(const std::vector<T>& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    value<uint64_t>(v.size());
    bytes_.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T));
  }
  const std::string& bytes() const { return bytes_; }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Throws std::out_of_range past the end, which the caller takes for damage. A count is checked against the bytes that are left, so a wrong
/// one asks for no memory.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  T value() {
    static_assert(std::is_trivially_copyable_v<T>);
    T v;
    std::memcpy(&v, take(sizeof v), sizeof v);
    return v;
  }
  std::string text() {
    const size_t n = count(1);
    return std::string(take(n), n);
  }
  template <class T>
  void array(std::vector<T>& v) {
    const size_t n = count(sizeof(T));
    v.resize(n);
    if (n > 0) std::memcpy(v.data(), take(n * sizeof(T)), n * sizeof(T));
  }
  /// A number of things of at least `size` bytes each.
  size_t count(size_t size) {
    const uint64_t n = value<uint64_t>();
    if (n > bytes_.size() / size) throw std::out_of_range("count");
    return static_cast<size_t>(n);
  }
  bool atEnd() const { return bytes_.empty(); }

 private:
  const char* take(size_t n) {
    if (n > bytes_.size()) throw std::out_of_range("end");
    const char* at = bytes_.data();
    bytes_.remove_prefix(n);
    return at;
  }
  std::string_view bytes_;
};

}  // namespace hl
