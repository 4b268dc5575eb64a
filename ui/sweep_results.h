#pragma once
// The results of a sweep, of a folder or of one that runs: which problem, reference, metric and cost; table and plots of it. Folders are read, and tables
// worked out, on a worker.
#include <QElapsedTimer>
#include <QThreadPool>
#include <QTimer>
#include <QWidget>

#include "ui/palette.h"
#include "ui/sweep_runner.h"

class QComboBox;
class QLabel;
class QSplitter;
class QTableView;
class QTabWidget;

namespace hl::ui {

class SweepPlot;
class SweepTableModel;
struct SweepRows;

class SweepResultsPanel : public QWidget {
  Q_OBJECT
 public:
  explicit SweepResultsPanel(PassPalette&, QWidget* parent = nullptr);
  ~SweepResultsPanel() override;

  /// Reads a folder that a sweep has written; where it is none, refused() says so and what was shown stays.
  void openFolder(const QString& folder);
  void show(const SharedSweep&);
  const SharedSweep& sweep() const { return sweep_; }
  SweepTableModel& model() { return *model_; }
  QTableView& table() { return *table_; }
  const PlotChoice& choice() const { return choice_; }
  void choose(const PlotChoice&);

 signals:
  void opened(const QString& folder);
  void refused(const QString& why);
  /// Someone wants to see a configuration: its first run's preset.
  void configurationChosen(const hl::Preset& preset, const QString& label);

 protected:
  void resizeEvent(QResizeEvent*) override;

 private:
  QWidget* makeChoices();
  void fillChoices();
  void takeChoice();
  void work();                       ///< rows of the choice, on the worker; the newest request counts
  void showRows(SweepRows, quint64 number);
  void load(size_t configuration);
  void dropElsewhere(SharedSweep);

  PassPalette& palette_;
  SharedSweep sweep_;
  PlotChoice choice_;
  QLabel* about_ = nullptr;
  QComboBox* problem_ = nullptr;
  QComboBox* reference_ = nullptr;
  QComboBox* metric_ = nullptr;
  QComboBox* cost_ = nullptr;
  QSplitter* halves_ = nullptr;
  SweepTableModel* model_ = nullptr;
  QTableView* table_ = nullptr;
  QTabWidget* plots_ = nullptr;
  std::vector<SweepPlot*> allPlots_;
  QThreadPool worker_;
  quint64 asked_ = 0;
  bool filling_ = false;
};

}  // namespace hl::ui
