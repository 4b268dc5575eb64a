#pragma once
// The experiments that run, wait and are through, each with its progress.
#include <QWidget>

#include "ui/sweep_runner.h"

class QLabel;
class QProgressBar;
class QPushButton;
class QTableWidget;
class QToolButton;

namespace hl::ui {

/// Of the experiment that runs: what it does, how far it is, time left, Cancel.
class SweepProgressLine : public QWidget {
  Q_OBJECT
 public:
  explicit SweepProgressLine(SweepRunner&, QWidget* parent = nullptr);

 private:
  void read();
  SweepRunner& runner_;
  QLabel* label_;
  QProgressBar* bar_;
  QPushButton* cancel_;
  int id_ = 0;
};

class SweepQueue : public QWidget {
  Q_OBJECT
 public:
  explicit SweepQueue(SweepRunner&, QWidget* parent = nullptr);
  QTableWidget& table() { return *table_; }

 signals:
  /// Someone wants to see its results.
  void chosen(int id);

 private:
  void readAll();
  void readOne(int id);
  void writeRow(int row, const SweepJob&);
  int idAt(int row) const;
  void updateButtons();

  SweepRunner& runner_;
  QTableWidget* table_;
  QPushButton* cancel_;
  QPushButton* forget_;
};

/// "3 of 12 runs, 1 failed, about 40 s left".
QString progressText(const SweepStatus&);

}  // namespace hl::ui
