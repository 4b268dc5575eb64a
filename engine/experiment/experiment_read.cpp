// Experiments from JSON. Strict: a key that is passed over would change what is measured, so a newer version is refused.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/experiment/bundle.h"
#include "engine/experiment/experiment.h"
#include "engine/experiment/json_reader.h"
#include "engine/experiment/open_target.h"
#include "engine/experiment/parameter_json.h"
#include "engine/experiment/preset_names.h"
#include "engine/experiment/preset_parameters.h"
#include "engine/metrics/metrics.h"
#include "engine/scene/animation.h"
#include "engine/techniques/technique.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kKeys = {"version",    "base",    "permute",         "seeds",       "metrics",
                                        "references", "stop",    "repeats",         "path_tracer", "images",
                                        "amortise_frames", "limit_ms", "targets", "target_error", "compare_with"};
const std::vector<std::string> kPlainAxes = {"technique", "camera", "resolution", kStartAxis};

class ExperimentReader {
 public:
  ExperimentReader(Experiment& e, const fs::path& file) : e_(e), file_(file) {}

  void read(const JsonReader& root) {
    known(root, kKeys);
    readBase(root.at("base"));
    if (root.has("permute")) readPermute(root.at("permute"));
    e_.seeds = {e_.base.seed};
    if (root.has("seeds")) readSeeds(root.at("seeds"));
    if (root.has("metrics")) readMetrics(root.at("metrics"));
    if (root.has("references")) readReferences(root.at("references"));
    if (root.has("targets")) readTargets(root.at("targets"));
    if (root.has("compare_with")) readComparison(root.at("compare_with"));
    if (root.has("target_error")) e_.targetError = static_cast<double>(root.at("target_error").number(0, 1e9f));
    if (root.has("stop")) readStop(root.at("stop"));
    if (root.has("limit_ms")) e_.limitMs = static_cast<double>(root.at("limit_ms").number(0, 1e9f));
    if (root.has("repeats")) e_.repeats = static_cast<int>(root.at("repeats").whole(1, 1000));
    if (root.has("amortise_frames")) e_.amortiseFrames = static_cast<int>(root.at("amortise_frames").whole(1, 1'000'000));
    if (root.has("path_tracer")) e_.pathTracer = root.at("path_tracer").boolean();
    if (root.has("images")) e_.images = root.at("images").boolean();
  }

 private:
  static void known(const JsonReader& object, const std::vector<std::string>& keys) {
    for (const std::string& key : object.unknownKeys(keys)) {
      const std::string near = nearest(key, keys);
      throw object.refused(fmt::format("unknown key \"{}\"; {}", key,
                                       near.empty() ? fmt::format("there are {}", fmt::join(keys, ", ")) : fmt::format("did you mean \"{}\"?", near)));
    }
  }

  void readBase(const JsonReader& node) {
    if (node.isObject()) {
      e_.base = presetFromJson(node.json().dump(), fmt::format("{}: base", file_.string()));
      e_.base.file = file_;  // which a scene's relative path is relative to
    } else {
      if (!node.isText()) throw node.refused("the name or path of a preset, or a preset in place, is wanted, not " + node.found());
      e_.base = namedBase(node);
    }
    e_.warnings = e_.base.warnings;
    e_.base.warnings.clear();
  }

  /// A path is looked for beside the experiment, then where the program's own presets are.
  Preset namedBase(const JsonReader& node) const {
    const std::string name = node.text();
    const std::string extension = fs::path(name).extension().string();
    if (extension == ".json" || extension == kBundleExtension) {
      for (const fs::path& at : {file_.parent_path() / name, homeFolder() / name})
        if (fs::exists(at)) return extension == kBundleExtension ? openBundle(at) : loadPreset(at);
      throw node.refused(fmt::format("there is no preset {} beside the experiment, nor in {}", name, homeFolder().string()));
    }
    std::vector<std::string> names;
    for (const PresetListing& listing : listPresets()) {
      if (listing.id == name) return loadPreset(listing.file);
      names.push_back(listing.id);
    }
    const std::string near = nearest(name, names);
    throw node.refused(fmt::format("there is no preset \"{}\"; {}", name,
                                   near.empty() ? "a path ends in .json or .hlb" : fmt::format("did you mean \"{}\"?", near)));
  }

  void readPermute(const JsonReader& node) {
    if (node.isObject()) {
      e_.permute.push_back(permutation(node));
      return;
    }
    for (const JsonReader& part : node.elements("an object, or an array of objects whose combinations are added up,")) e_.permute.push_back(permutation(part));
    if (e_.permute.empty()) throw node.refused("an array of at least one object is wanted; without \"permute\" the base runs as it is");
  }

