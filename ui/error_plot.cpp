#include "ui/error_plot.h"

#include <fmt/format.h>
#include <qcustomplot.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "engine/core/csv.h"
#include "engine/metrics/metrics.h"
#include "ui/palette.h"
#include "ui/plot_export.h"
#include "ui/plot_style.h"

namespace hl::ui {
namespace {

/// The share of its upper end where a logarithmic axis begins at the lowest.
constexpr double kDecades = 1e-8;
/// Values below this are drawn there: a logarithmic axis has no zero.
constexpr double kLeast = 1e-12;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

ErrorPlot::ErrorPlot(QWidget* parent) : QWidget(parent), plot_(new QCustomPlot(this)), export_(new PlotExport(*plot_, *this, QStringLiteral("error"), [this] { return csv(); })) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(plot_);
  plot_->setMinimumHeight(120);
  plot_->setInteractions(QCP::iRangeDrag | QCP::iRangeZoom);
  plot_->legend->setVisible(true);
  plot_->axisRect()->insetLayout()->setInsetAlignment(0, Qt::AlignTop | Qt::AlignRight);
  const auto graph = [&](const QString& name, int slot, Qt::PenStyle style) {
    QCPGraph* g = plot_->addGraph();
    g->setName(name);
    g->setPen(QPen(PassPalette::colour(slot), 2, style));
    g->setScatterStyle(style == Qt::SolidLine ? QCPScatterStyle(QCPScatterStyle::ssDisc, 4) : QCPScatterStyle());
    return g;
  };
  matched_ = graph(tr("matched reference"), 0, Qt::SolidLine);
  full_ = graph(tr("full reference"), 3, Qt::SolidLine);
  floor_ = graph(tr("noise floor (matched)"), 2, Qt::DashLine);
  plot_->setAccessibleName(tr("Error over time"));
  stylePlot(*plot_, *this);
  export_->showEverything = [this] { showEverything(); };
  connect(plot_, &QCustomPlot::mouseMove, this, [this](QMouseEvent* e) {
    plot_->setToolTip(QStringLiteral("%1, %2")
                          .arg(plot_->xAxis->pixelToCoord(e->position().x()), 0, 'g', 4)
                          .arg(plot_->yAxis->pixelToCoord(e->position().y()), 0, 'g', 4));
  });
}

void ErrorPlot::draw(const std::vector<ConvergencePoint>& points, const std::string& metric, const std::string& component, bool byFrames) {
  // Bias has a sign, psnr is in decibels, ssim ends at 1: all on a linear axis.
  const MetricInfo& info = metricInfo(metric);
  const bool logarithmic = info.perfect == 0 && !info.mapSigned;
  QVector<double> keys[2], values[2], floorKeys, floorValues;
  for (const ConvergencePoint& p : points)
    for (const ErrorValue& e : p.errors) {
      if (e.metric != metric || e.component != component || e.target != "image" || !e.roi.empty() || !std::isfinite(e.value)) continue;
      const size_t i = e.reference == "full" ? 1 : 0;
      const double x = byFrames ? static_cast<double>(p.frame) : p.ms / 1000;
      keys[i] << x;
      values[i] << (logarithmic ? std::max(e.value, kLeast) : e.value);
      if (i == 0 && e.noiseFloor > 0) floorKeys << x, floorValues << e.noiseFloor;
    }
  matched_->setData(keys[0], values[0], true);
  full_->setData(keys[1], values[1], true);
  floor_->setData(floorKeys, floorValues, true);
  floor_->setVisible(!floorKeys.isEmpty());
  const bool any = !keys[0].isEmpty() || !keys[1].isEmpty();
  plot_->legend->setVisible(any);
  logarithmic ? makeLogarithmic(*plot_->yAxis) : makeLinear(*plot_->yAxis);
  plot_->xAxis->setLabel(byFrames ? tr("frames since the reset") : tr("seconds of work since the reset"));
  plot_->yAxis->setLabel(QString::fromStdString(metric));
  metric_ = metric, byFrames_ = byFrames, logarithmic_ = logarithmic;
  showEverything();
}

void ErrorPlot::showEverything() {
  const bool any = matched_->dataCount() > 0 || full_->dataCount() > 0;
  plot_->rescaleAxes(true);
  if (!any) {
    plot_->xAxis->setRange(0, 10);
    plot_->yAxis->setRange(logarithmic_ ? 1e-4 : 0, 1);
  } else if (logarithmic_) {
    // Ticks are laid out by the decade: a value of nothing must not stretch the axis over dozens of them.
    const double upper = plot_->yAxis->range().upper * 2;
    plot_->yAxis->setRange(std::max(plot_->yAxis->range().lower / 2, upper * kDecades), upper);
  } else {
    plot_->yAxis->scaleRange(1.2);
  }
  plot_->xAxis->setRangeLower(0);
  plot_->replot(QCustomPlot::rpQueuedReplot);
}

std::string ErrorPlot::csv() const {
  std::string out = fmt::format("{},metric,matched,full,noise_floor_matched\n", byFrames_ ? "frame" : "seconds");
  std::map<double, std::array<double, 3>> rows;
  size_t column = 0;
  for (const QCPGraph* g : {matched_, full_, floor_}) {
    for (const QCPGraphData& p : *g->data()) rows.emplace(p.key, std::array{kNaN, kNaN, kNaN}).first->second[column] = p.value;
    ++column;
  }
  for (const auto& [x, values] : rows) out += fmt::format("{},{},{},{},{}\n", csvCell(x), csvCell(metric_), csvCell(values[0]), csvCell(values[1]), csvCell(values[2]));
  return out;
}

void ErrorPlot::changeEvent(QEvent* event) {
  if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange) {
    stylePlot(*plot_, *this);
    plot_->replot(QCustomPlot::rpQueuedReplot);
  }
  QWidget::changeEvent(event);
}

}  // namespace hl::ui
