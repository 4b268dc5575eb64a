#include "ui/sweep_table.h"

#include <QFont>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace hl::ui {
namespace {

constexpr int kNoPlace = 3;
constexpr double kMega = 1e6;
const double kNaN = std::numeric_limits<double>::quiet_NaN();

QString fromStd(const std::string& s) { return QString::fromStdString(s); }

/// Three or four digits that mean something.
QString shown(double v) {
  if (std::isnan(v)) return {};
  return QString::number(v, 'g', 4);
}

double numberIn(const std::string& text) {
  double v = kNaN;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), v);
  return end.ptr == text.data() + text.size() ? v : kNaN;
}

}  // namespace

SweepRows sweepRows(const SweepView& view, const PlotChoice& choice) {
  const SweepResults& r = view.results;
  SweepRows out;
  out.choice = choice;
  for (const Configuration& c : r.configurations)
    for (const auto& [key, value] : c.values)
      if (std::find(out.keys.begin(), out.keys.end(), key) == out.keys.end()) out.keys.push_back(key);
  for (const std::string& key : out.keys) out.titles.push_back(shortKey(r, key));
  const Front front = frontOf(r, view.summary, choice.problem, choice.cost, choice.reference, choice.metric);
  std::vector<const FrontPoint*> points(r.configurations.size());
  for (const FrontPoint& p : front.points) points[p.configuration] = &p;
  for (const ConfigurationSummary& c : view.summary.configurations) {
    if (c.problem != choice.problem) continue;
    SweepRows::Row row;
    row.configuration = c.configuration;
    for (const std::string& key : out.keys) {
      std::string value;
      for (const auto& [k, v] : r.configurations[c.configuration].values)
        if (k == key) value = v;
      row.values.push_back(value);
    }
    row.cost = row.costHalfWidth = row.error = row.halfWidth = row.bias = row.variance = kNaN;
    row.place = kNoPlace;
    if (const FrontPoint* p = points[c.configuration])
      row.cost = p->point.cost, row.costHalfWidth = p->point.costHalfWidth, row.halfWidth = p->point.halfWidth, row.place = static_cast<int>(p->place);
    for (const ErrorSummary& e : c.errors)
      if (e.reference == choice.reference && e.metric == choice.metric && e.target == "image" && e.component == "indirect" && e.roi.empty()) row.error = e.value.mean;
    for (const BiasVariance& parts : c.parts)
      if (parts.reference == choice.reference) row.bias = parts.biasSquared.mean, row.variance = parts.variance.mean;
    row.runs = c.runs, row.failed = c.failed, row.failure = c.failure;
    out.rows.push_back(std::move(row));
  }
  return out;
}

SweepTableModel::SweepTableModel(QObject* parent) : QAbstractTableModel(parent) {}

void SweepTableModel::show(SweepRows rows) {
  beginResetModel();
  if (rows.keys != rows_.keys) sorted_ = -1;
  rows_ = std::move(rows);
  order();
  endResetModel();
}

int SweepTableModel::rowCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : static_cast<int>(rows_.rows.size()); }
int SweepTableModel::columnCount(const QModelIndex& parent) const { return parent.isValid() || rows_.rows.empty() ? 0 : firstFixed() + FixedCount; }

double SweepTableModel::number(const SweepRows::Row& row, int column) const {
  if (column < firstFixed()) return numberIn(row.values[static_cast<size_t>(column)]);
  switch (column - firstFixed()) {
    case Cost:
      return row.cost;
    case Error:
      return row.error;
    case Interval:
      return row.halfWidth;
    case Place:
      return row.place;
    case Bias:
      return row.bias;
    case Variance:
      return row.variance;
    default:
      return row.runs;
  }
}

QString SweepTableModel::text(const SweepRows::Row& row, int column) const {
  if (column < firstFixed()) return fromStd(row.values[static_cast<size_t>(column)]);
  switch (column - firstFixed()) {
    case Cost:
      if (std::isnan(row.cost)) return {};
      return rows_.choice.cost == FrontAxis::Memory ? QString::number(row.cost / kMega, 'f', 2) : shown(row.cost);
    case Interval:
      return std::isfinite(row.halfWidth) ? QStringLiteral("\u00b1 ") + shown(row.halfWidth) : QString();
    case Place:
      return row.place == static_cast<int>(FrontPlace::On) ? tr("on") : row.place == static_cast<int>(FrontPlace::Within) ? tr("within") : QString();
    case Runs:
      return row.failed ? tr("%1, %2 failed").arg(row.runs).arg(row.failed) : QString::number(row.runs);
    default:
      return shown(number(row, column));
  }
}

