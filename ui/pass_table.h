#pragma once
// Passes with their times, as a table: the same rows and colours in the Technique and the Profiler dock.
#include <QAbstractTableModel>
#include <QTableView>

#include "engine/session/session.h"

namespace hl::ui {

class PassPalette;

class PassModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  enum Column { Name, Where, Last, Median, P5, P95, Skipped, ColumnCount };
  explicit PassModel(PassPalette&, QObject* parent = nullptr);
  /// Passes of frames, of work units, and the whole frame's time as the last row.
  void show(const FrameResult&);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex&, int role) const override;
  QVariant headerData(int section, Qt::Orientation, int role) const override;

 private:
  struct Row {
    PassStatistics pass;
    bool work = false, total = false;
  };
  PassPalette& palette_;
  std::vector<Row> rows_;
};

class PassTable : public QTableView {
  Q_OBJECT
 public:
  PassTable(PassModel&, const QList<int>& columns, QWidget* parent = nullptr);
};

}  // namespace hl::ui
