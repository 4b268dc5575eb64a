// `list`: what there is, as a table or as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "app/cli_commands.h"
#include "engine/core/json_writer.h"
#include "engine/core/error.h"
#include "engine/experiment/experiment.h"
#include "engine/params/groups.h"
#include "engine/scene/scene_file.h"
#include "engine/techniques/technique.h"

namespace hl::cli {
namespace {

/// A row of the list: `id` and `label` first, then what the kind has besides. A text, a truth value or a ready piece of
/// JSON.
struct Json {
  std::string text;
};
struct Field {
  std::string name;
  std::variant<std::string, bool, Json> value;
};
using Row = std::vector<Field>;

std::vector<Row> techniqueRows() {
  std::vector<Row> rows;
  for (const TechniqueInfo& t : techniqueInfos())
    rows.push_back({{"id", std::string(t.id)}, {"label", std::string(t.label)}, {"summary", std::string(t.summary)}});
  return rows;
}

std::vector<Row> sceneRows() {
  std::vector<Row> rows;
  for (const SceneListing& s : listScenes())
    rows.push_back({{"id", s.id},
                    {"label", s.label},
                    {"file", s.file.string()},
                    {"available", s.available},
                    {"missing", s.missing}});
  return rows;
}

std::vector<Row> presetRows() {
  std::vector<Row> rows;
  for (const PresetListing& p : listPresets())
    rows.push_back({{"id", p.id}, {"label", p.label}, {"file", p.file.string()}});
  return rows;
}

std::vector<Row> experimentRows() {
  std::vector<Row> rows;
  for (const PresetListing& p : listExperiments())
    rows.push_back({{"id", p.id}, {"label", p.label}, {"file", p.file.string()}});
  return rows;
}

Json jsonOf(const ParamInfo& p, ParamValue v) {
  JsonWriter w;
  if (p.type == ParamType::Enum)
    w.text(formatParam(p, v));
  else
    w.raw(formatParam(p, v));
  return {w.str()};
}

Json limitOf(const ParamInfo& p, double v) {
  return {p.type == ParamType::Float ? fmt::format("{}", static_cast<float>(v))
                                     : fmt::format("{}", static_cast<int64_t>(v))};
}

const char* typeName(ParamType t) {
  switch (t) {
    case ParamType::Bool:
      return "bool";
    case ParamType::Int:
      return "int";
    case ParamType::Float:
      return "float";
    case ParamType::Enum:
      return "enum";
  }
  return "";
}

const char* effectName(Effect e) { return e == Effect::Live ? "live" : e == Effect::Reset ? "reset" : "rebuild"; }

Row paramRow(const ParamInfo& p) {
  std::string label(p.name);
  std::replace(label.begin(), label.end(), '_', ' ');
  Row row = {{"id", p.key()},
             {"label", label},
             {"type", std::string(typeName(p.type))},
             {"default", jsonOf(p, defaultValue(p))}};
  if (p.type == ParamType::Enum) {
    JsonWriter values;
    values.beginArray();
    for (const EnumValue& v : p.values) values.text(v.name);
    row.push_back({"values", Json{values.endArray().str()}});
  } else if (p.type != ParamType::Bool) {
    row.push_back({"min", limitOf(p, p.min)});
    row.push_back({"max", limitOf(p, p.max)});
    row.push_back({"soft_min", limitOf(p, p.softMin)});
    row.push_back({"soft_max", limitOf(p, p.softMax)});
    row.push_back({"scale", std::string(p.scale == ParamScale::Log ? "log" : "linear")});
  }
  row.push_back({"unit", std::string(p.unit)});
  row.push_back({"effect", std::string(effectName(p.effect))});
  row.push_back({"help", std::string(p.help)});
  return row;
}

std::vector<Row> paramRows() {
  std::vector<Row> rows;
  for (const TechniqueInfo& t : techniqueInfos())
    for (const ParamInfo& p : t.create()->params().infos()) rows.push_back(paramRow(p));
  for (const auto& group : sharedParamGroups())
    for (const ParamInfo& p : group) rows.push_back(paramRow(p));
  return rows;
}

std::vector<Row> metricRows() {
  std::vector<Row> rows;
  for (const MetricInfo& m : metricInfos())
    rows.push_back({{"id", std::string(m.id)}, {"label", std::string(m.label)}, {"formula", std::string(m.formula)}});
  return rows;
}

std::vector<Row> deviceRows() {
  std::vector<Row> rows;
  for (const DeviceInfo& d : listDevices())
    rows.push_back({{"id", fmt::format("{}", rows.size())},
                    {"label", d.name},
                    {"type", d.type},
                    {"driver", d.driver},
                    {"api", d.api},
                    {"usable", d.missing.empty()},
                    {"missing", d.missing}});
  return rows;
}

struct Kind {
  const char* name;
  std::vector<Row> (*rows)();
};
constexpr Kind kKinds[] = {{"techniques", techniqueRows}, {"scenes", sceneRows},   {"presets", presetRows},
                           {"experiments", experimentRows},
                           {"params", paramRows},         {"metrics", metricRows}, {"devices", deviceRows}};

std::string asJson(const std::vector<Row>& rows) {
  JsonWriter w;
  w.beginArray();
  for (const Row& row : rows) {
    w.beginObject();
    for (const Field& f : row) {
      w.key(f.name);
      if (const auto* text = std::get_if<std::string>(&f.value))
        w.text(*text);
      else if (const auto* truth = std::get_if<bool>(&f.value))
        w.boolean(*truth);
      else
        w.raw(std::get<Json>(f.value).text);
    }
    w.endObject();
  }
  return w.endArray().str() + "\n";
}

std::string asTable(const std::vector<Row>& rows) {
  size_t widest = 0;
  for (const Row& row : rows) widest = std::max(widest, std::get<std::string>(row[0].value).size());
  std::string out;
  for (const Row& row : rows) {
    out += fmt::format("{:<{}}  {}", std::get<std::string>(row[0].value), widest, std::get<std::string>(row[1].value));
    for (const Field& f : row) {
      const auto* text = std::get_if<std::string>(&f.value);
      if (f.name == "default") out += fmt::format(" = {}", std::get<Json>(f.value).text);
      if (f.name == "missing" && text && !text->empty()) out += fmt::format("  (missing: {})", *text);
      if ((f.name == "summary" || f.name == "formula" || f.name == "driver") && text) out += fmt::format("  {}", *text);
    }
    out += '\n';
  }
  return out;
}

}  // namespace

const std::vector<std::string>& listKinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Kind& k : kKinds) out.emplace_back(k.name);
    return out;
  }();
  return names;
}

int list(const GlobalOptions& global, const std::string& what) {
  for (const Kind& k : kKinds) {
    if (what != k.name) continue;
    const std::vector<Row> rows = k.rows();
    print(global.json ? asJson(rows) : asTable(rows));
    return 0;
  }
  const std::string near = nearest(what, listKinds());
  throw badInput(fmt::format("list {}: there are {}{}", what, fmt::join(listKinds(), ", "),
                             near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

}  // namespace hl::cli
