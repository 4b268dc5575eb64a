#pragma once
// A sweep's configurations as a table: what was varied, cost, error with its interval, place on the front.
#include <QAbstractTableModel>
#include <QTableView>

#include "engine/sweep/curves.h"

namespace hl::ui {

/// Rows of a choice, made on any thread.
struct SweepRows {
  struct Row {
    size_t configuration = 0;
    std::vector<std::string> values;  ///< by `keys`; "" where the configuration does not have the key
    double cost = 0, costHalfWidth = 0;  ///< [ms] or bytes; NaN without a run that came through
    double error = 0, halfWidth = 0;     ///< the metric's own value, and its 95 % interval
    double bias = 0, variance = 0;       ///< squared error in its parts; NaN where not known
    int place = 0;                       ///< of FrontPlace; more than that without an error
    int runs = 0, failed = 0;
    std::string failure;
  };
  std::vector<std::string> keys, titles;  ///< of what was varied; titles as short as they say enough
  PlotChoice choice;
  std::vector<Row> rows;
};
SweepRows sweepRows(const SweepView&, const PlotChoice&);

class SweepTableModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  /// After the varied keys.
  enum Column { Cost, Error, Interval, Place, Bias, Variance, Runs, FixedCount };
  explicit SweepTableModel(QObject* parent = nullptr);
  /// Keeps the order that was chosen.
  void show(SweepRows);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex&, int role) const override;
  QVariant headerData(int section, Qt::Orientation, int role) const override;
  void sort(int column, Qt::SortOrder) override;

  const SweepRows& rows() const { return rows_; }
  size_t configurationAt(int row) const { return rows_.rows[static_cast<size_t>(row)].configuration; }
  /// -1 where it is not shown.
  int rowOf(size_t configuration) const;
  int firstFixed() const { return static_cast<int>(rows_.keys.size()); }

 private:
  void order();
  QString text(const SweepRows::Row&, int column) const;
  double number(const SweepRows::Row&, int column) const;

  SweepRows rows_;
  int sorted_ = -1;
  Qt::SortOrder sortOrder_ = Qt::AscendingOrder;
};

}  // namespace hl::ui
