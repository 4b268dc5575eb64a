#include "ui/convergence_plot.h"

#include <fmt/format.h>
#include <qcustomplot.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/core/csv.h"
#include "engine/metrics/metrics.h"
#include "ui/palette.h"
#include "ui/plot_style.h"
#include "ui/speed_error_plot.h"

namespace hl::ui {
namespace {

// Colours of the palette that lines can have on white: not its yellow, nor the pale ones.
constexpr int kSlots[] = {0, 1, 2, 3, 5, 7, 4, 9};
constexpr size_t kNamed = std::size(kSlots);
constexpr double kThin = 1.3, kThick = 3.5;
constexpr int kFaint = 90;  // alpha
constexpr int kLegendColumns = 2;

}  // namespace

ConvergencePlot::ConvergencePlot(Over over, QWidget* parent)
    : SweepPlot(over == Over::Time ? QStringLiteral("convergence_ms") : QStringLiteral("convergence_frames"),
                over == Over::Time ? tr("Error over time") : tr("Error over frames"), parent),
      over_(over) {}

/// All of them, or those on the front where there are too many to tell apart.
void ConvergencePlot::nameConfigurations() {
  named_.clear();
  for (const ConvergenceCurve& c : curves_)
    if (std::find(named_.begin(), named_.end(), c.configuration) == named_.end()) named_.push_back(c.configuration);
  std::sort(named_.begin(), named_.end());
  if (named_.size() <= kNamed) return;
  named_.clear();
  for (const FrontPoint& p : frontOf(view_->results, view_->summary, choice_.problem, choice_.cost, choice_.reference, choice_.metric).points)
    if (p.place == FrontPlace::On && named_.size() < kNamed) named_.push_back(p.configuration);
}

QColor ConvergencePlot::colourOf(size_t configuration) const {
  const auto at = std::find(named_.begin(), named_.end(), configuration);
  if (at != named_.end()) return PassPalette::colour(kSlots[static_cast<size_t>(at - named_.begin())]);
  QColor other = ink();
  other.setAlpha(kFaint);
  return other;
}

void ConvergencePlot::draw() {
  plot_->legend->setWrap(kLegendColumns);  // before its entries, which it would not move
  const SweepResults& r = view_->results;
  curves_ = convergenceCurves(r, choice_.problem, choice_.reference, choice_.metric);
  lines_.clear();
  logarithmic_ = isLogarithmic(choice_.metric);
  const bool byTime = over_ == Over::Time;
  size_t left = 0, points = 0;
  for (ConvergenceCurve& c : curves_) {
    ConvergenceCurve kept{c.configuration, c.seed, c.repeat, {}, {}, {}, {}};
    // The last point of a run, the picture that is measured, may be of a moment before the last that was followed.
    std::vector<size_t> order(c.ms.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return byTime ? c.ms[a] < c.ms[b] : c.frames[a] < c.frames[b]; });
    for (const size_t i : order) {
      const double x = byTime ? c.ms[i] : c.frames[i];
      if (!(x > 0) || !std::isfinite(x) || !std::isfinite(c.errors[i]) || (logarithmic_ && !(c.errors[i] > 0))) {
        ++left;
        continue;
      }
      kept.frames.push_back(c.frames[i]), kept.ms.push_back(c.ms[i]);
      kept.errors.push_back(logarithmic_ ? c.errors[i] : -c.errors[i]), kept.noiseFloors.push_back(c.noiseFloors[i]);
      ++points;
    }
    c = std::move(kept);
  }
  std::erase_if(curves_, [](const ConvergenceCurve& c) { return c.ms.empty(); });
  if (points == 0) {
    nothing_ = tr("No run has %1 against the %2 reference while it went on.").arg(QString::fromStdString(choice_.metric), QString::fromStdString(choice_.reference));
    return;
  }
  nameConfigurations();
  setTitle(tr("%1, against the %2 reference").arg(QString::fromStdString(r.problems[choice_.problem].label), QString::fromStdString(choice_.reference)));
  makeLogarithmic(*plot_->xAxis);
  logarithmic_ ? makeLogarithmic(*plot_->yAxis) : makeLinear(*plot_->yAxis);
  plot_->yAxis->setRangeReversed(!logarithmic_);
  plot_->xAxis->setLabel(byTime ? tr("preparation, work and frames [ms]") : tr("frames since the start"));
  const MetricInfo& info = metricInfo(choice_.metric);
  plot_->yAxis->setLabel(tr("%1 of indirect light").arg(QString::fromUtf8(info.label.data(), static_cast<qsizetype>(info.label.size()))));

