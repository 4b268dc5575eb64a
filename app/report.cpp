#include "app/report.h"

#include <QApplication>
#include <QCommandLineParser>
#include <clocale>
#include <cstdio>

#include "engine/core/error.h"
#include "ui/report.h"
#include "ui/settings.h"

namespace hl {
namespace {

constexpr int kBadUsage = 2;

/// For one line on a terminal.
int fail(const std::string& message, int code) {
  std::fprintf(stderr, "halflight: %s\n", message.c_str());
  return code;
}

int writeTo(const QString& folder, QString out) {
  if (out.isEmpty()) out = folder + QStringLiteral("/report");
  const auto view = ui::openResults(folder.toStdString());
  ui::Settings settings;
  const ui::Report r = ui::writeReport(*view, out.toStdString(), &settings);
  size_t drawn = 0;
  for (const ui::ReportPlot& p : r.plots) {
    drawn += p.nothing.empty() ? 1 : 0;
    if (!p.nothing.empty()) std::printf("not drawn: %s: %s\n", p.title.c_str(), p.nothing.c_str());
  }
  std::printf("%zu plots in %s: report.md has them all\n", drawn, out.toLocal8Bit().constData());
  if (std::fflush(stdout) != 0) return fail("standard output cannot be written", 1);
  if (r.missing) std::fprintf(stderr, "halflight: %zu of %zu runs are missing; the plots are of the others\n", r.missing, view->results.plan.size());
  if (r.failed) std::fprintf(stderr, "halflight: %zu runs failed; results.csv says why\n", r.failed);
  return 0;
}

}  // namespace

int report(int argc, char** argv) {
  // It needs no display, and shall not depend on one.
  if (qEnvironmentVariableIsEmpty("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication app(argc, argv);
  std::setlocale(LC_NUMERIC, "C");
  QCommandLineParser parser;
  parser.setApplicationDescription(QCoreApplication::translate("report", "Plots of a folder of results: PNG, PDF, CSV, report.md and a notebook."));
  parser.addPositionalArgument("report", QString(), "report");
  parser.addPositionalArgument("DIR", QCoreApplication::translate("report", "A folder that `halflight-cli bench` has written, complete or not."), "DIR");
  const QCommandLineOption out("out", QCoreApplication::translate("report", "Where the report goes; by default DIR/report."), "DIR2");
  parser.addOption(out);
  parser.addHelpOption();
  parser.process(app);
  const QStringList words = parser.positionalArguments();
  if (words.size() != 2) return fail("report: one folder of results is wanted: halflight report DIR [--out DIR2]", kBadUsage);
  try {
    return writeTo(words[1], parser.value(out));
  } catch (const Error& e) {
    return fail(e.what(), e.exitCode());
  } catch (const std::exception& e) {
    return fail(e.what(), 1);
  }
}

}  // namespace hl
