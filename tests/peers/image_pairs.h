#pragma once
// Pairs of pictures that other people's metrics were asked about. metric_goldens.py makes the same ones, to the bit of a float or nearly so.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/image_io.h"
#include "engine/metrics/appearance.h"

namespace hl::peers {

struct ImagePair {
  std::string id;
  Image value, reference;
  Appearance appearance;
};

/// Jarzynski and Olano's PCG hash, to [0, 1).
inline double uniform(uint32_t x) {
  const uint32_t state = x * 747796405u + 2891336453u;
  const uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return static_cast<double>((word >> 22u) ^ word) / 4294967296.0;
}

template <class Value>
Image imageOf(int width, int height, Value value) {
  Image out(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        out.pixel(x, y)[c] = static_cast<float>(value(x, y, c, static_cast<uint32_t>((y * width + x) * 3 + c)));
  return out;
}

inline double clamp01(double x) { return std::fmin(std::fmax(x, 0.0), 1.0); }

/// `data`: the folder with the pair from a real render.
inline std::vector<ImagePair> imagePairs(const std::filesystem::path& data) {
  std::vector<ImagePair> pairs;
  const Appearance stored{.stored = true};
  {
    const auto base = [](int x, int y, int c) { return 0.1 + 0.7 * (c == 0 ? x / 60.0 : c == 1 ? y / 46.0 : (x + y) / 106.0); };
    pairs.push_back({"ldr_noise", imageOf(61, 47, [&](int x, int y, int c, uint32_t n) { return clamp01(base(x, y, c) + 0.3 * (uniform(n) - 0.5)); }),
                     imageOf(61, 47, [&](int x, int y, int c, uint32_t) { return clamp01(base(x, y, c)); }), stored});
  }
  {
    const auto board = [](int x, int y, int c) { return ((x / 9 + y / 7) % 2 == 0) == (c == 0) ? 0.85 : 0.1 + 0.2 * c; };
    pairs.push_back({"ldr_edges", imageOf(64, 48, [&](int x, int y, int c, uint32_t) { return board(x + 2, y + 1, c); }),
                     imageOf(64, 48, [&](int x, int y, int c, uint32_t) { return board(x, y, c); }), stored});
  }
  pairs.push_back({"ldr_small", imageOf(7, 5, [](int, int, int, uint32_t n) { return uniform(n + 77); }),
                   imageOf(7, 5, [](int, int, int, uint32_t n) { return uniform(n); }), stored});
  {
    const auto light = [](int x, int y, int c, uint32_t n) {
      const double spike = uniform(n / 3 + 9000) > 0.99 ? 60.0 : 0.0;
      return (0.05 + x / 40.0 * (c + 1) / 3.0) * (y < 24 ? 0.2 : 1.0) + spike;
    };
    const auto noisy = [&](int x, int y, int c, uint32_t n) { return light(x, y, c, n) * (0.7 + 0.6 * uniform(n + 555)); };
    pairs.push_back({"hdr_spikes", imageOf(64, 48, noisy), imageOf(64, 48, light), {}});
    pairs.push_back({"hdr_aces", imageOf(64, 48, noisy), imageOf(64, 48, light), {.exposure = 1.5f, .curve = shared::kToneMapAces}});
  }
  {
    const auto range = [](int x, int y, int c) { return std::exp2(x / 4.0 - 8) * (0.4 + 0.3 * c) * (y % 16 < 8 ? 1.0 : 1.3); };
    pairs.push_back({"hdr_range", imageOf(72, 40, [&](int x, int y, int c, uint32_t) { return range(x, y + 3, c) * (y < 20 ? 1.2 : 0.9); }),
                     imageOf(72, 40, [&](int x, int y, int c, uint32_t) { return range(x, y, c); }), {.curve = shared::kToneMapReinhard}});
  }
  pairs.push_back({"render", readImage(data / "cornell_value.pfm"), readImage(data / "cornell_reference.pfm"), {}});
  return pairs;
}

}  // namespace hl::peers
