#pragma once
// Plots in the window's own colours and font.
class QCustomPlot;
class QCPAxis;
class QWidget;

namespace hl::ui {

/// Background, axes, ticks and grid from the widget's palette; call it again when that changes.
void stylePlot(QCustomPlot&, const QWidget& like);
/// A logarithmic axis with powers of ten as labels.
void makeLogarithmic(QCPAxis&);

}  // namespace hl::ui
