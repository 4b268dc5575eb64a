#include "ui/picture_view.h"

#include <algorithm>

namespace hl::ui {

QRectF PictureView::place(QSizeF size, const QRectF& pane) const {
  const QSizeF shown = size.scaled(pane.size(), Qt::KeepAspectRatio) * zoom_;
  return {pane.center() - QPointF(shown.width() * centre_.x(), shown.height() * centre_.y()), shown};
}

void PictureView::zoomAt(QPointF anchor, double factor, QSizeF size, const QRectF& pane) {
  const QRectF before = place(size, pane);
  if (before.isEmpty()) return;
  const QPointF share((anchor.x() - before.x()) / before.width(), (anchor.y() - before.y()) / before.height());
  zoom_ = std::clamp(zoom_ * factor, 1.0, kLargest);
  if (zoom_ == 1) {
    reset();
    return;
  }
  const QRectF after = place(size, pane);
  panBy(anchor - QPointF(after.x() + share.x() * after.width(), after.y() + share.y() * after.height()), size, pane);
}

void PictureView::panBy(QPointF pixels, QSizeF size, const QRectF& pane) {
  const QRectF now = place(size, pane);
  if (now.isEmpty()) return;
  // The pane's middle stays on the picture, so that it cannot be lost.
  centre_ = {std::clamp(centre_.x() - pixels.x() / now.width(), 0.0, 1.0), std::clamp(centre_.y() - pixels.y() / now.height(), 0.0, 1.0)};
}

}  // namespace hl::ui
