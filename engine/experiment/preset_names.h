#pragma once
// How a preset spells what is an enum or a float in memory, and its limits.
#include <string>

namespace hl {

inline constexpr int kMaxPresetSide = 8192;  ///< pixels; the session's limit
inline constexpr int kMaxExposure = 64;      ///< stops
inline constexpr float kLowestRate = 1e-3f, kHighestRate = 1e4f;  ///< of an animation, frames a second

/// In the order of ToneMap.
inline constexpr const char* kToneMapNames[] = {"linear", "aces", "reinhard"};

/// The shortest text that reads back as the same float.
std::string shortestText(float);

/// Angles are radians in memory and degrees in files; the shortest number of degrees that reads back as the same float.
float radiansOf(double degrees);
double degreesOf(float radians);

}  // namespace hl
