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

constexpr const char* kReferenceImages[] = {"reference", "reference_direct", "reference_indirect", "reference_matched", "reference_matched_indirect"};

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

Image SurfaceImages::composite(const Image& direct, const Image& indirect) const {
  Image out(direct.width, direct.height, 3);
  for (size_t i = 0; i < out.pixels(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const float e = direct.data[i * static_cast<size_t>(direct.channels) + c] + indirect.data[i * static_cast<size_t>(indirect.channels) + c];
      out.data[i * 3 + c] = seen(i) ? emission.data[i * 4 + c] + e * albedo.data[i * 4 + c] / kPi : sky[static_cast<int>(c)] + (map.empty() ? 0.0f : map[i][static_cast<int>(c)]);
    }
  return out;
}

std::shared_ptr<const ReferenceSurfaces> SurfaceImages::ofReference(bool composite) const {
  ReferenceSurfaces out{position, geometricNormal, {}, {}};
  if (composite) {
    out.gain = albedo, out.offset = emission;
    for (float& x : out.gain.data) x /= kPi;
  }
  return std::make_shared<const ReferenceSurfaces>(std::move(out));
}

SurfaceImages Session::Impl::surfaceImages() {
  SurfaceImages out{device.download(gbuffer.position), device.download(gbuffer.geometricNormal), device.download(gbuffer.albedo), device.download(gbuffer.emission), scene->sky, {}};
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

ReferenceImage SurfaceImages::composite(const ReferenceImage& direct, const ReferenceImage& indirect) const {
  return {composite(direct.mean, indirect.mean), composite(direct.halfA, indirect.halfA), composite(direct.halfB, indirect.halfB)};
}

ReferenceImage Session::Impl::referenceImage(const std::string& name) {
  const bool limited = name.rfind("reference_matched", 0) == 0;
  const ReferenceRun* run = limited ? matchedRun() : full.result ? &full : nullptr;
  if (!run) throw badInput(fmt::format("image '{}': there is no {}reference yet", name, limited ? "matched " : ""));
  const SurfaceImages surfaces = surfaceImages();
  const bool onlyDirect = name == "reference_direct", composite = !onlyDirect && !name.ends_with("_indirect");
  ReferenceImage image = onlyDirect ? run->result->directImage() : run->result->indirectImage(limited ? technique->transport().bounces : fullBounces());
  // Direct light is no technique's: that of the matched reference, of front faces or other normals, is not what is shown.
  if (composite) image = surfaces.composite(full.result->directImage(), image);
  image.surfaces = surfaces.ofReference(composite);
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
    return irradiance;
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
  std::vector<std::string> known = {"final", "indirect", "indirect_irradiance", "direct", "albedo", "normal", "position", "emission", "motion"};
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
    if (name.rfind("reference", 0) != 0) {
      r.images[name] = std::make_shared<const Image>(linearImage(name));
      continue;
    }
    const bool limited = name.rfind("reference_matched", 0) == 0;
    const ReferenceRun* run = limited ? matchedRun() : full.result ? &full : nullptr;
    if (!run) continue;
    const int bounces = limited ? technique->transport().bounces : fullBounces();
    const auto old = keptImages.find(name);
    const bool same = old != keptImages.end() && old->second.result == run->result && old->second.bounces == bounces;
    kept[name] = same ? old->second : KeptImage{run->result, bounces, std::make_shared<const ReferenceImage>(referenceImage(name))};
    const std::shared_ptr<const ReferenceImage> image = kept[name].image;
    r.references[name] = image;
    r.images[name] = std::shared_ptr<const Image>(image, &image->mean);
  }
  keptImages = std::move(kept);
  if (!r.images.empty()) r.surfaces = std::make_shared<const Mask>(surfaceMask());
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
  if (!full.result) {
    if (result.message.empty()) result.message = "the reference has no picture yet";
    return false;
  }
  if (truth)
    result.display = toneMapOnHost(linearImage(id), preset.display);
  else
    result.display = errorColours(errorMap(preset.display.errorMetric, id == "error_full"), metricInfo(preset.display.errorMetric));
  return true;
}

}  // namespace hl
