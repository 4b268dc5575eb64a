#include "ui/sweep_draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <regex>

#include "engine/core/error.h"
#include "engine/core/json_writer.h"
#include "engine/experiment/preset_parameters.h"
#include "engine/sweep/run_record.h"

namespace hl::ui {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWhere = "draft";  // the file's name in messages, taken off again
constexpr const char* kBlanks = " \t\n\r";

std::string trimmed(const std::string& text) {
  const size_t from = text.find_first_not_of(kBlanks);
  return from == std::string::npos ? std::string() : text.substr(from, text.find_last_not_of(kBlanks) - from + 1);
}

/// Empty parts between two separators stay, so that the reader says what is wrong with them.
std::vector<std::string> split(const std::string& text, bool atBlanks) {
  std::vector<std::string> out;
  if (trimmed(text).empty()) return out;
  std::string part;
  const auto finish = [&](bool evenEmpty) {
    if (evenEmpty || !trimmed(part).empty()) out.push_back(trimmed(part));
    part.clear();
  };
  for (const char c : text) {
    if (c == ',' || c == ';')
      finish(true);
    else if (atBlanks && std::string_view(kBlanks).find(c) != std::string_view::npos && !trimmed(part).empty())
      finish(false);
    else
      part += c;
  }
  finish(false);
  return out;
}

/// A JSON number as it was typed; anything else as text, which the reader refuses in its own words.
void writeNumber(JsonWriter& w, const std::string& text) {
  static const std::regex number(R"(-?(0|[1-9][0-9]*)(\.[0-9]+)?([eE][+-]?[0-9]+)?)");
  if (std::regex_match(text, number))
    w.raw(text);
  else
    w.text(text);
}

void writeResolution(JsonWriter& w, const std::string& text) {
  static const std::regex sides(R"(([0-9]{1,9}) *[xX*] *([0-9]{1,9}))");
  std::smatch m;
  if (!std::regex_match(text, m, sides)) {
    w.text(text);
    return;
  }
  w.beginArray().whole(std::stol(m[1])).whole(std::stol(m[2])).endArray();
}

void writeValue(JsonWriter& w, const ParamInfo* info, const std::string& key, const std::string& text) {
  if (key == "resolution") return writeResolution(w, text);
  if (info && info->type == ParamType::Bool && (text == "true" || text == "false")) {
    w.boolean(text == "true");
  } else if (info && (info->type == ParamType::Int || info->type == ParamType::Float)) {
    writeNumber(w, text);
  } else {
    w.text(text);
  }
}

bool isNumeric(const ParamInfo* info) { return info && (info->type == ParamType::Int || info->type == ParamType::Float); }

void writeAxis(JsonWriter& w, const SweepDraft& d, size_t set, const DraftAxis& axis) {
  const ParamInfo* info = declarationOf(d, set, axis.key);
  w.key(axis.key);
  if (axis.range) {
    w.beginObject().key("from"), writeNumber(w, trimmed(axis.from)), w.key("to"), writeNumber(w, trimmed(axis.to));
    w.member("count", axis.count).member("log", axis.log).endObject();
    return;
  }
  std::vector<std::string> values;
  // "640 x 360" is one resolution.
  std::string text = axis.values;
  if (axis.key == "resolution") text = std::regex_replace(text, std::regex(R"( *([xX*]) *)"), "$1");
  w.beginArray();
  for (const std::string& value : split(text, isNumeric(info) || axis.key == "resolution")) writeValue(w, info, axis.key, value);
  w.endArray();
}

void writeSeeds(JsonWriter& w, const std::string& text) {
  static const std::regex range(R"(\s*([0-9]{1,10})\s*(\.\.|-)\s*([0-9]{1,10})\s*)");
  std::smatch m;
  if (std::regex_match(text, m, range)) {
    w.beginObject().member("from", std::stoll(m[1])).member("count", std::stoll(m[3]) - std::stoll(m[1]) + 1).endObject();
    return;
  }
  w.beginArray();
  for (const std::string& seed : split(text, true)) writeNumber(w, seed);
  w.endArray();
}

std::string number(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v);
  return std::string(text, end.ptr);
}

std::string joined(const std::vector<std::string>& parts) { return fmt::format("{}", fmt::join(parts, ", ")); }

std::string seedsText(const std::vector<uint32_t>& seeds) {
  bool run = seeds.size() > 2;
  for (size_t i = 1; i < seeds.size(); ++i) run &= seeds[i] == seeds[i - 1] + 1;
  return run ? fmt::format("{}..{}", seeds.front(), seeds.back()) : fmt::format("{}", fmt::join(seeds, ", "));
}

