#include "engine/metrics/flip_difference.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/math.h"

namespace hl {

namespace {

// The paper's constants: section 4.1 (table 1), 4.1.1 (q_c, p_c, p_t), 4.2 (w, q_f).
constexpr double kFeatureWidth = 0.082;  // degrees
constexpr float kColourPower = 0.7f, kKnee = 0.4f, kKneeValue = 0.95f, kFeaturePower = 0.5f;

/// a sqrt(pi / b) exp(-pi^2 x^2 / b) over x in degrees: one term of a contrast sensitivity function, taken to space.
struct SpatialTerm {
  double a, b;
};
constexpr SpatialTerm kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053}, kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};
constexpr double kWidestB = 0.04;
constexpr double kPiD = 3.14159265358979323846;

// Linear Rec. 709 to CIE XYZ and back; white is (1, 1, 1)'s.
const mat3 kToXyz(0.41238656f, 0.21263682f, 0.01933062f, 0.35759149f, 0.71518298f, 0.11919716f, 0.18045049f, 0.07218020f, 0.95037259f);
const vec3 kWhite = kToXyz * vec3(1);
const mat3 kFromXyz = glm::inverse(kToXyz);

struct Planes {
  std::array<Plane, 3> c;
};

/// Linearised Lab: the opponent space in which the eye's filters act. (Y, C_x, C_z)
vec3 opponent(vec3 rgb) {
  const vec3 t = kToXyz * rgb / kWhite;
  return {116 * t.y - 16, 500 * (t.x - t.y), 200 * (t.y - t.z)};
}

vec3 rgbOfOpponent(vec3 o) {
  const float y = (o.x + 16) / 116;
  return kFromXyz * (vec3(y + o.y / 500, y, y - o.z / 200) * kWhite);
}

float labCurve(float t) {
  constexpr float kDelta = 6.0f / 29;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29;
}

/// CIE L*a*b* with its chroma lessened where it is dark (the Hunt effect).
vec3 huntLab(vec3 rgb) {
  const vec3 t = kToXyz * rgb / kWhite;
  const float x = labCurve(t.x), y = labCurve(t.y), z = labCurve(t.z);
  const float lightness = 116 * y - 16;
  return {lightness, 0.01f * lightness * 500 * (x - y), 0.01f * lightness * 200 * (y - z)};
}

/// Abasi et al.'s distance for large colour differences.
float hyab(vec3 a, vec3 b) { return std::fabs(a.x - b.x) + std::sqrt((a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z)); }

struct Filters {
  std::vector<float> achromatic, redGreen, blueYellow[2];
  float share[2];                          ///< of the two terms of blue-yellow; the sum is 1
  std::vector<float> smooth, edge, point;  ///< a Gaussian, its first and its second derivative; positive and negative taps sum to 1 each
};

Filters filtersFor(float pixelsPerDegree) {
  Filters f;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(kWidestB / (2 * kPiD * kPiD)) * pixelsPerDegree));
  // The narrower ones end where a float does not see them any more.
  const auto taps = [&](SpatialTerm t) {
    const double sigma = std::sqrt(t.b / (2 * kPiD * kPiD)) * pixelsPerDegree;
    return inFloat(gaussianTaps(sigma, std::min(radius, static_cast<int>(std::ceil(6 * sigma)))));
  };
  f.achromatic = taps(kAchromatic), f.redGreen = taps(kRedGreen);
  double total[2];
  for (size_t i = 0; i < 2; ++i) {
    f.blueYellow[i] = taps(kBlueYellow[i]);
    // What the term's samples sum to over the square: the sum along a row, squared.
    double sum = 0;
    for (int x = -radius; x <= radius; ++x) sum += std::exp(-kPiD * kPiD * x * x / (kBlueYellow[i].b * pixelsPerDegree * pixelsPerDegree));
    total[i] = kBlueYellow[i].a * std::sqrt(kPiD / kBlueYellow[i].b) * sum * sum;
  }
  for (size_t i = 0; i < 2; ++i) f.share[i] = static_cast<float>(total[i] / (total[0] + total[1]));

  const double sigma = 0.5 * kFeatureWidth * pixelsPerDegree;
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  f.smooth = inFloat(gaussianTaps(sigma, reach));
  const auto balanced = [&](auto&& weight) {
    std::vector<double> raw;
    double positive = 0, negative = 0;
    for (int x = -reach; x <= reach; ++x) {
      const double w = weight(x) * std::exp(-x * x / (2 * sigma * sigma));
      (w > 0 ? positive : negative) += std::fabs(w);
      raw.push_back(w);
    }
    std::vector<float> out;
    for (const double w : raw) out.push_back(static_cast<float>(w == 0 ? 0 : w / (w > 0 ? positive : negative)));
    return out;
  };
  f.edge = balanced([](double x) { return -x; });
  f.point = balanced([&](double x) { return x * x / (sigma * sigma) - 1; });
  return f;
}

