// Which configurations an experiment is made of, and where experiments are kept.
#include "engine/experiment/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/experiment/bundle.h"
#include "engine/experiment/json_reader.h"
#include "engine/experiment/preset_parameters.h"
#include "engine/techniques/technique.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

void setResolution(Preset& preset, const std::string& text) {
  const size_t x = text.find('x');
  const auto side = [](std::string_view part) {
    int v = 0;
    std::from_chars(part.data(), part.data() + part.size(), v);
    return v;
  };
  preset.width = side(std::string_view(text).substr(0, x));
  preset.height = side(std::string_view(text).substr(x + 1));
}

bool appliesTo(const PermuteAxis& axis, const std::string& technique) {
  if (axis.key.find('.') == std::string::npos || axis.key == kStartAxis) return true;
  return findParameter(parameterGroups(technique), axis.key) != nullptr;
}

void apply(Configuration& c, const PermuteAxis& axis, const std::string& value) {
  if (axis.key == "technique")
    changeTechnique(c.preset, value);
  else if (axis.key == "camera")
    c.preset.cameraName = value, c.preset.camera.reset();
  else if (axis.key == "resolution")
    setResolution(c.preset, value);
  else if (axis.key == kStartAxis)
    c.preset.animation.start = std::stof(value);
  else
    c.preset.parameters[axis.key] = value;
  c.values.emplace_back(axis.key, value);
}

/// The technique comes first, whatever its place: which of the others apply depends on it.
std::vector<Configuration> combinations(const Preset& base, const Permutation& axes) {
  std::vector<Configuration> out = {{base, {}}};
  const auto vary = [&](const PermuteAxis& axis) {
    std::vector<Configuration> next;
    for (const Configuration& c : out) {
      if (!appliesTo(axis, c.preset.technique)) {
        next.push_back(c);
        continue;
      }
      for (const std::string& value : axis.values) {
        next.push_back(c);
        apply(next.back(), axis, value);
      }
    }
    out = std::move(next);
  };
  for (const PermuteAxis& axis : axes)
    if (axis.key == "technique") vary(axis);
  for (const PermuteAxis& axis : axes)
    if (axis.key != "technique") vary(axis);
  return out;
}

}  // namespace

std::string Configuration::label() const {
  std::string out;
  for (const auto& [key, value] : values) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", key, value);
  return out.empty() ? preset.technique : out;
}

std::vector<Configuration> configurationsOf(const Experiment& e) {
  // Counted before anything is made: three axes of a thousand values are a billion presets.
  double runs = 0;
  for (const Permutation& axes : e.permute) {
    double product = 1;
    for (const PermuteAxis& axis : axes) product *= static_cast<double>(axis.values.size());
    runs += product;
  }
  if (e.permute.empty()) runs = 1;
  const double configurations = runs;
  runs *= static_cast<double>(e.seeds.size()) * e.repeats;
  if (runs > static_cast<double>(kMaxRuns))
    throw badInput(fmt::format("{}: {} configurations x {} seeds x {} repeats are {} runs; {} at most: fewer values, or several experiments",
                               e.file.string(), configurations, e.seeds.size(), e.repeats, runs, kMaxRuns));
  std::vector<Configuration> out;
  std::set<std::string> known;
  const auto add = [&](const Permutation& axes) {
    for (Configuration& c : combinations(e.base, axes))
      if (known.insert(presetHash(c.preset)).second) out.push_back(std::move(c));
  };
  if (e.permute.empty()) add({});
  for (const Permutation& axes : e.permute) add(axes);
  return out;
}

std::vector<size_t> counterpartsOf(const Experiment& e, const std::vector<Configuration>& configurations) {
  std::vector<size_t> out(configurations.size());
  for (size_t i = 0; i < out.size(); ++i) out[i] = i;
  if (e.compareWith.empty()) return out;
  std::map<std::string, size_t> places;
  for (size_t i = 0; i < configurations.size(); ++i) places.emplace(presetHash(configurations[i].preset), i);
  for (size_t i = 0; i < configurations.size(); ++i) {
    Configuration other = configurations[i];
    std::string wanted;
    // The technique first: what follows is read as its own.
    for (const bool technique : {true, false})
      for (const auto& [key, value] : e.compareWith) {
        const PermuteAxis axis{key, {value}};
        if ((key == "technique") == technique && appliesTo(axis, other.preset.technique)) apply(other, axis, value);
      }
    for (const auto& [key, value] : e.compareWith) {
      wanted += fmt::format("{}{} {}", wanted.empty() ? "" : ", ", key, value);
    }
    const auto found = places.find(presetHash(other.preset));
    if (found == places.end())
      throw badInput(fmt::format("{}: /compare_with: none of the runs is like \"{}\" with {}: \"permute\" must make it", e.file.string(), configurations[i].label(), wanted));
    out[i] = found->second;
  }
  return out;
}

void changeTechnique(Preset& preset, const std::string& technique) {
  techniqueInfo(technique);
  if (technique == preset.technique) return;
  const std::string own = preset.technique + ".";
  std::erase_if(preset.parameters, [&](const auto& p) { return p.first.starts_with(own); });
  preset.technique = technique;
}

Experiment loadExperiment(const fs::path& file) { return experimentFromJson(readFile(file), file); }

void saveExperiment(const Experiment& e, const fs::path& file) { writeFileAtomically(file, experimentJson(e)); }

std::vector<PresetListing> listExperiments() {
  std::vector<PresetListing> out;
  const fs::path folder = homeFolder() / "presets" / "experiments";
  if (!fs::is_directory(folder)) return out;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    PresetListing listing;
    listing.id = entry.path().stem().string();
    listing.file = entry.path();
    try {
      const Experiment e = loadExperiment(entry.path());
      listing.label = fmt::format("{} configurations of {}, {} seeds", configurationsOf(e).size(), e.base.scene, e.seeds.size());
    } catch (const Error& e) {
      listing.label = fmt::format("cannot be read: {}", e.what());
    }
    out.push_back(listing);
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return out;
}

bool isExperiment(const std::string& nameOrPath) {
  try {
    if (isBundleFile(nameOrPath)) return bundleKind(nameOrPath) == BundleKind::Experiment;
    if (fs::path(nameOrPath).extension() == ".json" && fs::is_regular_file(nameOrPath)) {
      const nlohmann::json document = parseStrictJson(readFile(nameOrPath), nameOrPath);
      return document.is_object() && document.contains("base");
    }
  } catch (const Error&) {
    return false;  // whoever opens it says what is wrong
  }
  const auto named = [&](const std::vector<PresetListing>& list) {
    return std::any_of(list.begin(), list.end(), [&](const PresetListing& l) { return l.id == nameOrPath; });
  };
  return fs::path(nameOrPath).extension().empty() && !named(listPresets()) && named(listExperiments());
}

Experiment openExperiment(const std::string& nameOrPath) {
  std::vector<std::string> names;
  if (!fs::is_regular_file(nameOrPath) && fs::path(nameOrPath).extension().empty()) {
    for (const PresetListing& listing : listExperiments()) {
      if (listing.id == nameOrPath) return loadExperiment(listing.file);
      names.push_back(listing.id);
    }
    const std::string near = nearest(nameOrPath, names);
    throw badInput(fmt::format("{}: an experiment's file is wanted, or the name of one: {}", nameOrPath,
                               near.empty() ? fmt::format("{}", fmt::join(names, ", ")) : fmt::format("did you mean {}?", near)));
  }
  return isBundleFile(nameOrPath) ? openExperimentBundle(nameOrPath) : loadExperiment(nameOrPath);
}

}  // namespace hl
