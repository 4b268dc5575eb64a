// halflight-cli: the command line. The only file that sees CLI11.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <charconv>
#include <clocale>
#include <cstdio>
#include <limits>
#include <new>

#include "app/cli_commands.h"
#include "engine/core/error.h"
#include "engine/core/log.h"

namespace {

using namespace hl::cli;

struct Arguments {
  GlobalOptions global;
  std::string listWhat, doctorScene = "cornell_box";
  RenderOptions render;
  ReferenceOptions reference;
  CompareOptions compare;
  PackOptions pack;
  BenchOptions bench;
  TuneArguments tune;
  bool markdown = false, schema = false;
};

/// A repeatable option that takes one value each time it stands there, so that it never swallows a file name.
template <class T>
CLI::Option* repeated(CLI::App* command, const char* name, T& values, const char* help) {
  return command->add_option(name, values, help)->allow_extra_args(false)->take_all();
}

/// Numbers from `least` to `most`, `what` they are; NaN and the infinities are none. (CLI11 would say no more than that a text could not be converted, and
/// CLI::Range lets NaN pass.)
template <class Number>
CLI::Validator numberWithin(Number least, Number most, const char* what) {
  const auto check = [least, most, what](const std::string& text) {
    Number v = 0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), v);
    const bool good = end.ec == std::errc() && end.ptr == text.data() + text.size() && v >= least && v <= most;
    return good ? std::string() : fmt::format("{} from {} to {} is wanted, not {}", what, least, most, text);
  };
  return CLI::Validator(check, "");
}
CLI::Validator wholeNumber(int64_t least, int64_t most) { return numberWithin(least, most, "a whole number"); }
CLI::Validator finiteNumber(double least, double most) { return numberWithin(least, most, "a number"); }

void defineGlobal(CLI::App& app, GlobalOptions& global) {
  app.add_option("--device", global.device, "Vulkan device: its index in `list devices`, or part of its name");
  app.add_option("--tracer", global.tracer, "Ray tracer: auto, embree, bvh or pipeline");
  app.add_flag("--verbose", global.verbose, "Say more on stderr");
  app.add_flag("--validation", global.validation, "Validation layers on; any message fails the run")
      ->envname("HALFLIGHT_VALIDATION");
  app.add_flag("--json", global.json, "Print one JSON document and nothing else");
  app.set_version_flag("--version", HALFLIGHT_VERSION);
}

void defineRender(CLI::App& app, RenderOptions& o) {
  CLI::App* c = app.add_subcommand("render", "Render until the work has settled, and say what it took");
  c->add_option("TARGET", o.target, "Preset, scene, mesh, or an image that carries its preset")->required();
  c->add_option("--technique", o.technique, "In place of the preset's");
  repeated(c, "--set", o.set, "A parameter, KEY=VALUE; may be repeated");
  c->add_option("--frames", o.frames, "Exactly so many frames")->check(wholeNumber(1, 1'000'000));
  c->add_option("--resolution", o.resolution, "WIDTHxHEIGHT");
  c->add_option("--camera", o.camera, "One of the scene's cameras");
  c->add_option("--seed", o.seed, "Seed of the random sequences")
      ->check(wholeNumber(0, std::numeric_limits<uint32_t>::max()));
  c->add_option("--view", o.view,
                "What picture.png shows: final, indirect, direct, albedo, a view of the technique ...");
  c->add_option("--exposure", o.exposure, "Of picture.png, in stops")->check(finiteNumber(-64, 64));
  repeated(c, "--metrics", o.metrics, "Errors against the matched and the full reference: relmse,bias,...")
      ->delimiter(',');
  repeated(c, "--errors-of", o.errorTargets, "What they are measured on: image, lightmap")->delimiter(',');
  c->add_flag("--play", o.play, "The scene's time runs: frame n is at the start plus n / rate seconds. Needs --frames");
  c->add_option("--time", o.time, "Where the time starts, or stands [s]")->check(finiteNumber(0, 1e5));
  c->add_option("--rate", o.rate, "Frames a second of the scene's time")->check(finiteNumber(1e-3, 1e4));
  c->add_option("--camera-path", o.cameraPath, "One of the scene's recorded flights, in place of the camera");
  c->add_option("--flicker", o.flicker, "How much the settled picture varies over so many further frames")->check(wholeNumber(2, 1'000'000));
  c->add_option("--step", o.step, "How long the indirect light takes to follow: lights=FACTOR (all lights and the sky), time=SECONDS (the scene's animations), "
                "camera=NAME (a cut), or KEY=VALUE of a parameter");
  c->add_option("--out", o.out, "Folder for result.json, the picture and the linear images");
}

