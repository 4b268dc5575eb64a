#pragma once
// Plots for other programs: PNG, PDF and CSV, by a right click on any plot and by `halflight report`. Pictures are in the colours of print, whatever the
// window's theme is.
#include <QByteArray>
#include <QMap>
#include <QObject>
#include <QSize>
#include <QThreadPool>
#include <functional>
#include <string>

class QCustomPlot;

namespace hl::ui {

/// Pixels of a PNG per pixel of the plot.
inline constexpr double kPlotPngScale = 2;

/// `owner` is the widget whose palette the plot follows; `texts` go into the file. @throws Error(Run) where the picture cannot be made.
QByteArray plotPng(QCustomPlot&, QWidget& owner, QSize size, const QMap<QString, QString>& texts = {});
/// One page, as large as the plot, of vectors and text.
QByteArray plotPdf(QCustomPlot&, QWidget& owner, QSize size, const QString& title);

/// The menu of a plot, and what it does. Lives as long as the plot.
class PlotExport : public QObject {
  Q_OBJECT
 public:
  /// `name`: what files are called; `csv`: the data as drawn.
  PlotExport(QCustomPlot& plot, QWidget& owner, QString name, std::function<std::string()> csv);
  ~PlotExport() override;
  /// Called where "Show everything" is chosen; without it that is not in the menu.
  std::function<void()> showEverything;
  /// By the extension: .png, .pdf or .csv; written on a worker, atomically.
  void write(const QString& path);

 signals:
  void written(const QString& path);
  void refused(const QString& why);

 private:
  void openMenu(QPoint);
  void choosePath(const QString& extension, const QString& kind);

  QCustomPlot& plot_;
  QWidget& owner_;
  QString name_;
  std::function<std::string()> csv_;
  QThreadPool worker_;
};

}  // namespace hl::ui
