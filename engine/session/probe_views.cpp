#include "engine/session/probe_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/placement/coverage.h"
#include "engine/session/session_impl.h"

namespace hl {
namespace {

constexpr const char *kProbes = "probes", *kCoverage = "probe_coverage", *kSeen = "probe_seen";
/// Rays of one picture of the heat map, about: with more probes its blocks of pixels are larger.
constexpr double kMapRays = 1 << 20;
constexpr float kSeenOffset = 1e-5f;  ///< in front of the surface, as a share of the scene's diagonal
constexpr uint32_t kPickedSamples = 4096;

struct Colour {
  unsigned char r, g, b;
};
constexpr Colour kPlaced{236, 236, 236}, kInside{230, 50, 40}, kSelected{255, 205, 40}, kUncovered{214, 39, 140};

void set(std::vector<unsigned char>& rgba, size_t pixel, Colour c, float light = 1) {
  const unsigned char channels[3] = {c.r, c.g, c.b};
  for (size_t k = 0; k < 3; ++k) rgba[4 * pixel + k] = static_cast<unsigned char>(std::clamp(static_cast<float>(channels[k]) * light, 0.0f, 255.0f));
}

/// Where the ray meets the ball, in lengths of `direction`; none where it misses or starts inside.
std::optional<float> meetBall(vec3 origin, vec3 direction, vec3 centre, float radius) {
  const vec3 to = centre - origin;
  const float d2 = glm::dot(direction, direction), along = glm::dot(to, direction) / d2;
  const vec3 off = to - direction * along;
  const float rest = radius * radius - glm::dot(off, off);
  if (rest < 0) return std::nullopt;
  const float t = along - std::sqrt(rest / d2);
  return t > 0 ? std::optional(t) : std::nullopt;
}

}  // namespace

const std::vector<ViewInfo>& probeViews() {
  static const std::vector<ViewInfo> views = {{kProbes, "Probes (red: inside geometry; yellow: picked)"},
                                              {kCoverage, "How many probes see each point (magenta: none)"},
                                              {kSeen, "What the picked probe sees"}};
  return views;
}
bool isProbeView(const std::string& id) {
  return std::any_of(probeViews().begin(), probeViews().end(), [&](const ViewInfo& v) { return v.id == id; });
}

float probeMarkRadius(const Bounds& bounds) {
  if (bounds.empty()) return 0;
  const vec3 side = bounds.max - bounds.min;
  return kProbeMarkRadius * std::max({side.x, side.y, side.z});
}

std::optional<uint32_t> probeOnRay(std::span<const vec3> probes, const CameraBasis& camera, vec3 direction, float radius) {
  std::optional<uint32_t> best;
  float nearest = std::numeric_limits<float>::infinity();
  for (uint32_t i = 0; i < probes.size(); ++i)
    if (const auto t = meetBall(camera.origin, direction, probes[i], radius); t && *t < nearest) nearest = *t, best = i;
  return best;
}

/// A ball under the pixel, else the nearest probe that sees the picked point.
void Session::Impl::pickProbe() {
  pickedProbe.reset();
  if (!placed || !technique->needs().probes || placed->count() == 0) return;
  const CameraBasis basis = cameraBasis(camera(), static_cast<float>(gbuffer.width) / static_cast<float>(gbuffer.height));
  const vec3 direction = pixelDirection(basis, static_cast<float>(picked.x) + 0.5f, static_cast<float>(picked.y) + 0.5f, gbuffer.width, gbuffer.height);
  freshEmbree();
  const float offset = kSeenOffset * scene->bounds.diagonal();
  pickedProbe = probeOnRay(placed->positions, basis, direction, probeMarkRadius(scene->bounds));
  if (!pickedProbe && picked.triangle != kNone) {
    float nearest = std::numeric_limits<float>::infinity();
    for (uint32_t i = 0; i < placed->count(); ++i) {
      const float distance = glm::length(placed->positions[i] - picked.position);
      if (distance < nearest && probeSees(*embree, placed->positions[i], {picked.position, picked.normal, false}, offset)) nearest = distance, pickedProbe = i;
    }
  }
  if (!pickedProbe) return;
  const vec3 at = placed->positions[*pickedProbe] + scene->report.recentred;
  const std::vector<SurfaceSample> samples = sampleSurfaces(*scene, kPickedSamples);
  const double share = coverageOf(*embree, std::span(&placed->positions[*pickedProbe], 1), samples, offset, pool, *progress);
  pickReport.facts.emplace_back("probe", fmt::format("{} of {} at ({:.3f}, {:.3f}, {:.3f}){}", *pickedProbe + 1, placed->count(), at.x, at.y, at.z,
                                                     placed->inside[*pickedProbe] ? ", inside geometry" : ""));
  pickReport.facts.emplace_back("it sees", fmt::format("{:.1f} % of the surfaces' area{}", 100 * share, atlas ? fmt::format(", {:.4g} m^2", share * atlas->report.area) : ""));
}

bool Session::Impl::showProbeView(FrameResult& r) {
  const std::string& id = preset.display.view;
  if (!isProbeView(id)) return false;
  if (!placed) {
    if (r.message.empty()) r.message = "there are no probes yet";
    return false;
  }
  const int width = r.width, height = r.height;
  const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  r.display.resize(pixels * 4);
  device.download(displayImage, r.display.data(), r.display.size());
  const Image position = device.download(gbuffer.position), normal = device.download(gbuffer.geometricNormal);
  const auto place = [&](size_t i) { return vec3(position.data[4 * i], position.data[4 * i + 1], position.data[4 * i + 2]); };
  const auto sampleAt = [&](size_t i) { return SurfaceSample{place(i), vec3(normal.data[4 * i], normal.data[4 * i + 1], normal.data[4 * i + 2]), false}; };
  const auto surface = [&](size_t i) { return position.data[4 * i + 3] != 0; };
  const float offset = kSeenOffset * scene->bounds.diagonal();
  freshEmbree();

  if (id == kCoverage) {
    const int side = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(pixels) * static_cast<double>(std::max<size_t>(1, placed->count())) / kMapRays))));
    const int across = (width + side - 1) / side, down = (height + side - 1) / side;
    Image map(width, height, 1);
    pool.parallelFor(static_cast<size_t>(across) * static_cast<size_t>(down), 16, [&](size_t begin, size_t end, unsigned) {
      for (size_t b = begin; b < end; ++b) {
        const int x0 = static_cast<int>(b) % across * side, y0 = static_cast<int>(b) / across * side;
        const size_t middle = static_cast<size_t>(std::min(height - 1, y0 + side / 2)) * static_cast<size_t>(width) + static_cast<size_t>(std::min(width - 1, x0 + side / 2));
        float seen = 0;
        if (surface(middle)) {
          const SurfaceSample s = sampleAt(middle);
          for (const vec3 p : placed->positions) seen += probeSees(*embree, p, s, offset) ? 1.0f : 0.0f;
        }
        for (int y = y0; y < std::min(height, y0 + side); ++y)
          for (int x = x0; x < std::min(width, x0 + side); ++x) map.data[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] = surface(middle) ? seen : -1;
      }
    });
    const float most = std::max(1.0f, *std::max_element(map.data.begin(), map.data.end()));
    const std::vector<unsigned char> colours = falseColour(map, most);
    for (size_t i = 0; i < pixels; ++i) {
      if (!surface(i) || map.data[i] < 0) continue;
      if (map.data[i] == 0)
        set(r.display, i, kUncovered);
      else
        std::copy_n(&colours[4 * i], 3, &r.display[4 * i]);
    }
  }
  if (id == kSeen && pickedProbe) {
    const vec3 from = placed->positions[*pickedProbe];
    pool.parallelFor(pixels, 1024, [&](size_t begin, size_t end, unsigned) {
      for (size_t i = begin; i < end; ++i) {
        if (!surface(i) || probeSees(*embree, from, sampleAt(i), offset)) continue;
        const float grey = 0.25f * (static_cast<float>(r.display[4 * i]) + static_cast<float>(r.display[4 * i + 1]) + static_cast<float>(r.display[4 * i + 2])) / 3;
        set(r.display, i, {60, 60, 70}, 0.3f + grey / 255);
      }
    });
  }
  if (id == kSeen && !pickedProbe && r.message.empty()) r.message = "click a probe, or a point that one sees";

  // Balls, in front of what is behind them; those inside geometry shine through it, or nobody would ever see them.
  const CameraBasis basis = cameraBasis(r.camera, static_cast<float>(width) / static_cast<float>(height));
  const float radius = probeMarkRadius(scene->bounds);
  const float tall = glm::length(basis.down), wide = glm::length(basis.right);
  std::vector<float> depth(pixels, std::numeric_limits<float>::infinity());
  for (size_t i = 0; i < placed->count(); ++i) {
    const vec3 to = placed->positions[i] - basis.origin;
    const float ahead = glm::dot(to, basis.forward);
    if (!(ahead > radius)) continue;
    const auto at = [&](vec3 axis, float half, int size) { return (glm::dot(to, axis) / (half * half) / ahead * 0.5f + 0.5f) * static_cast<float>(size); };
    const float x = at(basis.right, wide, width), y = at(basis.down, tall, height);
    const float rx = radius / (ahead - radius) / wide * 0.5f * static_cast<float>(width) + 1, ry = radius / (ahead - radius) / tall * 0.5f * static_cast<float>(height) + 1;
    const auto clamped = [](float v, int size) { return static_cast<int>(std::clamp(v, 0.0f, static_cast<float>(size))); };
    for (int py = clamped(y - ry, height); py < clamped(y + ry + 1, height); ++py)
      for (int px = clamped(x - rx, width); px < clamped(x + rx + 1, width); ++px) {
        const vec3 direction = pixelDirection(basis, static_cast<float>(px) + 0.5f, static_cast<float>(py) + 0.5f, width, height);
        const auto t = meetBall(basis.origin, direction, placed->positions[i], radius);
        if (!t) continue;
        const size_t pixel = static_cast<size_t>(py) * static_cast<size_t>(width) + static_cast<size_t>(px);
        const bool buried = placed->inside[i] != 0;
        const float behind = surface(pixel) && !buried ? glm::length(place(pixel) - basis.origin) / glm::length(direction) : std::numeric_limits<float>::infinity();
        if (*t > behind || *t >= depth[pixel]) continue;
        depth[pixel] = *t;
        const vec3 n = glm::normalize(basis.origin + direction * *t - placed->positions[i]);
        const float light = 0.35f + 0.65f * std::max(0.0f, -glm::dot(n, glm::normalize(direction)));
        set(r.display, pixel, pickedProbe && *pickedProbe == i ? kSelected : buried ? kInside : kPlaced, light);
      }
  }
  return true;
}

}  // namespace hl
