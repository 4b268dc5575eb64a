// The Sweep dock: what is typed is what the command line reads; what runs is what it measures; a click brings a configuration into the window.
#include <QApplication>
#include <QComboBox>
#include <QDir>
#include <QDirIterator>
#include <QDockWidget>
#include <QDropEvent>
#include <QLabel>
#include <QLineEdit>
#include <QMessageBox>
#include <QMimeData>
#include <QProcess>
#include <QPushButton>
#include <QSignalSpy>
#include <QSpinBox>
#include <QTableView>
#include <QTableWidget>
#include <QTemporaryDir>
#include <QTest>
#include <QUrl>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "tests/ui/fake_link.h"
#include "ui/main_window.h"
#include "ui/parameter_panel.h"
#include "ui/parameter_row.h"
#include "ui/session_link.h"
#include "ui/settings.h"
#include "ui/sweep_axis_row.h"
#include "ui/sweep_dock.h"
#include "ui/sweep_editor.h"
#include "ui/speed_error_plot.h"
#include "ui/sweep_plots.h"
#include "ui/sweep_queue.h"
#include "ui/sweep_results.h"
#include "ui/sweep_table.h"
#include "ui/technique_dock.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr int kLongest = 240000;  // ms, on a busy machine

Preset smallPreset() {
  Preset p;
  p.width = 32, p.height = 24;
  p.parameters = {{"reference.samples", "64"}, {"reference.direct_samples", "4"}, {"direct.samples", "4"}, {"direct.lumel_samples", "4"}, {"radiosity.bounces", "3"}};
  return p;
}

/// The rows of a table that do not depend on how fast the machine was.
QList<QStringList> tableOf(const QString& file) {
  QList<QStringList> rows;
  QList<bool> kept;
  const QString text = QString::fromStdString(readFile(file.toStdString()));
  for (const QString& line : text.split('\n', Qt::SkipEmptyParts)) {
    QStringList cells{QString()};
    bool quoted = false;
    for (const QChar c : line) {
      if (c == '"') quoted = !quoted;
      if (c == ',' && !quoted)
        cells << QString();
      else
        cells.back() += c;
    }
    if (kept.isEmpty())
      for (const QString& name : cells) kept << !name.endsWith("_ms");
    if (cells.front() == "path_tracer") continue;
    QStringList row;
    for (int i = 0; i < cells.size(); ++i)
      if (kept[i]) row << cells[i];
    rows << row;
  }
  return rows;
}

/// Every file below a folder with its bytes.
QMap<QString, QByteArray> contentOf(const QString& folder) {
  QMap<QString, QByteArray> out;
  for (QDirIterator it(folder, QDir::Files, QDirIterator::Subdirectories); it.hasNext();) {
    QFile f(it.next());
    if (!f.open(QIODevice::ReadOnly)) qFatal("cannot read %s", qPrintable(f.fileName()));
    out[f.fileName()] = f.readAll();
  }
  return out;
}

class SweepDockTest : public QObject {
  Q_OBJECT

  QTemporaryDir folder_;
  std::unique_ptr<Settings> settings_;
  std::unique_ptr<EngineLink> link_;
  std::unique_ptr<MainWindow> window_;
  int windows_ = 0;

