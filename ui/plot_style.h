#pragma once
// Plots in the window's own colours and font.
#include <QSize>
#include <QString>
#include <vector>

class QCustomPlot;
class QCPAxis;
class QCPRange;
class QWidget;

namespace hl::ui {

/// Background, axes, ticks and grid from the widget's palette; call it again when that changes.
void stylePlot(QCustomPlot&, const QWidget& like);
/// A logarithmic axis: powers of ten as labels, and as many steps between them as it takes for three labels.
void makeLogarithmic(QCPAxis&);
void makeLinear(QCPAxis&);
/// Round numbers between two values, both included, for labels: of a logarithmic axis as makeLogarithmic has them.
std::vector<double> roundNumbers(double lower, double upper, bool logarithmic);
/// Room at both ends of what is drawn: a share of the span, of its logarithm where the axis is logarithmic.
void setRangeWithRoom(QCPAxis&, double lower, double upper);
/// Writes in the middle of the plot, in place of axes that would be empty.
void drawNothing(QCustomPlot&, const QString& why);
/// Lays the plot out for a picture of `size`. The parts of a layout follow one another (the legend's height, the room left, the margins, what is clipped to
/// them), so that one pass, which is all that drawing makes, leaves some a step behind.
void settleLayout(QCustomPlot&, QSize size);

}  // namespace hl::ui
