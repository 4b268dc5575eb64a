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
#include "engine/core/task_pool.h"
#include "engine/experiment/preset_names.h"
#include "engine/passes/display.h"
#include "engine/passes/error_colours.h"

namespace hl::cli {
namespace {

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

void writeMap(const Image& map, const MetricInfo& metric, const std::string& file) {
  if (!displayReferred(file)) return writeImage(file, map);
  const std::vector<unsigned char> colours = errorColours(map, metric);
  Image shown(map.width, map.height, 3);
  for (size_t i = 0; i < shown.pixels(); ++i)
    for (size_t c = 0; c < 3; ++c) shown.data[i * 3 + c] = static_cast<float>(colours[i * 4 + c]) / 255.0f;
  writeImage(file, shown);
}

ToneMap toneMapNamed(const std::string& name) {
  const auto found = std::find(std::begin(kToneMapNames), std::end(kToneMapNames), name);
  if (found == std::end(kToneMapNames)) throw badInput(fmt::format("--tone-map {}: one of {} is wanted", name, fmt::join(kToneMapNames, ", ")));
  return static_cast<ToneMap>(found - std::begin(kToneMapNames));
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
    out += fmt::format("{:<11} {:<14.7g} +- {:<10.2g}{}{}\n", l.metric, l.result.value, l.result.standardError,
                       l.roi.empty() ? "" : fmt::format(" in {}", l.roi),
                       l.result.nonFinite ? fmt::format("  {} pixels are NaN or infinite", l.result.nonFinite) : "");
  return out;
}

}  // namespace

int compare(const GlobalOptions& global, const CompareOptions& o) {
  checkMetrics(o.metrics);
  if (!o.map.empty()) checkOutputImage("--map", o.map, {".exr", ".pfm", ".png"});
  // Two pictures as shown are compared as they are stored; one of them against a linear image is made linear first.
  const bool shown = displayReferred(o.value) && displayReferred(o.reference);
  std::vector<std::string> metrics = o.metrics;
  for (const std::string& m : metrics)
    if (shown && metricInfo(m).sceneReferred)
      throw badInput(fmt::format("{} looks at light over a range of exposures, and {} holds what a screen shows: two EXR or PFM files are wanted", m, o.value));
  if (metrics.empty())
    for (const MetricInfo& m : metricInfos())
      if (!shown || !m.sceneReferred) metrics.emplace_back(m.id);
  if (shown && (o.exposure != 0 || o.toneMap != kToneMapNames[0]))
    throw badInput(fmt::format("--exposure and --tone-map show light, and {} is a picture already", o.value));
  const Image a = rgbOf(readImage(o.value, !shown)), b = rgbOf(readImage(o.reference, !shown));
  if (a.width != b.width || a.height != b.height)
    throw badInput(fmt::format("{} has {}x{} pixels, {} has {}x{}: only images of one size can be compared", o.value,
                               a.width, a.height, o.reference, b.width, b.height));
  std::vector<std::string> names;
  std::vector<Mask> regions;
  if (o.regions.empty()) names.emplace_back(), regions.emplace_back();
  for (const std::string& r : o.regions) names.push_back(r), regions.push_back(regionMask(r, a));
  TaskPool pool;
  MeasureOptions options;
  options.pool = &pool;
  options.appearance = {.exposure = o.exposure, .curve = toneMapCurve(toneMapNamed(o.toneMap)), .stored = shown};

  std::vector<Line> lines;
  uint64_t nonFinite = 0;
  for (const std::string& m : metrics) {
    const std::vector<MetricResult> results = measureRegions(m, a, {b, {}, {}}, options, regions);
    for (size_t i = 0; i < results.size(); ++i) {
      lines.push_back({m, names[i], results[i]});
      nonFinite = std::max(nonFinite, results[i].nonFinite);
    }
  }
  std::stable_sort(lines.begin(), lines.end(), [&](const Line& x, const Line& y) {
    return std::find(names.begin(), names.end(), x.roi) < std::find(names.begin(), names.end(), y.roi);
  });
  print(global.json ? asJson(lines, shown ? "stored" : "linear") : asTable(lines));
  if (!o.map.empty()) {
    options.wantMap = true;
    writeMap(measure(metrics.front(), a, {b, {}, {}}, options).map, metricInfo(metrics.front()), o.map);
  }
  if (nonFinite > 0)
    throw Error(ErrorKind::Run, fmt::format("{} pixels are NaN or infinite: the comparison fails", nonFinite));
  return 0;
}

}  // namespace hl::cli
