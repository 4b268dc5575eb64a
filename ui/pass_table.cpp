#include "ui/pass_table.h"

#include <QHeaderView>

#include "ui/palette.h"

namespace hl::ui {

PassModel::PassModel(PassPalette& palette, QObject* parent) : QAbstractTableModel(parent), palette_(palette) {}

void PassModel::show(const FrameResult& frame) {
  std::vector<Row> next;
  for (const PassStatistics& p : frame.passes) next.push_back({p, false, false});
  for (const PassStatistics& p : frame.workPasses) next.push_back({p, true, false});
  if (!frame.passes.empty()) next.push_back({frame.frameTime, false, true});
  bool same = next.size() == rows_.size();
  for (size_t i = 0; same && i < next.size(); ++i) same = next[i].pass.name == rows_[i].pass.name;
  if (same) {
    rows_ = std::move(next);
    if (!rows_.empty()) emit dataChanged(index(0, 0), index(rowCount() - 1, ColumnCount - 1));
    return;
  }
  beginResetModel();
  rows_ = std::move(next);
  endResetModel();
}

int PassModel::rowCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : static_cast<int>(rows_.size()); }
int PassModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : static_cast<int>(ColumnCount); }

QVariant PassModel::data(const QModelIndex& i, int role) const {
  if (!i.isValid() || static_cast<size_t>(i.row()) >= rows_.size()) return {};
  const Row& row = rows_[static_cast<size_t>(i.row())];
  const PassStatistics& p = row.pass;
  const bool skipped = !p.skipped.empty() && !(p.share > 0);  // what runs in some frames only shows what it takes then
  const auto ms = [&](double v) { return skipped ? QString() : QString::number(v, 'f', 3); };
  if (role == Qt::DisplayRole) switch (i.column()) {
      case Name: return row.total ? tr("whole frame") : QString::fromStdString(p.name);
      case Where: return row.total ? QString() : row.work ? tr("%1, work").arg(QString::fromStdString(p.where)) : QString::fromStdString(p.where);
      case Last: return ms(p.lastMs);
      case Median: return ms(p.medianMs);
      case P5: return ms(p.p5Ms);
      case P95: return ms(p.p95Ms);
      case Skipped: return QString::fromStdString(p.skipped);
      default: return {};
    }
  if (role == Qt::ToolTipRole) return skipped ? tr("%1, skipped: %2").arg(QString::fromStdString(p.name), QString::fromStdString(p.skipped)) : QString::fromStdString(p.name);
  if (role == Qt::DecorationRole && i.column() == Name && !row.total && !skipped) return palette_.of(p.name);
  if (role == Qt::TextAlignmentRole && i.column() >= Last && i.column() <= P95) return QVariant(Qt::AlignRight | Qt::AlignVCenter);
  return {};
}

QVariant PassModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  switch (section) {
    case Name: return tr("Pass");
    case Where: return tr("Where");
    case Last: return tr("Last [ms]");
    case Median: return tr("Median");
    case P5: return tr("p5");
    case P95: return tr("p95");
    case Skipped: return tr("Skipped because");
    default: return {};
  }
}

PassTable::PassTable(PassModel& model, const QList<int>& columns, QWidget* parent) : QTableView(parent) {
  setModel(&model);
  for (int c = 0; c < PassModel::ColumnCount; ++c) setColumnHidden(c, !columns.contains(c));
  verticalHeader()->hide();
  verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  horizontalHeader()->setStretchLastSection(columns.contains(PassModel::Skipped));
  horizontalHeader()->setHighlightSections(false);
  horizontalHeader()->setMinimumSectionSize(30);
  const int em = fontMetrics().horizontalAdvance(QStringLiteral("0"));
  setColumnWidth(PassModel::Name, em * (columns.contains(PassModel::Skipped) ? 19 : 24));
  setColumnWidth(PassModel::Where, em * 9);
  for (const int c : {PassModel::Last, PassModel::Median, PassModel::P5, PassModel::P95}) setColumnWidth(c, em * 8);
  setShowGrid(false);
  setAlternatingRowColors(true);
  setWordWrap(false);
  setSelectionBehavior(QAbstractItemView::SelectRows);
  setEditTriggers(QAbstractItemView::NoEditTriggers);
  setTabKeyNavigation(false);
}

}  // namespace hl::ui