  QString path(const QString& name) const { return folder_.filePath(name); }
  SweepEditor& editor() { return window_->sweepPanel().editor(); }
  SweepRunner& runner() { return window_->sweepPanel().runner(); }
  SweepResultsPanel& results() { return window_->sweepPanel().results(); }
  template <class W>
  W& find(const char* name) {
    W* w = window_->findChild<W*>(QString::fromLatin1(name));
    if (!w) qFatal("no %s", name);
    return *w;
  }
  void makeWindow(std::unique_ptr<EngineLink> link, const QString& open) {
    window_.reset(), settings_.reset(), link_.reset();
    settings_ = std::make_unique<Settings>(path(QStringLiteral("settings%1.ini").arg(++windows_)));
    link_ = std::move(link);
    window_ = std::make_unique<MainWindow>(*link_, *settings_, open);
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
  }
  void fakeWindow() {
    makeWindow(std::make_unique<FakeLink>(), QString());
    emit link_->opened(smallPreset(), {});
    window_->findChild<QDockWidget*>("sweepDock")->raise();
  }
  void realWindow() {
    savePreset(smallPreset(), path("small.json").toStdString());
    SessionOptions options;
    options.device.validation = true;
    makeWindow(std::make_unique<SessionLink>(options), path("small.json"));
    QVERIFY(QTest::qWaitFor([&] { return link_->latest() && link_->latest()->settled; }, kLongest));
  }
  static void type(QLineEdit& field, const QString& text) {
    field.setFocus();
    field.selectAll();
    if (text.isEmpty())
      QTest::keyClick(&field, Qt::Key_Delete);
    else
      QTest::keyClicks(&field, text);
  }
  QLineEdit& valuesOf(const char* key) { return *editor().axisRow(key)->findChild<QLineEdit*>("values"); }
  void chooseList(const char* key) {
    for (QComboBox* c : editor().axisRow(key)->findChildren<QComboBox*>()) c->setCurrentIndex(0), emit c->activated(0);
  }
  /// Two axes, two seeds: eight runs.
  void typeSmallExperiment() {
    editor().addAxis("radiosity.samples");
    chooseList("radiosity.samples");
    type(valuesOf("radiosity.samples"), "16, 64");
    editor().addAxis("lightmap.resolution");
    chooseList("lightmap.resolution");
    type(valuesOf("lightmap.resolution"), "32, 48");
    type(find<QLineEdit>("sweepSeeds"), "1, 2");
    type(find<QLineEdit>("sweepMetrics"), "relmse, bias");
  }
  bool checks() {
    return QTest::qWaitFor([&] { return editor().upToDate(); }, kLongest);
  }
  bool save(const QString& file) {
    QSignalSpy saved(&editor(), &SweepEditor::saved), refused(&editor(), &SweepEditor::refused);
    editor().saveTo(file);
    return QTest::qWaitFor([&] { return saved.size() + refused.size() > 0; }, kLongest) && saved.size() == 1;
  }
  SweepJob runs(const QString& folder) {
    const size_t before = runner().jobs().size();
    editor().setFolder(folder);
    editor().start();
    if (!QTest::qWaitFor([&] { return runner().jobs().size() > before && runner().jobs().back().over(); }, kLongest)) qFatal("the sweep does not end");
    return runner().jobs().back();
  }
  void drop(const QString& file) {
    QMimeData mime;
    mime.setUrls({QUrl::fromLocalFile(file)});
    QDragEnterEvent enter(QPoint(10, 10), Qt::CopyAction, &mime, Qt::LeftButton, Qt::NoModifier);
    QCoreApplication::sendEvent(window_.get(), &enter);
    QVERIFY(enter.isAccepted());
    QDropEvent event(QPointF(10, 10), Qt::CopyAction, &mime, Qt::LeftButton, Qt::NoModifier);
    QCoreApplication::sendEvent(window_.get(), &event);
  }
  int commandLine(const QStringList& arguments) {
    QProcess process;
    process.start(HALFLIGHT_CLI, arguments);
    if (!process.waitForFinished(kLongest)) process.kill();
    if (process.exitCode() != 0) qWarning("%s", process.readAllStandardError().constData());
    return process.exitStatus() == QProcess::NormalExit ? process.exitCode() : -1;
  }

 private slots:
  void cleanupTestCase() { window_.reset(), settings_.reset(), link_.reset(); }

  void whatIsTypedIsWhatTheCommandLineReads() {
    fakeWindow();
    typeSmallExperiment();
    find<QSpinBox>("sweepRepeats").setValue(2);
    editor().addAxis("radiosity.directions");
    QVERIFY(checks());
    QCOMPARE(editor().problemAt({"", 0, {}}), QString());
    QVERIFY2(find<QLabel>("sweepCount").text().contains("runs"), qPrintable(find<QLabel>("sweepCount").text()));
    QVERIFY(save(path("typed.json")));
    const Experiment read = loadExperiment(path("typed.json").toStdString());
    QCOMPARE(read.permute.size(), size_t(1));
    QCOMPARE(read.permute[0].size(), size_t(3));
    QCOMPARE(read.permute[0][0].key, std::string("lightmap.resolution"));
    QVERIFY(read.permute[0][1].key == "radiosity.directions" && read.permute[0][1].values.size() > 1);  // all of an enum's values, as a first guess
    QCOMPARE(read.permute[0][2].values, (std::vector<std::string>{"16", "64"}));
    QCOMPARE(read.seeds, (std::vector<uint32_t>{1, 2}));
    QCOMPARE(read.metrics, (std::vector<std::string>{"relmse", "bias"}));
    QCOMPARE(read.repeats, 2);
    QCOMPARE(presetJson(read.base), presetJson(smallPreset()));
    // And back: the file opened says the same when it is saved again.
    const QByteArray first = QByteArray::fromStdString(readFile(path("typed.json").toStdString()));
    fakeWindow();
    QSignalSpy opened(&editor(), &SweepEditor::opened);
    editor().openExperiment(path("typed.json"));
    QVERIFY(opened.wait(kLongest));
    QVERIFY(save(path("again.json")));
    QCOMPARE(QByteArray::fromStdString(readFile(path("again.json").toStdString())), first);
  }

