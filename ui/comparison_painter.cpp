#include "ui/comparison_painter.h"

#include <QCoreApplication>
#include <QFontMetricsF>
#include <QLineF>
#include <QPainter>
#include <algorithm>

namespace hl::ui {
namespace {

constexpr double kGap = 4;  // between the panes

QString say(const char* text) { return QCoreApplication::translate("hl::ui::Viewport", text); }

/// The corner a label sits in.
void label(QPainter& painter, const QString& text, const QRectF& pane, Qt::Alignment where) {
  if (text.isEmpty()) return;
  const QFontMetricsF metrics(painter.font());
  const double pad = metrics.height() / 2;
  const QRectF area = pane.adjusted(pad, pad, -pad, -pad);
  if (area.width() < pad || area.height() < pad) return;
  const QString shown = metrics.elidedText(text, Qt::ElideRight, area.width() - pad);
  QRectF box(QPointF(), QSizeF(metrics.horizontalAdvance(shown) + pad, metrics.height() + pad / 2));
  box.moveLeft(where & Qt::AlignRight ? area.right() - box.width() : where & Qt::AlignHCenter ? area.center().x() - box.width() / 2 : area.left());
  box.moveTop(where & Qt::AlignBottom ? area.bottom() - box.height() : area.top());
  painter.setPen(Qt::NoPen);
  painter.setBrush(QColor(0, 0, 0, 170));
  painter.drawRoundedRect(box, 4, 4);
  painter.setPen(Qt::white);
  painter.drawText(box, Qt::AlignCenter, shown);
}

void legend(QPainter& painter, const ComparisonPictures& p, const QRectF& pane) {
  const QFontMetricsF metrics(painter.font());
  const double pad = metrics.height() / 2, width = std::min(pane.width() - 4 * pad, 24 * metrics.height());
  if (p.legend.isNull() || width < 40) return;
  const QRectF box(pane.center().x() - width / 2 - pad, pane.bottom() - 3.2 * metrics.height() - pad, width + 2 * pad, 2.6 * metrics.height() + pad);
  painter.setPen(Qt::NoPen);
  painter.setBrush(QColor(0, 0, 0, 170));
  painter.drawRoundedRect(box, 4, 4);
  const QRectF bar(box.x() + pad, box.y() + pad, width, metrics.height() * 0.9);
  painter.drawImage(bar, p.legend);
  painter.setPen(Qt::white);
  const QRectF text(bar.x(), bar.bottom() + 2, width, metrics.height() * 1.2);
  painter.drawText(text, Qt::AlignLeft | Qt::AlignVCenter, p.low);
  painter.drawText(text, Qt::AlignRight | Qt::AlignVCenter, p.high);
}

QRectF seen(const ShownComparison& c, const PictureView& view, const QRectF& widget) { return view.place(c.pictures.a.size(), widget) & widget; }

}  // namespace

bool smoothAt(double scale) { return scale < 3 && scale != 1; }

void paintPicture(QPainter& painter, const QImage& image, const QRectF& where) {
  const double scale = where.width() * painter.device()->devicePixelRatioF() / std::max(1, image.width());
  painter.setRenderHint(QPainter::SmoothPixmapTransform, smoothAt(scale));
  painter.drawImage(where, image);
}

std::vector<QRectF> comparisonPanes(CompareMode mode, const QRectF& widget) {
  if (mode != CompareMode::SideBySide) return {widget};
  const double half = (widget.width() - kGap) / 2;
  return {QRectF(widget.x(), widget.y(), half, widget.height()), QRectF(widget.x() + half + kGap, widget.y(), half, widget.height())};
}

QLineF wipeLine(const ShownComparison& c, const PictureView& view, const QRectF& widget) {
  if (!c.hasPicture() || (c.mode != CompareMode::WipeAcross && c.mode != CompareMode::WipeDown)) return {};
  const QRectF r = seen(c, view, widget);
  if (c.mode == CompareMode::WipeAcross) {
    const double x = r.x() + r.width() * c.wipe;
    return {x, r.top(), x, r.bottom()};
  }
  const double y = r.y() + r.height() * c.wipe;
  return {r.left(), y, r.right(), y};
}

double wipeAt(const ShownComparison& c, const PictureView& view, const QRectF& widget, QPointF pointer) {
  const QRectF r = seen(c, view, widget);
  if (r.isEmpty()) return c.wipe;
  return std::clamp(c.mode == CompareMode::WipeAcross ? (pointer.x() - r.x()) / r.width() : (pointer.y() - r.y()) / r.height(), 0.0, 1.0);
}

void paintComparison(QPainter& painter, const ShownComparison& c, const PictureView& view, const QRectF& widget, bool second) {
  const QImage &a = c.pictures.a, &b = c.pictures.b;
  painter.save();
  const std::vector<QRectF> panes = comparisonPanes(c.mode, widget);
  const QRectF place = view.place(a.size(), panes[0]);  // B is stretched to it where its size differs
  switch (c.mode) {
    case CompareMode::Off: break;
    case CompareMode::WipeAcross:
    case CompareMode::WipeDown: {
      const bool across = c.mode == CompareMode::WipeAcross;
      const QLineF line = wipeLine(c, view, widget);
      QRectF ofA = widget, ofB = widget;
      across ? ofA.setRight(line.x1()) : ofA.setBottom(line.y1());
      across ? ofB.setLeft(line.x1()) : ofB.setTop(line.y1());
      painter.setClipRect(ofA);
      paintPicture(painter, a, place);
      painter.setClipRect(ofB);
      paintPicture(painter, b, place);
      painter.setClipping(false);
      painter.setPen(QPen(Qt::black, 3));
      painter.drawLine(line);
      painter.setPen(QPen(Qt::white, 1));
      painter.drawLine(line);
      label(painter, say("A: ") + c.nameA, ofA & place, across ? Qt::AlignBottom | Qt::AlignLeft : Qt::AlignTop | Qt::AlignLeft);
      label(painter, say("B: ") + c.nameB, ofB & place, across ? Qt::AlignBottom | Qt::AlignRight : Qt::AlignBottom | Qt::AlignLeft);
      break;
    }
    case CompareMode::Flicker:
      paintPicture(painter, second ? b : a, place);
      label(painter, second ? say("B: ") + c.nameB : say("A: ") + c.nameA, place & widget, second ? Qt::AlignBottom | Qt::AlignRight : Qt::AlignBottom | Qt::AlignLeft);
      break;
    case CompareMode::SideBySide:
      for (const bool right : {false, true}) {
        const QRectF& pane = panes[right ? 1 : 0];
        painter.setClipRect(pane);
        const QRectF where = view.place(a.size(), pane);
        paintPicture(painter, right ? b : a, where);
        label(painter, right ? say("B: ") + c.nameB : say("A: ") + c.nameA, where & pane, Qt::AlignBottom | Qt::AlignLeft);
      }
      painter.setClipping(false);
      break;
    case CompareMode::Difference:
    case CompareMode::ErrorMap:
      paintPicture(painter, a, place);
      label(painter, (c.mode == CompareMode::Difference ? say("%1 minus %2") : say("%1 measured against %2")).arg(c.nameA, c.nameB) + (c.pictures.value.isEmpty() ? QString() : QStringLiteral(": ") + c.pictures.value), place & widget, Qt::AlignTop | Qt::AlignLeft);
      legend(painter, c.pictures, place & widget);
      break;
  }
  label(painter, c.note, widget, Qt::AlignTop | Qt::AlignHCenter);
  painter.restore();
}

}  // namespace hl::ui
