#pragma once
// Figures for papers: pictures side by side with captions, metrics and enlarged parts, as PNG or PDF. Plain functions for a worker thread.
#include <QRectF>
#include <QString>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/session/session.h"
#include "ui/comparison.h"

class QPainter;

namespace hl::ui {

struct FigureImage {
  QString caption;
  std::shared_ptr<const Image> image;        ///< linear, 3 channels
  std::shared_ptr<const FrameResult> frame;  ///< its preset and provenance go with the figure; null: none
  ErrorContext context;                      ///< what it is measured with
};

struct FigureSheet {
  std::vector<FigureImage> images;
  hl::Display display;               ///< exposure and tone map of all of them
  std::vector<std::string> metrics;  ///< of each against `truth`
  std::shared_ptr<const Image> truth;
  QString truthName;
  std::vector<Region> insets;        ///< enlarged under each picture, framed in it
};

/// Where everything of one picture lies, in points of the page.
struct FigureCell {
  QRectF picture, caption, metrics;
  std::vector<QRectF> insets;
};
struct FigureLayout {
  QSizeF page;
  std::vector<FigureCell> cells;
};
inline constexpr double kFigureWidth = 540;  ///< points: two columns of a paper
inline constexpr int kFigureColumns = 4;     ///< pictures in a row at most

FigureLayout layOut(const FigureSheet&);
/// What stands under each picture, one metric a line. @throws Error(BadInput) where sizes differ, or for an unknown metric.
std::vector<QStringList> figureMetrics(const FigureSheet&);
/// By the extension, .png (the page at 4 pixels to a point) or .pdf; written to a temporary file and renamed. A PNG carries the first picture's preset and
/// provenance, a PDF each one's as attached files. @throws Error.
void writeFigure(const FigureSheet&, const std::filesystem::path&);

}  // namespace hl::ui
