#pragma once
// Sixteen rays component by component, and what they hit: for passes that make and use their rays where they are cast.
#include <array>
#include <cstddef>
#include <cstdint>

namespace hl {

inline constexpr uint32_t kPacketRays = 16;

/// Rays as in shared::Ray, finite and with directions that are not zero; hits as in shared::Hit, of which a miss defines the primitive alone.
/// Meant for rays that start close to each other and go the same way; others are cast at a third to a half of the rate of a batch.
struct alignas(64) RayPacket {
  using Floats = std::array<float, kPacketRays>;
  Floats originX, originY, originZ, tMin, directionX, directionY, directionZ, tMax;
  Floats t, u, v;
  std::array<uint32_t, kPacketRays> primitive;
};

}  // namespace hl
