#include "ui/speed_error_plot.h"

#include <qcustomplot.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "engine/core/csv.h"
#include "engine/metrics/metrics.h"
#include "ui/plot_style.h"

namespace hl::ui {
namespace {

constexpr double kMark = 8, kRing = 17;     // pixels
constexpr double kLongestBar = 4;           // of an error bar's end, as a factor to the points: beyond, it leaves the picture
constexpr int kFaint = 110;                 // alpha
constexpr int kLegendColumns = 3;
const QCPScatterStyle::ScatterShape kShapes[] = {QCPScatterStyle::ssCircle, QCPScatterStyle::ssSquare, QCPScatterStyle::ssDiamond, QCPScatterStyle::ssTriangle,
                                                 QCPScatterStyle::ssTriangleInverted};

QColor faint(QColor c) {
  c.setAlpha(kFaint);
  return c;
}

QCPScatterStyle markOf(FrontPlace place, QCPScatterStyle::ScatterShape shape, const QColor& colour, const QColor& ink, const QColor& ground) {
  switch (place) {
    case FrontPlace::On:
      return {shape, QPen(ink, 1.4), QBrush(colour), kMark};
    case FrontPlace::Within:
      return {shape, QPen(colour, 1.4), QBrush(faint(colour)), kMark - 1};
    case FrontPlace::Off:
      break;
  }
  return {shape, QPen(faint(colour), 1.2), QBrush(ground), kMark - 2};
}

const char* nameOf(FrontPlace p) { return p == FrontPlace::On ? "on" : p == FrontPlace::Within ? "within" : "off"; }

}  // namespace

QString costLabel(FrontAxis axis) {
  switch (axis) {
    case FrontAxis::Frame:
      return SpeedErrorPlot::tr("time of a frame [ms]");
    case FrontAxis::Total:
      return SpeedErrorPlot::tr("preparation, bake and frames [ms]");
    case FrontAxis::Amortised:
      return SpeedErrorPlot::tr("time of a frame with the bake spread [ms]");
    case FrontAxis::Memory:
      return SpeedErrorPlot::tr("memory of the technique [bytes]");
  }
  return {};
}

QString costText(FrontAxis axis, double v) {
  return axis == FrontAxis::Memory ? QLocale::c().formattedDataSize(static_cast<qint64>(v), 1, QLocale::DataSizeIecFormat) : QStringLiteral("%1 ms").arg(v, 0, 'g', 4);
}

SpeedErrorPlot::SpeedErrorPlot(PassPalette& techniques, QWidget* parent)
    : SweepPlot(QStringLiteral("speed_error"), tr("Speed against error"), parent), techniques_(techniques) {}

double SpeedErrorPlot::plotted(const CostPoint& p) const {
  if (!logarithmic_) return -p.error;
  if (p.error > 0) return p.error;
  const double top = p.error + p.halfWidth;
  return top > 0 ? top : std::numeric_limits<double>::quiet_NaN();
}

bool SpeedErrorPlot::has(const CostPoint& p) const { return p.cost > 0 && std::isfinite(p.cost) && std::isfinite(plotted(p)); }

void SpeedErrorPlot::draw() {
  plot_->legend->setWrap(kLegendColumns);  // before its entries, which it would not move
  const SweepResults& r = view_->results;
  logarithmic_ = isLogarithmic(choice_.metric);
  front_ = frontOf(r, view_->summary, choice_.problem, choice_.cost, choice_.reference, choice_.metric);
  tracers_ = choice_.cost == FrontAxis::Memory ? std::vector<TracerCurve>() : tracerCurves(r, choice_.problem, choice_.reference, choice_.metric);
  const bool any = std::any_of(front_.points.begin(), front_.points.end(), [&](const FrontPoint& p) { return has(p.point); });
  if (!any) {
    nothing_ = front_.points.empty() ? tr("No run of %1 has %2 against the %3 reference.").arg(QString::fromStdString(r.problems[choice_.problem].label), QString::fromStdString(choice_.metric), QString::fromStdString(choice_.reference))
                                     : tr("No configuration has a cost and an error above 0: on logarithmic axes there is no place for them.");
    return;
  }
  setTitle(tr("%1, against the %2 reference").arg(QString::fromStdString(r.problems[choice_.problem].label), QString::fromStdString(choice_.reference)));
  makeLogarithmic(*plot_->xAxis);
  logarithmic_ ? makeLogarithmic(*plot_->yAxis) : makeLinear(*plot_->yAxis);
  plot_->yAxis->setRangeReversed(!logarithmic_);  // what is better is lower
  plot_->xAxis->setLabel(costLabel(choice_.cost));
  const MetricInfo& info = metricInfo(choice_.metric);
  QString metric = QString::fromUtf8(info.label.data(), static_cast<qsizetype>(info.label.size()));
  if (info.mapSigned) metric = tr("size of %1").arg(metric);
  if (info.perfect > 0 && logarithmic_) metric = tr("%1 lacking").arg(metric);
  plot_->yAxis->setLabel(tr("%1 of indirect light").arg(metric));
  drawFront();
  drawTracers();
  std::vector<std::string> techniques;
  for (const FrontPoint& p : front_.points)
    if (const std::string& t = r.configurations[p.configuration].preset.technique; std::find(techniques.begin(), techniques.end(), t) == techniques.end()) techniques.push_back(t);
  std::sort(techniques.begin(), techniques.end());
  for (size_t i = 0; i < techniques.size(); ++i) {
    QCPGraph* best = nullptr;
    for (const FrontPlace place : {FrontPlace::Off, FrontPlace::Within, FrontPlace::On})  // the front on top
      if (QCPGraph* g = drawPoints(techniques[i], i, place)) best = g;
    if (best) best->addToLegend();
  }
  drawLegendOfPlaces();
  std::sort(marks_.begin(), marks_.end(), [](const PlotMark& a, const PlotMark& b) { return a.x < b.x; });
  makeNote();
}

void SpeedErrorPlot::drawErrorBars(QCPGraph& graph, const QVector<double>& below, const QVector<double>& above, bool horizontal) {
  auto* bars = new QCPErrorBars(plot_->xAxis, plot_->yAxis);
  bars->setDataPlottable(&graph);
  bars->setErrorType(horizontal ? QCPErrorBars::etKeyError : QCPErrorBars::etValueError);
  bars->setData(below, above);
  bars->setPen(QPen(faint(graph.pen().color()), 1));
  bars->setWhiskerWidth(5);
  bars->setSymbolGap(0);
}

QCPGraph* SpeedErrorPlot::drawPoints(const std::string& technique, size_t index, FrontPlace place) {
  const SweepResults& r = view_->results;
  const QColor colour = techniques_.of(technique);
  QVector<double> x, y, left, right, down, up;
  for (const FrontPoint& p : front_.points) {
    if (p.place != place || r.configurations[p.configuration].preset.technique != technique || !has(p.point)) continue;
    const Spread cost = costOf(view_->summary.configurations[p.configuration], choice_.cost, r.experiment.amortiseFrames);
    const double half = std::isfinite(p.point.halfWidth) ? p.point.halfWidth : 0;
    const bool limit = logarithmic_ && !(p.point.error > 0);  // drawn at the top of its interval
    x << p.point.cost, y << plotted(p.point);
    left << cost.median - cost.p5, right << cost.p95 - cost.median;
    down << (limit ? 0 : half), up << (limit ? 0 : half);
    QString text = labelOf(p.configuration) + QLatin1Char('\n');
    text += tr("%1 (%2 to %3)").arg(costText(choice_.cost, cost.median), costText(choice_.cost, cost.p5), costText(choice_.cost, cost.p95)) + QLatin1Char('\n');
    text += tr("%1 %2 \u00b1 %3").arg(QString::fromStdString(choice_.metric)).arg(logarithmic_ ? p.point.error : -p.point.error, 0, 'g', 4).arg(half, 0, 'g', 2) + QLatin1Char('\n');
    text += place == FrontPlace::On ? tr("on the front") : place == FrontPlace::Within ? tr("within the error bars of the front") : tr("dominated");
    if (limit) text += tr("; not told from 0, drawn at the top of its interval");
    marks_.push_back({p.configuration, x.back(), y.back(), text});
  }
  if (x.isEmpty()) return nullptr;
  QCPGraph* g = plot_->addGraph();
  g->setName(QString::fromStdString(technique));
  g->setLineStyle(QCPGraph::lsNone);
  g->setPen(QPen(colour));
  g->setScatterStyle(markOf(place, kShapes[index % std::size(kShapes)], colour, ink(), ground()));
  g->setData(x, y, true);
  drawErrorBars(*g, left, right, true);
  drawErrorBars(*g, down, up, false);
  return g;
}

/// What can be had: as steps, since between two configurations there is none.
void SpeedErrorPlot::drawFront() {
  QVector<double> x, y;
  for (const FrontPoint& p : front_.points)
    if (p.place == FrontPlace::On && has(p.point)) x << p.point.cost, y << plotted(p.point);
  QCPGraph* g = plot_->addGraph();
  g->setName(tr("Pareto front"));
  g->setLineStyle(QCPGraph::lsStepLeft);
  g->setPen(QPen(faint(ink()), 2));
  g->setData(x, y, true);
  if (!x.isEmpty()) g->addToLegend();
}

void SpeedErrorPlot::drawTracers() {
  const Qt::PenStyle styles[] = {Qt::DashLine, Qt::DotLine, Qt::DashDotLine};
  size_t n = 0;
  for (const TracerCurve& curve : tracers_) {
    QVector<double> x, y, down, up, left, right;
    for (const CostPoint& p : curve.points) {
      if (!has(p)) continue;
      x << p.cost, y << plotted(p);
      down << (logarithmic_ && !(p.error > 0) ? 0 : p.halfWidth), up << down.back();
      left << p.costHalfWidth, right << p.costHalfWidth;
    }
    if (x.isEmpty()) continue;
    QCPGraph* g = plot_->addGraph();
    g->setName(tracers_.size() > 1 ? tr("path tracer (host, %1 threads; %2)").arg(curve.threads).arg(QString::fromStdString(curve.transport)) : tr("path tracer (host, %1 threads)").arg(curve.threads));
    g->setPen(QPen(ink(), 1.2, styles[n++ % std::size(styles)]));
    g->setScatterStyle(QCPScatterStyle(QCPScatterStyle::ssCross, QPen(ink(), 1.2), Qt::NoBrush, kMark - 2));
    g->setData(x, y, true);
    drawErrorBars(*g, left, right, true);
    drawErrorBars(*g, down, up, false);
    g->addToLegend();
  }
}

/// Graphs without data, for their entries.
void SpeedErrorPlot::drawLegendOfPlaces() {
  const std::pair<FrontPlace, QString> places[] = {{FrontPlace::On, tr("on the front")}, {FrontPlace::Within, tr("within its error bars")}, {FrontPlace::Off, tr("dominated")}};
  for (const auto& [place, name] : places) {
    if (std::none_of(front_.points.begin(), front_.points.end(), [&, at = place](const FrontPoint& p) { return p.place == at && has(p.point); })) continue;
    QCPGraph* g = plot_->addGraph();
    g->setName(name);
    g->setLineStyle(QCPGraph::lsNone);
    g->setScatterStyle(markOf(place, QCPScatterStyle::ssCircle, QColor(Qt::gray), ink(), ground()));
    g->addToLegend();
  }
}

void SpeedErrorPlot::makeNote() {
  int failed = 0, without = 0, limits = 0;
  for (const ConfigurationSummary& c : view_->summary.configurations)
    if (c.problem == choice_.problem && c.runs > 0 && c.runs == c.failed) ++failed;
  for (const FrontPoint& p : front_.points) {
    without += has(p.point) ? 0 : 1;
    limits += has(p.point) && logarithmic_ && !(p.point.error > 0) ? 1 : 0;
  }
  QStringList parts;
  if (const size_t missing = view_->results.plan.size() - view_->results.done()) parts << tr("%1 of %2 runs are missing.").arg(missing).arg(view_->results.plan.size());
  if (failed) parts << tr("Failed: %1.").arg(failed);
  if (without) parts << tr("Left out, without a cost and an error above 0: %1.").arg(without);
  if (limits) parts << tr("Not told from 0, drawn at the top of the interval: %1.").arg(limits);
  note_ = parts.join(QLatin1Char(' '));
}

void SpeedErrorPlot::showEverything() {
  double x0 = std::numeric_limits<double>::infinity(), x1 = 0, y0 = x0, y1 = -x0;
  const auto take = [&](const CostPoint& p) {
    if (!has(p)) return;
    const double y = plotted(p), half = std::isfinite(p.halfWidth) ? p.halfWidth : 0;
    x0 = std::min(x0, std::max(p.cost - p.costHalfWidth, p.cost / kLongestBar)), x1 = std::max(x1, std::min(p.cost + p.costHalfWidth, p.cost * kLongestBar));
    y0 = std::min(y0, logarithmic_ ? std::max(y - half, y / kLongestBar) : y - half);
    y1 = std::max(y1, logarithmic_ ? std::min(y + half, y * kLongestBar) : y + half);
  };
  for (const FrontPoint& p : front_.points) take(p.point);
  for (const TracerCurve& c : tracers_)
    for (const CostPoint& p : c.points) take(p);
  setRangeWithRoom(*plot_->xAxis, x0, x1);
  setRangeWithRoom(*plot_->yAxis, y0, y1);
}

void SpeedErrorPlot::highlight() {
  plot_->clearItems();
  for (const PlotMark& m : marks_) {
    if (!selected_ || m.configuration != *selected_) continue;
    // A ring of a fixed size about the point, whatever the zoom.
    auto* ring = new QCPItemEllipse(plot_);
    ring->setPen(QPen(ink(), 2));
    auto* at = new QCPItemTracer(plot_);
    at->setStyle(QCPItemTracer::tsNone);
    at->position->setCoords(m.x, m.y);
    for (QCPItemPosition* corner : {ring->topLeft, ring->bottomRight}) {
      corner->setParentAnchor(at->position);
      corner->setType(QCPItemPosition::ptAbsolute);
    }
    ring->topLeft->setCoords(-kRing / 2, -kRing / 2);
    ring->bottomRight->setCoords(kRing / 2, kRing / 2);
  }
}

std::string SpeedErrorPlot::csv() const {
  std::string out = fmt::format("kind,configuration,label,technique,paths,{0},{0}_p5,{0}_p95,reference,metric,error,error_ci95,front\n", kFrontAxes[static_cast<size_t>(choice_.cost)]);
  if (!view_) return out;
  const SweepResults& r = view_->results;
  const auto line = [&](const std::string& head, const Spread& cost, const CostPoint& p, const char* place) {
    out += fmt::format("{},{},{},{},{},{},{},{},{}\n", head, csvCell(cost.median), csvCell(cost.p5), csvCell(cost.p95), csvCell(choice_.reference), csvCell(choice_.metric),
                       csvCell(isLogarithmic(choice_.metric) ? p.error : -p.error), csvCell(p.halfWidth), place);
  };
  for (const FrontPoint& p : front_.points)
    line(fmt::format("configuration,{},{},{},", p.configuration, csvCell(r.configurations[p.configuration].label()), csvCell(r.configurations[p.configuration].preset.technique)),
         costOf(view_->summary.configurations[p.configuration], choice_.cost, r.experiment.amortiseFrames), p.point, nameOf(p.place));
  for (const TracerCurve& c : tracers_)
    for (size_t i = 0; i < c.points.size(); ++i)
      line(fmt::format("path_tracer,,{},path_tracer,{}", csvCell(fmt::format("host, {} threads, {}", c.threads, c.transport)), c.paths[i]),
           {c.points[i].cost, c.points[i].cost - c.points[i].costHalfWidth, c.points[i].cost + c.points[i].costHalfWidth}, c.points[i], "");
  return out;
}

}  // namespace hl::ui
