#pragma once
// Error of every run while it went on, over time or over frames, both axes logarithmic.
#include "ui/sweep_plot.h"

class QCPGraph;

namespace hl::ui {

class ConvergencePlot : public SweepPlot {
  Q_OBJECT
 public:
  enum class Over { Time, Frames };
  explicit ConvergencePlot(Over, QWidget* parent = nullptr);
  std::string csv() const override;
  const std::vector<ConvergenceCurve>& curves() const { return curves_; }

 protected:
  void draw() override;
  void showEverything() override;
  void highlight() override;

 private:
  void nameConfigurations();
  QColor colourOf(size_t configuration) const;

  Over over_;
  std::vector<ConvergenceCurve> curves_;
  std::vector<size_t> named_;                              ///< those with a colour and an entry in the legend of their own
  std::vector<std::pair<size_t, QCPGraph*>> lines_;  ///< by configuration
  double floor_ = 0;
  bool logarithmic_ = true;
};

}  // namespace hl::ui
