#pragma once
// A parameter is declared once, in a list file (params.inl) that C++ and GLSL include; everything else is derived from
// these tables.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hl {

enum class ParamType { Bool, Int, Float, Enum };
enum class ParamScale { Linear, Log };
/// What a change costs: shown next frame; histories start again; allocation or precomputation starts again. Ordered by
/// strength.
enum class Effect { Live, Reset, Rebuild };

struct EnumValue {
  std::string_view name, help;
};

/// bool and enum values are int32_t (an enum's value is its position in `values`).
using ParamValue = std::variant<int32_t, float>;

struct ParamInfo {
  std::string_view group, name;  ///< key = group.name
  ParamType type = ParamType::Float;
  double def = 0, min = 0, max = 0, softMin = 0, softMax = 0;
  ParamScale scale = ParamScale::Linear;
  Effect effect = Effect::Live;
  std::string_view unit, help;
  std::span<const EnumValue> values;  ///< enums only
  uint32_t offset = 0;  ///< in the group's struct, which is the GLSL block's scalar layout (every member 4 bytes)
  std::string key() const { return std::string(group) + "." + std::string(name); }
};

/// What declare_group.h checks at compile time of every list file.
namespace param_declarations {
constexpr bool countsUpFromZero(std::span<const int32_t> numbers) {
  for (size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] != static_cast<int32_t>(i)) return false;
  return true;
}
constexpr bool rangesMakeSense(std::span<const ParamInfo> infos) {
  for (const ParamInfo& p : infos) {
    if (!(p.min <= p.def && p.def <= p.max && p.min <= p.softMin && p.softMin <= p.softMax && p.softMax <= p.max))
      return false;
    if (p.scale == ParamScale::Log && !(p.softMin > 0)) return false;  // a log slider cannot start at 0
  }
  return true;
}
}  // namespace param_declarations

/// A group's values with their declarations. Does not own the values.
class ParamView {
 public:
  ParamView() = default;
  ParamView(std::span<const ParamInfo> infos, void* data) : infos_(infos), data_(data) {}
  std::span<const ParamInfo> infos() const { return infos_; }
  ParamValue get(const ParamInfo&) const;
  /// @throws Error(BadInput) naming key, value and range.
  void set(const ParamInfo&, ParamValue);
  void reset();
  bool isDefault(const ParamInfo&) const;
  const void* data() const { return data_; }

 private:
  std::span<const ParamInfo> infos_;
  void* data_ = nullptr;
};

ParamValue defaultValue(const ParamInfo&);
/// "[1, 4096] rays", for messages and tables.
std::string rangeText(const ParamInfo&);
/// Text as in `--set` and in the panel ("0.5", "true", "low_discrepancy"). @throws Error(BadInput) naming key, value,
/// and range or values.
ParamValue parseParam(const ParamInfo&, std::string_view text);
std::string formatParam(const ParamInfo&, ParamValue);

/// All groups of a session (technique, lightmap, direct, reference ...), by key.
class ParamSet {
 public:
  void add(ParamView);
  struct Found {
    ParamView* view;
    const ParamInfo* info;
  };
  /// @throws Error(BadInput) naming the nearest known key.
  Found find(std::string_view key);
  bool contains(std::string_view key) const;
  std::vector<ParamView>& views() { return views_; }
  const std::vector<ParamView>& views() const { return views_; }

 private:
  std::vector<ParamView> views_;
};

}  // namespace hl
