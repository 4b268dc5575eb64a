#pragma once
// The scene's environment map as a light: looked up by direction, and sampled in proportion to luminance times solid angle.
#include <filesystem>
#include <vector>

#include "engine/scene/scene.h"
#include "shaders/shared/environment.h"

namespace hl {

/// Larger maps are refused.
inline constexpr int kMostEnvironmentTexels = 1 << 23;

/// From an equirectangular image (PFM; EXR, HDR and the rest through the import module). Negative texels become 0 and are counted in `negative`.
/// @throws Error(BadInput): the file is missing, is no image, is too large, or has a texel that is not finite (which).
Environment loadEnvironment(const std::filesystem::path& file, uint64_t& negative);

struct EnvironmentSample {
  vec3 direction{0, 1, 0}, radiance{0.0f};
  float pdf = 0;  ///< by solid angle; 0: nothing shines
};

class EnvironmentLight {
 public:
  EnvironmentLight() = default;
  explicit EnvironmentLight(const Environment&);
  bool shines() const { return info_.power > 0; }
  vec3 radiance(vec3 direction) const { return shines() ? radiance_[shared::environmentTexel(info_, direction)] : vec3(0.0f); }
  /// Of `sample` choosing a direction in which this radiance is seen.
  float pdf(vec3 radianceSeen) const { return shines() ? luminance(radianceSeen) / info_.power : 0.0f; }
  EnvironmentSample sample(vec2 u) const;

  const shared::EnvironmentInfo& info() const { return info_; }
  const std::vector<vec3>& texels() const { return radiance_; }  ///< scaled, rows from the top
  /// Cumulative up to and with each: the rows, then each row's texels.
  const std::vector<float>& table() const { return table_; }

 private:
  shared::EnvironmentInfo info_{};
  std::vector<vec3> radiance_;
  std::vector<float> table_;
};

}  // namespace hl
