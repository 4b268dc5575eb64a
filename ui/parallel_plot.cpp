#include "ui/parallel_plot.h"

#include <fmt/format.h>
#include <qcustomplot.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/csv.h"
#include "engine/metrics/metrics.h"
#include "ui/plot_style.h"
#include "ui/speed_error_plot.h"

namespace hl::ui {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kNowhere = -0.1;  // where a line passes an axis that it has no value on
constexpr double kNear = 8, kOnAxis = 7;  // pixels
constexpr double kLeastBrush = 0.02;
constexpr double kDash = 0.02;  // of the way to the next axis
constexpr int kFaded = 18;      // alpha
constexpr int kColumnWidth = 150, kHeight = 420;  // of a picture
constexpr int kMostTicks = 12;

double distanceToSegment(QPointF p, QPointF a, QPointF b) {
  const QPointF d = b - a;
  const double length = QPointF::dotProduct(d, d);
  const double t = length > 0 ? std::clamp(QPointF::dotProduct(p - a, d) / length, 0.0, 1.0) : 0;
  const QPointF q = a + d * t - p;
  return std::hypot(q.x(), q.y());
}

/// Values by their place between the least and the largest, with round numbers as ticks.
ParallelPlot::Column measured(const QString& title, std::vector<double> values, bool logarithmic) {
  ParallelPlot::Column out;
  out.title = title;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (double& v : values) {
    if (!std::isfinite(v) || (logarithmic && !(v > 0))) v = kNaN;
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  }
  const auto scaled = [&](double v) { return logarithmic ? std::log(v) : v; };
  const auto placeOf = [&](double v) { return high > low ? (scaled(v) - scaled(low)) / (scaled(high) - scaled(low)) : 0.5; };
  for (const double v : values) out.places.push_back(std::isfinite(v) ? placeOf(v) : kNaN);
  if (high >= low)
    for (const double t : roundNumbers(low, high, logarithmic)) out.ticks.emplace_back(placeOf(t), QString::number(t, 'g', 4));
  if (high == low) out.ticks = {{0.5, QString::number(low, 'g', 4)}};
  out.values = std::move(values);
  return out;
}

}  // namespace

ParallelPlot::ParallelPlot(PassPalette& techniques, QWidget* parent)
    : SweepPlot(QStringLiteral("parallel"), tr("Parallel coordinates of what was varied, cost and error"), parent), techniques_(techniques) {}

QSize ParallelPlot::pictureSize() const { return {std::max(480, static_cast<int>(columns_.size()) * kColumnWidth), kHeight}; }

void ParallelPlot::addVaried() {
  const SweepResults& r = view_->results;
  for (const VariedAxis& axis : variedAxes(r, choice_.problem)) {
    Column c;
    c.title = QString::fromStdString(shortKey(r, axis.key));
    const size_t step = axis.numeric ? axis.values.size() / kMostTicks + 1 : 1;
    for (size_t i = 0; i < axis.values.size(); i += step) c.ticks.emplace_back(axis.places[i], QString::fromStdString(axis.values[i]));
    c.places = axis.byConfiguration;
    columns_.push_back(std::move(c));
  }
}

void ParallelPlot::addMeasured(const Front& front) {
  std::vector<double> cost(view_->results.configurations.size(), kNaN), error = cost;
  for (const FrontPoint& p : front.points) {
    cost[p.configuration] = p.point.cost;
    error[p.configuration] = isLogarithmic(choice_.metric) ? p.point.error : -p.point.error;
  }
  const char* const titles[] = {QT_TR_NOOP("frame [ms]"), QT_TR_NOOP("total [ms]"), QT_TR_NOOP("frame, bake spread [ms]"), QT_TR_NOOP("memory [bytes]")};
  columns_.push_back(measured(tr(titles[static_cast<size_t>(choice_.cost)]), std::move(cost), true));
  columns_.push_back(measured(QString::fromStdString(choice_.metric), std::move(error), isLogarithmic(choice_.metric)));
}

