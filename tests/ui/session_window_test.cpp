// The window with the real engine behind it: what it shows and saves is what halflight-cli makes of the same file.
#include <QElapsedTimer>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QPlainTextEdit>
#include <QProcess>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <cmath>

#include "engine/core/log.h"
#include "engine/experiment/open_target.h"
#include "engine/metrics/metrics.h"
#include "ui/log_dock.h"
#include "ui/main_window.h"
#include "ui/parameter_field.h"
#include "ui/parameter_panel.h"
#include "ui/parameter_row.h"
#include "ui/session_link.h"
#include "ui/settings.h"
#include "ui/technique_dock.h"
#include "ui/viewport.h"

namespace {

using namespace hl;
using namespace hl::ui;

constexpr int kLongest = 240000;  // ms, on a busy machine

/// A small, quick experiment.
Preset smallPreset() {
  Preset p;
  p.width = 96, p.height = 54;
  p.technique = "radiosity";
  p.parameters = {{"lightmap.resolution", "32"}, {"radiosity.samples", "16"}, {"radiosity.bounces", "2"}, {"direct.samples", "4"},
                  {"direct.lumel_samples", "4"}, {"reference.samples", "4"},   {"reference.direct_samples", "4"}};
  return p;
}

class SessionWindowTest : public QObject {
  Q_OBJECT

  QTemporaryDir folder_;
  std::unique_ptr<Settings> settings_;
  std::unique_ptr<SessionLink> link_;
  std::unique_ptr<MainWindow> window_;

  QString write(const QString& name, const std::string& text) {
    QFile f(folder_.filePath(name));
    if (!f.open(QIODevice::WriteOnly)) qFatal("cannot write %s", qPrintable(f.fileName()));
    f.write(QByteArray::fromStdString(text));
    return f.fileName();
  }
  /// The newest frame is of this experiment and nothing would change any more.
  std::shared_ptr<const FrameResult> settled(const Preset& wanted) {
    const auto done = [&] {
      const auto f = link_->latest();
      return f && f->settled && presetHash(f->preset) == presetHash(wanted) && f->preset.display == wanted.display;
    };
    if (!QTest::qWaitFor(done, kLongest)) return nullptr;
    // The frame whose work settled was drawn before its last unit: the picture that stays is a later one's.
    const uint64_t first = link_->latest()->number;
    // Asked for: a settled session draws a few frames for its times and then sleeps, perhaps before this looks.
    const auto later = [&] {
      if (done() && link_->latest()->number > first + 1) return true;
      link_->renderOnce();
      return false;
    };
    return QTest::qWaitFor(later, kLongest) ? link_->latest() : nullptr;
  }

  /// What halflight-cli prints; empty where it fails, as it does where the validation layers have a message.
  QJsonObject commandLine(const QStringList& arguments) {
    QProcess process;
    QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
    environment.insert("HALFLIGHT_VALIDATION", "1");
    environment.insert("HALFLIGHT_CACHE", folder_.filePath("cache of the command line"));  // no reference of the window's
    process.setProcessEnvironment(environment);
    process.start(HALFLIGHT_CLI, arguments);
    if (!process.waitForFinished(kLongest)) process.kill();
    const QByteArray said = process.readAllStandardError();
    if (!said.isEmpty()) qWarning("%s", said.constData());
    const bool good = process.exitStatus() == QProcess::NormalExit && process.exitCode() == 0;
    return good ? QJsonDocument::fromJson(process.readAllStandardOutput()).object() : QJsonObject();
  }
  /// Every entry, to the last digit. JSON has no word for what is not finite.
  static void compareErrors(const QJsonArray& told, const std::vector<ErrorValue>& shown) {
    QVERIFY(!shown.empty());
    QCOMPARE(static_cast<size_t>(told.size()), shown.size());
    for (const ErrorValue& w : shown) {
      std::vector<QJsonObject> found;
      for (const QJsonValue& v : told)
        if (v["reference"] == w.reference.c_str() && v["target"] == w.target.c_str() && v["component"] == w.component.c_str() &&
            v["metric"] == w.metric.c_str() && v["roi"] == w.roi.c_str())
          found.push_back(v.toObject());
      QVERIFY2(found.size() == 1, (w.reference + " " + w.component + " " + w.metric + " " + w.roi).c_str());
      const QJsonObject& e = found.front();
      const auto same = [&](const char* key, double value) { return std::isfinite(value) ? e[key].isDouble() && e[key].toDouble() == value : e[key].isNull(); };
      const QByteArray which = QJsonDocument(e).toJson(QJsonDocument::Compact);
      QVERIFY2(same("value", w.value), (which + " against the window's " + QByteArray::number(w.value, 'g', 17)).constData());
      QVERIFY2(same("noise_floor", w.noiseFloor), (which + " against the window's " + QByteArray::number(w.noiseFloor, 'g', 17)).constData());
      QVERIFY2(same("standard_error", w.standardError), (which + " against the window's " + QByteArray::number(w.standardError, 'g', 17)).constData());
    }
  }

