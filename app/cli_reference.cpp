// `reference`: the path-traced truth of a preset or scene, at the camera's pixels or at the lightmap's texels.
#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "app/cli_commands.h"
#include "app/cli_results.h"
#include "engine/core/json_writer.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/image_io.h"
#include "engine/experiment/open_target.h"

namespace hl::cli {
namespace {

namespace fs = std::filesystem;

struct Written {
  std::string name, file, hash;
  Image image;
  double noise = 0;  ///< root mean square of the mean's own error, estimated from the two halves
};

/// `inf` is the parameter's 0.
void setBounces(Preset& preset, const std::string& text) {
  if (text.empty()) return;
  int v = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), v);
  const bool number = end.ec == std::errc() && end.ptr == text.data() + text.size() && v >= 1;
  if (!number && text != "inf") throw badInput(fmt::format("--bounces {}: a number from 1, or inf, is wanted", text));
  preset.parameters["reference.bounces"] = fmt::format("{}", number ? v : 0);
}

/// The preset that the command line asks for, checked before any device is touched.
Preset wantedPreset(const ReferenceOptions& o) {
  Preset preset = openTarget(o.target);
  if (!o.lightmap) {
    // A camera's truth depends on no technique: none is prepared.
    const std::string own = preset.technique + ".";
    std::erase_if(preset.parameters, [&](const auto& p) { return p.first.starts_with(own); });
    preset.technique = "none";
  }
  setResolution(preset, o.resolution);
  if (!o.camera.empty()) preset.cameraName = o.camera, preset.camera.reset();
  if (o.samples) preset.parameters["reference.samples"] = fmt::format("{}", *o.samples);
  setBounces(preset, o.bounces);
  setParameters(preset, o.set);
  if (!o.out.empty()) checkOutputImage("--out", o.out, {".exr", ".pfm"});  // the values are linear
  return preset;
}

int bouncesOf(const Preset& preset) {
  const auto found = preset.parameters.find("reference.bounces");
  const int v = found == preset.parameters.end() ? 0 : std::stoi(found->second);
  return v == 0 ? kAllBounces : v;
}

/// A value a lumel, laid out as the lightmap is: texel row 0 (v = 0) is the bottom row of the picture.
Image lightmapImage(const Image& lumels, const Atlas& atlas) {
  Image out(atlas.resolution, atlas.resolution, 3);
  for (size_t i = 0; i < atlas.lumels.size(); ++i) {
    const int x = static_cast<int>(atlas.lumels[i].texel) % atlas.resolution;
    const int y = atlas.resolution - 1 - static_cast<int>(atlas.lumels[i].texel) / atlas.resolution;
    for (size_t c = 0; c < 3; ++c) out.pixel(x, y)[c] = lumels.data[i * 3 + c];
  }
  return out;
}

double noiseOf(const ReferenceImage& r) {
  double sum = 0;
  for (size_t i = 0; i < r.halfA.data.size(); ++i) {
    const double d = static_cast<double>(r.halfA.data[i]) - static_cast<double>(r.halfB.data[i]);
    sum += d * d / 4;
  }
  return r.halfA.data.empty() ? 0 : std::sqrt(sum / static_cast<double>(r.halfA.data.size()));
}

Written written(const char* name, Image image, double noise) {
  Written w{name, "", "", std::move(image), noise};
  w.hash = hashOf({reinterpret_cast<const char*>(w.image.data.data()), w.image.data.size() * sizeof(float)});
  return w;
}

std::vector<Written> imagesOf(Session& session, const ReferenceResult& r, bool lightmap, bool diffuseOnly, int bounces) {
  const ReferenceImage direct = r.directImage(), indirect = r.indirectImage(bounces);
  std::vector<Written> out;
  if (lightmap) {
    out.push_back(written("indirect irradiance", lightmapImage(indirect.mean, *session.atlas()), noiseOf(indirect)));
    out.push_back(written("direct irradiance", lightmapImage(direct.mean, *session.atlas()), noiseOf(direct)));
    return out;
  }
  const bool lobes = r.glossy() && !diffuseOnly;
  const ReferenceImage specular = r.specularImage(bounces);
  const ReferenceImage highlights = r.directSpecularImage();
  Image radiance = session.image("reference");
  if (r.glossy() && diffuseOnly)
    for (size_t i = 0; i < radiance.data.size(); ++i) radiance.data[i] -= specular.mean.data[i] + highlights.mean.data[i];
  out.push_back(written("radiance", std::move(radiance), 0));
  out.push_back(written("indirect irradiance", indirect.mean, noiseOf(indirect)));
  out.push_back(written("direct irradiance", direct.mean, noiseOf(direct)));
  if (lobes) out.push_back(written("specular radiance", specular.mean, noiseOf(specular))), out.push_back(written("direct specular radiance", highlights.mean, noiseOf(highlights)));
  return out;
}