  std::vector<size_t> inLegend;
  bool others = false;
  std::vector<double> floors;
  for (const bool second : {false, true})  // those with a name over the others
    for (const ConvergenceCurve& c : curves_) {
      const bool named = std::find(named_.begin(), named_.end(), c.configuration) != named_.end();
      if (named != second) continue;
      const std::vector<double>& keys = byTime ? c.ms : c.frames;
      QCPGraph* g = plot_->addGraph();
      const QColor colour = colourOf(c.configuration);
      g->setPen(QPen(colour, kThin));
      g->setScatterStyle(QCPScatterStyle(QCPScatterStyle::ssDisc, 4));
      g->setData(QVector<double>(keys.begin(), keys.end()), QVector<double>(c.errors.begin(), c.errors.end()), true);
      lines_.emplace_back(c.configuration, g);
      if (named && std::find(inLegend.begin(), inLegend.end(), c.configuration) == inLegend.end()) {
        inLegend.push_back(c.configuration);
        g->setName(labelOf(c.configuration));
        g->addToLegend();
      } else if (!named && !others) {
        others = true;
        g->setName(tr("those off the front"));
        g->addToLegend();
      }
      for (const double f : c.noiseFloors)
        if (f > 0) floors.push_back(f);
      for (size_t i = 0; i < keys.size(); ++i)
        marks_.push_back({c.configuration, keys[i], c.errors[i],
                          tr("%1, seed %2\n%3 ms, %4 frames\n%5 %6").arg(labelOf(c.configuration)).arg(c.seed).arg(c.ms[i], 0, 'g', 4).arg(c.frames[i]).arg(QString::fromStdString(choice_.metric)).arg(c.errors[i], 0, 'g', 4)});
    }
  floor_ = spreadOf(floors).median;
  if (logarithmic_ && floor_ > 0) {
    QCPGraph* g = plot_->addGraph();
    g->setName(tr("noise floor of the reference"));
    g->setPen(QPen(ink(), 1, Qt::DotLine));
    double first = std::numeric_limits<double>::infinity(), last = 0;
    for (const PlotMark& m : marks_) first = std::min(first, m.x), last = std::max(last, m.x);
    g->setData({first, last}, {floor_, floor_}, true);
    g->addToLegend();
  }
  QStringList notes;
  if (!byTime && r.experiment.stop.kind == StopRule::Kind::Settled) notes << tr("Frames shown while work goes on are the machine's pace.");
  if (left) notes << tr("Left out, not above 0: %1 values.").arg(left);
  if (const size_t missing = r.plan.size() - r.done()) notes << tr("%1 of %2 runs are missing.").arg(missing).arg(r.plan.size());
  note_ = notes.join(QLatin1Char(' '));
}

void ConvergencePlot::showEverything() {
  double x0 = std::numeric_limits<double>::infinity(), x1 = 0, y0 = x0, y1 = -x0;
  for (const PlotMark& m : marks_) x0 = std::min(x0, m.x), x1 = std::max(x1, m.x), y0 = std::min(y0, m.y), y1 = std::max(y1, m.y);
  setRangeWithRoom(*plot_->xAxis, x0, x1);
  setRangeWithRoom(*plot_->yAxis, y0, y1);
}

void ConvergencePlot::highlight() {
  for (const auto& [configuration, line] : lines_) line->setPen(QPen(colourOf(configuration), selected_ && configuration == *selected_ ? kThick : kThin));
}

std::string ConvergencePlot::csv() const {
  std::string out = fmt::format("configuration,label,seed,repeat,frames,ms,reference,metric,error,noise_floor\n");
  if (!view_) return out;
  for (const ConvergenceCurve& c : curves_)
    for (size_t i = 0; i < c.ms.size(); ++i)
      out += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", c.configuration, csvCell(view_->results.configurations[c.configuration].label()), c.seed, c.repeat, c.frames[i], csvCell(c.ms[i]),
                         csvCell(choice_.reference), csvCell(choice_.metric), csvCell(c.errors[i]), csvCell(c.noiseFloors[i]));
  return out;
}

}  // namespace hl::ui
