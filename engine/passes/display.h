#pragma once
// Composite, tone map and the views of the viewport.
#include <cstdint>
#include <string>
#include <vector>

#include "engine/gpu/frame_graph.h"
#include "engine/passes/gbuffer.h"

namespace hl {

enum class ToneMap { Linear, Aces, Reinhard };

struct Display {
  float exposure = 0;                 ///< stops
  ToneMap toneMap = ToneMap::Linear;  ///< then sRGB
  std::string view = "final";         ///< an id of displayViews(), or of a technique's debugViews()
  bool showInvalid = false;           ///< NaN, Inf and negative pixels in loud colours
  std::string errorMetric = "relmse";  ///< whose map the error views show
  bool operator==(const Display&) const = default;
};

/// final, indirect (irradiance times albedo / pi), indirect_irradiance, direct, albedo, normal, position, emission,
/// error, reference ...
struct ViewInfo {
  std::string id, label;
};
const std::vector<ViewInfo>& displayViews();

/// Radiance towards the camera: emission + (direct + indirect) albedo / pi + specular, or the sky. RGBA32F. Pass "composite".
/// Without `direct` it is the indirect light alone: no emission, no sky; pass "composite: indirect". Any image may
/// be empty. `specular`, `directSpecular`: radiance that lobes reflect, of indirect and of direct light.
GpuImage recordComposite(FrameGraph&, const GBuffer&, const GpuImage& direct, const GpuImage& indirect, vec3 sky, const GpuImage& specular = {},
                         const GpuImage& directSpecular = {});
/// Adds the environment map to a composite, where the camera sees no surface. Pass "background"; skipped without a map.
void recordBackground(FrameGraph&, const GBuffer&, const GpuScene&, const Camera&, const GpuImage& radiance);
/// Display-referred RGBA8 of `source` (float or RGBA8; empty: black), stretched to the frame. Pass "tone map". Counts
/// pixels that are not finite, and pixels with a negative channel (of radiance and colours), into `counters` (2 uints,
/// set to 0 first).
GpuImage recordToneMap(FrameGraph&, const GpuImage& source, const Display&, bool sceneReferred, int width, int height,
                       const Buffer& counters);
/// The same tone map on the host, for images (reference, error maps). RGBA8 rows from the top.
std::vector<unsigned char> toneMapOnHost(const Image& rgb, const Display&);
/// The tone map's number in shaders/shared/tone_map.h.
uint32_t toneMapCurve(ToneMap);
/// Signed: from -scale, blue, through 0, near white, to scale, orange: told apart under the common colour deficiencies, and equally dark at both ends.
enum class ColourScale { Viridis, Magma, Signed };
/// False colours of a map (the mean of its channels) from 0 to `scale`, or from -scale. RGBA8. What they mean for an error map: error_colours.h.
std::vector<unsigned char> falseColour(const Image& map, float scale, ColourScale = ColourScale::Viridis);
/// Where a map's colours end: the quantile 0.98 of its absolute values, so that one bright pixel does not darken all others. Above 0; not finite ones are
/// passed over.
float colourScale(const Image& map);

}  // namespace hl