 private slots:
  void initTestCase() {
    savePreset(smallPreset(), folder_.filePath("small.json").toStdString());
    settings_ = std::make_unique<Settings>(folder_.filePath("settings.ini"));
    SessionOptions options;
    options.device.validation = true;
    link_ = std::make_unique<SessionLink>(options);
    window_ = std::make_unique<MainWindow>(*link_, *settings_, folder_.filePath("small.json"));
    window_->show();
    QTRY_VERIFY_WITH_TIMEOUT(link_->latest() != nullptr, kLongest);
  }

  /// The window's device reports what the validation layers say through the log, where this looks for it.
  void cleanupTestCase() {
    const QPlainTextEdit* log = window_->findChild<LogPanel*>()->findChild<QPlainTextEdit*>();
    QTest::qWait(100);  // messages come by queued calls
    QVERIFY2(!log->toPlainText().contains("Vulkan: "), qPrintable(log->toPlainText()));
    logError("Vulkan: a message would be seen");
    QTRY_VERIFY(log->toPlainText().contains("Vulkan: "));
    window_.reset();
    link_.reset();
    settings_.reset();
  }

  void opensWhatItWasGiven() {
    QTRY_COMPARE_WITH_TIMEOUT(window_->document().path(), folder_.filePath("small.json"), kLongest);
    QCOMPARE(presetHash(window_->document().preset()), presetHash(smallPreset()));
    QVERIFY(!window_->document().modified());
    QVERIFY(settled(smallPreset()));
  }

  /// What waited for a later frame here waited for ever once the session slept, which on a busy machine it did now and then.
  void aSessionThatSleepsGivesAFrameWhenAsked() {
    uint64_t number = 0;
    do {
      number = link_->latest()->number;
      QTest::qWait(400);
    } while (link_->latest()->number != number);
    QElapsedTimer timer;
    timer.start();
    QVERIFY(settled(smallPreset()));
    QVERIFY(link_->latest()->number > number + 1);
    QVERIFY2(timer.elapsed() < kLongest / 4, qPrintable(QString::number(timer.elapsed())));
  }

