// Draws what surfels do over frames against the closed form of the exponential average with feedback (MEASURES.md section 1).
//
//   bench_surfels_laws_plot OUT.png [OUT.csv]
//
// Left: the furnaces' indirect light over x, walls that are covered and dark and begin to shine, with `ema` and with the defaults, beside 1 - f^n. Right: what is left of a
// light step in a sphere with a lamp at its centre, with `ema`, beside f^n. f = 1 - (1 - a) (1 - rho).
#include <QApplication>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "engine/core/files.h"
#include "engine/scene/scene_file.h"
#include "tests/bench/laws_plot.h"
#include "tests/surfels_harness.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

using test::SurfelsHarness;

Camera inside() {
  Camera c;
  c.position = vec3(0.2f, 1.1f, 0.9f), c.target = vec3(-0.1f, 0.9f, -1);
  c.verticalFov = 1.4f;
  return c;
}

/// As the tests of the furnace have it (tests/analytic/surfels_furnace_test.cpp).
void useEma(SurfelsHarness& h) {
  h.set("surfels.estimator", "ema").set("surfels.hysteresis", std::to_string(kHysteresis)).set("surfels.change_samples", "0").set("surfels.ray_budget", "8");
  h.set("surfels.max_surfels", "4096").set("surfels.sizing", "world").set("surfels.radius", "0.06").set("surfels.fade_in", "0").set("surfels.settled_every", "1");
}

Curve furnace(const FurnaceRun& f, bool ema) {
  SurfelsHarness h(loadScene(f.scene));
  h.set("direct.samples", "1");
  if (ema)
    useEma(h);
  else
    h.set("surfels.radius_max", "0.06");
  h.width = h.height = ema ? 48 : 32;
  const float emission = h.scene.materials.front().emission.x;
  for (Material& m : h.scene.materials) m.emission = vec3(0.0f);
  h.rebuild();
  h.turn(vec3(0.1f, 1.0f, 0.05f), 20);
  h.shine(emission);
  const double x = static_cast<double>(kPi * emission) * f.rho / (1 - f.rho);
  Curve c{f.rho, ema ? "ema" : "defaults", {}, {}};
  for (int n = 1; n <= f.frames; ++n) {
    h.frame(inside());
    if (taken(n) || n == f.frames) c.frame.push_back(n), c.measured.push_back(h.mean() / x);
  }
  return c;
}

Curve step(double rho, int frames) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "sphere.json").string();
  writeFileAtomically(file, lampSphere(rho));
  SurfelsHarness h(loadScene(file));
  useEma(h);
  h.set("surfels.hysteresis", "0.8");  // until it has settled
  h.width = h.height = 32;
  h.rebuild();
  const Camera camera = h.scene.cameras.front();
  h.turn(vec3(0.1f, 0, 0.05f), 20);
  for (int n = 0; n < static_cast<int>(std::ceil(std::log(1e-4) / std::log(1 - 0.2 * (1 - rho)))); ++n) h.frame(camera);
  const double before = h.mean(), share = 0.25;
  h.set("surfels.hysteresis", std::to_string(kHysteresis));
  h.scene.pointLights[0].intensity *= static_cast<float>(share);
  h.lightsEdited();
  Curve c{rho, "step", {}, {}};
  for (int n = 1; n <= frames; ++n) {
    h.frame(camera);
    if (n % 10 == 0 || n == 1) c.frame.push_back(n), c.measured.push_back((h.mean() / before - share) / (1 - share));
  }
  return c;
}

int run(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_surfels_laws_plot OUT.png [OUT.csv]\n");
    return 2;
  }
  const test::TemporaryFolder cache;
  setenv("HALFLIGHT_CACHE", cache.path().c_str(), 1);
  std::vector<Curve> curves;
  for (const FurnaceRun& f : kFurnaces)
    for (const bool ema : {true, false}) curves.push_back(furnace(f, ema));
  for (const FurnaceRun& f : kFurnaces) curves.push_back(step(f.rho, 600));
  const std::string table = lawsTable(curves);
  if (argc > 2) writeFileAtomically(argv[2], table);
  draw(curves, QString::fromLocal8Bit(argv[1]), "frames since covered walls began to shine", "ema");
  return ::testing::Test::HasFailure() ? 1 : 0;
}

}  // namespace
}  // namespace hl

int main(int argc, char** argv) {
  if (qEnvironmentVariableIsEmpty("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication app(argc, argv);
  try {
    return hl::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_surfels_laws_plot: %s\n", e.what());
    return 1;
  }
}
