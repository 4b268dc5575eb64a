#pragma once
// What a run of the reference has summed up so far, and its file.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/ext/vector_double3.hpp>

#include "engine/core/math.h"

namespace hl {

/// How far a receiver is: samples in each of its two halves.
struct ReferenceCount {
  uint32_t paths = 0;
  uint32_t direct = 0;  ///< samples of emissive surfaces and the sky
  bool operator==(const ReferenceCount&) const = default;
};

/// How much there is to sum up.
struct ReferenceShape {
  uint32_t receivers = 0;
  uint32_t buckets = 0;  ///< kept a receiver
  bool lobes = false;    ///< glossy receivers are among them
  bool operator==(const ReferenceShape&) const = default;
};

/// Sums over samples, by receiver, both halves apart. Indirect sums are added up in double within a pass and kept in float between passes: in
/// double they would take 0.8 kB a receiver, and rounding once a pass leaves an error of 6e-8 times the root of the passes. Every receiver is at `now`, or, where `ahead` is set, already at `next`: so a pass that was
/// stopped half-way is neither lost nor done twice.
struct ReferenceState : ReferenceShape {
  ReferenceCount now, next;
  uint64_t backFaceHits = 0, nonFinite = 0, paths = 0, rays = 0;
  std::vector<vec3> indirect[2];  ///< receivers * buckets, a receiver's buckets together
  std::vector<vec3> specular[2];  ///< the same of the receivers' lobes; empty without `lobes`
  std::vector<glm::dvec3> extended[2];  ///< receivers: from emissive surfaces and the sky
  std::vector<glm::dvec3> extendedSpecular[2];  ///< receivers: what lobes reflect of those; empty without `lobes`
  std::vector<vec3> punctualSpecular;  ///< receivers: of punctual lights, exact; likewise
  std::vector<vec3> punctual;     ///< receivers: exact, not a sum
  std::vector<uint8_t> ahead;     ///< receivers

  ReferenceState() = default;
  explicit ReferenceState(const ReferenceShape&);
};

/// Where a state of `key` with `samples` paths a half (once its pass is complete) is kept.
std::filesystem::path referenceCacheFile(const std::string& key, uint32_t samples);
/// That `bytes` are a whole and unaltered state, and that of the key and samples that the file's name says. @throws Error(BadInput) with what is wrong.
void checkReferenceFile(const std::string& name, std::string_view bytes);

/// The furthest state stored under `key` with at most `maxSamples` paths a half, or nothing. Only states with that many, or with a multiple of `pass`,
/// will do: going on from others would round at other places than a run in one go. A file that is cut off, altered or of another shape is passed over
/// with a warning.
std::optional<ReferenceState> loadReference(const std::string& key, const ReferenceShape&, uint32_t maxSamples, uint32_t pass);

/// Atomically. The oldest other references go where the folder would hold more than kReferenceCacheBytes.
/// @throws Error(Run) where the file cannot be written.
void storeReference(const std::string& key, const ReferenceState&);
inline constexpr uint64_t kReferenceCacheBytes = uint64_t{4} << 30;

}  // namespace hl