  void aRangeIsTheFilesRange() {
    fakeWindow();
    editor().addAxis("radiosity.samples");  // its soft range, by its declared scale
    SweepAxisRow& row = *editor().axisRow("radiosity.samples");
    type(*row.findChild<QLineEdit*>("from"), "16");
    type(*row.findChild<QLineEdit*>("to"), "1024");
    row.findChild<QSpinBox*>("count")->setValue(4);
    QVERIFY(row.axis().range && row.axis().log);
    type(find<QLineEdit>("sweepSeeds"), "3..6");
    QVERIFY(save(path("range.json")));
    const std::string text = R"({"version": 1, "base": )" + presetJson(smallPreset()) +
                             R"(, "permute": {"radiosity.samples": {"from": 16, "to": 1024, "count": 4, "log": true}}, "seeds": {"from": 3, "count": 4}})";
    QCOMPARE(readFile(path("range.json").toStdString()), experimentJson(experimentFromJson(text, "by hand")));
  }

  void mistakesAreToldAtTheirField_data() {
    QTest::addColumn<QString>("field");
    QTest::addColumn<QString>("text");
    QTest::addColumn<QString>("where");
    QTest::addColumn<QString>("says");
    QTest::newRow("twice the same seed") << "sweepSeeds" << "1, 2, 1" << "seeds" << "stands twice";
    QTest::newRow("no seed") << "sweepSeeds" << "" << "seeds" << "at least one value";
    QTest::newRow("a word for a seed") << "sweepSeeds" << "one" << "seeds" << "whole number";
    QTest::newRow("seeds backwards") << "sweepSeeds" << "4..1" << "seeds" << "out of range";
    QTest::newRow("unknown metric") << "sweepMetrics" << "relmsee" << "metrics" << "did you mean relmse";
    QTest::newRow("out of range") << "values" << "16, 0" << "axis" << "radiosity.samples";
    QTest::newRow("not a number") << "values" << "16, many" << "axis" << "number";
    QTest::newRow("no value") << "values" << "" << "axis" << "at least one value";
    QTest::newRow("empty between commas") << "values" << "16,, 64" << "axis" << "number";
  }
  void mistakesAreToldAtTheirField() {
    QFETCH(QString, field);
    QFETCH(QString, text);
    QFETCH(QString, where);
    QFETCH(QString, says);
    fakeWindow();
    editor().addAxis("radiosity.samples");
    chooseList("radiosity.samples");
    type(valuesOf("radiosity.samples"), "16, 64");
    QVERIFY(checks());
    type(field == "values" ? valuesOf("radiosity.samples") : find<QLineEdit>(qPrintable(field)), text);
    QVERIFY(checks());
    const DraftField at = where == "axis" ? DraftField{"axis", 0, "radiosity.samples"} : DraftField{where.toStdString(), 0, {}};
    const QString said = editor().problemAt(at);
    QVERIFY2(said.contains(says), qPrintable(said));
    QVERIFY(!said.contains('\n') && !said.contains("draft"));
    if (where == "axis") QCOMPARE(editor().axisRow("radiosity.samples")->problem(), said);
    // Nothing is started, nothing written.
    QSignalSpy refused(&editor(), &SweepEditor::refused);
    editor().setFolder(path("never"));
    editor().start();
    QVERIFY(refused.wait(kLongest));
    QVERIFY(runner().jobs().empty());
    QVERIFY(!QDir(path("never")).exists());
    QVERIFY(!save(path("never.json")));
    QVERIFY(!QFile::exists(path("never.json")));
  }

