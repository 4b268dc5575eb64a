// `compare`: errors of one image against another.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "app/cli_commands.h"
#include "engine/core/json_writer.h"
#include "engine/core/error.h"
#include "engine/core/image_io.h"
#include "engine/passes/display.h"

namespace hl::cli {
namespace {

// False colours end at this quantile of the map, so that one bright pixel does not darken all others.
constexpr double kMapQuantile = 0.98;

std::string extensionOf(const std::string& file) {
  std::string e = std::filesystem::path(file).extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}

/// Formats that hold what a screen shows, with the sRGB curve applied.
bool displayReferred(const std::string& file) {
  const std::string e = extensionOf(file);
  for (const char* known : {".png", ".jpg", ".jpeg", ".bmp", ".tga", ".gif", ".webp"})
    if (e == known) return true;
  return false;
}

/// Grey as three equal channels, so that it can be compared with colour; alpha is left out.
Image rgbOf(const Image& in) {
  if (in.channels == 3) return in;
  Image out(in.width, in.height, 3);
  const size_t stride = static_cast<size_t>(in.channels);
  for (size_t i = 0; i < in.pixels(); ++i)
    for (size_t c = 0; c < 3; ++c) out.data[i * 3 + c] = in.data[i * stride + (in.channels >= 3 ? c : 0)];
  return out;
}

Mask regionMask(const std::string& region, const Image& image) {
  std::array<int, 4> v{};
  const char* at = region.data();
  const char* const end = at + region.size();
  bool good = true;
  for (size_t i = 0; i < v.size() && good; ++i) {
    const auto parsed = std::from_chars(at, end, v[i]);
    good = parsed.ec == std::errc() && (i == 3 ? parsed.ptr == end : parsed.ptr != end && *parsed.ptr == ',');
    at = parsed.ptr + 1;
  }
  const auto [x, y, w, h] = v;
  if (!good) throw badInput(fmt::format("--roi {}: x,y,width,height in pixels is wanted", region));
  if (x < 0 || y < 0 || w < 1 || h < 1 || w > image.width - x || h > image.height - y)
    throw badInput(fmt::format("--roi {}: it must lie within the image, which has {}x{} pixels", region, image.width,
                               image.height));
  Mask mask(image.pixels(), 0);
  for (int row = y; row < y + h; ++row)
    for (int column = x; column < x + w; ++column)
      mask[static_cast<size_t>(row) * static_cast<size_t>(image.width) + static_cast<size_t>(column)] = 1;
  return mask;
}

float quantile(const Image& map) {
  std::vector<float> sorted;
  for (const float v : map.data)
    if (std::isfinite(v)) sorted.push_back(std::abs(v));
  if (sorted.empty()) return 1;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(kMapQuantile * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  return std::max(*at, 1e-12f);
}

void writeMap(const Image& map, const std::string& file) {
  if (!displayReferred(file)) return writeImage(file, map);
  const std::vector<unsigned char> colours = falseColour(map, quantile(map));
  Image shown(map.width, map.height, 3);
  for (size_t i = 0; i < shown.pixels(); ++i)
    for (size_t c = 0; c < 3; ++c) shown.data[i * 3 + c] = static_cast<float>(colours[i * 4 + c]) / 255.0f;
  writeImage(file, shown);
}

struct Line {
  std::string metric, roi;
  MetricResult result;
};

std::string asJson(const std::vector<Line>& lines, const char* values) {
  JsonWriter w;
  w.beginObject().key("errors").beginArray();
  for (const Line& l : lines)
    w.beginObject()
        .member("metric", l.metric)
        .member("value", l.result.value)
        .member("roi", l.roi)
        .member("standard_error", l.result.standardError)
        .member("pixels", l.result.pixels)
        .member("non_finite", l.result.nonFinite)
        .endObject();
  return w.endArray().member("values", values).endObject().str() + "\n";
}

std::string asTable(const std::vector<Line>& lines) {
  std::string out;
  for (const Line& l : lines)
    out += fmt::format("{:<8} {:<14.7g} +- {:<10.2g}{}{}\n", l.metric, l.result.value, l.result.standardError,
                       l.roi.empty() ? "" : fmt::format(" in {}", l.roi),
                       l.result.nonFinite ? fmt::format("  {} pixels are NaN or infinite", l.result.nonFinite) : "");
  return out;
}

}  // namespace

int compare(const GlobalOptions& global, const CompareOptions& o) {
  checkMetrics(o.metrics);
  std::vector<std::string> metrics = o.metrics;
  if (metrics.empty())
    for (const MetricInfo& m : metricInfos()) metrics.emplace_back(m.id);
  if (!o.map.empty()) checkOutputImage("--map", o.map, {".exr", ".pfm", ".png"});
  // Two pictures as shown are compared as they are stored; one of them against a linear image is made linear first.
  const bool shown = displayReferred(o.value) && displayReferred(o.reference);
  const Image a = rgbOf(readImage(o.value, !shown)), b = rgbOf(readImage(o.reference, !shown));
  if (a.width != b.width || a.height != b.height)
    throw badInput(fmt::format("{} has {}x{} pixels, {} has {}x{}: only images of one size can be compared", o.value,
                               a.width, a.height, o.reference, b.width, b.height));
  std::vector<std::pair<std::string, Mask>> regions;
  if (o.regions.empty()) regions.emplace_back("", Mask());
  for (const std::string& r : o.regions) regions.emplace_back(r, regionMask(r, a));

  std::vector<Line> lines;
  uint64_t nonFinite = 0;
  for (const auto& [name, mask] : regions)
    for (const std::string& m : metrics) {
      lines.push_back({m, name, measure(m, a, {b, {}, {}}, mask)});
      nonFinite = std::max(nonFinite, lines.back().result.nonFinite);
    }
  print(global.json ? asJson(lines, shown ? "stored" : "linear") : asTable(lines));
  if (!o.map.empty()) writeMap(measure(metrics.front(), a, {b, {}, {}}, {}, true).map, o.map);
  if (nonFinite > 0)
    throw Error(ErrorKind::Run, fmt::format("{} pixels are NaN or infinite: the comparison fails", nonFinite));
  return 0;
}

}  // namespace hl::cli
