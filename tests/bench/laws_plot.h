#pragma once
// Furnaces and light steps over frames against the closed form of the exponential average with feedback (MEASURES.md section 1), drawn and as a table.
#include <qcustomplot.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "engine/core/error.h"

namespace hl {

inline constexpr double kHysteresis = 0.97;
inline constexpr double kFirstOfDefaults = 100;  ///< frames without history, and as many again until a mean has outgrown their noise

struct Curve {
  double rho;
  const char* kind;  ///< "ema", "step", or the defaults' name
  std::vector<double> frame, measured;
};

inline double factor(double rho) { return 1 - (1 - kHysteresis) * (1 - rho); }

/// Frames that lie evenly on a logarithmic axis, 24 to a factor of ten.
inline bool taken(int n) { return n == 1 || std::floor(24 * std::log10(n)) > std::floor(24 * std::log10(n - 1)); }

/// `start`: what the left plot counts frames from. `follower`: what dots of the right one are.
inline void draw(const std::vector<Curve>& curves, const QString& file, const char* start, const char* follower) {
  QCustomPlot plot;
  plot.plotLayout()->clear();
  auto* const left = new QCPAxisRect(&plot);
  auto* const right = new QCPAxisRect(&plot);
  plot.plotLayout()->addElement(1, 0, left);
  plot.plotLayout()->addElement(1, 1, right);
  const QColor colours[] = {QColor(0x1f, 0x77, 0xb4), QColor(0xd6, 0x5f, 0x0e), QColor(0x2c, 0x8c, 0x3c)};
  for (QCPAxisRect* const rect : {left, right}) {
    auto* const legend = new QCPLegend;
    plot.plotLayout()->addElement(0, rect == left ? 0 : 1, legend);
    legend->setFillOrder(QCPLayoutGrid::foRowsFirst);
    legend->setWrap(rect == left ? 3 : 2);
    legend->setBorderPen(Qt::NoPen);
    legend->setLayer("legend");
    legend->setFont(QFont("sans", 8));
    rect->axis(QCPAxis::atBottom)->setLabel(rect == left ? start : "frames from the step of the light to a quarter");
    rect->axis(QCPAxis::atLeft)->setLabel(rect == left ? "indirect light / x, by albedo" : "share of the step that is left, by albedo");
    for (const Curve& c : curves) {
      const bool ofStep = std::string(c.kind) == "step", ema = std::string(c.kind) == "ema";
      if (ofStep != (rect == right)) continue;
      const QColor colour = colours[c.rho < 0.6 ? 0 : c.rho < 0.85 ? 1 : 2];
      const auto graph = [&](const QString& name) {
        QCPGraph* const g = plot.addGraph(rect->axis(QCPAxis::atBottom), rect->axis(QCPAxis::atLeft));
        g->removeFromLegend();
        g->setName(name);
        legend->addItem(new QCPPlottableLegendItem(legend, g));
        return g;
      };
      if (ofStep || ema) {
        QVector<double> x, y;
        for (double f = 1; f <= c.frame.back(); f *= 1.02) {
          const double rest = std::pow(factor(c.rho), f);
          x.push_back(f), y.push_back(ofStep ? rest : 1 - rest);
        }
        QCPGraph* const law = graph(QString("%1: %2").arg(c.rho).arg(ofStep ? "f^n" : "1 - f^n"));
        law->setPen(QPen(colour, 1.3));
        law->setData(x, y);
      }
      QCPGraph* const dots = graph(QString("%1: %2").arg(c.rho).arg(ofStep ? follower : ema ? "ema" : "defaults"));
      dots->setLineStyle(QCPGraph::lsNone);
      dots->setScatterStyle(QCPScatterStyle(ema || ofStep ? QCPScatterStyle::ssDisc : QCPScatterStyle::ssCross, colour, ema || ofStep ? 4 : 5));
      dots->setData(QVector<double>(c.frame.begin(), c.frame.end()), QVector<double>(c.measured.begin(), c.measured.end()));
    }
    QCPAxis* const across = rect->axis(QCPAxis::atBottom);
    if (rect == left) {
      across->setScaleType(QCPAxis::stLogarithmic);
      across->setTicker(QSharedPointer<QCPAxisTickerLog>(new QCPAxisTickerLog));
      across->setRange(0.9, 4000);
      across->setNumberFormat("gb");
      across->setNumberPrecision(0);
      rect->axis(QCPAxis::atLeft)->setRange(0, 1.05);
    } else {
      across->setRange(0, 610);
      QCPAxis* const up = rect->axis(QCPAxis::atLeft);
      up->setScaleType(QCPAxis::stLogarithmic);
      up->setTicker(QSharedPointer<QCPAxisTickerLog>(new QCPAxisTickerLog));
      up->setRange(0.003, 1.1);
    }
  }
  plot.plotLayout()->setRowStretchFactor(0, 0.001);
  plot.replot();
  if (!plot.savePng(file, 1100, 460, 1.0)) throw badInput("cannot write " + file.toStdString());
}

/// What to print, and the table.
inline std::string lawsTable(const std::vector<Curve>& curves) {
  std::string table = "kind,albedo,frame,measured,closed_form\n";
  for (const Curve& c : curves) {
    double worst = 0;  // of x, or of the step
    const bool defaults = std::string(c.kind) != "ema" && std::string(c.kind) != "step";
    for (size_t i = 0; i < c.frame.size(); ++i) {
      const double left = std::pow(factor(c.rho), c.frame[i]);
      const double law = std::string(c.kind) == "step" ? left : std::string(c.kind) == "ema" ? 1 - left : 1;
      if (!defaults || c.frame[i] >= kFirstOfDefaults) worst = std::max(worst, std::abs(c.measured[i] - law));
      table += std::string(c.kind) + "," + std::to_string(c.rho) + "," + std::to_string(static_cast<int>(c.frame[i])) + "," + std::to_string(c.measured[i]) + "," +
               std::to_string(law) + "\n";
    }
    std::printf("%s, albedo %.1f: last %.5f at frame %.0f; off the closed form by at most %.4f%s\n", c.kind, c.rho, c.measured.back(), c.frame.back(), worst,
                defaults ? " from frame 100 on" : "");
  }
  return table;
}

struct FurnaceRun {
  const char* scene;
  double rho;
  int frames;
};
inline constexpr FurnaceRun kFurnaces[] = {{"furnace_box_050", 0.5, 610}, {"furnace_box_080", 0.8, 1530}, {"furnace_box_090", 0.9, 3066}};

/// A closed sphere with a lamp at its centre, as a scene file.
inline std::string lampSphere(double rho) {
  return R"({"version": 1, "shapes": [{"type": "icosphere", "material": "wall", "centre": [0, 0, 0], "radius": 1, "subdivisions": 6,
    "facing": "inward"}], "materials": {"wall": {"albedo": )" + std::to_string(rho) + R"(}},
    "lights": [{"type": "point", "name": "lamp", "position": [0, 0, 0], "intensity": 1}],
    "cameras": [{"name": "in", "position": [0.3, 0.1, 0.8], "target": [0, 0, 0], "vertical_fov_degrees": 80}]})";
}

}  // namespace hl