void defineReference(CLI::App& app, ReferenceOptions& o) {
  CLI::App* c = app.add_subcommand("reference", "Path trace the truth");
  c->add_option("TARGET", o.target, "Preset, scene or mesh")->required();
  c->add_option("--spp", o.samples, "Paths a pixel or texel")->check(wholeNumber(1, std::numeric_limits<int>::max()));
  c->add_option("--bounces", o.bounces, "Indirect bounces: a number, or inf");
  c->add_flag("--diffuse-only", o.diffuseOnly,
              "Without what glossy surfaces reflect by their lobes");
  c->add_flag("--lightmap", o.lightmap, "At the texels of the lightmap, in place of the camera's pixels");
  repeated(c, "--set", o.set, "A parameter, KEY=VALUE; may be repeated");
  c->add_option("--resolution", o.resolution, "WIDTHxHEIGHT");
  c->add_option("--camera", o.camera, "One of the scene's cameras");
  c->add_option("--out", o.out, "EXR or PFM file; direct and indirect irradiance, and specular radiance where surfaces are glossy, go beside it");
}

void defineCompare(CLI::App& app, CompareOptions& o) {
  CLI::App* c = app.add_subcommand("compare", "Errors of image A against image B");
  c->add_option("A", o.value, "The image")->required();
  c->add_option("B", o.reference, "What it is measured against")->required();
  repeated(c, "--metric", o.metrics, "One of `list metrics`; may be repeated; all of them where left out")
      ->delimiter(',');
  repeated(c, "--roi", o.regions, "x,y,width,height in pixels; may be repeated");
  c->add_option("--exposure", o.exposure, "Stops, for the metrics that look at the picture: ssim, flip, l_star_mse, dfpr")->check(finiteNumber(-64, 64));
  c->add_option("--tone-map", o.toneMap, "Likewise: linear, aces or reinhard");
  c->add_option("--map", o.map, "The first metric's map: .exr or .pfm as values, .png in false colours");
}

void definePack(CLI::App& app, PackOptions& o) {
  CLI::App* c = app.add_subcommand("pack", "A preset or an experiment and its scene in one file, for a machine without the meshes");
  c->add_option("TARGET", o.target, "Preset, experiment, scene or mesh")->required();
  c->add_option("--out", o.out, "The bundle, FILE.hlb")->required();
  c->add_flag("--references", o.references, "Trace the references first, and let them travel too");
  repeated(c, "--set", o.set, "A parameter, KEY=VALUE; may be repeated");
  c->add_option("--resolution", o.resolution, "WIDTHxHEIGHT");
  c->add_option("--camera", o.camera, "One of the scene's cameras");
}

void defineBench(CLI::App& app, BenchOptions& o) {
  CLI::App* c = app.add_subcommand("bench", "An experiment: sweep, results, speed against error. The same command goes on with what is there");
  c->add_option("EXPERIMENT", o.experiment, "Its file, its bundle, or the name of one in `list experiments`")->required();
  c->add_option("--out", o.out, "Folder of the results")->required();
}

void defineTune(CLI::App& app, TuneArguments& o) {
  CLI::App* c = app.add_subcommand("tune", "Search techniques and their knobs for the least error within a time budget");
  c->add_option("TARGET", o.target, "Preset, scene or mesh")->required();
  c->add_option("--budget-ms", o.budgetMs, "For preparation, bake and frames until the finished work shows")->required()->check(finiteNumber(1e-3, 1e8));
  c->add_flag("--per-frame", o.perFrame, "The budget is for a frame, with preparation and bake spread over --amortise frames");
  c->add_option("--amortise", o.amortiseFrames, "Frames")->check(wholeNumber(1, 1'000'000));
  repeated(c, "--techniques", o.techniques, "All but none where left out")->delimiter(',');
  c->add_option("--metric", o.metric, "What is to be least");
  c->add_option("--reference", o.reference, "What it is against: full or matched");
  c->add_option("--candidates", o.candidates, "Drawn at first for each technique")->check(wholeNumber(2, 1000));
  c->add_option("--seed", o.seed, "Of the drawing")->check(wholeNumber(0, std::numeric_limits<uint32_t>::max()));
  repeated(c, "--set", o.set, "A parameter that stays as it is, KEY=VALUE; may be repeated");
  c->add_option("--resolution", o.resolution, "WIDTHxHEIGHT");
  c->add_option("--camera", o.camera, "One of the scene's cameras");
  c->add_option("--out", o.out, "Folder of the winner and the evidence");
}

