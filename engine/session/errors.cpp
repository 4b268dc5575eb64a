// Errors of what is shown, against the full reference and against one limited to the paths the technique models.
#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "engine/session/session_impl.h"

namespace hl {
namespace {

ErrorValue valueOf(const MetricResult& m, const std::string& metric, const char* reference, const char* target, const char* component,
                   const std::string& roi) {
  ErrorValue e;
  e.reference = reference, e.target = target, e.component = component, e.metric = metric, e.roi = roi;
  e.value = m.value, e.noiseFloor = m.noiseFloor, e.standardError = m.standardError, e.nonFinite = m.nonFinite;
  return e;
}

Mask within(const Mask& mask, const Region& region, int width, int height) {
  Mask out(mask.size(), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width), v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      if (u >= region.x && u < region.x + region.width && v >= region.y && v < region.y + region.height) out[i] = mask[i];
    }
  return out;
}

/// Lumels laid out as they lie in the lightmap, so that they have neighbours. Texels without surface are 0 in it, and do not count.
Image inAtlas(const Atlas& atlas, const Image& lumels) {
  const int side = atlas.resolution;
  Image out(side, side, 3);
  for (size_t i = 0; i < lumels.pixels(); ++i) std::copy_n(&lumels.data[i * 3], 3, &out.data[static_cast<size_t>(atlas.lumels[i].texel) * 3]);
  return out;
}

std::shared_ptr<const ReferenceSurfaces> surfacesInAtlas(const Atlas& atlas) {
  const int side = atlas.resolution;
  ReferenceSurfaces out{Image(side, side, 3), Image(side, side, 3), {}, {}};
  for (const Lumel& l : atlas.lumels)
    for (int c = 0; c < 3; ++c) {
      const size_t i = static_cast<size_t>(l.texel) * 3 + static_cast<size_t>(c);
      out.position.data[i] = l.position[c], out.normal.data[i] = l.normal[c];
    }
  return std::make_shared<const ReferenceSurfaces>(std::move(out));
}

/// What the picture shows of a technique and of the truth, ready to be measured.
struct Truth {
  const char* reference;
  ReferenceImage of[3];  ///< by Component
};

}  // namespace

bool anySet(const Mask& mask) {
  for (const unsigned char m : mask)
    if (m) return true;
  return false;
}

std::vector<std::pair<std::string, Mask>> Session::Impl::regionMasks(const Mask& surfaces) const {
  std::vector<std::pair<std::string, Mask>> out = {{"", surfaces}};
  for (const Region& region : scene->regions) {
    Mask part = within(surfaces, region, gbuffer.width, gbuffer.height);
    if (anySet(part)) out.emplace_back(region.name, std::move(part));
  }
  return out;
}

Appearance Session::Impl::appearance() const { return {.exposure = preset.display.exposure, .curve = toneMapCurve(preset.display.toneMap)}; }

std::vector<ErrorValue> Session::measureErrors(const std::vector<std::string>& metrics, const std::string& target) {
  Impl& s = *impl_;
  std::vector<ErrorValue> out;
  MeasureOptions options;
  options.appearance = s.appearance();
  options.pool = &s.pool;
  const int bounces = s.technique->transport().bounces;
  if (target == "lightmap") {
    const std::vector<vec3> lightmap = s.technique->lightmapIrradiance();
    if (!s.lightmapRun.result || lightmap.empty()) return out;
    Image lumels(static_cast<int>(lightmap.size()), 1, 3);
    for (size_t i = 0; i < lightmap.size(); ++i)
      for (size_t c = 0; c < 3; ++c) lumels.data[i * 3 + c] = lightmap[i][static_cast<int>(c)];
    const Image value = inAtlas(*s.atlas, lumels);
    const ReferenceImage traced = s.lightmapRun.result->indirectImage(bounces);
    const ReferenceImage truth{inAtlas(*s.atlas, traced.mean), inAtlas(*s.atlas, traced.halfA), inAtlas(*s.atlas, traced.halfB), surfacesInAtlas(*s.atlas)};
    options.weights.assign(value.pixels(), 0.0f);
    for (const Lumel& l : s.atlas->lumels) options.weights[l.texel] = l.area;
    for (const std::string& m : metrics) out.push_back(valueOf(measure(m, value, truth, options), m, "matched", "lightmap", "indirect", ""));
    return out;
  }
  if (target != "image") throw badInput(fmt::format("error target '{}': it is image or lightmap", target));
  if (!s.full.result) return out;
  const Image specular = s.indirectSpecular();
  return measureErrorsOf(s.indirectIrradiance(), metrics, &specular);
}