void ParallelPlot::draw() {
  const SweepResults& r = view_->results;
  columns_.clear(), lines_.clear();
  const Front front = frontOf(r, view_->summary, choice_.problem, choice_.cost, choice_.reference, choice_.metric);
  addVaried();
  if (columns_.empty()) {
    nothing_ = tr("Nothing was varied here: there is one configuration.");
    return;
  }
  if (front.points.empty()) {
    nothing_ = tr("No run of %1 has %2 against the %3 reference.").arg(QString::fromStdString(r.problems[choice_.problem].label), QString::fromStdString(choice_.metric), QString::fromStdString(choice_.reference));
    return;
  }
  addMeasured(front);
  QStringList titles;
  for (const Column& c : columns_) titles << c.title;
  if (titles.join(QLatin1Char('\n')) != brushesOf_) brushes_.clear(), brushesOf_ = titles.join(QLatin1Char('\n'));
  setTitle(tr("%1, against the %2 reference").arg(QString::fromStdString(r.problems[choice_.problem].label), QString::fromStdString(choice_.reference)));
  std::vector<FrontPoint> points = front.points;
  std::stable_sort(points.begin(), points.end(), [](const FrontPoint& a, const FrontPoint& b) { return a.place > b.place; });  // the front on top
  bool nowhere = false;
  for (const FrontPoint& p : points) {
    Line line{p.configuration, p.place, plot_->addGraph(), {}};
    QVector<double> x, y;
    for (size_t i = 0; i < columns_.size(); ++i) {
      const double place = columns_[i].places[p.configuration];
      nowhere |= !std::isfinite(place);
      line.points.emplace_back(static_cast<double>(i), std::isfinite(place) ? place : kNowhere);
      x << line.points.back().x(), y << line.points.back().y();
    }
    line.graph->setData(x, y, true);
    QString text = labelOf(p.configuration);
    for (size_t i = columns_.size() - 2; i < columns_.size(); ++i) text += QStringLiteral("\n%1 %2").arg(columns_[i].title).arg(columns_[i].values[p.configuration], 0, 'g', 4);
    marks_.push_back({p.configuration, x.back(), y.back(), text});
    lines_.push_back(std::move(line));
  }
  drawColumns();
  addLegend();
  plot_->legend->setWrap(4);
  QStringList notes;
  if (nowhere) notes << tr("Below an axis: no value there.");
  if (const size_t missing = r.plan.size() - r.done()) notes << tr("%1 of %2 runs are missing.").arg(missing).arg(r.plan.size());
  note_ = notes.join(QLatin1Char(' '));
}

QPen ParallelPlot::penOf(FrontPlace place, QColor colour) const {
  if (place == FrontPlace::Off) colour = ink();
  colour.setAlpha(place == FrontPlace::On ? 255 : place == FrontPlace::Within ? 150 : 70);
  return {colour, place == FrontPlace::On ? 2.2 : 1.2, place == FrontPlace::Within ? Qt::DashLine : Qt::SolidLine};
}

/// Graphs without data, for their entries.
void ParallelPlot::addLegend() {
  const auto entry = [&](const QString& name, const QPen& pen) {
    QCPGraph* g = plot_->addGraph();
    g->setName(name);
    g->setPen(pen);
    g->addToLegend();
  };
  std::vector<std::string> techniques;
  for (const Line& line : lines_)
    if (const std::string& t = view_->results.configurations[line.configuration].preset.technique; line.place != FrontPlace::Off && std::find(techniques.begin(), techniques.end(), t) == techniques.end()) techniques.push_back(t);
  std::sort(techniques.begin(), techniques.end());
  if (techniques.size() > 1)
    for (const std::string& t : techniques) entry(QString::fromStdString(t), penOf(FrontPlace::On, techniques_.of(t)));
  const std::pair<FrontPlace, QString> places[] = {{FrontPlace::On, tr("on the front")}, {FrontPlace::Within, tr("within its error bars")}, {FrontPlace::Off, tr("dominated")}};
  for (const auto& [place, name] : places)
    if (std::any_of(lines_.begin(), lines_.end(), [at = place](const Line& line) { return line.place == at; }))
      entry(name, penOf(place, techniques.size() == 1 ? techniques_.of(techniques.front()) : ink()));
}

void ParallelPlot::drawColumns() {
  plot_->yAxis->setVisible(false);
  plot_->yAxis->grid()->setVisible(false);
  plot_->xAxis->grid()->setVisible(false);
  makeLinear(*plot_->xAxis), makeLinear(*plot_->yAxis);
  auto* titles = new QCPAxisTickerText;
  for (size_t i = 0; i < columns_.size(); ++i) titles->addTick(static_cast<double>(i), columns_[i].title);
  plot_->xAxis->setTicker(QSharedPointer<QCPAxisTicker>(titles));
  plot_->xAxis->setSubTicks(false);
  plot_->xAxis->setLabel({});
}

void ParallelPlot::showEverything() {
  plot_->xAxis->setRange(-0.35, static_cast<double>(columns_.size()) - 0.35);
  plot_->yAxis->setRange(-0.16, 1.06);
}

void ParallelPlot::highlight() {
  plot_->clearItems();
  QFont small = font();
  small.setPointSizeF(small.pointSizeF() * 0.9);
  for (size_t i = 0; i < columns_.size(); ++i) {
    const double x = static_cast<double>(i);
    if (const auto brush = brushes_.find(i); brush != brushes_.end()) {
      auto* part = new QCPItemLine(plot_);
      part->start->setCoords(x, brush->second.first), part->end->setCoords(x, brush->second.second);
      QColor c = PassPalette::colour(1);
      c.setAlpha(150);
      part->setPen(QPen(c, 9, Qt::SolidLine, Qt::FlatCap));
    }
    for (const auto& [place, text] : columns_[i].ticks) {
      auto* tick = new QCPItemText(plot_);
      tick->position->setCoords(x, place);
      tick->setPositionAlignment(Qt::AlignLeft | Qt::AlignVCenter);
      tick->setPadding(QMargins(4, 0, 2, 0));
      tick->setText(text);
      tick->setFont(small);
      tick->setColor(ink());
      QColor behind = ground();
      behind.setAlpha(190);
      tick->setBrush(QBrush(behind));
      auto* dash = new QCPItemLine(plot_);
      dash->start->setCoords(x - kDash, place), dash->end->setCoords(x, place);
      dash->setPen(QPen(ink(), 1));
    }
    auto* axis = new QCPItemLine(plot_);  // over what lies behind the labels
    axis->start->setCoords(x, 0), axis->end->setCoords(x, 1);
    axis->setPen(QPen(ink(), 1));
  }
  for (const Line& line : lines_) {
    QPen pen = penOf(line.place, techniques_.of(view_->results.configurations[line.configuration].preset.technique));
    if (isBrushedAway(line.configuration)) {
      QColor faded = pen.color();
      faded.setAlpha(kFaded);
      pen.setColor(faded);
    }
    if (selected_ && line.configuration == *selected_) pen = QPen(ink(), 3.5);
    line.graph->setPen(pen);
  }
}

