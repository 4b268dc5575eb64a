#pragma once
// JSON as text, in the order in which it is written. A number that JSON cannot hold (NaN, infinity) becomes null.
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace hl {

class JsonWriter {
 public:
  JsonWriter& beginObject() { return open('{'); }
  JsonWriter& endObject() { return close('}'); }
  JsonWriter& beginArray() { return open('['); }
  JsonWriter& endArray() { return close(']'); }
  JsonWriter& key(std::string_view);
  JsonWriter& text(std::string_view);
  JsonWriter& number(double);
  JsonWriter& whole(int64_t);
  JsonWriter& boolean(bool);
  JsonWriter& null();
  JsonWriter& raw(std::string_view json);  ///< a value that is JSON already; line ends after it are dropped

  template <class T>
  JsonWriter& member(std::string_view name, const T& value) {
    key(name);
    if constexpr (std::is_same_v<T, bool>)
      return boolean(value);
    else if constexpr (std::is_floating_point_v<T>)
      return number(static_cast<double>(value));
    else if constexpr (std::is_integral_v<T>)
      return whole(static_cast<int64_t>(value));
    else
      return text(value);
  }
  const std::string& str() const { return out_; }

 private:
  JsonWriter& open(char);
  JsonWriter& close(char);
  void before();
  void line();

  std::string out_;
  std::vector<bool> filled_;  ///< of each open object or array: whether it has an element
  bool afterKey_ = false;
};

}  // namespace hl
