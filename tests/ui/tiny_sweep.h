#pragma once
// A small sweep, really run: four settings of radiosity and direct light alone, two seeds, 32x24.
#include <QTemporaryDir>
#include <QTest>
#include <cstdlib>
#include <filesystem>

#include "engine/core/files.h"
#include "engine/core/log.h"
#include "engine/session/session.h"
#include "engine/sweep/curves.h"

namespace hl::test {

inline const char* const kTinyBase = R"("base": {"version": 1, "scene": "cornell_box", "resolution": [32, 24], "technique": "radiosity",
  "parameters": {"reference.samples": 64, "reference.direct_samples": 4, "direct.samples": 4, "direct.lumel_samples": 4, "radiosity.bounces": 3}})";
inline const char* const kTinyPermute =
    R"("permute": [{"radiosity.samples": [16, 64], "lightmap.resolution": [32, 48]}, {"technique": ["none"]}], "seeds": [1, 2], "metrics": ["relmse", "bias", "psnr"])";

/// Under validation; the folder holds what `bench` writes. `rest`: the experiment without its base.
inline std::shared_ptr<const SweepView> runTinySweep(const std::filesystem::path& folder, const std::string& rest = kTinyPermute) {
  setenv("HALFLIGHT_CACHE", (folder.parent_path() / "cache").c_str(), 1);
  setLogLevel(LogLevel::Error);
  SessionOptions options;
  options.device.validation = true;
  Session session(options);
  Sweep sweep(experimentFromJson(std::string(R"({"version": 1, )") + kTinyBase + ", " + rest + "}", folder / "e.json"), folder);
  Progress p;
  sweep.run(session, p);
  for (const std::string& message : session.device().takeValidationMessages()) QTest::qFail(message.c_str(), __FILE__, __LINE__);
  auto view = std::make_shared<SweepView>();
  view->results = openSweep(folder);
  view->summary = summarise(view->results);
  return view;
}

}  // namespace hl::test
