#include "ui/comparison.h"

#include <QCoreApplication>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/passes/error_colours.h"

namespace hl::ui {
namespace {

constexpr int kLegendSteps = 256;

QString say(const char* text) { return QCoreApplication::translate("hl::ui::Comparison", text); }

Image difference(const Image& a, const Image& b, float scale) {
  Image out(a.width, a.height, 3);
  for (size_t i = 0; i < out.data.size(); ++i) out.data[i] = (a.data[i] - b.data[i]) * scale;
  return out;
}

Image ramp(float from, float to) {
  Image out(kLegendSteps, 1, 1);
  for (int i = 0; i < kLegendSteps; ++i) out.data[static_cast<size_t>(i)] = from + (to - from) * static_cast<float>(i) / (kLegendSteps - 1);
  return out;
}

QImage signedColours(const Image& map, float scale) { return pictureOf(falseColour(map, scale, ColourScale::Signed), map.width, map.height); }

/// Differences and maps: pixel against pixel.
void renderMap(const ComparisonJob& job, ComparisonPictures& out) {
  const Image &a = *job.a, &b = *job.b;
  if (a.width != b.width || a.height != b.height) {
    out.refused = say("A has %1 \u00d7 %2 pixels and B %3 \u00d7 %4: only pictures of one size can be subtracted").arg(a.width).arg(a.height).arg(b.width).arg(b.height);
    return;
  }
  if (job.mode == CompareMode::Difference) {
    const float scale = 1 / std::max(job.gain, 1e-6f);
    out.a = signedColours(difference(a, b, std::exp2(job.display.exposure)), scale);
    out.legend = signedColours(ramp(-scale, scale), scale);
    out.low = say("A darker by %1").arg(static_cast<double>(scale), 0, 'g', 3);
    out.high = say("A brighter by %1").arg(static_cast<double>(scale), 0, 'g', 3);
    return;
  }
  try {
    const MetricInfo& metric = metricInfo(job.metric);
    const MetricResult result = measured(job.metric, a, b, job.context, howShown(job.display, true));
    const Image& map = result.map;
    out.value = errorText(job.metric, result);
    out.a = pictureOf(errorColours(map, metric), map.width, map.height);
    // The legend goes through the same colours as the map.
    const double least = metric.mapSigned ? -static_cast<double>(colourScale(map)) : metric.mapEnd > 0 ? metric.perfect : 0;
    const double most = metric.mapEnd > 0 && !metric.mapSigned ? metric.perfect + static_cast<double>(metric.mapEnd) : static_cast<double>(colourScale(map));
    out.legend = pictureOf(errorColours(ramp(static_cast<float>(least), static_cast<float>(most)), metric), kLegendSteps, 1);
    out.low = QString::number(least, 'g', 3);
    out.high = QString::fromStdString(job.metric) + QLatin1Char(' ') + (metric.perfect > 0 && metric.mapEnd > 0 ? QString::number(metric.perfect - static_cast<double>(metric.mapEnd), 'g', 3) : QString::number(most, 'g', 3));
  } catch (const Error& e) {
    out.refused = QString::fromUtf8(e.what());
  }
}

}  // namespace

MetricResult measured(const std::string& metric, const Image& value, const Image& against, const ErrorContext& context, MeasureOptions options) {
  if (context.surfaces && context.surfaces->size() == value.pixels()) options.mask = *context.surfaces;
  return measure(metric, value, context.truth ? *context.truth : ReferenceImage{against, {}, {}}, options);
}

QString errorText(const std::string& metric, const MetricResult& result) {
  const QString name = QString::fromStdString(metric);
  if (result.nonFinite > 0) return say("%1: %2 pixels are NaN or Inf").arg(name).arg(result.nonFinite);
  return std::isnan(result.value) ? name + QStringLiteral(" NaN") : QStringLiteral("%1 %2").arg(name).arg(result.value, 0, 'g', 3);
}

MeasureOptions howShown(const hl::Display& display, bool wantMap) {
  MeasureOptions options;
  options.wantMap = wantMap;
  options.appearance.exposure = display.exposure;
  options.appearance.curve = toneMapCurve(display.toneMap);
  return options;
}

QImage pictureOf(std::vector<unsigned char> rgba, int width, int height) {
  auto* bytes = new std::vector<unsigned char>(std::move(rgba));
  return QImage(bytes->data(), width, height, width * 4, QImage::Format_RGBX8888, [](void* held) { delete static_cast<std::vector<unsigned char>*>(held); }, bytes);
}

QImage ToneMappedImages::of(const std::shared_ptr<const Image>& image, const hl::Display& display) {
  for (const Entry& e : entries_)
    if (e.image == image && e.display == display) return e.picture;
  Entry& e = entries_[next_++ % entries_.size()];
  e = {image, display, pictureOf(toneMapOnHost(*image, display), image->width, image->height)};
  return e.picture;
}

ComparisonPictures renderComparison(const ComparisonJob& job, ToneMappedImages& toneMapped) {
  ComparisonPictures out;
  out.mode = job.mode;
  if (job.mode == CompareMode::Off || !job.a || !job.b) return out;
  if (job.mode == CompareMode::Difference || job.mode == CompareMode::ErrorMap) {
    renderMap(job, out);
    return out;
  }
  hl::Display display = job.display;
  display.view.clear();  // has no say in the tone map
  out.a = toneMapped.of(job.a, display);
  out.b = toneMapped.of(job.b, display);
  return out;
}

}  // namespace hl::ui