QVariant SweepTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const SweepRows::Row& row = rows_.rows[static_cast<size_t>(index.row())];
  if (role == Qt::DisplayRole) return text(row, index.column());
  if (role == Qt::TextAlignmentRole) {
    const bool isText = index.column() < firstFixed() ? std::isnan(number(row, index.column())) : index.column() - firstFixed() == Place;
    return isText ? int(Qt::AlignLeft | Qt::AlignVCenter) : int(Qt::AlignRight | Qt::AlignVCenter);
  }
  if (role == Qt::FontRole && row.place == static_cast<int>(FrontPlace::On)) {
    QFont bold;
    bold.setBold(true);
    return bold;
  }
  if (role == Qt::ToolTipRole) {
    if (row.failed) return fromStd(row.failure);
    return tr("A click, or Enter, loads this configuration into the window");
  }
  return {};
}

QVariant SweepTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || section >= columnCount()) return {};
  const int fixed = section - firstFixed();
  if (fixed < 0) {
    if (role == Qt::DisplayRole) return fromStd(rows_.titles[static_cast<size_t>(section)]);
    return role == Qt::ToolTipRole ? QVariant(fromStd(rows_.keys[static_cast<size_t>(section)])) : QVariant();
  }
  const bool bytes = rows_.choice.cost == FrontAxis::Memory;
  if (role == Qt::DisplayRole) {
    const QString names[FixedCount] = {bytes ? tr("Memory [MB]") : tr("Cost [ms]"), fromStd(rows_.choice.metric), tr("95 %"), tr("Front"), tr("Bias\u00b2"), tr("Variance"), tr("Runs")};
    return names[fixed];
  }
  if (role == Qt::ToolTipRole) {
    const QString tips[FixedCount] = {bytes ? tr("Of the technique's own memory") : tr("Median over runs"),
                                      tr("Mean over seeds, of indirect light over the whole picture"),
                                      tr("Half of the 95 % interval; with one seed, of what the reference's noise makes of it"),
                                      tr("on: nothing is as good in both and better in one; within: something is, but not beyond the error bars"),
                                      tr("Squared bias, in the unit of mse: what more seeds do not take away. Once the sweep is through, with several seeds"),
                                      tr("Variance over seeds, in the unit of mse"),
                                      tr("Runs so far")};
    return tips[fixed];
  }
  return {};
}

void SweepTableModel::sort(int column, Qt::SortOrder order) {
  sorted_ = column, sortOrder_ = order;
  beginResetModel();
  this->order();
  endResetModel();
}

/// Numbers by their size, then texts; what is not known last, whichever way round.
void SweepTableModel::order() {
  const auto byConfiguration = [](const SweepRows::Row& a, const SweepRows::Row& b) { return a.configuration < b.configuration; };
  std::sort(rows_.rows.begin(), rows_.rows.end(), byConfiguration);
  if (sorted_ < 0 || rows_.rows.empty() || sorted_ >= columnCount()) return;
  const bool rising = sortOrder_ == Qt::AscendingOrder;
  std::stable_sort(rows_.rows.begin(), rows_.rows.end(), [&](const SweepRows::Row& a, const SweepRows::Row& b) {
    const double x = number(a, sorted_), y = number(b, sorted_);
    if (std::isnan(x) != std::isnan(y)) return std::isnan(y);
    if (!std::isnan(x)) return rising ? x < y : x > y;
    if (sorted_ >= firstFixed()) return false;
    const std::string &s = a.values[static_cast<size_t>(sorted_)], &t = b.values[static_cast<size_t>(sorted_)];
    return rising ? s < t : s > t;
  });
}

int SweepTableModel::rowOf(size_t configuration) const {
  for (size_t i = 0; i < rows_.rows.size(); ++i)
    if (rows_.rows[i].configuration == configuration) return static_cast<int>(i);
  return -1;
}

}  // namespace hl::ui
