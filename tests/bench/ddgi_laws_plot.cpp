// Draws what the probes do over frames against the closed form of the exponential average with feedback (MEASURES.md section 1).
//
//   bench_ddgi_laws_plot OUT.png [OUT.csv]
//
// Left: the furnaces' indirect light over x, from black with `ema` and with the defaults, beside 1 - f^n. Right: what is left of a light step in a sphere
// with a lamp at its centre, followed without a reset, beside f^n. f = 1 - (1 - a) (1 - rho).
#include <QApplication>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "engine/core/files.h"
#include "engine/session/session.h"
#include "tests/bench/laws_plot.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

double meanIndirect(Session& session) {
  const Image e = session.image("indirect_irradiance");
  double sum = 0;
  for (size_t i = 0; i < e.data.size(); i += static_cast<size_t>(e.channels)) sum += static_cast<double>(e.data[i]);
  return sum / static_cast<double>(e.pixels());
}

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
  writeFileAtomically(scene, lampSphere(rho));
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
  for (const auto& f : kFurnaces) {
    curves.push_back(furnace(session, f.scene, f.rho, "ema", f.frames));
    curves.push_back(furnace(session, f.scene, f.rho, "bounces", f.frames));
  }
  for (const auto& f : kFurnaces) curves.push_back(step(session, f.rho, 600));
  const std::string table = lawsTable(curves);
  if (argc > 2) writeFileAtomically(argv[2], table);
  draw(curves, QString::fromLocal8Bit(argv[1]), "frames from a reset", "followed");
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