void define(CLI::App& app, Arguments& a) {
  app.require_subcommand(0, 1);
  app.fallthrough();
  app.allow_extras();  // so that what is unknown gets a message of our own
  defineGlobal(app, a.global);
  app.add_subcommand("list", fmt::format("What there is: {}", fmt::join(listKinds(), ", ")))
      ->add_option("WHAT", a.listWhat, "What to list")
      ->required();
  app.add_subcommand("doctor", "Device, driver, tracers with their rates, and what is missing")
      ->add_option("SCENE", a.doctorScene, "Scene that rays are timed on");
  defineRender(app, a.render);
  defineReference(app, a.reference);
  defineCompare(app, a.compare);
  definePack(app, a.pack);
  defineBench(app, a.bench);
  defineTune(app, a.tune);
  CLI::App* describe = app.add_subcommand("describe", "Every parameter");
  describe->add_flag("--markdown", a.markdown, "As the table of docs/PARAMETERS.md");
  describe->add_flag("--schema", a.schema, "The JSON Schema of presets and experiments");
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) command->fallthrough();
}

/// What neither the program nor the command knows, with the nearest thing it does know.
void refuseExtras(const CLI::App& app) {
  const std::vector<std::string> extras = app.remaining(true);
  const auto used = app.get_subcommands();
  if (used.empty()) {
    std::vector<std::string> commands;
    for (const CLI::App* c : app.get_subcommands([](const CLI::App*) { return true; }))
      commands.push_back(c->get_name());
    const auto word =
        std::find_if(extras.begin(), extras.end(), [](const std::string& e) { return !e.starts_with("-"); });
    if (word == extras.end() && extras.empty())
      throw hl::badInput(fmt::format("a command is wanted: {}; --help says more", fmt::join(commands, ", ")));
    if (word != extras.end()) {
      const std::string near = hl::nearest(*word, commands);
      throw hl::badInput(fmt::format("unknown command {}; {}", *word,
                                     near.empty() ? fmt::format("there are {}", fmt::join(commands, ", "))
                                                  : fmt::format("did you mean {}?", near)));
    }
  }
  if (extras.empty()) return;
  std::vector<std::string> options;
  std::vector<const CLI::App*> scopes = {&app};
  if (!used.empty()) scopes.push_back(used.front());
  for (const CLI::App* scope : scopes)
    for (const CLI::Option* o : scope->get_options())
      if (!o->get_lnames().empty()) options.push_back("--" + o->get_lnames().front());
  const std::string near = extras.front().starts_with("-") ? hl::nearest(extras.front(), options) : "";
  throw hl::badInput(fmt::format("unknown argument {}{}{}", extras.front(),
                                 used.empty() ? "" : " of " + used.front()->get_name(),
                                 near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

int dispatch(const CLI::App& app, const Arguments& a) {
  if (app.got_subcommand("list")) return list(a.global, a.listWhat);
  if (app.got_subcommand("doctor")) return doctor(a.global, a.doctorScene);
  if (app.got_subcommand("render")) return render(a.global, a.render);
  if (app.got_subcommand("reference")) return reference(a.global, a.reference);
  if (app.got_subcommand("compare")) return compare(a.global, a.compare);
  if (app.got_subcommand("pack")) return pack(a.global, a.pack);
  if (app.got_subcommand("bench")) return bench(a.global, a.bench);
  if (app.got_subcommand("tune")) return tune(a.global, a.tune);
  return describe(a.markdown, a.schema);
}

std::string oneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

int run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Halflight without a display: render, measure and compare global illumination.", "halflight-cli");
  define(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& e) {
    return app.exit(e);
  } catch (const CLI::CallForVersion& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    throw hl::badInput(e.what());
  }
  refuseExtras(app);
  hl::setLogLevel(arguments.global.verbose ? hl::LogLevel::Debug : hl::LogLevel::Warning);
  return dispatch(app, arguments);
}

}  // namespace

int main(int argc, char** argv) {
  std::setlocale(LC_NUMERIC, "C");
  int code = 1;
  std::string message;
  try {
    code = run(argc, argv);
  } catch (const hl::Error& e) {
    message = e.what(), code = e.exitCode();
  } catch (const std::bad_alloc&) {
    message = "out of memory", code = 3;
  } catch (const std::exception& e) {
    message = e.what();
  }
  finishProgress();
  if (!message.empty()) std::fprintf(stderr, "halflight-cli: %s\n", oneLine(message).c_str());
  return code;
}
