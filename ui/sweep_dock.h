#pragma once
// Sweep: write an experiment, run it and others one after the other, and see what came of it.
#include <QWidget>
#include <map>

#include "ui/document.h"
#include "ui/sweep_runner.h"

class QTabWidget;

namespace hl::ui {

class PassPalette;
class Settings;
class SweepEditor;
class SweepQueue;
class SweepResultsPanel;

class SweepPanel : public QWidget {
  Q_OBJECT
 public:
  SweepPanel(Document&, EngineLink&, Settings&, PassPalette&, QWidget* parent = nullptr);
  ~SweepPanel() override;

  SweepEditor& editor() { return *editor_; }
  SweepResultsPanel& results() { return *results_; }
  SweepQueue& queue() { return *queue_; }
  SweepRunner& runner() { return *runner_; }
  /// Varies a parameter of the experiment that is being written, and shows it.
  void sweepParameter(const std::string& key);
  void openResults(const QString& folder);
  void openExperiment(const QString& path);

 signals:
  /// To be loaded into the window.
  void presetChosen(const hl::Preset& preset, const QString& label);
  void message(const QString& text);
  void refused(const QString& why);
  void busyChanged(bool busy);
  void statusChanged(const QString& text);  ///< "Sweep: 3 of 12 runs, about 40 s left"; "" while none runs

 private:
  void readStatus();
  void onResults(int id, const SharedSweep&);
  void onFinished(int id);
  void showResultsOf(int id);

  SweepRunner* runner_;
  QTabWidget* pages_;
  SweepEditor* editor_;
  SweepQueue* queue_;
  SweepResultsPanel* results_;
  std::map<int, SharedSweep> newest_;  ///< of experiments that were run here
  int shownJob_ = 0;                   ///< whose results are shown; 0: a folder's
};

}  // namespace hl::ui
