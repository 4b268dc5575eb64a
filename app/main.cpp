// The workbench: halflight [PRESET|SCENE|MESH|SCREENSHOT|EXPERIMENT|RESULTS], and halflight report DIR
#include <QCommandLineParser>
#include <QFileInfo>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "app/report.h"
#include "ui/files.h"
#include "ui/heartbeat.h"
#include "ui/main_window.h"
#include "ui/presenter_choice.h"
#include "ui/session_link.h"
#include "ui/settings.h"

namespace {

/// Answers that need no display.
bool wantsText(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    for (const char* word : {"-h", "--help", "--help-all", "-v", "--version"})
      if (std::strcmp(argv[i], word) == 0) return true;
  return false;
}

struct Arguments {
  QString file, device, tracer;
  std::optional<hl::ui::PresenterWish> presenter;
  bool measure = false;
};

Arguments parse(const QCoreApplication& app) {
  QCommandLineParser parser;
  parser.setApplicationDescription(QCoreApplication::translate("main", "Workbench for research on real-time global illumination.\n"
                                                               "`halflight report DIR` makes plots of a folder of results (`halflight report --help`)."));
  parser.addHelpOption();
  parser.addVersionOption();
  parser.addPositionalArgument("file", QCoreApplication::translate("main", "Preset, scene, mesh, screenshot, experiment or folder of results to open; a scene's name will do."), "[FILE]");
  const QCommandLineOption device("device", QCoreApplication::translate("main", "Vulkan device: its index or part of its name."), "D");
  const QCommandLineOption tracer("tracer", QCoreApplication::translate("main", "Ray tracer: auto, embree, bvh or pipeline."), "T", "auto");
  const QCommandLineOption presenter("presenter",
                                     QCoreApplication::translate("main", "How the picture comes to the screen: swapchain (drawn by the device; X11 alone), readback, "
                                                                         "or auto (swapchain on a GPU). The menu View keeps another choice than auto."),
                                     "P");
  const QCommandLineOption measure("measure-ui",
                                   QCoreApplication::translate("main", "Measure the window's own responsiveness, and print it as JSON at the end: raw, and with the time that "
                                                               "a virtual machine's host took subtracted (corrected)."));
  parser.addOptions({device, tracer, presenter, measure});
  parser.process(app);
  if (parser.positionalArguments().size() > 1) {
    std::fprintf(stderr, "halflight: one file at most\n");
    std::exit(2);
  }
  std::optional<hl::ui::PresenterWish> wish;
  if (parser.isSet(presenter)) {
    wish = hl::ui::parsePresenterWish(parser.value(presenter));
    if (!wish) {
      std::fprintf(stderr, "halflight: --presenter %s: it must be auto, swapchain or readback\n", qPrintable(parser.value(presenter)));
      std::exit(2);
    }
  }
  return {parser.positionalArguments().value(0), parser.value(device), parser.value(tracer), wish, parser.isSet(measure)};
}

}  // namespace

int main(int argc, char** argv) {
  QCoreApplication::setApplicationName("halflight");
  QCoreApplication::setApplicationVersion(HALFLIGHT_VERSION);
  if (argc > 1 && std::strcmp(argv[1], "report") == 0) return hl::report(argc, argv);
  if (wantsText(argc, argv)) {
    QCoreApplication text(argc, argv);
    parse(text);
    return 0;
  }
  // Docks float and keep their place under xcb; Wayland lets no window choose its place.
  if (qEnvironmentVariableIsEmpty("QT_QPA_PLATFORM") && !qEnvironmentVariableIsEmpty("WAYLAND_DISPLAY") && !qEnvironmentVariableIsEmpty("DISPLAY"))
    qputenv("QT_QPA_PLATFORM", "xcb");
  hl::ui::MeasuredApplication app(argc, argv);
  std::setlocale(LC_NUMERIC, "C");  // files are written and read with a decimal point, whatever the desktop's language
  const Arguments arguments = parse(app);
  hl::SessionOptions options;
  options.device.select = arguments.device.toStdString();
  options.tracer = arguments.tracer.toStdString();
  // A path as the person's shell sees it; a scene's name stays as it is.
  const QFileInfo file(arguments.file);
  const QString open = !arguments.file.isEmpty() && file.exists() ? file.absoluteFilePath() : arguments.file;

  hl::ui::Settings settings;
  hl::ui::SessionLink link(options);
  // Experiments and folders of results are for the Sweep dock, over the default preset.
  const bool forSweeps = !open.isEmpty() && hl::ui::kindOfFile(open.toStdString()) != hl::ui::FileKind::Other;
  hl::ui::MainWindow window(link, settings, forSweeps ? QString() : open);
  if (arguments.presenter) window.setPresenterWish(*arguments.presenter);
  window.show();
  if (forSweeps) window.openPath(open);
  hl::ui::Heartbeat heartbeat;
  if (arguments.measure) heartbeat.start(), app.startMeasuring();
  const int code = QApplication::exec();
  if (arguments.measure) std::printf("%s\n", hl::ui::responsivenessJson(heartbeat, app).c_str());
  return code;
}
