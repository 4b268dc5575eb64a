#pragma once
// Speed against error: a point a configuration with its error bars, the Pareto front, the path tracer's own curve.
#include "ui/palette.h"
#include "ui/sweep_plot.h"

class QCPGraph;

namespace hl::ui {

/// How the plots' axis of costs is called, with its unit.
QString costLabel(FrontAxis);
/// A cost as text with its unit.
QString costText(FrontAxis, double);

class SpeedErrorPlot : public SweepPlot {
  Q_OBJECT
 public:
  /// `techniques`: their colours.
  explicit SpeedErrorPlot(PassPalette& techniques, QWidget* parent = nullptr);
  std::string csv() const override;
  /// As drawn; its points by growing cost.
  const Front& front() const { return front_; }
  const std::vector<TracerCurve>& tracers() const { return tracers_; }
  /// Where a point is drawn: bias and errors as they are, psnr as decibels; at the top of its interval where the error itself is not above 0 on a
  /// logarithmic axis; NaN where it has no place.
  double plotted(const CostPoint&) const;

 protected:
  void draw() override;
  void showEverything() override;
  void highlight() override;

 private:
  /// `index`: of the technique among those here, for its shape. Null where there is none.
  QCPGraph* drawPoints(const std::string& technique, size_t index, FrontPlace);
  void drawFront();
  void drawTracers();
  void drawLegendOfPlaces();
  void drawErrorBars(QCPGraph&, const QVector<double>& below, const QVector<double>& above, bool horizontal);
  void makeNote();
  bool has(const CostPoint& p) const;

  PassPalette& techniques_;
  Front front_;
  std::vector<TracerCurve> tracers_;
  bool logarithmic_ = true;
};

}  // namespace hl::ui
