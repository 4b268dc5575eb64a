#include "ui/plot_style.h"

#include <qcustomplot.h>

namespace hl::ui {

void stylePlot(QCustomPlot& plot, const QWidget& like) {
  // Otherwise each plot repaints the window by itself, and at once.
  plot.setPlottingHint(QCP::phImmediateRefresh, false);
  const QPalette& p = like.palette();
  const QColor ink = p.color(QPalette::Text), ground = p.color(QPalette::Base);
  QColor grid = ink;
  grid.setAlpha(40);
  plot.setBackground(QBrush(ground));
  plot.setFont(like.font());
  QFont small = like.font();
  small.setPointSizeF(small.pointSizeF() * 0.9);
  for (QCPAxis* axis : {plot.xAxis, plot.yAxis}) {
    axis->setBasePen(QPen(ink));
    axis->setTickPen(QPen(ink));
    axis->setSubTickPen(QPen(grid));
    axis->setTickLabelColor(ink);
    axis->setLabelColor(ink);
    axis->setTickLabelFont(small);
    axis->setLabelFont(small);
    axis->grid()->setPen(QPen(grid, 0, Qt::DotLine));
    axis->grid()->setZeroLinePen(Qt::NoPen);
  }
  if (plot.legend) {
    plot.legend->setBrush(QBrush(QColor(ground.red(), ground.green(), ground.blue(), 210)));
    plot.legend->setBorderPen(Qt::NoPen);
    plot.legend->setTextColor(ink);
    plot.legend->setFont(small);
  }
}

void makeLogarithmic(QCPAxis& axis) {
  axis.setScaleType(QCPAxis::stLogarithmic);
  axis.setTicker(QSharedPointer<QCPAxisTickerLog>(new QCPAxisTickerLog));
  axis.setNumberFormat(QStringLiteral("gbc"));
  axis.setNumberPrecision(2);
}

}  // namespace hl::ui
