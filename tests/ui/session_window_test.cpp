// The window with the real engine behind it: what it shows, saves and reopens is what the command line's path computes.
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>

#include "engine/experiment/open_target.h"
#include "engine/session/session.h"
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
    const auto later = [&] { return done() && link_->latest()->number > first + 1; };
    return QTest::qWaitFor(later, kLongest) ? link_->latest() : nullptr;
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

  void cleanupTestCase() {
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

  void editUndoRedoSaveReloadGiveTheSamePictureAsTheCommandLinesPath() {
    Document& d = window_->document();
    ParameterField* field = window_->techniquePanel().parameters().row("radiosity.samples")->field();
    field->setValue(64);
    QCOMPARE(d.parameter("radiosity.samples"), std::string("64"));
    const Preset edited = d.preset();
    d.undoStack().undo();
    QCOMPARE(d.parameter("radiosity.samples"), std::string("16"));
    QCOMPARE(field->value(), 16.0);
    d.undoStack().redo();
    QCOMPARE(presetHash(d.preset()), presetHash(edited));
    const auto shown = settled(edited);
    QVERIFY(shown);

    const QString file = folder_.filePath("edited.json");
    QSignalSpy saved(link_.get(), &EngineLink::saved);
    d.save(file);
    QVERIFY(d.modified() || saved.size() > 0);  // until it is written
    QTRY_COMPARE(saved.size(), 1);
    QVERIFY(!d.modified());
    const Preset reloaded = openTarget(file.toStdString());
    QCOMPARE(presetJson(reloaded), presetJson(edited));

    SessionOptions options;
    options.device.validation = true;
    Session session(options);
    session.load(reloaded);
    const auto again = session.settle();
    QCOMPARE(again->displayHash, shown->displayHash);
    QCOMPARE(session.device().takeValidationMessages(), std::vector<std::string>{});
  }

  void errorsAreThoseOfTheCommandLinesPath() {
    link_->setReferenceWanted(true);
    const auto shown = settled(window_->document().preset());
    QVERIFY(shown);
    QTRY_VERIFY_WITH_TIMEOUT(link_->latest()->settled && !link_->latest()->errors.empty() && !link_->latest()->reference.running, kLongest);
    const auto frame = link_->latest();
    SessionOptions options;
    options.device.validation = true;
    Session session(options);
    session.load(window_->document().preset());
    session.settle();
    session.reference();
    for (const ErrorValue& e : session.measureErrors({"relmse", "mse", "bias"})) {
      bool found = false;
      for (const ErrorValue& w : frame->errors)
        if (w.metric == e.metric && w.reference == e.reference && w.component == e.component && w.roi == e.roi && w.target == e.target) {
          found = true;
          QCOMPARE(w.value, e.value);
        }
      QVERIFY2(found, e.metric.c_str());
    }
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
