#pragma once
// All plots of a sweep on pages, with the choices of what they show: the Sweep dock's, and whoever else has a SweepView.
#include <QWidget>
#include <memory>
#include <optional>
#include <vector>

#include "ui/palette.h"
#include "ui/sweep_plot.h"

class QComboBox;
class QTabWidget;

namespace hl::ui {

class Settings;
class SpeedErrorPlot;

class SweepPlots : public QWidget {
  Q_OBJECT
 public:
  /// `passes`: the window's colours of passes; `settings`: where those of techniques are kept, may be null.
  SweepPlots(PassPalette& passes, Settings* settings, QWidget* parent = nullptr);
  /// Cheap: what is seen is drawn later, at most ten times a second. The choices stay where the new view has them. Null: nothing.
  void setView(std::shared_ptr<const SweepView>);
  /// In all plots.
  void select(std::optional<size_t> configuration);
  const PlotChoice& choice() const { return choice_; }
  /// As far as the view has it.
  void choose(const PlotChoice&);
  const std::vector<SweepPlot*>& plots() const { return plots_; }
  SpeedErrorPlot& speedError() { return *speedError_; }

 signals:
  /// A click on a point, line or bar: results.configurations[configuration] is wanted.
  void chosen(size_t configuration);
  /// Someone chose what is shown.
  void choiceChanged();

 private:
  void readChoices();
  void fillChoices();
  void showChoices();

  PassPalette techniques_;
  std::shared_ptr<const SweepView> view_;
  PlotChoice choice_;
  QComboBox* problem_;
  QComboBox* cost_;
  QComboBox* metric_;
  QComboBox* reference_;
  QTabWidget* pages_;
  SpeedErrorPlot* speedError_;
  std::vector<SweepPlot*> plots_;
};

}  // namespace hl::ui
