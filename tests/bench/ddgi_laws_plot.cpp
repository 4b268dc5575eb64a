// Draws what the probes do over frames against the closed form of the exponential average with feedback (MEASURES.md section 1).
//
//   bench_ddgi_laws_plot OUT.png [OUT.csv]
//
// Left: the furnaces' indirect light over x, from black with `ema` and with the defaults, beside 1 - f^n. Right: what is left of a light step in a sphere
// with a lamp at its centre, followed without a reset, beside f^n. f = 1 - (1 - a) (1 - rho).
#include <qcustomplot.h>

#include <QApplication>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/session/session.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

constexpr double kHysteresis = 0.97;
constexpr double kFirstOfDefaults = 100;  ///< frames without history, and as many again until a mean has outgrown their noise

struct Curve {
  double rho;
  const char* kind;
  std::vector<double> frame, measured;
};

double factor(double rho) { return 1 - (1 - kHysteresis) * (1 - rho); }

double meanIndirect(Session& session) {
  const Image e = session.image("indirect_irradiance");
  double sum = 0;
  for (size_t i = 0; i < e.data.size(); i += static_cast<size_t>(e.channels)) sum += static_cast<double>(e.data[i]);
  return sum / static_cast<double>(e.pixels());
}

/// Frames that lie evenly on a logarithmic axis, 24 to a factor of ten.
bool taken(int n) { return n == 1 || std::floor(24 * std::log10(n)) > std::floor(24 * std::log10(n - 1)); }

Preset smallPictures(const std::string& scene) {
  Preset p;
  p.scene = scene;
  p.technique = "ddgi";
  p.width = 16, p.height = 12;
  p.parameters = {{"direct.samples", "1"}, {"ddgi.rays", "64"}};
  return p;
}

Curve furnace(Session& session, const char* scene, double rho, const char* start, int frames) {
  Preset p = smallPictures(scene);
  p.parameters["ddgi.spacing"] = "0.5";
  p.parameters["ddgi.start"] = start;
  session.load(p);
  Curve c{rho, start, {}, {}};
  for (int n = 1; n <= frames; ++n) {
    session.frame();
    if (!taken(n)) continue;
    const double x = 3.14159265358979 * static_cast<double>(session.scene().materials.front().emission.x) * rho / (1 - rho);
    c.frame.push_back(n), c.measured.push_back(meanIndirect(session) / x);
  }
  return c;
}

Curve step(Session& session, double rho, int frames) {
  const test::TemporaryFolder folder;
  const std::string scene = (folder.path() / "sphere.json").string();
  writeFileAtomically(scene, R"({"version": 1, "shapes": [{"type": "icosphere", "material": "wall", "centre": [0, 0, 0], "radius": 1, "subdivisions": 6,
    "facing": "inward"}], "materials": {"wall": {"albedo": )" + std::to_string(rho) + R"(}},
    "lights": [{"type": "point", "name": "lamp", "position": [0, 0, 0], "intensity": 1}],
    "cameras": [{"name": "in", "position": [0.3, 0.1, 0.8], "target": [0, 0, 0], "vertical_fov_degrees": 80}]})");
  Preset p = smallPictures(scene);
  p.parameters["ddgi.spacing"] = "0.15";
  p.parameters["ddgi.rays"] = "32";
  session.load(p);
  session.settle();
  const double before = meanIndirect(session), share = 0.25;
  std::vector<PointLight> lamp = session.scene().pointLights;
  lamp.front().intensity *= static_cast<float>(share);
  session.setLights(lamp, {}, {}, session.scene().sky);
  Curve c{rho, "step", {}, {}};
  for (int n = 1; n <= frames; ++n) {
    session.frame();
    if (n % 10 == 0 || n == 1) c.frame.push_back(n), c.measured.push_back((meanIndirect(session) / before - share) / (1 - share));
  }
  return c;
}

void draw(const std::vector<Curve>& curves, const QString& file) {
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
    rect->axis(QCPAxis::atBottom)->setLabel(rect == left ? "frames from a reset" : "frames from the step of the light to a quarter");
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
      QCPGraph* const dots = graph(QString("%1: %2").arg(c.rho).arg(ofStep ? "followed" : ema ? "ema" : "defaults"));
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

int run(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_ddgi_laws_plot OUT.png [OUT.csv]\n");
    return 2;
  }
  const test::TemporaryFolder cache;
  setenv("HALFLIGHT_CACHE", cache.path().c_str(), 1);
  const SessionOptions options;
  Session session(options);
  std::vector<Curve> curves;
  const struct {
    const char* scene;
    double rho;
    int frames;
  } furnaces[] = {{"furnace_box_050", 0.5, 610}, {"furnace_box_080", 0.8, 1530}, {"furnace_box_090", 0.9, 3066}};
  for (const auto& f : furnaces) {
    curves.push_back(furnace(session, f.scene, f.rho, "ema", f.frames));
    curves.push_back(furnace(session, f.scene, f.rho, "bounces", f.frames));
  }
  for (const auto& f : furnaces) curves.push_back(step(session, f.rho, 600));
  std::string table = "kind,albedo,frame,measured,closed_form\n";
  for (const Curve& c : curves) {
    double worst = 0;  // of x, or of the step
    const bool defaults = std::string(c.kind) == "bounces";
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
  if (argc > 2) writeFileAtomically(argv[2], table);
  draw(curves, QString::fromLocal8Bit(argv[1]));
  return 0;
}

}  // namespace
}  // namespace hl

int main(int argc, char** argv) {
  if (qEnvironmentVariableIsEmpty("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication app(argc, argv);
  try {
    return hl::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_ddgi_laws_plot: %s\n", e.what());
    return 1;
  }
}
