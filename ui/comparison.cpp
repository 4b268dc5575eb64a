#include "ui/comparison.h"

#include <QCoreApplication>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/metrics/metrics.h"

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

QImage colours(const Image& map, float scale, bool isSigned) {
  return pictureOf(falseColour(map, scale, isSigned ? ColourScale::Signed : ColourScale::Viridis), map.width, map.height);
}

/// Differences and maps: pixel against pixel.
void renderMap(const ComparisonJob& job, ComparisonPictures& out) {
  const Image &a = *job.a, &b = *job.b;
  if (a.width != b.width || a.height != b.height) {
    out.refused = say("A has %1 \u00d7 %2 pixels and B %3 \u00d7 %4: only pictures of one size can be subtracted").arg(a.width).arg(a.height).arg(b.width).arg(b.height);
    return;
  }
  if (job.mode == CompareMode::Difference) {
    const float scale = 1 / std::max(job.gain, 1e-6f);
    out.a = colours(difference(a, b, std::exp2(job.display.exposure)), scale, true);
    out.legend = colours(ramp(-scale, scale), scale, true);
    out.low = say("A darker by %1").arg(static_cast<double>(scale), 0, 'g', 3);
    out.high = say("A brighter by %1").arg(static_cast<double>(scale), 0, 'g', 3);
    return;
  }
  Image map;
  try {
    map = measure(job.metric, a, ReferenceImage{b, {}, {}}, {}, true).map;
  } catch (const Error& e) {
    out.refused = QString::fromUtf8(e.what());
    return;
  }
  const bool isSigned = std::any_of(map.data.begin(), map.data.end(), [](float v) { return v < 0; });
  const float scale = colourScale(map);
  out.a = colours(map, scale, isSigned);
  out.legend = colours(ramp(isSigned ? -scale : 0, scale), scale, isSigned);
  out.low = QString::number(isSigned ? -static_cast<double>(scale) : 0.0, 'g', 3);
  out.high = QString::fromStdString(job.metric) + QStringLiteral(" \u2265 ") + QString::number(static_cast<double>(scale), 'g', 3);
}

}  // namespace

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
