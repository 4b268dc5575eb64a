#include "engine/passes/display.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "shaders/shared/tone_map.h"

namespace hl {
namespace {

/// What the values of an image are; kMode of tone_map.comp.
enum Mode : uint32_t { kRadiance = 0, kColour = 1, kDirection = 2, kPlace = 3, kShift = 4 };

struct ToneMapConstants {
  float scale;
  uint32_t curve, showInvalid;
};

uint32_t channelsOf(Format f) {
  switch (f) {
    case Format::R32F:
    case Format::D32F:
      return 1;
    case Format::RG32F:
      return 2;
    case Format::RGBA32F:
    case Format::RGBA16F:
    case Format::RGBA8:
      return 4;
    default:
      throw badInput("tone map: an image of whole numbers cannot be shown");
  }
}

unsigned char byteOf(float display) {
  return static_cast<unsigned char>(std::lround(std::clamp(display, 0.0f, 1.0f) * 255.0f));
}

void store(unsigned char* to, vec3 display) {
  for (int i = 0; i < 3; ++i) to[i] = byteOf(display[i]);
  to[3] = 255;
}

vec3 colourAt(const Image& image, size_t pixel) {
  const float* p = image.data.data() + pixel * static_cast<size_t>(image.channels);
  return image.channels == 1 ? vec3(p[0]) : image.channels == 2 ? vec3(p[0], p[1], 0) : vec3(p[0], p[1], p[2]);
}

/// Viridis by van der Walt and Smith (CC0), sampled at sixteenths of its range; display values from dark to bright.
constexpr uint32_t kViridis[] = {0x440154, 0x481a6c, 0x472f7d, 0x414487, 0x39568c, 0x31688e, 0x2a788e, 0x23888e,
                                 0x1f988b, 0x22a884, 0x35b779, 0x54c568, 0x7ad151, 0xa5db36, 0xd2e21b, 0xfde725};

/// Magma, by the same authors and in the same steps.
constexpr uint32_t kMagma[] = {0x000004, 0x0b0924, 0x20114b, 0x3b0f70, 0x57157e, 0x721f81, 0x8c2981, 0xa8327d,
                               0xc43c75, 0xde4968, 0xf1605d, 0xfa7f5e, 0xfe9f6d, 0xfebf84, 0xfddea0, 0xfcfdbf};

vec3 colourOf(uint32_t c) {
  return vec3(static_cast<float>(c >> 16), static_cast<float>(c >> 8 & 255), static_cast<float>(c & 255)) / 255.0f;
}

vec3 ramp(const uint32_t (&colours)[16], float x) {
  const float at = std::clamp(x, 0.0f, 1.0f) * 15.0f;
  const size_t low = std::min(static_cast<size_t>(at), size_t{14});
  return glm::mix(colourOf(colours[low]), colourOf(colours[low + 1]), at - static_cast<float>(low));
}

/// Colours between Okabe and Ito's blues and oranges, sampled at quarters; both arms have the same luminance at each, within 0.03.
constexpr uint32_t kBelow[] = {0xf5f5f5, 0xa9cdea, 0x569fd0, 0x1f6aa5, 0x0b3a63};
constexpr uint32_t kAbove[] = {0xf5f5f5, 0xf2c288, 0xd98a2b, 0xa0561a, 0x5e2f0a};

vec3 diverging(float x) {
  const auto& arm = x < 0 ? kBelow : kAbove;
  const float at = std::min(std::abs(x), 1.0f) * 4.0f;
  const size_t low = std::min(static_cast<size_t>(at), size_t{3});
  return glm::mix(colourOf(arm[low]), colourOf(arm[low + 1]), at - static_cast<float>(low));
}

vec3 falseColourOf(float x, ColourScale scale) {
  if (scale == ColourScale::Signed) return diverging(x);
  return scale == ColourScale::Magma ? ramp(kMagma, x) : ramp(kViridis, x);
}

float meanOfChannels(const Image& map, size_t pixel) {
  const int channels = std::min(map.channels, 3);
  const float* p = map.data.data() + pixel * static_cast<size_t>(map.channels);
  float sum = 0;
  for (int k = 0; k < channels; ++k) sum += p[k];
  return sum / static_cast<float>(channels);
}

constexpr double kScaleQuantile = 0.98;

}  // namespace

uint32_t toneMapCurve(ToneMap t) {
  switch (t) {
    case ToneMap::Linear:
      return shared::kToneMapLinear;
    case ToneMap::Aces:
      return shared::kToneMapAces;
    case ToneMap::Reinhard:
      return shared::kToneMapReinhard;
  }
  return shared::kToneMapLinear;
}

const std::vector<ViewInfo>& displayViews() {
  static const std::vector<ViewInfo> views = {
      {"final", "Final image"},
      {"indirect", "Indirect light"},
      {"indirect_irradiance", "Indirect irradiance (without albedo)"},
      {"specular", "Indirect specular radiance"},
      {"direct", "Direct irradiance"},
      {"direct_specular", "Direct specular radiance (highlights)"},
      {"albedo", "Albedo"},
      {"normal", "Normal"},
      {"position", "Position (fractions of a metre)"},
      {"emission", "Emission"},
      {"motion", "Motion since the last frame (grey: none; full colour at 16 pixels)"},
      {"reference", "Reference"},
      {"reference_indirect", "Reference, indirect irradiance"},
      {"reference_specular", "Reference, indirect specular radiance"},
      {"reference_direct", "Reference, direct irradiance"},
      {"reference_direct_specular", "Reference, direct specular radiance"},
      {"error", "Error against the matched reference"},
      {"error_full", "Error against the full reference"},
  };
  return views;
}

GpuImage recordComposite(FrameGraph& graph, const GBuffer& g, const GpuImage& direct, const GpuImage& indirect,
                         vec3 sky, const GpuImage& specular, const GpuImage& directSpecular) {
  // Two composites of one frame (the picture, and indirect light alone to look at) are two images.
  const char* name = direct ? "composite" : "composite: indirect";
  const GpuImage radiance = graph.transient(name, {g.width, g.height, Format::RGBA32F});
  graph.compute(name, "passes/composite.comp")
      .sample("position", g.position)
      .sample("albedo", g.albedo)
      .sample("emission", g.emission)
      // What is missing is never read; something has to be bound all the same.
      .sample("direct", direct ? direct : g.position)
      .sample("indirect", indirect ? indirect : g.position)
      .sample("specular", specular ? specular : g.position)
      .sample("directSpecular", directSpecular ? directSpecular : g.position)
      .bind("radiance", radiance, Access::Write)
      .specialize("kDirect", direct ? 1 : 0)
      .specialize("kIndirect", indirect ? 1 : 0)
      .specialize("kSpecular", specular ? 1 : 0)
      .specialize("kDirectSpecular", directSpecular ? 1 : 0)
      .push(sky)
      .dispatchThreads(static_cast<uint32_t>(g.width), static_cast<uint32_t>(g.height));
  return radiance;
}

void recordBackground(FrameGraph& graph, const GBuffer& g, const GpuScene& scene, const Camera& camera, const GpuImage& radiance) {
  if (scene.environment.width == 0) return graph.skip("background", "scene has no environment map");
  const CameraBasis basis = cameraBasis(camera, static_cast<float>(g.width) / static_cast<float>(g.height));
  struct Constants {
    vec3 forward, right, down;
    shared::EnvironmentInfo environment;
  } constants{basis.forward, basis.right, basis.down, scene.environment};
  graph.compute("background", "passes/background.comp")
      .sample("position", g.position)
      .bind("environment_texels", scene.environmentTexels, Access::Read)
      .bind("radiance", radiance, Access::ReadWrite)
      .push(constants)
      .dispatchThreads(static_cast<uint32_t>(g.width), static_cast<uint32_t>(g.height));
}

GpuImage recordToneMap(FrameGraph& graph, const GpuImage& source, const Display& display, bool sceneReferred, int width,
                       int height, const Buffer& counters) {
  const GpuImage shown = graph.transient("display", {width, height, Format::RGBA8});
  graph.clear("tone map: clear counters", counters, 0);
  if (!source) {
    graph.clear("tone map", shown);
    return shown;
  }
  Mode mode = sceneReferred ? kRadiance : kColour;
  if (!sceneReferred && display.view == "normal") mode = kDirection;
  if (!sceneReferred && display.view == "position") mode = kPlace;
  if (!sceneReferred && display.view == "motion") mode = kShift;
  const ToneMapConstants constants{std::exp2(display.exposure), toneMapCurve(display.toneMap),
                                   display.showInvalid ? 1u : 0u};
  graph.compute("tone map", "passes/tone_map.comp")
      .sample("source", source)
      .bind("display", shown, Access::Write)
      .bind("counters", counters, Access::ReadWrite)
      .specialize("kChannels", channelsOf(source.format()))
      .specialize("kMode", mode)
      .push(constants)
      .dispatchThreads(static_cast<uint32_t>(width), static_cast<uint32_t>(height));
  return shown;
}

std::vector<unsigned char> toneMapOnHost(const Image& rgb, const Display& display) {
  std::vector<unsigned char> out(rgb.pixels() * 4);
  const float scale = std::exp2(display.exposure);
  const uint32_t curve = toneMapCurve(display.toneMap);
  for (size_t i = 0; i < rgb.pixels(); ++i) {
    const vec3 c = colourAt(rgb, i);
    vec3 shown(0);
    bool nan = false, nonFinite = false, negative = false;
    for (int k = 0; k < 3; ++k) {
      nan = nan || shared::isNanBits(c[k]);
      nonFinite = nonFinite || shared::isNonFinite(c[k]);
      negative = negative || c[k] < 0;
    }
    for (int k = 0; k < 3; ++k) {
      const bool bad = shared::isNonFinite(c[k]);
      if (nonFinite) {
        shown[k] = bad && !shared::isNanBits(c[k]) && c[k] > 0 ? 1.0f : 0.0f;
      } else {
        shown[k] = shared::displayValue(c[k] * scale, curve);
      }
    }
    if (display.showInvalid) {
      if (negative) shown = shared::kNegativeColour;
      if (nonFinite) shown = nan ? shared::kNanColour : shared::kInfiniteColour;
    }
    store(out.data() + 4 * i, shown);
  }
  return out;
}

std::vector<unsigned char> falseColour(const Image& map, float scale, ColourScale colours) {
  if (!(scale > 0)) throw badInput(fmt::format("false colours: the scale is {}; it must be above 0", scale));
  std::vector<unsigned char> out(map.pixels() * 4);
  for (size_t i = 0; i < map.pixels(); ++i) {
    const float value = meanOfChannels(map, i);
    store(out.data() + 4 * i, shared::isNonFinite(value) ? shared::kNanColour : falseColourOf(value / scale, colours));
  }
  return out;
}

float colourScale(const Image& map) {
  std::vector<float> sorted;
  sorted.reserve(map.pixels());
  for (size_t i = 0; i < map.pixels(); ++i)
    if (const float v = meanOfChannels(map, i); !shared::isNonFinite(v)) sorted.push_back(std::abs(v));
  if (sorted.empty()) return 1;
  const size_t at = static_cast<size_t>(kScaleQuantile * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(at), sorted.end());
  return std::max(sorted[at], 1e-12f);
}

}  // namespace hl
