#pragma once
// Times by pass, stacked: a bar a configuration, of a frame or of a unit of the bake. Colours are those that passes have everywhere.
#include "ui/palette.h"
#include "ui/sweep_plot.h"

namespace hl::ui {

class PassStackPlot : public SweepPlot {
  Q_OBJECT
 public:
  enum class Of { Frame, Work };
  PassStackPlot(Of, PassPalette& passes, QWidget* parent = nullptr);
  std::string csv() const override;
  QSize pictureSize() const override;
  /// From the bottom of the stack; the last may be what of the frame is in no pass.
  const std::vector<std::string>& passes() const { return order_; }

 protected:
  void draw() override;
  void showEverything() override;
  void highlight() override;
  const PlotMark* markNear(QPointF pixel) const override;

 private:
  struct Segment {
    double from = 0, to = 0;  ///< ms; by position like marks_
  };
  const std::vector<PassSummary>& passesOf(size_t configuration) const;
  double timeOf(size_t configuration, const std::string& pass) const;

  Of of_;
  PassPalette& palette_;
  std::vector<size_t> rows_;  ///< configurations, from the top
  std::vector<std::string> order_;
  std::vector<Segment> segments_;
  double top_ = 0;
};

}  // namespace hl::ui
