// What the tuner tries: draws from the declared soft ranges, and neighbours of what did well.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "engine/core/hash.h"
#include "engine/experiment/preset_parameters.h"
#include "engine/params/groups.h"
#include "engine/sweep/cost_model.h"
#include "engine/sweep/tune.h"
#include "engine/techniques/technique.h"

namespace hl {
namespace {

// Knobs that stay at their value in a draw: with all of them moved, hardly any draw would be near something sensible.
constexpr double kKeptShare = 0.4;
// Standard deviation of a neighbour's step, as a share of the soft range.
constexpr double kStep = 0.2;

using Random = std::mt19937_64;

double uniform(Random& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

std::string text(const ParamInfo& p, double v) {
  return p.type == ParamType::Int ? formatParam(p, static_cast<int32_t>(std::lround(v))) : formatParam(p, static_cast<float>(v));
}

std::string drawn(const ParamInfo& p, Random& random) {
  if (p.type == ParamType::Bool) return random() % 2 ? "true" : "false";
  if (p.type == ParamType::Enum) return std::string(p.values[random() % p.values.size()].name);
  return text(p, fromUnit(p, uniform(random)));
}

std::vector<std::string> techniquesOf(const TuneOptions& o) {
  if (!o.techniques.empty()) return o.techniques;
  std::vector<std::string> out;
  for (const TechniqueInfo& t : techniqueInfos())
    if (t.id != "none") out.emplace_back(t.id);
  return out;
}

Preset draw(const Preset& defaults, const std::vector<const ParamInfo*>& knobs, Random& random) {
  Preset p = defaults;
  for (const ParamInfo* knob : knobs)
    if (uniform(random) >= kKeptShare) p.parameters[knob->key()] = drawn(*knob, random);
  p.parameters = canonicalParameters(p.technique, p.parameters);
  return p;
}

/// Every number at the bottom of its soft range: mostly the quickest there is, so that something is timed whatever the budget.
Preset lowest(const Preset& defaults, const std::vector<const ParamInfo*>& knobs) {
  Preset p = defaults;
  for (const ParamInfo* knob : knobs)
    if (knob->type == ParamType::Int || knob->type == ParamType::Float) p.parameters[knob->key()] = text(*knob, knob->softMin);
  p.parameters = canonicalParameters(p.technique, p.parameters);
  return p;
}

/// The technique as it comes, with the base's shared parameters.
Preset defaultsOf(const TuneOptions& o, const std::string& technique) {
  Preset p = o.base;
  changeTechnique(p, technique);
  std::erase_if(p.parameters, [&](const auto& parameter) { return parameter.first.starts_with(technique + ".") && !o.fixed.count(parameter.first); });
  return p;
}

}  // namespace

std::vector<const ParamInfo*> knobsOf(const std::string& technique, const std::set<std::string>& fixed) {
  std::vector<const ParamInfo*> out;
  const auto made = techniqueInfo(technique).create();
  const auto add = [&](const ParamInfo& p) {
    const bool choice = p.type == ParamType::Enum ? p.values.size() > 1 : p.type == ParamType::Bool || p.softMin < p.softMax;
    if (choice && p.effect != Effect::Live && !fixed.count(p.key())) out.push_back(&p);
  };
  for (const ParamInfo& p : made->params().infos()) add(p);
  if (made->needs().lightmap)
    for (const ParamInfo& p : lightmapParamInfos())
      if (p.name == "resolution") add(p);  // `texels` says the same in another way; the rest are about seams
  return out;
}

std::vector<Preset> firstCandidates(const TuneOptions& o) {
  std::vector<Preset> out;
  std::set<std::string> known;
  const auto add = [&](const Preset& p) { return known.insert(presetHash(p)).second ? (out.push_back(p), true) : false; };
  const std::vector<std::string> techniques = techniquesOf(o);
  if (std::find(techniques.begin(), techniques.end(), o.base.technique) != techniques.end()) add(o.base);
  for (const std::string& technique : techniques) {
    Hasher h;
    h.text(technique).value(o.seed);
    Random random(std::stoull(h.hex().substr(0, 15), nullptr, 16));
    const Preset defaults = defaultsOf(o, technique);
    add(defaults);
    const std::vector<const ParamInfo*> knobs = knobsOf(technique, o.fixed);
    if (knobs.empty()) continue;
    add(lowest(defaults, knobs));
    // A technique with few values has fewer candidates than draws.
    int made = 1;
    for (int tries = 0; made < o.candidates && tries < 20 * o.candidates; ++tries) made += add(draw(defaults, knobs, random)) ? 1 : 0;
  }
  return out;
}

std::vector<Preset> furtherCandidates(const TuneOptions& o, const std::vector<Trial>& trials, uint64_t round) {
  constexpr int kProposals = 400, kSteps = 12;
  constexpr double kRoom = 0.9;  // of the budget: the judgement is rough
  std::set<std::string> known;
  for (const Trial& t : trials) known.insert(presetHash(t.preset));
  std::vector<Preset> out;
  for (const std::string& technique : techniquesOf(o)) {
    const std::vector<const ParamInfo*> knobs = knobsOf(technique, o.fixed);
    if (knobs.empty()) continue;
    CostModel model(technique, knobs);
    std::vector<const Trial*> good;
    for (const Trial& t : trials) {
      model.add(t.preset, t.costMs);
      if (t.withinBudget && t.preset.technique == technique) good.push_back(&t);
    }
    Hasher h;
    h.text(technique).value(o.seed).value(round);
    Random random(std::stoull(h.hex().substr(0, 15), nullptr, 16));
    const size_t wanted = static_cast<size_t>(std::max(2, o.candidates / 2));
    const auto add = [&](const Preset& p) {
      if (!known.insert(presetHash(p)).second) return false;
      out.push_back(p);
      return true;
    };
    // Half of them near the best, within what the budget seems to allow.
    std::stable_sort(good.begin(), good.end(), [](const Trial* a, const Trial* b) { return a->error.mean < b->error.mean; });
    good.resize(std::min(good.size(), std::max<size_t>(1, wanted / 2)));
    size_t near = 0;
    for (int step = 0; step < kSteps && near < wanted; ++step)
      for (const Trial* t : good) {
        const Preset p = neighbourOf(t->preset, o, random());
        if (near < wanted && model.predict(p) <= kRoom * o.budgetMs) near += add(p) ? 1 : 0;
      }
    // The others anywhere: of many draws, from the third that seems to use the budget best.
    std::vector<std::pair<double, Preset>> proposals;
    const Preset defaults = defaultsOf(o, technique);
    for (int i = 0; i < kProposals; ++i) {
      Preset p = draw(defaults, knobs, random);
      const double ms = model.predict(p);
      proposals.emplace_back(ms, std::move(p));
    }
    std::stable_sort(proposals.begin(), proposals.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    size_t fitting = 0;
    while (fitting < proposals.size() && proposals[fitting].first <= kRoom * o.budgetMs) ++fitting;
    const size_t first = fitting - fitting / 3, count = fitting > 0 ? std::max<size_t>(1, fitting / 3) : proposals.size() / 10;
    size_t far = 0;
    for (int tries = 0; tries < kProposals && far + near < 2 * wanted && far < wanted; ++tries) {
      const size_t at = fitting > 0 ? std::min(first, proposals.size() - 1) + random() % count : random() % count;
      far += add(proposals[std::min(at, proposals.size() - 1)].second) ? 1 : 0;
    }
  }
  return out;
}

Preset neighbourOf(const Preset& from, const TuneOptions& o, uint64_t seed) {
  Random random(seed);
  Preset out = from;
  for (const ParamInfo* knob : knobsOf(from.technique, o.fixed)) {
    if (uniform(random) < kKeptShare) continue;
    if (knob->type == ParamType::Bool || knob->type == ParamType::Enum) {
      if (uniform(random) < kStep) out.parameters[knob->key()] = drawn(*knob, random);
      continue;
    }
    // A normal step from twelve uniform ones: the same on every platform.
    double step = -6;
    for (int i = 0; i < 12; ++i) step += uniform(random);
    const double at = numberOf(from, *knob);
    out.parameters[knob->key()] = text(*knob, fromUnit(*knob, unitOf(*knob, at) + kStep * step));
  }
  out.parameters = canonicalParameters(out.technique, out.parameters);
  return out;
}

}  // namespace hl