  void unknownKeysTooManyRunsAndAFileForAFolder() {
    fakeWindow();
    editor().addAxis("radiosity.sampels");
    QVERIFY(checks());
    QVERIFY2(editor().problemAt({"axis", 0, "radiosity.sampels"}).contains("did you mean \"radiosity.samples\""), qPrintable(editor().problemAt({"axis", 0, "radiosity.sampels"})));
    fakeWindow();
    editor().addAxis("radiosity.samples");
    editor().axisRow("radiosity.samples")->findChild<QSpinBox*>("count")->setValue(1000);
    type(find<QLineEdit>("sweepSeeds"), "1..100");
    QVERIFY(checks());
    QVERIFY2(editor().problemAt({"", 0, {}}).contains("10000 at most"), qPrintable(editor().problemAt({"", 0, {}})));
    fakeWindow();
    savePreset(smallPreset(), path("file.json").toStdString());
    editor().setFolder(path("file.json"));
    QVERIFY(checks());
    QVERIFY(editor().problemAt({"folder", 0, {}}).contains("this is a file"));
  }

  void sweepThisParameterAddsAnAxis() {
    fakeWindow();
    window_->findChild<QDockWidget*>("sweepDock")->close();
    ParameterRow* row = window_->techniquePanel().parameters().row("radiosity.bounces");
    const QList<QAction*> actions = row->nameLabel()->actions();
    const auto sweep = std::find_if(actions.begin(), actions.end(), [](const QAction* a) { return a->text().contains("Sweep"); });
    QVERIFY(sweep != actions.end());
    (*sweep)->trigger();
    QVERIFY(!window_->findChild<QDockWidget*>("sweepDock")->isHidden());
    QVERIFY(editor().axisRow("radiosity.bounces"));
    (*sweep)->trigger();  // goes to it, and adds no other
    QCOMPARE(editor().draft().permute[0].size(), size_t(1));
  }

  /// Eight runs in the dock and the same file by the command line: the same table, but for times.
  void resultsAreTheCommandLines() {
    realWindow();
    typeSmallExperiment();
    QVERIFY(save(path("small experiment.json")));
    QSignalSpy shown(&runner(), &SweepRunner::results);
    const SweepJob job = runs(path("by the window"));
    QVERIFY2(job.state == SweepJob::State::Done, qPrintable(job.message));
    QCOMPARE(job.status.done, size_t(8));
    QVERIFY(shown.size() > 0);
    QVERIFY(!link_->gate()->closed());
    QCOMPARE(commandLine({"bench", path("small experiment.json"), "--out", path("by the command line")}), 0);
    const auto mine = tableOf(path("by the window/results.csv"));
    QVERIFY(mine.size() > 16);
    QCOMPARE(mine, tableOf(path("by the command line/results.csv")));
    QTRY_COMPARE(results().model().rowCount(), 4);
  }

  /// By a click on the table, and by the keyboard; undo takes it back.
  void aClickLoadsTheConfiguration() {
    results().openFolder(path("by the command line"));
    QSignalSpy opened(&results(), &SweepResultsPanel::opened);
    QVERIFY(opened.wait(kLongest));
    QTRY_COMPARE(results().model().rowCount(), 4);
    const SweepResults& r = results().sweep()->results;
    const std::string before = presetJson(window_->document().preset());
    const int steps = window_->document().undoStack().count();
    QTableView& table = results().table();
    for (int row = 0; row < 4; ++row) {
      const size_t configuration = results().model().configurationAt(row);
      const auto run = std::find_if(r.plan.begin(), r.plan.end(), [&](const PlannedRun& p) { return p.configuration == configuration; });
      const std::string hash = r.runs[static_cast<size_t>(run - r.plan.begin())]->provenance.presetHash;
      QVERIFY(!hash.empty());
      if (row % 2) {
        table.setCurrentIndex(results().model().index(row, 0));
        QTest::keyClick(&table, Qt::Key_Return);
      } else {
        table.scrollTo(results().model().index(row, 0));
        QTest::mouseClick(table.viewport(), Qt::LeftButton, {}, table.visualRect(results().model().index(row, 0)).center());
      }
      QCOMPARE(presetHash(window_->document().preset()), hash);
      QVERIFY(QTest::qWaitFor([&] { return presetHash(link_->latest()->preset) == hash; }, kLongest));
    }
    // And by a click on its point.
    SweepPlot& plot = results().plots().speedError();
    plot.drawNow();
    QVERIFY(!plot.marks().empty());
    const PlotMark mark = plot.marks().front();
    emit plot.chosen(mark.configuration);
    QCOMPARE(table.currentIndex().row(), results().model().rowOf(mark.configuration));
    const auto chosen = std::find_if(r.plan.begin(), r.plan.end(), [&](const PlannedRun& p) { return p.configuration == mark.configuration; });
    QCOMPARE(presetHash(window_->document().preset()), r.runs[static_cast<size_t>(chosen - r.plan.begin())]->provenance.presetHash);
    QCOMPARE(window_->document().undoStack().count(), steps + 5);
    for (int i = 0; i < 5; ++i) window_->document().undoStack().undo();
    QCOMPARE(presetJson(window_->document().preset()), before);
  }

