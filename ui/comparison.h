#pragma once
// Two linear images, shown for comparison: tone mapped the same way, or as a map of what differs. Plain functions for a worker thread.
#include <QImage>
#include <QString>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/image.h"
#include "engine/metrics/metrics.h"
#include "engine/passes/display.h"

namespace hl::ui {

/// How the viewport shows A and B. Across: A left of a line, B right of it; down: A above it, B below.
enum class CompareMode { Off, WipeAcross, WipeDown, Flicker, SideBySide, Difference, ErrorMap };

/// What else the engine's errors rest on: what an image is measured with, the Error dock's figures are made with.
struct ErrorContext {
  std::shared_ptr<const ReferenceImage> truth;  ///< the image measured against, with its halves; null: it is no reference, and has none
  std::shared_ptr<const Mask> surfaces;         ///< pixels that count; null: all
  bool operator==(const ErrorContext&) const = default;
};
/// @throws Error as measure().
MetricResult measured(const std::string& metric, const Image& value, const Image& against, const ErrorContext&, MeasureOptions);
/// "relmse 0.0123"; where pixels are not finite, how many.
QString errorText(const std::string& metric, const MetricResult&);

struct ComparisonJob {
  std::shared_ptr<const Image> a, b;  ///< linear, 3 channels
  hl::Display display;                ///< exposure, tone map and invalid pixels, for both
  CompareMode mode = CompareMode::Off;
  float gain = 1;                     ///< of the difference: one of display range is 1 / gain
  std::string metric;                 ///< of the error map: A measured against B
  ErrorContext context;               ///< ... with this
};

struct ComparisonPictures {
  CompareMode mode = CompareMode::Off;  ///< that they were made for
  QImage a, b;           ///< what is shown; a map is `a` alone
  QImage legend;         ///< of a map: its colours from least to most, one row
  QString low, high;     ///< ... and what its ends stand for
  QString value;         ///< of an error map: the metric over the whole picture
  QString refused;       ///< why there is no picture
};

/// Tone mapped pictures of the images shown last, so that one that stays the same is not done again. For one thread at a time.
class ToneMappedImages {
 public:
  QImage of(const std::shared_ptr<const Image>&, const hl::Display&);

 private:
  struct Entry {
    std::shared_ptr<const Image> image;
    hl::Display display;
    QImage picture;
  };
  std::array<Entry, 2> entries_;
  size_t next_ = 0;
};

/// Metrics of appearance judge what a screen would show.
MeasureOptions howShown(const hl::Display&, bool wantMap = false);
/// Over the bytes themselves, which it takes.
QImage pictureOf(std::vector<unsigned char> rgba, int width, int height);
ComparisonPictures renderComparison(const ComparisonJob&, ToneMappedImages&);

}  // namespace hl::ui
