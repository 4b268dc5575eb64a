#pragma once
// The numbers one path is made of: a function of (seed, half, receiver, sample, bounce, purpose) and nothing else.
#include "shaders/shared/random.h"
#include "shaders/shared/sampling.h"

namespace hl {

enum class SamplePurpose : uint32_t { Direction, LightPoint, Choices, Count, Environment = Count };

class PathSampler {
 public:
  /// `stream` keeps uses apart that share a receiver: the halves, and direct from indirect light.
  PathSampler(uint64_t seed, uint32_t stream, uint32_t receiver) {
    using shared::pcgHash;
    key_ = pcgHash(receiver ^ pcgHash(stream ^ pcgHash(static_cast<uint32_t>(seed) ^
                                                       pcgHash(static_cast<uint32_t>(seed >> 32)))));
  }
  void begin(uint32_t sample) { sample_ = sample, random_ = shared::randomInit(key_, sample, 0x5eedu); }

  vec2 next(uint32_t bounce, SamplePurpose purpose) {
    if (bounce < kStratifiedBounces) {
      // The environment's pairs lie apart, so that all others stay as they are in scenes without one.
      const uint32_t pair = purpose == SamplePurpose::Environment ? kEnvironmentPairs + bounce
                                                                  : bounce * static_cast<uint32_t>(SamplePurpose::Count) + static_cast<uint32_t>(purpose);
      return shared::shuffledSobolPoint(sample_, shared::pcgHash(key_ ^ (pair * 0x9e3779b9u + 0x7f4a7c15u)));
    }
    const float x = shared::randomFloat(random_);
    return vec2(x, shared::randomFloat(random_));
  }

 private:
  // Later bounces see so many dimensions before them that stratifying them gains nothing.
  static constexpr uint32_t kStratifiedBounces = 4, kEnvironmentPairs = 1024;
  uint32_t key_ = 0, sample_ = 0;
  shared::Random random_{};
};

}  // namespace hl
