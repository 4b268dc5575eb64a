#include "engine/params/param.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>

#include "engine/core/error.h"
#include "engine/params/groups.h"

namespace hl {
namespace {

/// Shortest text that reads back as the same number.
template <class T>
std::string shortest(T v) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, v);
  return std::string(text, end.ptr);
}

}  // namespace

/// Ranges are declared as double literals of what are mostly float values: 0.001 and not 0.0010000000474974513.
std::string rangeText(const ParamInfo& p) {
  const bool whole = p.type == ParamType::Int;
  const auto number = [&](double v) {
    return whole ? shortest(static_cast<int64_t>(v)) : shortest(static_cast<float>(v));
  };
  const std::string unit = p.unit.empty() ? "" : fmt::format(" {}", p.unit);
  return fmt::format("[{}, {}]{}", number(p.min), number(p.max), unit);
}

namespace {

std::vector<std::string> valueNames(const ParamInfo& p) {
  std::vector<std::string> names;
  for (const EnumValue& v : p.values) names.emplace_back(v.name);
  return names;
}

Error refused(const ParamInfo& p, const std::string& value, const std::string& why) {
  return badInput(fmt::format("{} = {}: {}", p.key(), value, why));
}

void checkRange(const ParamInfo& p, double v, const std::string& text) {
  // A float parameter's limits are compared as floats: 0.1f is slightly more than 0.1.
  const bool real = p.type == ParamType::Float;
  const double low = real ? static_cast<double>(static_cast<float>(p.min)) : p.min;
  const double high = real ? static_cast<double>(static_cast<float>(p.max)) : p.max;
  if (v < low || v > high) throw refused(p, text, fmt::format("out of range {}", rangeText(p)));
}

template <class T>
bool parseWhole(std::string_view text, T& v) {
  const auto end = std::from_chars(text.data(), text.data() + text.size(), v);
  return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

}  // namespace

ParamValue ParamView::get(const ParamInfo& p) const {
  const char* at = static_cast<const char*>(data_) + p.offset;
  if (p.type == ParamType::Float) {
    float v;
    std::memcpy(&v, at, sizeof v);
    return v;
  }
  int32_t v;
  std::memcpy(&v, at, sizeof v);
  return v;
}

void ParamView::set(const ParamInfo& p, ParamValue value) {
  char* at = static_cast<char*>(data_) + p.offset;
  if (p.type == ParamType::Float) {
    const float* v = std::get_if<float>(&value);
    const float real = v ? *v : static_cast<float>(std::get<int32_t>(value));
    if (!std::isfinite(real))
      throw refused(p, shortest(real), fmt::format("not a finite number; the range is {}", rangeText(p)));
    checkRange(p, real, shortest(real));
    std::memcpy(at, &real, sizeof real);
    return;
  }
  const int32_t* v = std::get_if<int32_t>(&value);
  if (!v) throw refused(p, shortest(std::get<float>(value)), "a whole number is wanted");
  if (p.type == ParamType::Enum && (*v < 0 || *v >= static_cast<int32_t>(p.values.size())))
    throw refused(p, shortest(*v),
                  fmt::format("not the number of one of its values: {}", fmt::join(valueNames(p), ", ")));
  checkRange(p, *v, shortest(*v));
  std::memcpy(at, v, sizeof *v);
}

ParamValue defaultValue(const ParamInfo& p) {
  if (p.type == ParamType::Float) return static_cast<float>(p.def);
  return static_cast<int32_t>(p.def);
}

bool ParamView::isDefault(const ParamInfo& p) const { return get(p) == defaultValue(p); }

void ParamView::reset() {
  for (const ParamInfo& p : infos_) set(p, defaultValue(p));
}

ParamValue parseParam(const ParamInfo& p, std::string_view text) {
  const std::string shown = text.empty() ? "\"\"" : std::string(text);
  switch (p.type) {
    case ParamType::Bool:
      if (text == "true" || text == "on" || text == "1") return int32_t{1};
      if (text == "false" || text == "off" || text == "0") return int32_t{0};
      throw refused(p, shown, "true or false is wanted");
    case ParamType::Int: {
      int64_t v = 0;
      if (!parseWhole(text, v))
        throw refused(p, shown, fmt::format("not a whole number; the range is {}", rangeText(p)));
      checkRange(p, static_cast<double>(v), shown);
      return static_cast<int32_t>(v);
    }
    case ParamType::Float: {
      float v = 0;
      if (!parseWhole(text, v)) throw refused(p, shown, fmt::format("not a number; the range is {}", rangeText(p)));
      if (!std::isfinite(v)) throw refused(p, shown, fmt::format("not a finite number; the range is {}", rangeText(p)));
      checkRange(p, v, shown);
      return v;
    }
    case ParamType::Enum:
      break;
  }
  for (size_t i = 0; i < p.values.size(); ++i)
    if (p.values[i].name == text) return static_cast<int32_t>(i);
  const std::vector<std::string> names = valueNames(p);
  const std::string near = nearest(std::string(text), names);
  throw refused(p, shown,
                fmt::format("not one of {}{}", fmt::join(names, ", "),
                            near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

std::string formatParam(const ParamInfo& p, ParamValue value) {
  switch (p.type) {
    case ParamType::Bool:
      return std::get<int32_t>(value) ? "true" : "false";
    case ParamType::Int:
      return shortest(std::get<int32_t>(value));
    case ParamType::Float:
      return shortest(std::get<float>(value));
    case ParamType::Enum:
      break;
  }
  return std::string(p.values[static_cast<size_t>(std::get<int32_t>(value))].name);
}

void ParamSet::add(ParamView view) { views_.push_back(view); }

ParamSet::Found ParamSet::find(std::string_view key) {
  std::vector<std::string> known;
  for (ParamView& view : views_)
    for (const ParamInfo& p : view.infos()) {
      known.push_back(p.key());
      if (known.back() == key) return {&view, &p};
    }
  const std::string near = nearest(std::string(key), known);
  throw badInput(fmt::format("unknown parameter \"{}\"; {}", key,
                             near.empty() ? std::string("`halflight-cli list params` shows them all")
                                          : fmt::format("did you mean {}?", near)));
}

bool ParamSet::contains(std::string_view key) const {
  for (const ParamView& view : views_)
    for (const ParamInfo& p : view.infos())
      if (p.key() == key) return true;
  return false;
}

std::vector<std::span<const ParamInfo>> sharedParamGroups() {
  return {lightmapParamInfos(), probesParamInfos(), directParamInfos(), referenceParamInfos()};
}

}  // namespace hl
