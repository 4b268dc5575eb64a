#pragma once
// Which light paths a technique models, so that the reference can be limited to exactly these.
namespace hl {

/// Which normal weighs incoming light: the triangle's own, the smooth one tilted by the normal map, or that one where light is received for the last time
/// and the triangle's own at each bounce before.
enum class ReceiverNormal { Geometric, Mapped, MappedAtReceiver };

struct Transport {
  int bounces = 16;                  ///< indirect bounces; kAllBounces for all
  bool frontFacesOnly = false;       ///< back faces neither receive nor reflect, two-sided or not
  ReceiverNormal receiver = ReceiverNormal::Mapped;
  bool glossyLastBounce = false;     ///< the surface that the camera sees also reflects by its glossy lobe (IndirectLight::specular); all bounces before are diffuse
  bool operator==(const Transport&) const = default;
};
inline constexpr int kAllBounces = 1 << 20;
inline constexpr int kBounceBuckets = 17;  ///< bounces 1 to 16, and the rest

}  // namespace hl
