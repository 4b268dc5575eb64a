// No include guard: included once for each group of parameters, with HL_PARAM_LIST naming its list file. Produces, in
// namespace hl, from the list's PARAM_GROUP_BEGIN(group, Struct) and the lines after it:
//
//   enum Type : int32_t { constants };             for each PARAM_ENUM_BEGIN(Type)
//   struct Struct { members with their defaults }; every member 4 bytes (bools and enums are int32_t): the GLSL block's
//   scalar layout std::span<const ParamInfo> groupParamInfos(); ParamView groupView(Struct&);
//
// The pattern, the macros' arguments and a complete example are in README.md beside this file.
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/params/param.h"

#ifndef HL_PARAM_LIST
#error "Set HL_PARAM_LIST to the list file before including declare_group.h"
#endif

namespace hl {

// 1. Enums, as C++ types.
#define PARAM_ENUM_BEGIN(Type) enum Type : int32_t {
#define PARAM_ENUM_VALUE(constant, number, text, help) constant = number,
#define PARAM_ENUM_END(Type) \
  }                          \
  ;
#define PARAM_GROUP_BEGIN(group, Struct)
#define PARAM_INT(name, def, min, max, softMin, softMax, scale, effect, unit, help)
#define PARAM_FLOAT(name, def, min, max, softMin, softMax, scale, effect, unit, help)
#define PARAM_BOOL(name, def, effect, help)
#define PARAM_ENUM(name, Type, def, effect, help)
#define PARAM_GROUP_END(group, Struct)
#include HL_PARAM_LIST
#undef PARAM_ENUM_BEGIN
#undef PARAM_ENUM_VALUE
#undef PARAM_ENUM_END

// 2. An enum's values are numbered by their position: that is what ParamInfo::values relies on.
#define PARAM_ENUM_BEGIN(Type)   \
  namespace param_declarations { \
  inline constexpr int32_t k##Type##Numbers[] = {
#define PARAM_ENUM_VALUE(constant, number, text, help) number,
#define PARAM_ENUM_END(Type)                                                                                          \
  }                                                                                                                   \
  ;                                                                                                                   \
  static_assert(countsUpFromZero(k##Type##Numbers), "The values of " #Type " are not numbered 0, 1, 2 ... in order"); \
  }
#include HL_PARAM_LIST
#undef PARAM_ENUM_BEGIN
#undef PARAM_ENUM_VALUE
#undef PARAM_ENUM_END

// 3. Their names and help.
#define PARAM_ENUM_BEGIN(Type)   \
  namespace param_declarations { \
  inline constexpr EnumValue k##Type##Values[] = {
#define PARAM_ENUM_VALUE(constant, number, text, help) EnumValue{text, help},
#define PARAM_ENUM_END(Type) \
  }                          \
  ;                          \
  }
#include HL_PARAM_LIST
#undef PARAM_ENUM_BEGIN
#undef PARAM_ENUM_VALUE
#undef PARAM_ENUM_END
#undef PARAM_GROUP_BEGIN
#undef PARAM_INT
#undef PARAM_FLOAT
#undef PARAM_BOOL
#undef PARAM_ENUM
#undef PARAM_GROUP_END

#define PARAM_ENUM_BEGIN(Type)
#define PARAM_ENUM_VALUE(constant, number, text, help)
#define PARAM_ENUM_END(Type)

// 4. The struct.
#define PARAM_GROUP_BEGIN(group, Struct) struct Struct {
#define PARAM_INT(name, def, min, max, softMin, softMax, scale, effect, unit, help) int32_t name = def;
#define PARAM_FLOAT(name, def, min, max, softMin, softMax, scale, effect, unit, help) \
  float name = static_cast<float>(def);
#define PARAM_BOOL(name, def, effect, help) int32_t name = def;
#define PARAM_ENUM(name, Type, def, effect, help) int32_t name = def;
#define PARAM_GROUP_END(group, Struct) \
  }                                    \
  ;
#include HL_PARAM_LIST
#undef PARAM_GROUP_BEGIN
#undef PARAM_INT
#undef PARAM_FLOAT
#undef PARAM_BOOL
#undef PARAM_ENUM
#undef PARAM_GROUP_END

// 5. Its table.
#define PARAM_GROUP_BEGIN(group, Struct)           \
  namespace param_declarations::group##_group {    \
    using Values = Struct;                         \
    inline constexpr const char kGroup[] = #group; \
    inline constexpr ParamInfo kInfos[] = {
#define PARAM_INT(name, def, min, max, softMin, softMax, scale, effect, unit, help)                                   \
  ParamInfo{                                                                                                          \
      kGroup, #name, ParamType::Int,        def, min, max, softMin, softMax, ParamScale::scale, Effect::effect, unit, \
      help,   {},    offsetof(Values, name)},
#define PARAM_FLOAT(name, def, min, max, softMin, softMax, scale, effect, unit, help)                                 \
  ParamInfo{                                                                                                          \
      kGroup, #name, ParamType::Float,      def, min, max, softMin, softMax, ParamScale::scale, Effect::effect, unit, \
      help,   {},    offsetof(Values, name)},
#define PARAM_BOOL(name, def, effect, help)                                                                \
  ParamInfo{kGroup, #name, ParamType::Bool,       def, 0, 1, 0, 1, ParamScale::Linear, Effect::effect, "", \
            help,   {},    offsetof(Values, name)},
#define PARAM_ENUM(name, Type, def, effect, help)                \
  ParamInfo{kGroup,                                              \
            #name,                                               \
            ParamType::Enum,                                     \
            def,                                                 \
            0,                                                   \
            static_cast<double>(std::size(k##Type##Values) - 1), \
            0,                                                   \
            static_cast<double>(std::size(k##Type##Values) - 1), \
            ParamScale::Linear,                                  \
            Effect::effect,                                      \
            "",                                                  \
            help,                                                \
            k##Type##Values,                                     \
            offsetof(Values, name)},
#define PARAM_GROUP_END(group, Struct)                                                                        \
  }                                                                                                           \
  ;                                                                                                           \
  static_assert(sizeof(Values) == 4 * std::size(kInfos));                                                     \
  static_assert(rangesMakeSense(kInfos),                                                                      \
                "In " #Struct " a default or a soft range lies outside its range, or a log scale reaches 0"); \
  }                                                                                                           \
  inline std::span<const ParamInfo> group##ParamInfos() { return param_declarations::group##_group::kInfos; } \
  inline ParamView group##View(Struct& values) { return ParamView(group##ParamInfos(), &values); }
#include HL_PARAM_LIST
#undef PARAM_GROUP_BEGIN
#undef PARAM_INT
#undef PARAM_FLOAT
#undef PARAM_BOOL
#undef PARAM_ENUM
#undef PARAM_GROUP_END
#undef PARAM_ENUM_BEGIN
#undef PARAM_ENUM_VALUE
#undef PARAM_ENUM_END

}  // namespace hl

#undef HL_PARAM_LIST
