// What the viewport paints: the picture, where it is read back; and what lies over it, by itself or as the presenter's overlay.
#include <QPainter>
#include <cmath>

#include "ui/pick_overlay.h"
#include "ui/probe_tool.h"
#include "ui/swapchain_view.h"
#include "ui/viewport.h"

namespace hl::ui {
namespace {

constexpr int kGroundLevel = 38;  // neutral, whatever the theme: it surrounds pictures that are judged
const QColor kGround(kGroundLevel, kGroundLevel, kGroundLevel);

}  // namespace

void Viewport::paintEvent(QPaintEvent*) {
  if (swapchain_) swapchain_->setView(presentView());
  if (onDevice()) return;
  QPainter painter(this);
  painter.fillRect(rect(), kGround);
  if (!comparing() && !image_.isNull()) paintPicture(painter, image_, pictureRect());
  paintOver(painter);
}

/// All but the frame's own picture.
void Viewport::paintOver(QPainter& painter) {
  if (comparing()) paintComparison(painter, comparison_, view_, rect(), flickerSecond_);
  if (pickShown_ && frame_ && cameraKnown_ && !spaceHeld_) drawPickedSamples(painter, *frame_, controller_.camera(), pictureRect());
  if (frame_ && !comparing() && !spaceHeld_) probeTool_->paint(painter, frame_->camera, frameSize(), pictureRect());
  drawOutlines(painter);
  drawLabels(painter);
}

void Viewport::drawLabels(QPainter& painter) {
  const int pad = fontMetrics().height() / 2;
  const auto label = [&](const QString& text, Qt::Alignment where, QColor ink, QColor ground) {
    const QRect area = rect().adjusted(pad, pad, -pad, -pad);
    const int flags = static_cast<int>(where) | Qt::TextWordWrap;
    const QRect box = fontMetrics().boundingRect(area.adjusted(pad, pad / 2, -pad, -pad / 2), flags, text);
    painter.setPen(Qt::NoPen);
    painter.setBrush(ground);
    painter.drawRoundedRect(box.adjusted(-pad, -pad / 2, pad, pad / 2), 4, 4);
    painter.setPen(ink);
    // Lines of a list begin under each other, on whichever side it stands.
    const int lines = text.contains('\n') ? (flags & ~Qt::AlignHorizontal_Mask) | Qt::AlignLeft : flags;
    painter.drawText(box, lines, text);
  };
  const QColor white(255, 255, 255), shade(0, 0, 0, 170);
  if (comparison_.on() && !spaceHeld_ && !comparison_.pictures.refused.isEmpty()) label(tr("Comparison: %1").arg(comparison_.pictures.refused), Qt::AlignTop | Qt::AlignHCenter, white, shade);
  painter.setRenderHint(QPainter::Antialiasing);
  if (!waiting_.isEmpty() && (!frame_ || !cameraKnown_)) label(waiting_, Qt::AlignCenter, white, shade);
  QString title;
  if (spaceHeld_) title = frame_ && frame_->view == "reference" ? tr("Reference") : tr("Reference: waiting for the frame");
  if (view_.zoom() > 1) title += (title.isEmpty() ? QString() : QStringLiteral("  ")) + tr("%1 \u00d7 (Ctrl+0 shows the whole picture)").arg(view_.zoom(), 0, 'f', 1);
  if (paused_) title += (title.isEmpty() ? QString() : QStringLiteral("  ")) + tr("Paused");
  if (!title.isEmpty()) label(title, Qt::AlignTop | Qt::AlignLeft, white, shade);
  if (const QString facts = pickShown_ && frame_ ? pickedFacts(*frame_) : QString(); !facts.isEmpty())
    label(facts + '\n' + tr("Esc hides this"), Qt::AlignTop | Qt::AlignRight, white, shade);
  if (!notice_.isEmpty()) label(notice_, Qt::AlignBottom | Qt::AlignHCenter, white, QColor(140, 30, 20, 225));
}

/// Whether paintOver() paints anything.
bool Viewport::overlaid() const {
  const bool labelled = spaceHeld_ || paused_ || view_.zoom() > 1 || !waiting_.isEmpty() || !notice_.isEmpty();
  return labelled || comparison_.on() || pickShown_ || marked_ || bandStart_ || !regions_.empty() || probeTool_->active();
}

PresentView Viewport::presentView() {
  PresentView v;
  const double ratio = devicePixelRatioF();
  const QSize pixels = (QSizeF(size()) * ratio).toSize();
  v.picture = frame_ && !comparing();
  if (v.picture) {
    const QRectF place = pictureRect();
    // On whole pixels, so that one of the picture's for each of the window's is just that.
    v.x = static_cast<float>(std::round(place.x() * ratio)), v.y = static_cast<float>(std::round(place.y() * ratio));
    v.width = static_cast<float>(place.width() * ratio), v.height = static_cast<float>(place.height() * ratio);
    v.smooth = smoothAt(place.width() * ratio / frame_->width);
  }
  for (float& channel : v.background) channel = static_cast<float>(kGroundLevel) / 255.0f;
  if (!overlaid() || pixels.isEmpty()) return v;
  QImage image(pixels, QImage::Format_ARGB32_Premultiplied);
  image.setDevicePixelRatio(ratio);
  image.fill(comparing() ? kGround : QColor(Qt::transparent));
  QPainter painter(&image);
  painter.setFont(font());
  paintOver(painter);
  painter.end();
  image.convertTo(QImage::Format_RGBA8888_Premultiplied);
  auto overlay = std::make_shared<Overlay>();
  overlay->width = pixels.width(), overlay->height = pixels.height();
  overlay->rgba.assign(image.constBits(), image.constBits() + image.sizeInBytes());  // rows of 32-bit pixels have no padding
  v.overlay = std::move(overlay);
  return v;
}

void Viewport::drawOutlines(QPainter& painter) {
  if (!frame_) return;
  painter.save();
  painter.setRenderHint(QPainter::Antialiasing, false);
  painter.setBrush(Qt::NoBrush);
  const auto outline = [&](const QRectF& box, const QString& name) {
    painter.setPen(QPen(Qt::black, 3));
    painter.drawRect(box);
    painter.setPen(QPen(QColor(255, 221, 85), 1));
    painter.drawRect(box);
    if (name.isEmpty()) return;
    const QRectF text(box.topLeft() + QPointF(3, 2), QSizeF(fontMetrics().horizontalAdvance(name) + 6, fontMetrics().height()));
    painter.fillRect(text, QColor(0, 0, 0, 150));
    painter.drawText(text, Qt::AlignCenter, name);
  };
  for (const QRectF& pane : comparisonPanes(comparing() ? comparison_.mode : CompareMode::Off, rect())) {
    const QRectF r = view_.place(pictureSize(), pane);
    painter.setClipRect(pane);
    const auto placed = [&](double x, double y, double w, double h) { return QRectF(r.x() + x * r.width(), r.y() + y * r.height(), w * r.width(), h * r.height()); };
    for (const Region& region : regions_)
      outline(placed(static_cast<double>(region.x), static_cast<double>(region.y), static_cast<double>(region.width), static_cast<double>(region.height)), QString::fromStdString(region.name));
    if (const QRectF band = drawnShares(); !band.isEmpty()) outline(placed(band.x(), band.y(), band.width(), band.height()), {});
    if (marked_) {
      const QRectF pixel = placed(marked_->x() / static_cast<double>(frame_->width), marked_->y() / static_cast<double>(frame_->height), 1.0 / frame_->width, 1.0 / frame_->height);
      const double grow = std::max(0.0, (9 - pixel.width()) / 2);
      outline(pixel.adjusted(-grow, -grow, grow, grow), {});
    }
  }
  painter.restore();
}

}  // namespace hl::ui
