#include "ui/pass_stack_plot.h"

#include <fmt/format.h>
#include <qcustomplot.h>

#include <algorithm>
#include <cmath>

#include "engine/core/csv.h"
#include "ui/plot_style.h"

namespace hl::ui {
namespace {

constexpr double kBar = 0.76, kRoom = 1.04;
constexpr int kRowHeight = 24, kFrameHeight = 150, kWidth = 860;  // of a picture
constexpr int kLegendColumns = 3, kLegendRow = 18;
constexpr int kLongestLabel = 44;
const char* const kRest = "in no pass";

QString shortened(const QString& s) { return s.size() <= kLongestLabel ? s : s.left(kLongestLabel - 1) + QChar(0x2026); }

}  // namespace

PassStackPlot::PassStackPlot(Of of, PassPalette& passes, QWidget* parent)
    : SweepPlot(of == Of::Frame ? QStringLiteral("passes_frame") : QStringLiteral("passes_work"),
                of == Of::Frame ? tr("Times of a frame by pass") : tr("Times of a unit of work by pass"), parent),
      of_(of),
      palette_(passes) {}

QSize PassStackPlot::pictureSize() const {
  const int legend = (static_cast<int>(order_.size()) / kLegendColumns + 1) * kLegendRow;
  return {kWidth, kFrameHeight + kRowHeight * std::max(2, static_cast<int>(rows_.size())) + legend};
}

const std::vector<PassSummary>& PassStackPlot::passesOf(size_t configuration) const {
  const ConfigurationSummary& c = view_->summary.configurations[configuration];
  return of_ == Of::Frame ? c.passes : c.workPasses;
}

double PassStackPlot::timeOf(size_t configuration, const std::string& pass) const {
  double sum = 0;
  for (const PassSummary& p : passesOf(configuration)) {
    if (p.name == pass) return p.share * p.ms.median;
    sum += p.share * p.ms.median;
  }
  return pass == kRest ? std::max(0.0, view_->summary.configurations[configuration].frameMs.median - sum) : 0;
}

void PassStackPlot::draw() {
  plot_->legend->setWrap(kLegendColumns);  // before its entries, which it would not move
  const SweepResults& r = view_->results;
  rows_.clear(), order_.clear(), segments_.clear();
  top_ = 0;
  for (const size_t c : r.problems[choice_.problem].configurations)
    if (!passesOf(c).empty()) rows_.push_back(c);
  if (rows_.empty()) {
    nothing_ = of_ == Of::Frame ? tr("No run has times of passes.") : tr("No technique here works between frames: there are no passes of a bake.");
    return;
  }
  bool rest = false;
  for (const size_t c : rows_)
    for (const PassSummary& p : passesOf(c))
      if (std::find(order_.begin(), order_.end(), p.name) == order_.end()) order_.push_back(p.name);
  if (of_ == Of::Frame)
    for (const size_t c : rows_) rest |= timeOf(c, kRest) > 0;
  if (rest) order_.emplace_back(kRest);
  setTitle(QString::fromStdString(r.problems[choice_.problem].label));
  makeLinear(*plot_->xAxis);
  plot_->xAxis->setLabel(of_ == Of::Frame ? tr("time of a frame, medians over runs [ms]") : tr("time of a unit of work, medians over runs [ms]"));
  plot_->yAxis->grid()->setVisible(false);
  plot_->yAxis->setRangeReversed(true);
  auto* labels = new QCPAxisTickerText;
  for (size_t row = 0; row < rows_.size(); ++row) labels->addTick(static_cast<double>(row), shortened(labelOf(rows_[row])));
  plot_->yAxis->setTicker(QSharedPointer<QCPAxisTicker>(labels));
  plot_->yAxis->setSubTicks(false);
  plot_->yAxis->setTickLength(0, 3);  // outside: inside, they would lie on the bars
  std::vector<double> ends(rows_.size(), 0);
  QCPBars* below = nullptr;
  for (const std::string& pass : order_) {
    auto* bars = new QCPBars(plot_->yAxis, plot_->xAxis);
    bars->setName(QString::fromStdString(pass));
    bars->setPen(Qt::NoPen);
    bars->setBrush(pass == kRest ? QBrush(ink(), Qt::BDiagPattern) : QBrush(palette_.of(pass)));
    bars->setWidth(kBar);
    QVector<double> keys, values;
    for (size_t row = 0; row < rows_.size(); ++row) {
      const double ms = timeOf(rows_[row], pass);
      keys << static_cast<double>(row), values << ms;
      if (!(ms > 0)) continue;
      segments_.push_back({ends[row], ends[row] + ms});
      ends[row] += ms;
      marks_.push_back({rows_[row], (segments_.back().from + segments_.back().to) / 2, static_cast<double>(row),
                        tr("%1\n%2: %3 ms").arg(labelOf(rows_[row]), QString::fromStdString(pass)).arg(ms, 0, 'g', 4)});
    }
    bars->setData(keys, values, true);
    if (below) bars->moveAbove(below);
    below = bars;
    bars->addToLegend();
  }
  top_ = *std::max_element(ends.begin(), ends.end());
  if (const size_t missing = r.plan.size() - r.done()) note_ = tr("%1 of %2 runs are missing.").arg(missing).arg(r.plan.size());
}

void PassStackPlot::showEverything() {
  plot_->xAxis->setRange(0, top_ > 0 ? top_ * kRoom : 1);
  plot_->yAxis->setRange(-0.6, static_cast<double>(rows_.size()) - 0.4);
}

void PassStackPlot::highlight() {
  plot_->clearItems();
  for (size_t row = 0; row < rows_.size(); ++row) {
    if (!selected_ || rows_[row] != *selected_) continue;
    auto* frame = new QCPItemRect(plot_);
    frame->setPen(QPen(ink(), 2));
    const double end = [&] {
      double sum = 0;
      for (const std::string& pass : order_) sum += timeOf(rows_[row], pass);
      return sum;
    }();
    frame->topLeft->setCoords(0, static_cast<double>(row) - kBar / 2);
    frame->bottomRight->setCoords(end, static_cast<double>(row) + kBar / 2);
  }
}

const PlotMark* PassStackPlot::markNear(QPointF pixel) const {
  const double ms = plot_->xAxis->pixelToCoord(pixel.x()), row = plot_->yAxis->pixelToCoord(pixel.y());
  for (size_t i = 0; i < marks_.size(); ++i)
    if (std::abs(marks_[i].y - row) <= kBar / 2 && ms >= segments_[i].from && ms < segments_[i].to) return &marks_[i];
  return nullptr;
}

std::string PassStackPlot::csv() const {
  std::string out = "configuration,label,technique,during,pass,where,median_ms,p5_ms,p95_ms\n";
  if (!view_) return out;
  for (const size_t c : rows_) {
    const std::string head = fmt::format("{},{},{},{}", c, csvCell(view_->results.configurations[c].label()), csvCell(view_->results.configurations[c].preset.technique), of_ == Of::Frame ? "frame" : "work");
    for (const PassSummary& p : passesOf(c)) out += fmt::format("{},{},{},{},{},{}\n", head, csvCell(p.name), p.where, csvCell(p.ms.median), csvCell(p.ms.p5), csvCell(p.ms.p95));
    if (of_ == Of::Frame && timeOf(c, kRest) > 0) out += fmt::format("{},{},,{},,\n", head, kRest, csvCell(timeOf(c, kRest)));
  }
  return out;
}

}  // namespace hl::ui