/// What one picture looks like to the eye that the method models.
struct Seen {
  Planes colour;      ///< Hunt-adjusted Lab of the filtered picture
  Plane edge, point;  ///< how much of either there is
};

Seen seen(const Image& image, const Filters& f, TaskPool* pool) {
  const int width = image.width, height = image.height;
  Planes o;
  for (Plane& plane : o.c) plane.resize(image.pixels());
  Plane grey(image.pixels());
  const auto forPixels = [&](auto&& body) {
    forRows(pool, height, [&](int first, int end) {
      for (size_t i = static_cast<size_t>(first) * static_cast<size_t>(width); i < static_cast<size_t>(end) * static_cast<size_t>(width); ++i) body(i);
    });
  };
  forPixels([&](size_t i) {
    const float* p = &image.data[i * 3];
    const vec3 c = opponent({p[0], p[1], p[2]});
    for (int k = 0; k < 3; ++k) o.c[static_cast<size_t>(k)][i] = c[k];
    grey[i] = (c.x + 16) / 116;
  });
  const auto filtered = [&](const Plane& in, const std::vector<float>& across, const std::vector<float>& down) {
    return filterColumns(filterRows(in, width, height, across, Border::Clamp, pool), width, height, down, Border::Clamp, pool);
  };
  Seen out;
  {
    const Plane y = filtered(o.c[0], f.achromatic, f.achromatic), x = filtered(o.c[1], f.redGreen, f.redGreen);
    const Plane z0 = filtered(o.c[2], f.blueYellow[0], f.blueYellow[0]), z1 = filtered(o.c[2], f.blueYellow[1], f.blueYellow[1]);
    for (Plane& plane : out.colour.c) plane.resize(image.pixels());
    forPixels([&](size_t i) {
      const vec3 rgb = rgbOfOpponent({y[i], x[i], f.share[0] * z0[i] + f.share[1] * z1[i]});
      const vec3 lab = huntLab(glm::clamp(rgb, vec3(0), vec3(1)));
      for (int k = 0; k < 3; ++k) out.colour.c[static_cast<size_t>(k)][i] = lab[k];
    });
  }
  const Plane across = filterRows(grey, width, height, f.smooth, Border::Clamp, pool);
  const auto strength = [&](const std::vector<float>& derivative) {
    Plane x = filterColumns(filterRows(grey, width, height, derivative, Border::Clamp, pool), width, height, f.smooth, Border::Clamp, pool);
    const Plane y = filterColumns(across, width, height, derivative, Border::Clamp, pool);
    forPixels([&](size_t i) { x[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]); });
    return x;
  };
  out.edge = strength(f.edge), out.point = strength(f.point);
  return out;
}

}  // namespace

Plane flipDifference(const Image& value, const Image& reference, float pixelsPerDegree, TaskPool* pool) {
  const Filters filters = filtersFor(pixelsPerDegree);
  const Seen v = seen(value, filters, pool), r = seen(reference, filters, pool);
  // The largest difference there is between colours of the screen: its blue and its green.
  const float most = std::pow(hyab(huntLab({0, 0, 1}), huntLab({0, 1, 0})), kColourPower), knee = kKnee * most;
  Plane out(value.pixels());
  forRows(pool, value.height, [&](int first, int end) {
    const size_t width = static_cast<size_t>(value.width);
    for (size_t i = static_cast<size_t>(first) * width; i < static_cast<size_t>(end) * width; ++i) {
      const auto at = [&](const Seen& s) { return vec3(s.colour.c[0][i], s.colour.c[1][i], s.colour.c[2][i]); };
      const float distance = std::pow(hyab(at(v), at(r)), kColourPower);
      const float colour = distance < knee ? distance * kKneeValue / knee : kKneeValue + (distance - knee) / (most - knee) * (1 - kKneeValue);
      const float feature = std::max(std::fabs(v.edge[i] - r.edge[i]), std::fabs(v.point[i] - r.point[i]));
      out[i] = std::pow(colour, 1 - std::pow(feature / std::sqrt(2.0f), kFeaturePower));
    }
  });
  return out;
}

}  // namespace hl