std::vector<ErrorValue> Session::measureErrorsOf(const Image& indirect, const std::vector<std::string>& metrics, const Image* specular) {
  Impl& s = *impl_;
  std::vector<ErrorValue> out;
  const Transport transport = s.technique->transport();
  const int bounces = transport.bounces;
  if (!s.full.result) return out;
  MeasureOptions options;
  options.appearance = s.appearance();
  options.pool = &s.pool;
  const SurfaceImages surfaces = s.surfaceImages();
  const Image direct = s.device.download(s.directImage);
  options.mask = maskOf(surfaces.position);
  if (!anySet(options.mask)) return out;
  std::vector<Component> components = {Component::Indirect, Component::Final};
  // Of lobes, where any is seen; without their light there is no picture to compare.
  const Mask glossy = surfaces.glossy();
  if (anySet(glossy)) {
    if (specular)
      components.insert(components.begin() + 1, Component::Specular);
    else
      components = {Component::Indirect};
  }
  const Image values[] = {indirect, specular ? *specular : Image(), surfaces.composite(direct, indirect, s.directSpecular(), specular ? *specular : Image())};
  struct Regions {
    std::vector<std::string> names;
    std::vector<Mask> masks;
  };
  const auto regionsOf = [&](const Mask& mask) {
    Regions r;
    for (auto& [name, part] : s.regionMasks(mask)) r.names.push_back(name), r.masks.push_back(std::move(part));
    return r;
  };
  const Regions all = regionsOf(options.mask), lobes = anySet(glossy) ? regionsOf(glossy) : Regions{};

  const ReferenceImage sun = s.full.result->directImage();  // direct light is no technique's: the matched reference's, of front faces or other normals, is not what is shown
  const ReferenceImage highlights = s.full.result->directSpecularImage();
  std::vector<Truth> truths;
  // One run serves both where they differ in bounces alone; beyond its buckets they do not differ at all.
  const bool same = !s.matched.tracer && std::min(bounces, kBounceBuckets) == std::min(s.fullBounces(), kBounceBuckets) && (!anySet(glossy) || transport.glossyLastBounce);
  for (const bool matched : {true, false}) {
    if (matched && !s.referencesStarted()) continue;  // the technique was changed since
    if (!matched && same && !truths.empty()) continue;
    const ReferenceRun& run = matched && s.matched.tracer ? s.matched : s.full;
    if (!run.result) continue;
    Truth truth{matched ? "matched" : "full", {run.result->indirectImage(s.bouncesOf(matched)), s.lobesOf(run, matched), {}}};
    truth.of[2] = surfaces.composite(sun, truth.of[0], highlights, truth.of[1]);
    for (const Component c : components) truth.of[static_cast<size_t>(c)].surfaces = surfaces.ofReference(c);
    truths.push_back(std::move(truth));
  }

  struct Job {
    const Truth* truth;
    std::string metric;
    Component component;
    std::vector<MetricResult> results;
  };
  std::vector<Job> jobs;
  for (const Truth& truth : truths)
    for (const std::string& m : metrics)
      for (const Component c : components) {
        // Where the technique models no lobes there is no light in its matched reference's either.
        if (c == Component::Specular && truth.reference == std::string_view("matched") && !transport.glossyLastBounce) continue;
        jobs.push_back({&truth, m, c, {}});
      }
  const auto run = [&](Job& job, MeasureOptions with) {
    const auto component = static_cast<size_t>(job.component);
    const bool ofLobes = job.component == Component::Specular;
    if (ofLobes) with.mask = glossy;
    job.results = measureRegions(job.metric, values[component], job.truth->of[component], with, ofLobes ? lobes.masks : all.masks);
  };
  // Those that see neighbours share the pool among their rows, one after the other; of the rest each is a task.
  for (Job& job : jobs)
    if (metricInfo(job.metric).windowed) run(job, options);
  MeasureOptions alone = options;
  alone.pool = nullptr;
  s.pool.parallelFor(jobs.size(), 1, [&](size_t first, size_t last, unsigned) {
    for (size_t i = first; i < last; ++i)
      if (!metricInfo(jobs[i].metric).windowed) run(jobs[i], alone);
  });
  for (const Job& job : jobs) {
    const std::vector<std::string>& names = job.component == Component::Specular ? lobes.names : all.names;
    for (size_t i = 0; i < names.size(); ++i)
      out.push_back(valueOf(job.results[i], job.metric, job.truth->reference, "image", kComponentNames[static_cast<size_t>(job.component)], names[i]));
  }
  if (same && truths.size() == 1 && truths[0].reference == std::string_view("matched")) {
    const size_t count = out.size();
    for (size_t i = 0; i < count; ++i) out.push_back(out[i]), out.back().reference = "full";
  }
  return out;
}

