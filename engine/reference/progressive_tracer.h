#pragma once
// The reference's path tracer as a competitor: indirect irradiance at the pixels of a picture, one more path a pixel with each pass, and the time that
// tracing took. Without what makes the reference a reference: no halves, no buckets by bounce, no cache, no direct light.
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/core/image.h"
#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/reference/reference.h"

namespace hl {

class ProgressiveTracer {
 public:
  /// Of the settings, samplesPerPixel and directSamples mean nothing here. The seed must not be the reference's: its errors would be of the same noise.
  /// @throws Error(BadInput) where the receivers are not width x height.
  ProgressiveTracer(std::shared_ptr<const EmbreeScene>, std::vector<Receiver> receivers, int width, int height, const ReferenceSettings&, TaskPool&);
  ~ProgressiveTracer();

  /// One path a pixel. A cancelled pass is forgotten. @throws Error(Cancelled)
  void advance(Progress&);
  uint32_t passes() const;  ///< paths a pixel so far
  double ms() const;        ///< that those took
  Image image() const;      ///< mean indirect irradiance [W/m^2], RGB; black before the first pass

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
