// Images of the last frame, linear or as shown.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/hash.h"
#include "engine/passes/error_colours.h"
#include "engine/scene/environment.h"
#include "engine/session/presenter.h"
#include "engine/session/probe_views.h"
#include "engine/session/session_impl.h"

namespace hl {
namespace {

constexpr const char* kReferenceImages[] = {"reference", "reference_direct", "reference_direct_specular", "reference_indirect", "reference_specular", "reference_matched", "reference_matched_indirect", "reference_matched_specular"};

Image withoutAlpha(Image in) {
  if (in.channels <= 3) return in;
  Image out(in.width, in.height, 3);
  for (size_t i = 0; i < in.pixels(); ++i) std::copy_n(&in.data[i * static_cast<size_t>(in.channels)], 3, &out.data[i * 3]);
  return out;
}

}  // namespace

Mask maskOf(const Image& position) {
  Mask mask(position.pixels());
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = position.data[i * 4 + 3] != 0;
  return mask;
}

uint64_t Session::surfacePixels() {
  const Mask mask = impl_->surfaceMask();
  return static_cast<uint64_t>(std::count(mask.begin(), mask.end(), 1));
}

Mask Session::Impl::surfaceMask() { return maskOf(device.download(gbuffer.position)); }

Image SurfaceImages::composite(const Image& direct, const Image& indirect, const Image& highlights, const Image& lobes) const {
  Image out(direct.width, direct.height, 3);
  const auto at = [](const Image& image, size_t pixel, size_t c) { return image.data[pixel * static_cast<size_t>(image.channels) + c]; };
  for (size_t i = 0; i < out.pixels(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      float& radiance = out.data[i * 3 + c];
      if (!seen(i)) {
        radiance = sky[static_cast<int>(c)] + (map.empty() ? 0.0f : map[i][static_cast<int>(c)]);
        continue;
      }
      radiance = at(emission, i, c) + (at(direct, i, c) + at(indirect, i, c)) * at(albedo, i, c) / kPi;
      for (const Image* image : {&lobes, &highlights})
        if (image->pixels() > 0) radiance += at(*image, i, c);
    }
  return out;
}

Mask SurfaceImages::glossy() const {
  Mask out(position.pixels(), 0);
  for (size_t i = 0; i < specular.pixels(); ++i) out[i] = seen(i) && (specular.data[i * 4] > 0 || specular.data[i * 4 + 1] > 0 || specular.data[i * 4 + 2] > 0);
  return out;
}

std::shared_ptr<const ReferenceSurfaces> SurfaceImages::ofReference(Component component) const {
  ReferenceSurfaces out{position, geometricNormal, {}, {}};
  if (component == Component::Specular) out.gain = specular;
  if (component == Component::Final) {
    out.gain = albedo, out.offset = emission;
    // A lobe's radiance goes with its reflectance about as that of the diffuse part goes with albedo.
    for (size_t i = 0; i < specular.data.size(); ++i)
      if (i % 4 < 3) out.gain.data[i] += specular.data[i];
    for (float& x : out.gain.data) x /= kPi;
  }
  return std::make_shared<const ReferenceSurfaces>(std::move(out));
}

SurfaceImages Session::Impl::surfaceImages() {
  SurfaceImages out{device.download(gbuffer.position), device.download(gbuffer.geometricNormal), device.download(gbuffer.albedo), device.download(gbuffer.emission),
                    gbuffer.specular ? device.download(gbuffer.specular) : Image(), scene->sky, {}};
  if (!features.environment) return out;
  const EnvironmentLight environment(scene->environment);
  const CameraBasis basis = cameraBasis(camera(), static_cast<float>(gbuffer.width) / static_cast<float>(gbuffer.height));
  out.map.resize(out.position.pixels());
  for (int y = 0; y < gbuffer.height; ++y)
    for (int x = 0; x < gbuffer.width; ++x)
      out.map[static_cast<size_t>(y) * static_cast<size_t>(gbuffer.width) + static_cast<size_t>(x)] =
          environment.radiance(pixelDirection(basis, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, gbuffer.width, gbuffer.height));
  return out;
}

Image Session::Impl::indirectIrradiance() {
  return indirectImage ? device.download(indirectImage) : Image(gbuffer.width, gbuffer.height, 4);
}

Image Session::Impl::indirectSpecular() {
  if (!features.glossySurfaces) return {};
  return specularImage ? device.download(specularImage) : Image(gbuffer.width, gbuffer.height, 4);
}

Image Session::Impl::directSpecular() {
  if (!features.glossySurfaces) return {};
  return directSpecularImage ? device.download(directSpecularImage) : Image(gbuffer.width, gbuffer.height, 4);
}

ReferenceImage SurfaceImages::composite(const ReferenceImage& direct, const ReferenceImage& indirect, const ReferenceImage& highlights, const ReferenceImage& lobes) const {
  return {composite(direct.mean, indirect.mean, highlights.mean, lobes.mean), composite(direct.halfA, indirect.halfA, highlights.halfA, lobes.halfA),
          composite(direct.halfB, indirect.halfB, highlights.halfB, lobes.halfB)};
}

ReferenceImage Session::Impl::lobesOf(const ReferenceRun& run, bool matchedPaths) const {
  if (!features.glossySurfaces) return {};
  return run.result->specularImage(matchedPaths && !technique->transport().glossyLastBounce ? 0 : bouncesOf(matchedPaths));
}

ReferenceImage Session::Impl::referenceImage(const std::string& name) {
  const bool limited = name.rfind("reference_matched", 0) == 0;
  const ReferenceRun* run = limited ? matchedRun() : full.result ? &full : nullptr;
  if (!run) throw badInput(fmt::format("image '{}': there is no {}reference yet", name, limited ? "matched " : ""));
  if (name.ends_with("_specular") && !features.glossySurfaces) throw badInput(fmt::format("image '{}': the scene has no glossy surfaces", name));
  const SurfaceImages surfaces = surfaceImages();
  if (name.ends_with("_specular")) {
    ReferenceImage image = name == "reference_direct_specular" ? run->result->directSpecularImage() : lobesOf(*run, limited);
    image.surfaces = surfaces.ofReference(Component::Specular);
    return image;
  }
  const bool onlyDirect = name == "reference_direct", composite = !onlyDirect && !name.ends_with("_indirect");
  ReferenceImage image = onlyDirect ? run->result->directImage() : run->result->indirectImage(bouncesOf(limited));
  // Direct light is no technique's: that of the matched reference, of front faces or other normals, is not what is shown.
  if (composite) image = surfaces.composite(full.result->directImage(), image, full.result->directSpecularImage(), lobesOf(*run, limited));
  image.surfaces = surfaces.ofReference(composite ? Component::Final : Component::Indirect);
  return image;
}

Image Session::Impl::linearImage(const std::string& name) {
  if (name == "final") return withoutAlpha(device.download(finalImage));
  if (name == "indirect" || name == "indirect_irradiance") {
    Image irradiance = withoutAlpha(indirectIrradiance());
    if (name == "indirect_irradiance") return irradiance;
    const Image albedo = device.download(gbuffer.albedo);
    for (size_t i = 0; i < irradiance.pixels(); ++i)
      for (size_t c = 0; c < 3; ++c) irradiance.data[i * 3 + c] *= albedo.data[i * 4 + c] / kPi;
    if (!specularImage) return irradiance;
    const Image lobes = device.download(specularImage);
    for (size_t i = 0; i < irradiance.pixels(); ++i)
      for (size_t c = 0; c < 3; ++c) irradiance.data[i * 3 + c] += lobes.data[i * 4 + c];
    return irradiance;
  }
  if (name == "specular" || name == "direct_specular") {
    if (!features.glossySurfaces) throw badInput(fmt::format("image '{}': the scene has no glossy surfaces", name));
    return withoutAlpha(name == "specular" ? indirectSpecular() : directSpecular());
  }
  if (name == "direct") return withoutAlpha(device.download(directImage));
  if (name == "albedo") return withoutAlpha(device.download(gbuffer.albedo));
  if (name == "normal") return withoutAlpha(device.download(gbuffer.normal));
  if (name == "position") return withoutAlpha(device.download(gbuffer.position));
  if (name == "motion") {
    if (!gbuffer.motion) throw badInput("image 'motion': no frame has recorded it; show the view motion, or name it among the images wanted");
    const Image two = device.download(gbuffer.motion);
    Image three(two.width, two.height, 3);
    for (size_t i = 0; i < two.pixels(); ++i) std::copy_n(&two.data[i * 2], 2, &three.data[i * 3]);
    return three;
  }
  if (name == "emission") return withoutAlpha(device.download(gbuffer.emission));
  if (std::find(std::begin(kReferenceImages), std::end(kReferenceImages), name) != std::end(kReferenceImages)) return referenceImage(name).mean;
  for (const DebugView& v : technique->debugViews())
    if (v.id == name && v.image) return withoutAlpha(device.download(v.image));
  throw badInput(fmt::format("image '{}': there is none of that name; there are {}", name, fmt::join(imageNames(), ", ")));
}

std::vector<std::string> Session::Impl::imageNames() const {
  std::vector<std::string> known = {"final", "indirect", "indirect_irradiance", "specular", "direct", "direct_specular", "albedo", "normal", "position", "emission", "motion"};
  known.insert(known.end(), std::begin(kReferenceImages), std::end(kReferenceImages));
  for (const DebugView& v : technique->debugViews()) known.push_back(v.id);
  return known;
}

bool Session::Impl::motionWanted() const {
  return technique->needs().motion || preset.display.view == "motion" || std::find(imagesWanted.begin(), imagesWanted.end(), "motion") != imagesWanted.end();
}

const ReferenceRun* Session::Impl::matchedRun() const {
  if (!referencesStarted()) return nullptr;  // the technique was changed since
  const ReferenceRun& run = matched.tracer ? matched : full;
  return run.result && full.result ? &run : nullptr;  // direct light is the full one's
}

void Session::Impl::publishImages(FrameResult& r) {
  std::map<std::string, KeptImage> kept;
  const std::vector<std::string> known = imageNames();
  for (const std::string& name : imagesWanted) {
    if (std::find(known.begin(), known.end(), name) == known.end()) continue;  // a debug view of a technique that is gone
    if (name.ends_with("specular") && !features.glossySurfaces) continue;  // of a scene before
    if (name.rfind("reference", 0) != 0) {
      r.images[name] = std::make_shared<const Image>(linearImage(name));
      continue;
    }
    const bool limited = name.rfind("reference_matched", 0) == 0;
    const ReferenceRun* run = limited ? matchedRun() : full.result ? &full : nullptr;
    if (!run) continue;
    const int bounces = bouncesOf(limited);
    const bool lobes = features.glossySurfaces && (!limited || technique->transport().glossyLastBounce);
    const auto old = keptImages.find(name);
    const bool same = old != keptImages.end() && old->second.result == run->result && old->second.bounces == bounces && old->second.lobes == lobes;
    kept[name] = same ? old->second : KeptImage{run->result, bounces, lobes, std::make_shared<const ReferenceImage>(referenceImage(name))};
    const std::shared_ptr<const ReferenceImage> image = kept[name].image;
    r.references[name] = image;
    r.images[name] = std::shared_ptr<const Image>(image, &image->mean);
  }
  keptImages = std::move(kept);
  if (!r.images.empty()) r.surfaces = std::make_shared<const Mask>(surfaceMask());
  if (std::any_of(r.images.begin(), r.images.end(), [](const auto& image) { return image.first.ends_with("specular"); })) r.glossy = std::make_shared<const Mask>(surfaceImages().glossy());
}

Image Session::image(const std::string& view) {
  if (impl_->frameNumber == 0) throw badInput("image: no frame has been rendered yet");
  return impl_->linearImage(view);
}

/// To the host, to the window, or both.
void Session::Impl::publishPicture(FrameResult& r) {
  const double start = nowMs();
  const bool onDevice = presenter->attached();
  const bool wanted = !onDevice || std::find(imagesWanted.begin(), imagesWanted.end(), "display") != imagesWanted.end();
  const size_t bytes = static_cast<size_t>(r.width) * static_cast<size_t>(r.height) * 4;
  if (showHostView(r)) {
    if (onDevice) device.upload(displayImage, 0, r.display.data(), bytes);
  } else if (wanted) {
    r.display.resize(bytes);
    device.download(displayImage, r.display.data(), bytes);
  }
  if (!r.display.empty()) r.displayHash = hashOf({reinterpret_cast<const char*>(r.display.data()), r.display.size()});
  if (onDevice) presenter->publish(displayImage);
  r.publishMs = nowMs() - start;
}

/// Views that are made on the host: the reference and the error maps. Without a reference the technique's picture stays, and a message says so.
bool Session::Impl::showHostView(FrameResult& result) {
  const std::string& id = preset.display.view;
  if (technique->needs().probes && isProbeView(id)) return showProbeView(result);
  const bool error = id.rfind("error", 0) == 0, truth = id.rfind("reference", 0) == 0;
  if (!error && !truth) return false;
  const bool noLobes = id.ends_with("_specular") && !features.glossySurfaces;
  if (!full.result || noLobes) {
    if (result.message.empty()) result.message = noLobes ? "the scene has no glossy surfaces" : "the reference has no picture yet";
    return false;
  }
  if (truth)
    result.display = toneMapOnHost(linearImage(id), preset.display);
  else
    result.display = errorColours(errorMap(preset.display.errorMetric, id == "error_full"), metricInfo(preset.display.errorMetric));
  return true;
}

}  // namespace hl
