#pragma once
// Which part of a picture is seen, and how large: zoom and pan, the same for every pane. Pure; no widget.
#include <QPointF>
#include <QRectF>

namespace hl::ui {

class PictureView {
 public:
  static constexpr double kLargest = 64;  ///< times the fit
  double zoom() const { return zoom_; }
  /// 1 and the middle: the whole picture fits the pane.
  void reset() { zoom_ = 1, centre_ = {0.5, 0.5}; }
  /// Where a picture of `size` lies when it is seen in `pane`.
  QRectF place(QSizeF size, const QRectF& pane) const;
  /// Makes the picture `factor` times as large; the point under `anchor` stays where it is.
  void zoomAt(QPointF anchor, double factor, QSizeF size, const QRectF& pane);
  void panBy(QPointF pixels, QSizeF size, const QRectF& pane);

 private:
  double zoom_ = 1;
  QPointF centre_{0.5, 0.5};  ///< of the pane, in shares of the picture
};

}  // namespace hl::ui
