#pragma once
// A comparison in the viewport: two pictures with a line between them, in turn, side by side, or a map with its legend.
#include <QRectF>
#include <vector>

#include "ui/comparison.h"
#include "ui/picture_view.h"

class QPainter;

namespace hl::ui {

/// What the viewport shows in place of the frame's own picture.
struct ShownComparison {
  CompareMode mode = CompareMode::Off;
  ComparisonPictures pictures;
  QString nameA, nameB, note;
  double wipe = 0.5;
  double flickerHz = 2;
  bool on() const { return mode != CompareMode::Off; }
  bool hasPicture() const { return on() && !pictures.a.isNull(); }
};

/// The parts of the widget that pictures are shown in: one, or two side by side.
std::vector<QRectF> comparisonPanes(CompareMode, const QRectF& widget);
/// The wipe's line as it is seen; a null line in other modes.
QLineF wipeLine(const ShownComparison&, const PictureView&, const QRectF& widget);
/// Where the line would be with the pointer there, in shares of what is seen of the picture.
double wipeAt(const ShownComparison&, const PictureView&, const QRectF& widget, QPointF pointer);

/// `second`: B's turn of the flicker.
void paintComparison(QPainter&, const ShownComparison&, const PictureView&, const QRectF& widget, bool second);

/// Whether a picture is smoothed when each of its pixels is `scale` wide on the screen: enlarged a good deal, people judge its pixels as they are.
bool smoothAt(double scale);
/// A picture in its rectangle.
void paintPicture(QPainter&, const QImage&, const QRectF& where);

}  // namespace hl::ui