  Permutation permutation(const JsonReader& node) const {
    node.wantObject();
    std::vector<std::string> techniques = {e_.base.technique};
    if (node.has("technique")) techniques = techniqueAxis(node.at("technique"));
    Permutation out;
    for (const auto& member : node.json().items()) {
      const JsonReader values = node.at(member.key());
      PermuteAxis axis{member.key(), {}};
      if (axis.key == "technique")
        axis.values = techniques;
      else if (axis.key == "camera")
        for (const JsonReader& v : listOf(values)) axis.values.push_back(v.text());
      else if (axis.key == "resolution")
        axis.values = resolutions(values);
      else if (axis.key == kStartAxis)
        for (const JsonReader& v : listOf(values)) axis.values.push_back(shortestText(v.number(0, kLongestAnimation)));
      else
        axis.values = parameterAxis(values, parameter(node, axis.key, techniques));
      withoutDoubles(axis.values);
      out.push_back(std::move(axis));
    }
    return out;
  }

  /// One value counts as a list of one.
  static std::vector<JsonReader> listOf(const JsonReader& node) {
    if (!node.json().is_array()) return {node};
    auto out = node.elements("a list");
    if (out.empty()) throw node.refused("a list of at least one value is wanted");
    if (out.size() > static_cast<size_t>(kMaxAxisValues)) throw node.refused(fmt::format("{} values; {} at most", out.size(), kMaxAxisValues));
    return out;
  }

  static std::vector<std::string> techniqueAxis(const JsonReader& node) {
    std::vector<std::string> out;
    for (const JsonReader& v : listOf(node)) {
      try {
        techniqueInfo(v.text());
      } catch (const Error& e) {
        throw v.refused(e.what());
      }
      out.push_back(v.text());
    }
    return out;
  }

  static std::vector<std::string> resolutions(const JsonReader& node) {
    const nlohmann::json& json = node.json();
    const bool onePair = json.is_array() && !json.empty() && json.front().is_number();
    std::vector<std::string> out;
    for (const JsonReader& pair : onePair ? std::vector<JsonReader>{node} : listOf(node)) {
      const auto sides = pair.elements("[width, height], or a list of such,");
      if (sides.size() != 2) throw pair.refused(fmt::format("[width, height] is wanted, not an array of {}", sides.size()));
      out.push_back(fmt::format("{}x{}", sides[0].whole(1, kMaxPresetSide), sides[1].whole(1, kMaxPresetSide)));
    }
    return out;
  }

  static const ParamInfo& parameter(const JsonReader& node, const std::string& key, const std::vector<std::string>& techniques) {
    std::vector<std::string> near = kPlainAxes;
    for (const std::string& technique : techniques) {
      const auto groups = parameterGroups(technique);
      if (const ParamInfo* p = findParameter(groups, key)) return *p;
      for (const auto& group : groups)
        for (const ParamInfo& p : group) near.push_back(p.key());
    }
    if (key == "seed" || key == "seeds") throw node.refused("seeds are not permuted: they go under \"seeds\", so that the spread over them is known");
    const std::string guess = nearest(key, near);
    throw node.refused(fmt::format("unknown parameter \"{}\" of technique {}{}", key, fmt::join(techniques, ", "),
                                   guess.empty() ? "; also technique, camera, resolution and animation.start can be permuted" : fmt::format("; did you mean \"{}\"?", guess)));
  }

  static std::vector<std::string> parameterAxis(const JsonReader& node, const ParamInfo& info) {
    std::vector<std::string> out;
    if (!node.isObject()) {
      for (const JsonReader& v : listOf(node)) out.push_back(parameterText(v, info));
      return out;
    }
    if (info.type != ParamType::Int && info.type != ParamType::Float)
      throw node.refused(fmt::format("{} has no range: a list of its values is wanted", info.key()));
    known(node, {"from", "to", "count", "log"});
    parameterText(node.at("from"), info), parameterText(node.at("to"), info);
    const double from = node.at("from").json().get<double>(), to = node.at("to").json().get<double>();
    const int64_t count = node.at("count").whole(2, kMaxAxisValues);
    const bool log = node.has("log") && node.at("log").boolean();
    if (!(from < to)) throw node.refused("\"from\" must be less than \"to\"");
    if (log && !(from > 0)) throw node.at("from").refused("a logarithmic range begins above 0");
    for (int64_t i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(count - 1);
      double v = log ? from * std::pow(to / from, t) : from + (to - from) * t;
      if (i == 0) v = from;
      if (i == count - 1) v = to;
      out.push_back(info.type == ParamType::Int ? fmt::format("{}", std::llround(v)) : shortestText(static_cast<float>(v)));
    }
    return out;
  }