void ParallelPlot::brush(size_t column, std::optional<std::pair<double, double>> between) {
  brushes_.erase(column);
  if (between) brushes_[column] = std::minmax(between->first, between->second);
  highlight();
  plot_->replot(QCustomPlot::rpQueuedReplot);
}

bool ParallelPlot::isBrushedAway(size_t configuration) const {
  for (const auto& [column, between] : brushes_) {
    const double place = columns_[column].places[configuration];
    if (!(place >= between.first && place <= between.second)) return true;
  }
  return false;
}

const PlotMark* ParallelPlot::markNear(QPointF pixel) const {
  const PlotMark* best = nullptr;
  double least = kNear;
  for (size_t i = 0; i < lines_.size(); ++i)
    for (size_t k = 1; k < lines_[i].points.size(); ++k) {
      const auto at = [&](const QPointF& p) { return QPointF(plot_->xAxis->coordToPixel(p.x()), plot_->yAxis->coordToPixel(p.y())); };
      // Of lines that meet, that on the front, which is drawn last.
      if (const double d = distanceToSegment(pixel, at(lines_[i].points[k - 1]), at(lines_[i].points[k])); d <= least) best = &marks_[i], least = d;
    }
  return best;
}

std::optional<size_t> ParallelPlot::columnAt(QPointF pixel) const {
  for (size_t i = 0; i < columns_.size(); ++i)
    if (std::abs(plot_->xAxis->coordToPixel(static_cast<double>(i)) - pixel.x()) <= kOnAxis) return i;
  return std::nullopt;
}

/// A drag that begins on an axis brushes; elsewhere it moves the plot.
bool ParallelPlot::eventFilter(QObject* watched, QEvent* event) {
  if (watched == plot_ && nothing_.isEmpty() && (event->type() == QEvent::MouseButtonPress || event->type() == QEvent::MouseMove || event->type() == QEvent::MouseButtonRelease)) {
    const auto* mouse = static_cast<QMouseEvent*>(event);
    const double place = plot_->yAxis->pixelToCoord(mouse->position().y());
    if (event->type() == QEvent::MouseButtonPress && mouse->button() == Qt::LeftButton) {
      if (const auto column = columnAt(mouse->position())) {
        brushing_ = {*column, place};
        return true;
      }
    } else if (brushing_ && event->type() == QEvent::MouseMove) {
      brush(brushing_->first, std::pair(brushing_->second, place));
      return true;
    } else if (brushing_ && event->type() == QEvent::MouseButtonRelease) {
      const auto [column, from] = *brushing_;
      brushing_.reset();
      brush(column, std::abs(place - from) < kLeastBrush ? std::nullopt : std::optional(std::pair(from, place)));
      return true;
    }
  }
  return SweepPlot::eventFilter(watched, event);
}

std::string ParallelPlot::csv() const {
  std::string out = "configuration,label,technique";
  if (!view_ || columns_.size() < 2) return out + '\n';
  const SweepResults& r = view_->results;
  std::vector<std::string> keys;
  for (const VariedAxis& axis : variedAxes(r, choice_.problem))
    if (axis.key != "technique") keys.push_back(axis.key);
  for (const std::string& key : keys) out += fmt::format(",{}", csvCell(key));
  out += fmt::format(",{},{}_{},front\n", kFrontAxes[static_cast<size_t>(choice_.cost)], choice_.metric, choice_.reference);
  for (const Line& line : lines_) {
    const Configuration& c = r.configurations[line.configuration];
    out += fmt::format("{},{},{}", line.configuration, csvCell(c.label()), csvCell(c.preset.technique));
    for (const std::string& key : keys) {
      std::string value;
      for (const auto& [k, v] : c.values)
        if (k == key) value = v;
      out += fmt::format(",{}", csvCell(value));
    }
    const char* const place = line.place == FrontPlace::On ? "on" : line.place == FrontPlace::Within ? "within" : "off";
    out += fmt::format(",{},{},{}\n", csvCell(columns_[columns_.size() - 2].values[line.configuration]), csvCell(columns_.back().values[line.configuration]), place);
  }
  return out;
}

}  // namespace hl::ui