/// "draft: permute[0].\"radiosity.samples\"[2]: 5000 is ..." to its field and what is said of it.
DraftProblem problemOf(const std::string& what) {
  const std::string start = std::string(kWhere) + ": ";
  DraftProblem out;
  out.message = what.rfind(start, 0) == 0 ? what.substr(start.size()) : what;
  std::smatch m;
  static const std::regex axis(R"re(permute\[([0-9]+)\]\.("([^"]*)"|[A-Za-z_]+)(\[[0-9]+\])*\.?([a-z]*): (.*))re");
  static const std::regex unknown(R"re(permute\[([0-9]+)\]: (unknown parameter "([^"]*)".*))re");
  static const std::regex other(R"re(([a-z_]+)(\[[0-9]+\])?(\.[^:]*)?: (.*))re");
  if (std::regex_match(out.message, m, axis)) {
    const std::string key = m[3].matched ? m[3].str() : m[2].str();
    const std::string part = m[5].str(), said = m[6].str();
    out = {{"axis", static_cast<size_t>(std::stoul(m[1])), key}, part.empty() ? said : part + ": " + said};
  } else if (std::regex_match(out.message, m, unknown)) {
    out = {{"axis", static_cast<size_t>(std::stoul(m[1])), m[3].str()}, m[2].str()};
  } else if (std::regex_match(out.message, m, other)) {
    static const std::vector<std::string> fields = {"base", "seeds", "metrics", "references", "stop", "limit_ms", "repeats", "amortise_frames", "targets", "target_error"};
    if (std::find(fields.begin(), fields.end(), m[1].str()) != fields.end()) out = {{m[1].str(), 0, {}}, m[4].str()};
  }
  return out;
}

}  // namespace

std::vector<std::string> techniquesOf(const SweepDraft& d, size_t set) {
  if (set < d.permute.size())
    for (const DraftAxis& axis : d.permute[set])
      if (axis.key == "technique") {
        const std::vector<std::string> chosen = split(axis.values, false);
        if (!chosen.empty()) return chosen;
      }
  return {d.base.technique};
}

const ParamInfo* declarationOf(const SweepDraft& d, size_t set, const std::string& key) {
  for (const std::string& technique : techniquesOf(d, set)) {
    try {
      if (const ParamInfo* info = findParameter(parameterGroups(technique), key)) return info;
    } catch (const Error&) {
      // an unknown technique: the reader says so where it stands
    }
  }
  return nullptr;
}

std::string draftJson(const SweepDraft& d) {
  JsonWriter w;
  w.beginObject().member("version", kExperimentVersion).key("base").raw(presetJson(d.base));
  const bool varied = std::any_of(d.permute.begin(), d.permute.end(), [](const auto& set) { return !set.empty(); });
  if (varied) {
    w.key("permute").beginArray();
    for (size_t set = 0; set < d.permute.size(); ++set) {
      w.beginObject();
      for (const DraftAxis& axis : d.permute[set]) writeAxis(w, d, set, axis);
      w.endObject();
    }
    w.endArray();
  }
  w.key("seeds"), writeSeeds(w, d.seeds);
  w.key("metrics").beginArray();
  for (const std::string& metric : split(d.metrics, true)) w.text(metric);
  w.endArray().key("references").beginArray();
  if (d.matched) w.text("matched");
  if (d.full) w.text("full");
  w.endArray().key("stop").beginObject();
  if (d.stop.kind == StopRule::Kind::Settled) w.member("settled", true);
  if (d.stop.kind == StopRule::Kind::Frames) w.member("frames", std::llround(d.stop.amount));
  if (d.stop.kind == StopRule::Kind::Milliseconds) w.key("ms").raw(number(d.stop.amount));
  w.endObject().key("limit_ms").raw(number(d.limitMs)).member("repeats", d.repeats).member("amortise_frames", d.amortiseFrames);
  w.key("targets").beginArray().text("image");
  if (d.lightmap) w.text("lightmap");
  w.endArray().key("compare_with").beginObject();
  for (const auto& [key, value] : d.compareWith) w.key(key), writeValue(w, declarationOf(d, 0, key), key, value);
  w.endObject().key("target_error").raw(number(d.targetError));
  w.member("path_tracer", d.pathTracer).member("images", d.images);
  return w.endObject().str() + "\n";
}

SweepDraft draftOf(const Experiment& e) {
  SweepDraft d;
  d.base = e.base;
  d.permute.clear();
  for (const Permutation& axes : e.permute) {
    d.permute.emplace_back();
    for (const PermuteAxis& axis : axes) {
      DraftAxis typed;
      typed.key = axis.key, typed.values = joined(axis.values);
      d.permute.back().push_back(typed);
    }
  }
  if (d.permute.empty()) d.permute.emplace_back();
  d.seeds = seedsText(e.seeds), d.metrics = joined(e.metrics);
  d.matched = std::find(e.references.begin(), e.references.end(), "matched") != e.references.end();
  d.full = std::find(e.references.begin(), e.references.end(), "full") != e.references.end();
  d.stop = e.stop, d.limitMs = e.limitMs, d.repeats = e.repeats, d.amortiseFrames = e.amortiseFrames;
  d.pathTracer = e.pathTracer, d.images = e.images;
  d.lightmap = std::find(e.targets.begin(), e.targets.end(), "lightmap") != e.targets.end();
  d.targetError = e.targetError, d.compareWith = e.compareWith;
  return d;
}

DraftCheck checkDraft(const SweepDraft& d, const fs::path& folder) {
  DraftCheck out;
  try {
    Experiment e = experimentFromJson(draftJson(d), kWhere);
    e.base.file = d.base.file;  // which a scene's relative path is relative to
    e.file.clear();
    const std::vector<Configuration> configurations = configurationsOf(e);
    const std::vector<PlannedRun> plan = planOf(e, configurations);
    out.configurations = configurations.size(), out.runs = plan.size();
    if (folder.empty()) {
      out.problem = DraftProblem{{"folder", 0, {}}, "a folder for the results is wanted"};
      return out;
    }
    std::error_code none;
    if (fs::exists(folder, none) && !fs::is_directory(folder, none)) {
      out.problem = DraftProblem{{"folder", 0, {}}, fmt::format("{}: this is a file; a folder for the results is wanted", folder.string())};
      return out;
    }
    if (fs::is_directory(folder / "runs", none))
      for (const PlannedRun& run : plan) out.present += fs::exists(folder / "runs" / (run.key + ".json"), none) ? 1 : 0;
    out.experiment = std::move(e);
  } catch (const Error& error) {
    out.problem = problemOf(error.what());
  } catch (const std::exception& error) {
    out.problem = DraftProblem{{}, error.what()};
  }
  return out;
}

}  // namespace hl::ui