  static void withoutDoubles(std::vector<std::string>& values) {
    std::vector<std::string> out;
    for (const std::string& v : values)
      if (std::find(out.begin(), out.end(), v) == out.end()) out.push_back(v);
    values = std::move(out);
  }

  void readSeeds(const JsonReader& node) {
    constexpr int64_t kMost = 0xffffffffLL;
    e_.seeds.clear();
    if (node.isObject()) {
      known(node, {"from", "count"});
      const int64_t from = node.at("from").whole(0, kMost), count = node.at("count").whole(1, kMaxAxisValues);
      if (from + count - 1 > kMost) throw node.refused("the last seed would be above 4294967295");
      for (int64_t i = 0; i < count; ++i) e_.seeds.push_back(static_cast<uint32_t>(from + i));
      return;
    }
    for (const JsonReader& v : listOf(node)) {
      const auto seed = static_cast<uint32_t>(v.whole(0, kMost));
      if (std::find(e_.seeds.begin(), e_.seeds.end(), seed) != e_.seeds.end())
        throw v.refused(fmt::format("seed {} stands twice: it would count as two independent ones", seed));
      e_.seeds.push_back(seed);
    }
  }

  void readMetrics(const JsonReader& node) {
    e_.metrics.clear();
    for (const JsonReader& v : listOf(node)) e_.metrics.push_back(v.text());
    withoutDoubles(e_.metrics);
    try {
      checkMetrics(e_.metrics);
    } catch (const Error& e) {
      throw node.refused(e.what());
    }
  }

  void readReferences(const JsonReader& node) {
    e_.references.clear();
    for (const JsonReader& v : listOf(node)) {
      if (v.text() != "matched" && v.text() != "full") throw v.refused("\"matched\" or \"full\" is wanted, not " + v.found());
      e_.references.push_back(v.text());
    }
    withoutDoubles(e_.references);
  }

  /// Values that one run has, so written like what is varied, and each single.
  void readComparison(const JsonReader& node) {
    for (const PermuteAxis& axis : permutation(node)) {
      const JsonReader at = node.at(axis.key);
      if (axis.values.size() != 1) throw at.refused(fmt::format("one value is wanted, not {}: it names one run", axis.values.size()));
      if (axis.key == "camera" || axis.key == "resolution" || axis.key == kStartAxis) throw at.refused("runs of different pictures cannot be compared pixel by pixel");
      e_.compareWith.emplace_back(axis.key, axis.values.front());
    }
  }

  void readTargets(const JsonReader& node) {
    e_.targets.clear();
    for (const JsonReader& v : listOf(node)) {
      if (v.text() != "image" && v.text() != "lightmap") throw v.refused("\"image\" or \"lightmap\" is wanted, not " + v.found());
      e_.targets.push_back(v.text());
    }
    withoutDoubles(e_.targets);
  }

  void readStop(const JsonReader& node) {
    known(node, {"settled", "frames", "ms"});
    if (node.json().size() != 1) throw node.refused("one of settled, frames and ms is wanted");
    if (node.has("settled")) {
      if (!node.at("settled").boolean()) throw node.at("settled").refused("true is wanted; or another rule, frames or ms, in its place");
    } else if (node.has("frames")) {
      e_.stop = {StopRule::Kind::Frames, static_cast<double>(node.at("frames").whole(1, 1'000'000))};
    } else {
      const float ms = node.at("ms").number(0, 1e8f);
      if (!(ms > 0)) throw node.at("ms").refused("more than 0 is wanted");
      e_.stop = {StopRule::Kind::Milliseconds, static_cast<double>(ms)};
    }
  }

  Experiment& e_;
  fs::path file_;
};

}  // namespace

Experiment experimentFromJson(const std::string& text, const fs::path& file) {
  const nlohmann::json document = parseStrictJson(text, file.string());
  const JsonReader root(document, file.string());
  root.wantObject();
  if (root.has("scene") && !root.has("base")) throw root.refused("this is a preset; an experiment has a \"base\" and what is varied about it");
  const int64_t version = root.at("version").whole(1, 1'000'000);
  if (version > kExperimentVersion)
    throw root.at("version").refused(fmt::format("version {} is newer than this program's ({})", version, kExperimentVersion));
  Experiment e;
  e.file = file;
  ExperimentReader(e, file).read(root);
  counterpartsOf(e, configurationsOf(e));  // not too many, each of them a preset, and what they are compared with among them
  return e;
}

}  // namespace hl
