#include "ui/pass_bars.h"

#include <fmt/format.h>
#include <qcustomplot.h>

#include <algorithm>
#include <cmath>

#include "engine/core/csv.h"
#include "ui/palette.h"
#include "ui/plot_export.h"
#include "ui/plot_style.h"

namespace hl::ui {
namespace {

constexpr size_t kFrames = 120;

}  // namespace

PassBars::PassBars(PassPalette& palette, QWidget* parent) : QWidget(parent), palette_(palette), plot_(new QCustomPlot(this)), export_(new PlotExport(*plot_, *this, QStringLiteral("pass_times"), [this] { return csv(); })) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(plot_);
  plot_->setMinimumHeight(120);
  plot_->setInteractions(QCP::iRangeDrag | QCP::iRangeZoom);
  plot_->axisRect()->setRangeDrag(Qt::Vertical);
  plot_->axisRect()->setRangeZoom(Qt::Vertical);
  plot_->xAxis->setLabel(tr("frame"));
  plot_->yAxis->setLabel(tr("ms"));
  plot_->setAccessibleName(tr("Pass times of the last frames"));
  stylePlot(*plot_, *this);
  export_->showEverything = [this] { draw(); };
  connect(plot_, &QCustomPlot::mouseMove, this, [this](QMouseEvent* e) { showValueAt(e->position()); });
}

void PassBars::add(uint64_t number, const std::vector<PassTiming>& passes) {
  if (!history_.empty() && history_.back().number == number) return;
  Frame f{number, {}};
  for (const PassTiming& p : passes) {
    if (!p.skipped.empty()) continue;
    f.ms[p.name] += p.ms;
    if (std::find(order_.begin(), order_.end(), p.name) == order_.end()) order_.push_back(p.name);
  }
  history_.push_back(std::move(f));
  if (history_.size() > kFrames) history_.pop_front();
}

void PassBars::clear() {
  history_.clear();
  order_.clear();
  plot_->clearPlottables();
  bars_.clear();
  plot_->replot();
}

QCPBars* PassBars::barsOf(const std::string& pass) {
  QCPBars*& bars = bars_[pass];
  if (bars) return bars;
  bars = new QCPBars(plot_->xAxis, plot_->yAxis);
  bars->setName(QString::fromStdString(pass));
  bars->setPen(Qt::NoPen);
  bars->setBrush(palette_.of(pass));
  bars->setWidth(0.92);
  bars->setAntialiased(false);
  return bars;
}

void PassBars::draw() {
  if (history_.empty()) return;
  // Passes that no frame here has any more give their place up.
  std::erase_if(order_, [&](const std::string& pass) {
    const bool gone = std::none_of(history_.begin(), history_.end(), [&](const Frame& f) { return f.ms.count(pass) > 0; });
    if (gone && bars_.count(pass)) {
      bars_[pass]->moveBelow(nullptr), bars_[pass]->moveAbove(nullptr);
      plot_->removePlottable(bars_[pass]);
      bars_.erase(pass);
    }
    return gone;
  });
  double top = 0;
  for (const Frame& f : history_) {
    double sum = 0;
    for (const auto& [name, ms] : f.ms) sum += ms;
    top = std::max(top, sum);
  }
  QCPBars* below = nullptr;
  for (const std::string& pass : order_) {
    QCPBars* bars = barsOf(pass);
    QVector<double> keys, values;
    for (const Frame& f : history_) {
      const auto found = f.ms.find(pass);
      keys << static_cast<double>(f.number);
      values << (found == f.ms.end() ? 0.0 : found->second);
    }
    bars->setData(keys, values, true);
    if (bars->barBelow() != below) bars->moveAbove(below);
    below = bars;
  }
  const double last = static_cast<double>(history_.back().number);
  const double first = std::max(static_cast<double>(history_.front().number), last - static_cast<double>(kFrames) + 1);
  plot_->xAxis->setRange(first - 0.5, std::max(last, first + 20) + 0.5);  // few bars are not stretched into blocks
  plot_->yAxis->setRange(0, top > 0 ? top * 1.05 : 1);
  plot_->replot(QCustomPlot::rpQueuedReplot);
}

void PassBars::showValueAt(QPointF p) {
  const double x = plot_->xAxis->pixelToCoord(p.x()), y = plot_->yAxis->pixelToCoord(p.y());
  for (const Frame& f : history_) {
    if (static_cast<double>(f.number) != std::round(x)) continue;
    double sum = 0;
    for (const std::string& pass : order_) {
      const auto found = f.ms.find(pass);
      if (found == f.ms.end()) continue;
      sum += found->second;
      if (y <= sum && y >= sum - found->second) {
        plot_->setToolTip(tr("frame %1\n%2: %3 ms").arg(f.number).arg(QString::fromStdString(pass)).arg(found->second, 0, 'f', 3));
        return;
      }
    }
  }
  plot_->setToolTip({});
}

std::string PassBars::csv() const {
  std::string out = "frame,pass,ms\n";
  for (const Frame& f : history_)
    for (const std::string& pass : order_)
      if (const auto found = f.ms.find(pass); found != f.ms.end()) out += fmt::format("{},{},{}\n", f.number, csvCell(pass), csvCell(found->second));
  return out;
}

void PassBars::changeEvent(QEvent* event) {
  if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange) {
    stylePlot(*plot_, *this);
    plot_->replot(QCustomPlot::rpQueuedReplot);
  }
  QWidget::changeEvent(event);
}

}  // namespace hl::ui
