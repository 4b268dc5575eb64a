#pragma once
// Composite, tone map and the views of the viewport.
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
  bool operator==(const Display&) const = default;
};

/// final, indirect (irradiance times albedo / pi), indirect_irradiance, direct, albedo, normal, position, emission, error, reference ...
struct ViewInfo {
  std::string id, label;
};
const std::vector<ViewInfo>& displayViews();

/// Radiance towards the camera: emission + (direct + indirect) albedo / pi, or the sky. RGBA32F. Pass "composite".
GpuImage recordComposite(FrameGraph&, const GBuffer&, const GpuImage& direct, const GpuImage& indirect, vec3 sky);
/// Display-referred RGBA8 of `source`, stretched to the frame. Pass "tone map". Counts non-finite and negative values into `counters` (2 uints).
GpuImage recordToneMap(FrameGraph&, const GpuImage& source, const Display&, bool sceneReferred, int width, int height, const Buffer& counters);
/// The same tone map on the host, for images (reference, error maps). RGBA8 rows from the top.
std::vector<unsigned char> toneMapOnHost(const Image& rgb, const Display&);
/// Error map in false colours (viridis), from 0 to `scale`. RGBA8.
std::vector<unsigned char> falseColour(const Image& map, float scale);

}  // namespace hl
