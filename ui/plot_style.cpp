#include "ui/plot_style.h"

#include <qcustomplot.h>

#include <algorithm>
#include <cmath>

namespace hl::ui {
namespace {

constexpr int kLeastLabels = 3;
constexpr int kDecadesInFull = 12;  // beyond that every second, third ... power of ten
constexpr double kRoom = 0.06, kLeastRoom = 1.1;
constexpr double kPlainFrom = 1e-3, kPlainTo = 1e5;  // numbers in between need no power of ten

/// Labels at powers of ten; with few of those also at 3, at 2 and 5, at all whole multiples. Fewer than kLeastLabels where even those are too few.
QVector<double> powersOfTen(const QCPRange& range) {
  QVector<double> ticks;
  const int first = static_cast<int>(std::floor(std::log10(range.lower))), last = static_cast<int>(std::ceil(std::log10(range.upper)));
  const int step = (last - first) / kDecadesInFull + 1;
  const QVector<double> choices[] = {{1}, {1, 3}, {1, 2, 5}, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
  for (const QVector<double>& multiples : choices) {
    ticks.clear();
    for (int decade = first; decade <= last; decade += step)
      for (const double m : multiples)
        if (const double at = m * std::pow(10.0, decade); range.contains(at)) ticks << at;
    if (ticks.size() >= kLeastLabels) break;
  }
  return ticks;
}

/// Within less than that, even steps.
class LogarithmicTicker : public QCPAxisTicker {
 public:
  void generate(const QCPRange& range, const QLocale& locale, QChar format, int precision, QVector<double>& ticks, QVector<double>* subTicks,
                QVector<QString>* labels) override {
    ticks.clear();
    if (range.lower > 0 && range.upper > range.lower) ticks = powersOfTen(range);
    if (ticks.size() < kLeastLabels) return QCPAxisTicker::generate(range, locale, format, precision, ticks, subTicks, labels);
    if (subTicks) {
      subTicks->clear();
      const int first = static_cast<int>(std::floor(std::log10(range.lower))), last = static_cast<int>(std::ceil(std::log10(range.upper)));
      for (int decade = first; decade <= last && last - first <= kDecadesInFull; ++decade)
        for (int m = 1; m < 10; ++m)
          if (const double at = m * std::pow(10.0, decade); range.contains(at)) *subTicks << at;
    }
    if (labels) *labels = createLabelVector(ticks, locale, format, precision);
  }

 protected:
  QString getTickLabel(double tick, const QLocale& locale, QChar format, int precision) override {
    if (tick >= kPlainFrom && tick < kPlainTo) return locale.toString(tick, 'g', 6);
    return QCPAxisTicker::getTickLabel(tick, locale, format, precision);
  }
};

}  // namespace

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
  axis.setTicker(QSharedPointer<QCPAxisTicker>(new LogarithmicTicker));
  axis.setNumberFormat(QStringLiteral("gbc"));
  axis.setNumberPrecision(3);
}

void makeLinear(QCPAxis& axis) {
  axis.setScaleType(QCPAxis::stLinear);
  axis.setTicker(QSharedPointer<QCPAxisTicker>(new QCPAxisTicker));
  axis.setNumberFormat(QStringLiteral("gb"));
  axis.setNumberPrecision(4);
}

std::vector<double> roundNumbers(double lower, double upper, bool logarithmic) {
  QVector<double> ticks;
  const QCPRange range(lower, upper);
  if (logarithmic && lower > 0 && upper > lower) ticks = powersOfTen(range);
  if (ticks.size() < kLeastLabels) {
    ticks.clear();
    QCPAxisTicker even;
    even.generate(range, QLocale::c(), QLatin1Char('g'), 4, ticks, nullptr, nullptr);
  }
  std::vector<double> out;
  for (const double t : ticks)
    if (t >= lower && t <= upper) out.push_back(t);
  return out;
}

void setRangeWithRoom(QCPAxis& axis, double lower, double upper) {
  if (axis.scaleType() == QCPAxis::stLogarithmic) {
    const double room = std::max(kLeastRoom, std::pow(upper / lower, kRoom));
    axis.setRange(lower / room, upper * room);
  } else {
    const double room = upper > lower ? (upper - lower) * kRoom : std::max(std::abs(upper) * kRoom, kRoom);
    axis.setRange(lower - room, upper + room);
  }
}

void drawNothing(QCustomPlot& plot, const QString& why) {
  for (QCPAxis* axis : {plot.xAxis, plot.yAxis}) axis->setVisible(false), axis->grid()->setVisible(false);
  auto* text = new QCPItemText(&plot);
  text->setPositionAlignment(Qt::AlignCenter);
  // Of the whole plot: axes that are hidden may have no room of their own.
  text->setClipToAxisRect(false);
  text->position->setType(QCPItemPosition::ptViewportRatio);
  text->position->setCoords(0.5, 0.5);
  text->setColor(plot.xAxis->labelColor());
  text->setFont(plot.font());
  text->setText(why);
}

void settleLayout(QCustomPlot& plot, QSize size) {
  constexpr int kPasses = 3;  // as many as there are parts above one another
  if (size.isEmpty()) return;
  const QRect before = plot.viewport();
  plot.setViewport(QRect(QPoint(0, 0), size));
  for (int pass = 0; pass < kPasses; ++pass)
    for (const auto phase : {QCPLayoutElement::upPreparation, QCPLayoutElement::upMargins, QCPLayoutElement::upLayout}) plot.plotLayout()->update(phase);
  plot.setViewport(before);
}

}  // namespace hl::ui