  void theTableSortsByNumbers() {
    SweepTableModel& model = results().model();
    const int cost = model.firstFixed() + SweepTableModel::Cost;
    model.sort(cost, Qt::DescendingOrder);
    for (size_t i = 1; i < model.rows().rows.size(); ++i) QVERIFY(model.rows().rows[i - 1].cost >= model.rows().rows[i].cost);
    model.sort(1, Qt::DescendingOrder);
    QCOMPARE(model.headerData(1, Qt::Horizontal, Qt::ToolTipRole).toString(), QString("radiosity.samples"));
    QCOMPARE(model.index(0, 1).data().toString(), QString("64"));
    QCOMPARE(model.index(3, 1).data().toString(), QString("16"));
    bool front = false;
    for (const SweepRows::Row& row : model.rows().rows) {
      front |= row.place == static_cast<int>(FrontPlace::On);
      QVERIFY(row.error > 0 && row.cost > 0 && row.halfWidth > 0);
    }
    QVERIFY(front);
    PlotChoice choice = results().plots().choice();
    choice.metric = "bias", choice.reference = "full", choice.cost = FrontAxis::Memory;
    results().plots().choose(choice);
    QTRY_COMPARE(model.rows().choice.metric, std::string("bias"));
    QVERIFY(model.headerData(cost, Qt::Horizontal, Qt::DisplayRole).toString().contains("MB"));
  }

  /// Cancelled half-way, what is done is kept; started again it goes on, and ends with the same table.
  void cancelledItGoesOnWhereItWas() {
    editor().setFolder(path("halved"));
    editor().start();
    QVERIFY(QTest::qWaitFor([&] { return !runner().jobs().empty() && runner().jobs().back().status.done >= 2 && !runner().jobs().back().over(); }, kLongest));
    QVERIFY(link_->gate()->closed());
    QTest::mouseClick(&find<QPushButton>("cancelSweep"), Qt::LeftButton);
    QVERIFY(QTest::qWaitFor([&] { return runner().jobs().back().over(); }, kLongest));
    QVERIFY(runner().jobs().back().state == SweepJob::State::Cancelled);
    QVERIFY(!link_->gate()->closed());
    const int kept = static_cast<int>(QDir(path("halved/runs")).entryList({"*.json"}).size());
    QVERIFY2(kept >= 2 && kept < 8, qPrintable(QString::number(kept)));
    QVERIFY(QFile::exists(path("halved/results.csv")));
    const SweepJob again = runs(path("halved"));
    QVERIFY2(again.state == SweepJob::State::Done, qPrintable(again.message));
    QCOMPARE(tableOf(path("halved/results.csv")), tableOf(path("by the command line/results.csv")));
  }

