#pragma once
// The results of a sweep, of a folder or of one that runs: a table and plots, of one problem, reference, metric and cost. Folders are read, and tables worked
// out, on a worker.
#include <QThreadPool>
#include <QWidget>

#include "ui/palette.h"
#include "ui/sweep_runner.h"

class QLabel;
class QSplitter;
class QTableView;

namespace hl::ui {

class Settings;
class SweepPlots;
class SweepTableModel;
struct SweepRows;

class SweepResultsPanel : public QWidget {
  Q_OBJECT
 public:
  SweepResultsPanel(PassPalette&, Settings&, QWidget* parent = nullptr);
  ~SweepResultsPanel() override;

  /// Reads a folder that a sweep has written; where it is none, refused() says so and what was shown stays.
  void openFolder(const QString& folder);
  void show(const SharedSweep&);
  const SharedSweep& sweep() const { return sweep_; }
  SweepTableModel& model() { return *model_; }
  QTableView& table() { return *table_; }
  SweepPlots& plots() { return *plots_; }

 signals:
  void opened(const QString& folder);
  void refused(const QString& why);
  /// Someone wants to see a configuration: its first run's preset.
  void configurationChosen(const hl::Preset& preset, const QString& label);

 protected:
  void resizeEvent(QResizeEvent*) override;

 private:
  void work();                       ///< rows of the choice, on the worker; the newest request counts
  void showRows(SweepRows, quint64 number);
  void load(size_t configuration);
  void dropElsewhere(SharedSweep);

  SharedSweep sweep_;
  QLabel* about_;
  QSplitter* halves_;
  SweepTableModel* model_;
  QTableView* table_;
  SweepPlots* plots_;
  QThreadPool worker_;
  quint64 asked_ = 0;
};

}  // namespace hl::ui