std::vector<ErrorValue> Session::measureErrorsBetween(const Image& indirect, const Image& other, const std::vector<std::string>& metrics, const char* reference) {
  Impl& s = *impl_;
  if (indirect.width != other.width || indirect.height != other.height)
    throw badInput(fmt::format("images of {}x{} and {}x{} cannot be compared", indirect.width, indirect.height, other.width, other.height));
  MeasureOptions options;
  options.appearance = s.appearance();
  options.pool = &s.pool;
  options.mask = s.surfaceMask();
  std::vector<ErrorValue> out;
  if (!anySet(options.mask)) return out;
  std::vector<std::string> names;
  std::vector<Mask> masks;
  for (auto& [name, part] : s.regionMasks(options.mask)) names.push_back(name), masks.push_back(std::move(part));
  const ReferenceImage truth{other, other, other};
  for (const std::string& m : metrics) {
    const std::vector<MetricResult> results = measureRegions(m, indirect, truth, options, masks);
    for (size_t i = 0; i < results.size(); ++i) out.push_back(valueOf(results[i], m, reference, "image", kComponentNames[static_cast<size_t>(Component::Indirect)], names[i]));
  }
  return out;
}

Image Session::Impl::errorMap(const std::string& metric, bool againstFull) {
  const ReferenceRun& run = !againstFull && matched.result ? matched : full;
  if (!run.result) throw badInput("error map: there is no reference yet");
  const Image indirect = indirectIrradiance();
  MeasureOptions mapped;
  // Not surfaceImages(): an error map is made every frame.
  const auto surfaces = std::make_shared<const ReferenceSurfaces>(ReferenceSurfaces{device.download(gbuffer.position), device.download(gbuffer.geometricNormal), {}, {}});
  mapped.mask = maskOf(surfaces->position), mapped.wantMap = true, mapped.appearance = appearance(), mapped.pool = &pool;
  if (!anySet(mapped.mask)) return Image(indirect.width, indirect.height, 1);
  ReferenceImage truth = run.result->indirectImage(againstFull ? fullBounces() : technique->transport().bounces);
  truth.surfaces = surfaces;
  return measure(metric, indirect, truth, mapped).map;
}

Image Session::errorMap(const std::string& metric, const std::string& reference) {
  if (reference != "matched" && reference != "full") throw badInput(fmt::format("reference '{}': it is matched or full", reference));
  return impl_->errorMap(metric, reference == "full");
}

}  // namespace hl