  /// Runs of another build are not mixed with, and not touched; the window shows them and says why not.
  void aFolderOfAnotherBuildIsRefused() {
    QVERIFY(QDir(folder_.path()).mkpath("foreign/runs"));
    for (const auto& [name, bytes] : contentOf(path("by the command line/runs")).asKeyValueRange()) {
      QByteArray changed = bytes;
      if (name.endsWith(".json")) {
        const qsizetype at = changed.lastIndexOf("\"commit\": \"");
        QVERIFY(at > 0);
        changed.replace(at + 11, 7, "0000000");
      }
      QFile f(path("foreign/runs/") + name.section('/', -1));
      QVERIFY(f.open(QIODevice::WriteOnly));
      f.write(changed);
    }
    const auto before = contentOf(path("foreign"));
    const SweepJob job = runs(path("foreign"));
    QVERIFY(job.state == SweepJob::State::Failed);
    QVERIFY2(job.message.contains("commit") && job.message.contains("0000000") && !job.message.contains('\n'), qPrintable(job.message));
    QVERIFY(window_->noticeText().contains("0000000"));
    QVERIFY(!link_->gate()->closed());
    const auto after = contentOf(path("foreign"));
    QCOMPARE(after.keys(), before.keys());
    QVERIFY(after == before);
  }

  void whatIsNoFolderOfResultsIsRefusedInOneLine() {
    QVERIFY(results().sweep());
    const SharedSweep shown = results().sweep();
    QVERIFY(QDir(folder_.path()).mkpath("empty"));
    QVERIFY(QDir(folder_.path()).mkpath("broken"));
    QFile broken(path("broken/experiment.json"));
    QVERIFY(broken.open(QIODevice::WriteOnly));
    broken.write("{\"version\": 1, \"base\"");
    broken.close();
    for (const char* name : {"empty", "broken", "nowhere"}) {
      QSignalSpy refused(&results(), &SweepResultsPanel::refused);
      results().openFolder(path(name));
      QVERIFY(refused.wait(kLongest));
      const QString why = refused[0][0].toString();
      QVERIFY2(why.contains(name) && !why.contains('\n'), qPrintable(why));
      QCOMPARE(results().sweep(), shown);
    }
  }

  void aDroppedFolderIsShown() {
    results().show(nullptr);
    drop(path("halved"));
    QTRY_VERIFY_WITH_TIMEOUT(results().sweep() != nullptr, kLongest);
    QCOMPARE(QString::fromStdString(results().sweep()->results.folder.string()), path("halved"));
    QSignalSpy opened(&editor(), &SweepEditor::opened);
    drop(path("small experiment.json"));
    QVERIFY(opened.wait(kLongest));
    QCOMPARE(editor().name(), QString("small experiment"));
  }

  /// An edit made while a sweep runs shows before its end, between two runs.
  void editsShowBetweenRuns() {
    editor().setFolder(path("with edits"));
    editor().start();
    QVERIFY(QTest::qWaitFor([&] { return !runner().jobs().empty() && runner().jobs().back().status.done >= 1 && !runner().jobs().back().over(); }, kLongest));
    const uint32_t seed = window_->document().preset().seed + 100;
    window_->document().editSeed(seed);
    QVERIFY(QTest::qWaitFor([&] { return link_->latest()->preset.seed == seed; }, kLongest));
    QVERIFY(runner().busy());
    QVERIFY(QTest::qWaitFor([&] { return !runner().busy(); }, kLongest));
    QVERIFY(runner().jobs().back().state == SweepJob::State::Done);
    QCOMPARE(tableOf(path("with edits/results.csv")), tableOf(path("by the command line/results.csv")));
  }

  void closingAsksAndKeepsWhatIsDone() {
    window_->document().undoStack().undo();
    editor().setFolder(path("closed"));
    editor().start();
    QVERIFY(QTest::qWaitFor([&] { return runner().busy() && runner().jobs().back().status.done >= 1; }, kLongest));
    window_->document().open(path("small.json"));  // no unsaved changes
    QTRY_VERIFY_WITH_TIMEOUT(!window_->document().modified(), kLongest);
    window_->close();
    QVERIFY(window_->isVisible());
    auto& box = find<QMessageBox>("stopSweepQuestion");
    for (QAbstractButton* b : box.buttons())
      if (box.buttonRole(b) == QMessageBox::AcceptRole) b->click();
    QTRY_VERIFY_WITH_TIMEOUT(!window_->isVisible(), kLongest);
    QVERIFY(!runner().busy());
    QVERIFY(QDir(path("closed/runs")).entryList({"*.json"}).size() >= 1);
    QVERIFY(openSweep(path("closed").toStdString()).done() >= 1);
  }
};

}  // namespace

QTEST_MAIN(SweepDockTest)
#include "sweep_dock_test.moc"