void save(std::vector<Written>& images, const std::string& out, const Session& session) {
  const fs::path first(out);
  const auto attributes = imageAttributes(session.preset(), session.provenance());
  for (size_t i = 0; i < images.size(); ++i) {
    fs::path file = first;
    if (i > 0) {
      std::string suffix = images[i].name;
      for (char& c : suffix) c = c == ' ' ? '_' : c;
      file.replace_filename(fmt::format("{}_{}{}", first.stem().string(), suffix, first.extension().string()));
    }
    images[i].image.metadata = attributes;
    writeImage(file, images[i].image);
    images[i].file = file.string();
  }
}

std::string asJson(const std::vector<Written>& images, const ReferenceResult& r, const Session& session, int bounces,
                   double seconds) {
  JsonWriter w;
  w.beginObject()
      .key("preset")
      .raw(presetJson(session.preset(), true))
      .member("samples", r.samplesPerPixel)
      .key("bounces");
  bounces == kAllBounces ? w.null() : w.whole(bounces);
  w.member("width", images.front().image.width)
      .member("height", images.front().image.height)
      .member("seconds", seconds);
  w.member("back_face_hits", r.backFaceHits).member("non_finite", r.nonFinite).key("images").beginArray();
  for (const Written& i : images)
    w.beginObject()
        .member("name", i.name)
        .member("file", i.file)
        .member("hash", i.hash)
        .member("rms_noise", i.noise)
        .endObject();
  return w.endArray().key("provenance").raw(provenanceJson(session.provenance())).endObject().str() + "\n";
}

std::string asText(const std::vector<Written>& images, const ReferenceResult& r, int bounces, double seconds) {
  std::string out = fmt::format("{} samples, {} bounces, {}x{}, {:.1f} s\n", r.samplesPerPixel,
                                bounces == kAllBounces ? "all" : fmt::format("{}", bounces), images.front().image.width,
                                images.front().image.height, seconds);
  if (r.backFaceHits) out += fmt::format("{} hits on back faces\n", r.backFaceHits);
  if (r.nonFinite) out += fmt::format("{} samples were NaN or infinite and left out\n", r.nonFinite);
  for (const Written& i : images) out += fmt::format("{:<20} rms noise {:<10.3g} {}\n", i.name, i.noise, i.file);
  return out;
}

}  // namespace

int reference(const GlobalOptions& global, const ReferenceOptions& o) {
  const Preset preset = wantedPreset(o);
  for (const std::string& w : preset.warnings) note(w);
  const auto progress = interruptibleProgress(global);
  Session session(global.session());
  session.useProgress(progress);
  session.load(preset, progress.get());
  for (const std::string& w : session.scene().report.warnings) note(w);
  const auto start = std::chrono::steady_clock::now();
  bool cancelled = false;
  std::shared_ptr<const ReferenceResult> result;
  try {
    result = session.reference(o.lightmap ? "lightmap" : "image", progress.get());
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::Cancelled) throw;
    cancelled = true;
    if (!o.lightmap) result = session.currentReference();
    if (!result) throw;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  finishProgress();
  const int bounces = bouncesOf(preset);
  std::vector<Written> images = imagesOf(session, *result, o.lightmap, o.diffuseOnly, bounces);
  if (!o.out.empty()) save(images, o.out, session);
  print(global.json ? asJson(images, *result, session, bounces, seconds) : asText(images, *result, bounces, seconds));
  if (cancelled)
    throw Error(ErrorKind::Cancelled,
                fmt::format("cancelled after {} of the samples; what was done is kept", result->samplesPerPixel));
  return validationVerdict(global, session.device(), 0);
}

}  // namespace hl::cli