  void editUndoRedoSaveReloadGiveWhatTheCommandLineGives() {
    Document& d = window_->document();
    const auto before = settled(d.preset());
    QVERIFY(before);
    link_->setReferenceWanted(true);
    ParameterField* field = window_->techniquePanel().parameters().row("radiosity.samples")->field();
    field->setValue(64);
    QCOMPARE(d.parameter("radiosity.samples"), std::string("64"));
    const Preset edited = d.preset();
    d.undoStack().undo();
    QCOMPARE(d.parameter("radiosity.samples"), std::string("16"));
    QCOMPARE(field->value(), 16.0);
    d.undoStack().redo();
    QCOMPARE(presetHash(d.preset()), presetHash(edited));
    QVERIFY(settled(edited));
    QTRY_VERIFY_WITH_TIMEOUT(link_->latest()->settled && !link_->latest()->errors.empty() && !link_->latest()->reference.running, kLongest);
    const auto shown = link_->latest();
    QVERIFY(shown->displayHash != before->displayHash);  // else equal pictures below would say nothing of the edit

    const QString file = folder_.filePath("edited.json");
    QSignalSpy saved(link_.get(), &EngineLink::saved);
    d.save(file);
    QVERIFY(d.modified() || saved.size() > 0);  // until it is written
    QTRY_COMPARE(saved.size(), 1);
    QVERIFY(!d.modified());
    QCOMPARE(presetJson(openTarget(file.toStdString())), presetJson(edited));

    QStringList metrics;
    for (const MetricInfo& m : metricInfos())  // the others are not measured while nobody looks at them
      if (!m.costly) metrics << QString::fromLatin1(m.id.data(), static_cast<qsizetype>(m.id.size()));
    QVERIFY(metrics.size() >= 7);
    const QJsonObject told = commandLine({"render", file, "--json", "--metrics", metrics.join(',')});
    QCOMPARE(told["image"]["display_hash"].toString().toStdString(), shown->displayHash);
    compareErrors(told["errors"].toArray(), shown->errors);
    link_->setReferenceWanted(false);
  }

  void aScreenshotBringsTheExperimentBack() {
    const QString file = folder_.filePath("shot.png");
    QSignalSpy saved(link_.get(), &EngineLink::saved);
    const auto frame = link_->latest();
    link_->saveScreenshot(frame, frame->preset, file);
    QTRY_COMPARE(saved.size(), 1);
    const Preset inside = openTarget(file.toStdString());
    QCOMPARE(presetJson(inside), presetJson(frame->preset));
    const QImage image(file);
    QCOMPARE(image.size(), QSize(frame->width, frame->height));
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) {
        const unsigned char* p = &frame->display[static_cast<size_t>(y * image.width() + x) * 4];
        QCOMPARE(image.pixel(x, y), qRgb(p[0], p[1], p[2]));
      }
  }

  void wrongFilesSaySoAndNothingIsLost() {
    window_->document().editSeed(11);
    const Preset before = window_->document().preset();
    const QString wrong[] = {write("notes.txt", "hello"), write("cut.json", "{\"version\": 1, \"scene\": "), write("empty.obj", "# nothing\n"),
                             write("odd.json", "{\"version\": 1, \"scene\": \"cornell_box\", \"technique\": \"nonsense\"}"),
                             write("picture.png", "not a picture"), folder_.filePath("missing.json")};
    for (const QString& file : wrong) {
      QSignalSpy failed(link_.get(), &EngineLink::failed);
      window_->document().open(file);
      QTRY_COMPARE_WITH_TIMEOUT(failed.size(), 1, kLongest);
      const QString message = failed[0][0].toString();
      QVERIFY2(message.contains(file.section('/', -1)) || message.contains("nonsense"), qPrintable(message));
      QVERIFY2(!message.contains('\n'), qPrintable(message));
      QTest::qWait(100);
      QCOMPARE(presetJson(window_->document().preset()), presetJson(before));
      QCOMPARE(window_->document().preset().seed, 11u);
    }
    QVERIFY(settled(before));
  }

  void aRefusedEditIsTakenBack() {
    Document& d = window_->document();
    QSignalSpy failed(link_.get(), &EngineLink::failed);
    d.editResolution(99999, 10);
    QTRY_COMPARE_WITH_TIMEOUT(failed.size(), 1, kLongest);
    QTRY_COMPARE_WITH_TIMEOUT(d.preset().width, 96, kLongest);
  }

  void techniqueSwitchAndBack() {
    Document& d = window_->document();
    const Preset before = d.preset();
    d.editTechnique("none");
    QVERIFY(settled(d.preset()));
    d.undoStack().undo();
    QCOMPARE(presetHash(d.preset()), presetHash(before));
    QVERIFY(settled(before));
  }
};

}  // namespace

QTEST_MAIN(SessionWindowTest)
#include "session_window_test.moc"
